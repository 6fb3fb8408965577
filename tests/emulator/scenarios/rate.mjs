// Rate: how many steps a second the image sustains, and what they cost the processor.
//
// Six axes at the highest rate that the settings accept, 1 M steps/s each, for 100 ms; then scenes of 2, 4 and 6 axes at
// the same rate for the cost of a tick. Steps are counted at the pins. A machine that ran dry, or a deadline that was
// missed, would be a fault, and the log and the state would show it.

import { blobOf, predict, scene } from '../bench/host.mjs';
import { log } from '../bench/log.mjs';
import { CYCLES_PER_S, Machine } from '../bench/machine.mjs';

const SECONDS = 0.1;
const LEAST_RATE = 1e6 * 0.999;
const MOST_BUSY = 0.5;

export const title = 'Rate: a million steps a second on each axis';

export function run(outcome) {
  const played = scene('fast');
  const { report } = predict(played);
  const machine = new Machine({ ...played, blob: blobOf(played) });
  machine.boot();
  const began = machine.start();
  // The program's hold begins after its ramp, and what the shaft's limits add to that.
  const from = began + Math.round((report.time_in_state_s.align + 0.062) * CYCLES_PER_S);
  machine.board.run({ untilCycle: from });
  const before = machine.board.usage.sums();
  machine.board.run({ untilCycle: from + SECONDS * CYCLES_PER_S });
  const after = machine.board.usage.sums();

  const rates = [];
  for (let axis = 0; axis < played.axes; axis += 1) {
    const steps = machine.board.edges.to(`step_${axis}`, 1).filter((cycle) => cycle >= from).length;
    rates.push(steps / SECONDS);
  }
  const busy = (after.awake - before.awake) / (after.cycles - before.cycles);
  const steps = rates.reduce((sum, rate) => sum + rate * SECONDS, 0);
  const ticks = machine.ticks(from).map(({ own }) => own);
  const worst = Math.max(...ticks);
  outcome.say(`${played.axes} axes, ${(Math.min(...rates) / 1e6).toFixed(4)} M steps/s each for ${SECONDS * 1e3} ms, ${(steps / SECONDS / 1e6).toFixed(2)} M in all`);
  outcome.say(`processor ${(busy * 100).toFixed(1)} % busy, worst tick ${worst} cycles, ${((after.awake - before.awake) / steps).toFixed(2)} cycles a step`);
  outcome.check(Math.min(...rates) >= LEAST_RATE, `every axis makes 1 M steps/s, not ${rates.join(', ')}`);
  outcome.check(busy < MOST_BUSY, `the processor is less than half busy, not ${(busy * 100).toFixed(1)} %`);
  const lines = log(machine.board);
  const bad = lines.filter((line) => /fault|missed|late|lost/.test(line));
  outcome.check(bad.length === 0, `the log tells of no fault: ${bad.join('; ')}`);
  outcome.check(machine.level('enable') === 1, 'the drives are still on');
  outcome.figure('processor busy at 6 × 1 M steps/s, %', busy * 100);
  outcome.figure('processor cycles a step at 6 × 1 M steps/s', (after.awake - before.awake) / steps);
  outcome.figure('worst tick at 6 × 1 M steps/s, cycles', worst);
}
