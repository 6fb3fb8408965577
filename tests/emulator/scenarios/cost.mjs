// Cost: what a control tick takes of the processor, for 2, 4 and 6 axes, with everything on; and the most ticks a second
// that the board accepts.
//
// A tick is what the loop's interrupt takes from the moment in which its deadline wakes it to that in which it sleeps
// again: reading, reckoning and handing over. What the timer's and the channels' interrupts take beside it is counted
// too, and told apart. Nothing in them waits for the flash: all of it runs from RAM.

import { blobOf, predict, refusedBy, scene, withAxes } from '../bench/host.mjs';
import { log } from '../bench/log.mjs';
import { Machine } from '../bench/machine.mjs';
import { act } from '../bench/play.mjs';

const AXES = [2, 4, 6];

/** What the worst tick of six axes is meant to come to, in cycles: 48 µs. Not reached; figures are kept from rising. */
const GOAL_CYCLES = 6000;

export const title = 'Cost: a control tick with everything on';

export function run(outcome) {
  for (const axes of AXES) {
    const played = scene('everything', withAxes(axes));
    const predicted = predict(played);
    const machine = new Machine({ ...played, blob: blobOf(played) });
    machine.boot();
    const began = machine.start();
    const before = machine.board.usage.sums();
    const waited = machine.board.core.waitedInHandlers;
    act(machine, played, predicted, began);
    const after = machine.board.usage.sums();
    const ticks = machine.ticks(began).map(({ own }) => own);
    const mean = ticks.reduce((sum, own) => sum + own, 0) / ticks.length;
    const worst = Math.max(...ticks);
    const all = (after.awake - before.awake) / ticks.length;
    outcome.say(
      `${axes} axes: worst ${worst}, mean ${mean.toFixed(0)} cycles a tick of ${machine.tick}; with all interrupts ${all.toFixed(0)}`,
    );
    const waits = machine.board.core.waitedInHandlers - waited;
    outcome.check(waits === 0, `${axes} axes: no interrupt waits for the flash, not for ${waits} cycles in all`);
    outcome.figure(`tick of ${axes} axes, worst, cycles`, worst);
    outcome.figure(`tick of ${axes} axes, mean, cycles`, Math.round(mean));
    if (axes === 6) {
      outcome.say(`goal for the worst tick of 6 axes: ${GOAL_CYCLES}; it is ${(worst / GOAL_CYCLES).toFixed(1)} times that`);
      outcome.figure('stack, deepest, bytes', machine.board.stackDepth);
    }
  }
  for (let axes = 2; axes <= 6; axes += 1) fastest(outcome, axes);
}

/** The shortest tick that the board accepts, with everything on: every deadline is met. */
function fastest(outcome, axes) {
  const at = (tickHz) => scene('everything', (toml) => {
    withAxes(axes)(toml);
    toml.control.tick_hz = tickHz;
  });
  const [, most] = refusedBy(at(10_000))?.match(/give at most (\d+) Hz/) ?? [undefined, 10_000];
  const played = at(Number(most));
  const machine = new Machine({ ...played, blob: blobOf(played) });
  machine.boot();
  act(machine, played, predict(played), machine.start());
  const trouble = log(machine.board).find((line) => /fault|missed|late|lost|rejected/i.test(line))?.trim();
  outcome.check(trouble === undefined, `${axes} axes at ${most} ticks a second: the log tells of no trouble: ${trouble}`);
  outcome.say(`${axes} axes: up to ${most} ticks a second, every deadline met`);
}
