// Example programs, scaled to the limits of the machine.

/** Standard gravity, m/s²: the unit of `amax_g`. */
const GRAVITY = 9.80665;

/** Programs. `level(part)` is a part of the largest amplitude of the machine, in g. */
export const EXAMPLES = [
  {
    name: 'One level',
    program: (level) => `[[program]]
amax_g = ${level(0.5)}
ramp_s = 3
hold_s = 5
`,
  },
  {
    name: 'Wet, mix, settle',
    program: (level) => `[[program]]              # wet
amax_g = ${level(0.15)}
ramp_s = 3
hold_s = 4

[[program]]              # mix
amax_g = ${level(0.7)}
ramp_s = 4
hold_s = 8

[[program]]              # settle
amax_g = ${level(0.1)}
ramp_s = 3
hold_s = 3
shape = "linear"
`,
  },
  {
    name: 'Three bursts',
    program: (level) => `[[program]]
repeat = 3
segments = [
  { amax_g = ${level(0.6)}, ramp_s = 2, hold_s = 2 },
  { amax_g = ${level(0.2)}, ramp_s = 2, hold_s = 1 },
]
`,
  },
  {
    name: 'Staircase',
    program: (level) =>
      [0.2, 0.4, 0.6, 0.8].map((part) => `[[program]]\namax_g = ${level(part)}\nramp_s = 1\nhold_s = 2\n`).join('\n'),
  },
];

/** Replaces the program of a pane's text by an example. `limits` are those of the last scene without mistakes. */
export function insertExample(pane, index, limits) {
  const most_g = (limits?.amax_mps2 ?? 10 * GRAVITY) / GRAVITY;
  const level = (part) => String(Number((part * most_g).toPrecision(2)));
  pane.replace(withProgram(pane.text, EXAMPLES[index].program(level)));
}

/** Returns the text with another program, in the place of the first entry, or at the end if there is none. */
export function withProgram(text, program) {
  const kept = [];
  let at = null;
  let isProgram = false;
  for (const line of text.split('\n')) {
    const heading = /^\s*\[\[?\s*([\w.-]+)\s*\]\]?\s*(#.*)?$/.exec(line);
    if (heading) isProgram = heading[1] === 'program';
    if (!isProgram) kept.push(line);
    else at ??= kept.length;
  }
  const lines = program.trimEnd().split('\n');
  if (at === null) kept.push(...(kept.at(-1) === '' ? [] : ['']), ...lines);
  else kept.splice(at, 0, ...lines, ...(at < kept.length ? [''] : []));
  return `${kept.join('\n').trimEnd()}\n`;
}
