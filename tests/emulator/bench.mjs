// The bench: runs scenarios on the firmware, prints their results, and fails if a check fails.

import fs from 'node:fs';
import path from 'node:path';
import { Outcome } from './bench/outcome.mjs';
import { worse, write } from './bench/figures.mjs';

const SCENARIOS = [
  'firmware', 'parity', 'rate', 'cost', 'deadlines', 'stops', 'index', 'faults', 'safety', 'single-faults', 'settings-in-use', 'sweeps', 'store', 'link', 'wiring',
];

const HELP = `usage: tests/emulator/run [--write] [--no-figures] [SCENARIO ... | SCENE.toml ...]
       tests/emulator/run --profile SCENE [OPTION ...]
       tests/emulator/run --build

Builds the firmware, runs it in the emulator, and compares what it does with what it should.
Scenarios: ${SCENARIOS.join(', ')}; all of them if none is named.
A scene of your own is run as it is, and every edge compared with what \`cophase run\` predicts: a minute of three axes
takes about five.

  --write       keep the figures: docs/emulated.csv, the table in docs/firmware.md, and tests/emulator/image-size.toml
  --build       builds what the bench runs, and runs nothing
  --profile     where the cycles of a tick go, by function; \`--profile --help\` has its options
  --no-figures  do not compare figures, and the firmware's size, with those that are kept: for another compiler than theirs

In the environment, for \`sweeps\`:
  COPHASE_SWEEP=20            twenty times as many cases, the usual ones among them: half an hour
  COPHASE_CASE='freezes 17'   this case alone, with its log

In the environment, for \`deadlines\` and \`stops\`:
  COPHASE_SEARCH=200          so many scenes, of each line for \`stops\`; 8 and 3 if it is not given
  COPHASE_SEED=2              other scenes

The firmware is built with the default settings, whatever COPHASE_SETTINGS says; scenes are placed in its flash.

Exit status: 0 all holds; 1 something does not, or a figure is worse by over 5 %; 2 a question that makes no sense.`;

const args = process.argv.slice(2);
if (args.includes('--help') || args.includes('-h')) {
  console.log(HELP);
  process.exit(0);
}
const OPTIONS = ['--write', '--no-figures', '--only-arguments'];
const scenes = args.filter((arg) => arg.endsWith('.toml')).map((file) => path.resolve(file));
const missing = scenes.filter((file) => !fs.existsSync(file));
const requested = args.filter((arg) => !arg.startsWith('--') && !arg.endsWith('.toml'));
const unknown = [...args.filter((arg) => ![...OPTIONS, ...SCENARIOS].includes(arg) && !arg.endsWith('.toml')), ...missing];
if (unknown.length > 0) {
  console.error(`bench: nothing is called ${unknown.join(', ')}\n\n${HELP}`);
  process.exit(2);
}
const writing = args.includes('--write');
if (writing && requested.length + scenes.length > 0) {
  console.error('bench: --write keeps the figures of all scenarios, so name none');
  process.exit(2);
}
if (args.includes('--only-arguments')) process.exit(0);

const compare = !args.includes('--no-figures');
const figures = [];
const goals = [];
let failures = 0;
if (scenes.length > 0) {
  const parity = await import('./scenarios/parity.mjs');
  console.log(parity.title);
  const outcome = new Outcome('parity');
  parity.own(outcome, scenes);
  failures += outcome.failures.length;
}
for (const name of requested.length + scenes.length > 0 ? requested : SCENARIOS) {
  const scenario = await import(`./scenarios/${name}.mjs`);
  console.log(scenario.title);
  const outcome = new Outcome(name);
  scenario.run(outcome, { write: writing, compare });
  figures.push(...outcome.figures);
  goals.push(...outcome.goals);
  failures += outcome.failures.length;
}
if (writing) {
  write(figures);
  console.log('Figures written to docs/emulated.csv and docs/firmware.md.');
} else if (compare) {
  for (const sentence of worse(figures)) {
    console.log(`FAILED: ${sentence}`);
    failures += 1;
  }
}
if (goals.length > 0) {
  const missed = goals.filter(({ met }) => !met).length;
  console.log(`Goals: ${goals.length - missed} met, ${missed} missed; a missed one is a failure if it is enforced (bench/goals.mjs).`);
}
console.log(failures === 0 ? 'All of it holds.' : `${failures} of it do not hold.`);
process.exit(failures === 0 ? 0 : 1);
