// Plays a scene on a machine that has been started.

import { CYCLES_PER_S } from './machine.mjs';
import * as pins from './pins.mjs';

/**
 * Applies the scene's inputs and the host's index pulses to the machine, at their times from `began` on. Runs it up to half a tick
 * after the last predicted edge.
 */
export function act(machine, played, predicted, began) {
  const last = feed(machine, played, predicted, began);
  machine.board.run({ untilCycle: last + machine.tick / 2 });
}

/**
 * Schedules these inputs and pulses. The cranks turn with the steps, which begin `turned` cycles after the deadline. Gives the cycle of
 * the last predicted edge.
 */
export function feed(machine, { inputs }, predicted, began, turned = 0) {
  for (const { at_s: seconds, line, active } of inputs) {
    // Both lines are low in normal operation: stop is high while it is active, enable is high while it is inactive.
    const [pin, level] = line === 'stop' ? [pins.STOP, active] : [pins.ENABLE, !active];
    machine.set(pin, Number(level), began + Math.round(seconds * CYCLES_PER_S));
  }
  let last = 0;
  for (const [wire, edges] of predicted.edges) {
    const [, kind, axis] = wire.match(/^(index|step|dir)_(\d)$/) ?? [];
    for (const { cycle, level } of edges) {
      if (kind) last = Math.max(last, cycle);
      if (kind === 'index') machine.set(pins.INDEX[axis], level, began + turned + cycle);
    }
  }
  return began + last;
}
