// Plays a scene on a machine that has been started.

import { CYCLES_PER_S } from './machine.mjs';
import * as pins from './pins.mjs';

/**
 * Gives the machine the scene's inputs, and the index pulses that the host has, at their times from `began` on; runs it
 * up to half a tick after the last edge that is predicted.
 */
export function act(machine, played, predicted, began) {
  const last = feed(machine, played, predicted, began);
  machine.board.run({ untilCycle: last + machine.tick / 2 });
}

/**
 * Sets all of that up; the cranks turn with the steps, which begin `turned` cycles after the deadline. Gives the cycle of the last edge
 * that is predicted.
 */
export function feed(machine, { inputs }, predicted, began, turned = 0) {
  for (const { at_s: seconds, line, active } of inputs) {
    // Both lines are low when all is well: stop goes high when it is active, enable when it is not.
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
