// Parity: every edge of STEP and DIR comes at the cycle that the host predicts.
//
// A scene's blob is placed in the flash, the button is pressed, the scene's inputs are acted out and its index pulses
// given as the host has them. Then the edges of each pin are compared, one by one: there must be as many, and all must be
// off by the same number of cycles on a PIO block. That one number is what lies between a deadline of the timer and the
// first cycle of the tick that begins there.

import { blobOf, predict, scene } from '../bench/host.mjs';
import { CYCLES_PER_S, Machine } from '../bench/machine.mjs';
import * as pins from '../bench/pins.mjs';

const SCENES = ['start-stop', 'band', 'reversal', 'index', 'gears', 'fast'];

/** Edges compared in all must be at least this many. */
const LEAST_EDGES = 100_000;

/** Edges due at one instant, across blocks: at most this far apart. */
const MOST_SKEW = 2;

export const title = 'Parity: edges against the host’s prediction';

export function run(outcome, { scenes = SCENES } = {}) {
  let total = 0;
  let skew = 0;
  for (const name of scenes) {
    const { edges, offsets } = compare(outcome, scene(name));
    total += edges;
    const [first, second = first] = offsets;
    skew = Math.max(skew, Math.abs(first - second));
    outcome.say(`${name.padEnd(12)} ${edges.toString().padStart(8)} edges, 0 cycles off (blocks begin at ${offsets.join(', ')})`);
  }
  outcome.say(`${total} edges compared; skew within a block 0 cycles, across blocks ${skew}`);
  outcome.check(total >= LEAST_EDGES, `at least ${LEAST_EDGES} edges are compared, not ${total}`);
  outcome.check(skew <= MOST_SKEW, `blocks are at most ${MOST_SKEW} cycles apart, not ${skew}`);
  outcome.figure('parity edges', total);
  outcome.figure('skew across blocks, cycles', skew);
}

function compare(outcome, played) {
  const predicted = predict(played);
  const machine = play(played, predicted);
  const offsets = [];
  let count = 0;
  for (let axis = 0; axis < played.axes; axis += 1) {
    for (const wire of [`step_${axis}`, `dir_${axis}`]) {
      const want = predicted.edges.get(wire);
      const got = machine.board.edges.of(wire).filter(({ cycle }) => cycle >= machine.began);
      const where = `${played.name}, ${wire}`;
      outcome.check(got.length === want.length, `${where}: ${want.length} edges, not ${got.length}`);
      const block = pins.blockOf(axis);
      const worst = { at: -1, off: 0 };
      for (let i = 0; i < Math.min(got.length, want.length); i += 1) {
        const off = got[i].cycle - machine.began - want[i].cycle;
        offsets[block] ??= off;
        if (off !== offsets[block] || got[i].level !== want[i].level) {
          worst.at = i;
          worst.off = off;
          break;
        }
      }
      outcome.check(worst.at < 0, `${where}: edge ${worst.at} is ${worst.off} cycles from its prediction, as are all before it by ${offsets[block]}`);
      count += got.length;
    }
  }
  return { edges: count, offsets };
}

/** Runs the image through a scene, up to half a tick after the last edge that is predicted. */
export function play(played, predicted, options = {}) {
  const machine = new Machine({ ...played, blob: blobOf(played), options });
  machine.boot();
  machine.began = machine.start();
  const at = (seconds) => machine.began + Math.round(seconds * CYCLES_PER_S);
  for (const { at_s: seconds, line, active } of played.inputs) {
    // Both lines are low when all is well: stop goes high when it is active, enable when it is not.
    const [pin, level] = line === 'stop' ? [pins.STOP, active] : [pins.ENABLE, !active];
    machine.set(pin, Number(level), at(seconds));
  }
  let last = 0;
  for (const [wire, edges] of predicted.edges) {
    const [, kind, axis] = wire.match(/^(index|step|dir)_(\d)$/) ?? [];
    for (const { cycle, level } of edges) {
      if (kind) last = Math.max(last, cycle);
      if (kind === 'index') machine.set(pins.INDEX[axis], level, machine.began + cycle);
    }
  }
  machine.board.run({ untilCycle: machine.began + last + machine.tick / 2 });
  return machine;
}
