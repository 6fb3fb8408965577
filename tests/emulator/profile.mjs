// Profile of a control tick: cycles by function, for a scene, on the firmware or on any other ELF of it.

import path from 'node:path';
import { parseArgs } from 'node:util';

const HELP = `usage: tests/emulator/run --profile SCENE [OPTION ...]
       node tests/emulator/profile.mjs SCENE [OPTION ...]     (nothing is built)

Counts every cycle of the control loop's interrupt (TIMER_IRQ_1) in a run of SCENE, a name in tests/emulator/scenes or a
file, and prints two tables as Markdown: functions as they are linked, and as they are written, with inlined functions
separate. Each has self and inclusive cycles: the mean over all ticks, and in the worst tick.

  --axes N          only the first N axes of the scene
  --sensors-alike   all index sensors at one crank angle, and no user trims
  --tick-hz N       another tick rate
  --state STATE     only ticks in this state: homing, run, stop, ...
  --tick N          this tick in place of the worst; ticks count from the start
  --longest N       list so many of the longest ticks (default 0)
  --least N         leave out functions below N cycles (default 20)
  --elf FILE        another ELF than target/thumbv6m-none-eabi/firmware/cophase-firmware`;

const OPTIONS = {
  profile: { type: 'boolean' },
  'only-arguments': { type: 'boolean' },
  help: { type: 'boolean', short: 'h' },
  axes: { type: 'string' },
  'sensors-alike': { type: 'boolean' },
  'tick-hz': { type: 'string' },
  state: { type: 'string' },
  tick: { type: 'string' },
  least: { type: 'string', default: '20' },
  longest: { type: 'string', default: '0' },
  elf: { type: 'string' },
};

function fail(text) {
  console.error(`profile: ${text}\n\n${HELP}`);
  process.exit(2);
}

function readArguments() {
  try {
    return parseArgs({ options: OPTIONS, allowPositionals: true });
  } catch (error) {
    return fail(error.message);
  }
}

const { values, positionals } = readArguments();
if (values.help) {
  console.log(HELP);
  process.exit(0);
}
if (positionals.length !== 1) fail('name one scene');
for (const name of ['axes', 'tick-hz', 'tick', 'least']) {
  if (values[name] !== undefined && !/^\d+$/.test(values[name])) fail(`--${name} takes a whole number, not ${values[name]}`);
}
if (values['only-arguments']) process.exit(0);
// The bench reads this when it is loaded.
if (values.elf) process.env.COPHASE_ELF = path.resolve(values.elf);

const { predict, scene, sensorsAlike, settingsOf, withAxes } = await import('./bench/host.mjs');
const { run } = await import('./bench/ticks.mjs');
const { markdown, Named } = await import('./bench/profile.mjs');

const [name] = positionals;
const played = scene(name.endsWith('.toml') ? path.resolve(name) : name, (toml) => {
  if (values.axes) withAxes(Number(values.axes))(toml);
  if (values['sensors-alike']) sensorsAlike(toml);
  if (values['tick-hz']) toml.control = { ...toml.control, tick_hz: Number(values['tick-hz']) };
});
const { ticks, profile, period } = run(played, predict(played), settingsOf(played), { profile: true });
const chosen = ticks.filter(({ state }) => values.state === undefined || state === values.state);
if (chosen.length === 0) fail(`no tick is in state ${values.state}; states: ${[...new Set(ticks.map(({ state }) => state))].join(', ')}`);
const worst = values.tick === undefined
  ? chosen.reduce((most, tick) => (tick.own > most.own ? tick : most))
  : ticks.find(({ number }) => number === Number(values.tick)) ?? fail(`there is no tick ${values.tick}: ${ticks.length} ticks`);

const named = new Named(profile);
const callsOf = (some) => some.map(({ call }) => call);
const mean = chosen.reduce((sum, { own }) => sum + own, 0) / chosen.length;
const which = values.state === undefined ? 'all states' : `state ${values.state}`;
console.log(`Scene ${path.basename(name, '.toml')}, ${played.axes} axes, ${played.tickHz} ticks a second (${period} cycles each): ${chosen.length} ticks, ${which}.`);
console.log(`Mean ${mean.toFixed(0)} cycles; the worst tick is number ${worst.number}, in state ${worst.state}: ${worst.own} cycles, ${worst.pulses} index pulses confirmed.\n`);
const longest = chosen.toSorted((one, other) => other.own - one.own).slice(0, Number(values.longest));
for (const { number, state, own, pulses } of longest) console.log(`Tick ${number}, state ${state}: ${own} cycles, ${pulses} index pulses confirmed.`);
for (const [how, title] of [['linked', 'Functions as linked'], ['written', 'Functions as written, inlined ones separate']]) {
  console.log(`### ${title}\n`);
  const options = { least: Number(values.least), withCalls: how === 'linked' };
  console.log(`${markdown(named.table(callsOf(chosen), how), named.table(callsOf([worst]), how), options)}\n`);
}
