// Many cases of one kind: numbered, spread evenly, and the same in every run.
//
// Case n has two numbers from 0 to 1, taken from a sequence (R2). The first cases lie evenly in the square, however
// many there are. So a longer sweep has the same cases, and others between them. A case that failed can be run alone by
// its number: COPHASE_SWEEP multiplies the number of cases, COPHASE_CASE='freezes 17' runs that one.

const SIZE = Number(process.env.COPHASE_SWEEP || 1);
const ONLY = process.env.COPHASE_CASE;
if (!(SIZE > 0)) throw new Error(`COPHASE_SWEEP is a number of times, such as 20, not ${process.env.COPHASE_SWEEP}`);

/** The real root of x³ = x + 1, which generates the sequence. */
const ROOT = 1.324717957244746;

export const spread = (number) => [(0.5 + number / ROOT) % 1, (0.5 + number / ROOT ** 2) % 1];

/** True if any case of these sweeps is selected. */
export const isSelected = (...names) => ONLY === undefined || names.some((name) => ONLY.startsWith(`${name} `));

/**
 * A sweep. Runs `count` cases, or a multiple of that. `play(u, v, number)` plays one and gives { name, wrong: the
 * conditions that failed, ended: in a word, worst: a figure }; `unit` is the unit of `worst`.
 */
export function sweep(outcome, name, count, unit, play) {
  if (!isSelected(name)) return;
  const numbers = [...Array(Math.round(count * SIZE)).keys()];
  const ends = new Map();
  let worst = -Infinity;
  for (const number of ONLY === undefined ? numbers : [Number(ONLY.slice(name.length))]) {
    const done = play(...spread(number), number);
    ends.set(done.ended, (ends.get(done.ended) ?? 0) + 1);
    worst = Math.max(worst, done.worst ?? -Infinity);
    for (const text of done.wrong) outcome.check(false, `${name} ${number} (${done.name}): ${text}`);
    if (ONLY !== undefined) outcome.say(`${name} ${number} (${done.name}): ${done.ended}${done.log ? `; the log:\n    ${done.log().join('\n    ')}` : ''}`);
  }
  const counts = [...ends].sort(([, a], [, b]) => b - a).map(([end, times]) => `${times} ${end}`);
  const ran = [...ends.values()].reduce((sum, times) => sum + times, 0);
  outcome.say(`${name.padEnd(10)} ${String(ran).padStart(4)} cases: ${counts.join(', ')}${worst > -Infinity ? `; at most ${Number(worst.toPrecision(4))} ${unit}` : ''}`);
}
