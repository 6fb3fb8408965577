// The bench: runs scenarios on the image, prints what they found, and fails if anything does not hold.
//   node bench.mjs [SCENARIO ...]

import { Outcome } from './bench/outcome.mjs';

const SCENARIOS = ['parity', 'rate', 'cost', 'index', 'safety', 'store'];

const asked = process.argv.slice(2);
const unknown = asked.filter((name) => !SCENARIOS.includes(name));
if (unknown.length > 0) {
  console.error(`bench: no scenario called ${unknown.join(', ')}; there are ${SCENARIOS.join(', ')}`);
  process.exit(2);
}
let failed = 0;
for (const name of asked.length > 0 ? asked : SCENARIOS) {
  const scenario = await import(`./scenarios/${name}.mjs`);
  console.log(scenario.title);
  const outcome = new Outcome(name);
  scenario.run(outcome);
  failed += outcome.failures.length;
}
process.exit(failed > 0 ? 1 : 0);
