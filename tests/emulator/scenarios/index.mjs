// Index: what the image makes of pulses that come at known times, from six cranks at 200 rev/s at once.
//
// The cranks of the scene are each off by a known angle, and the host says at which cycle each passes its sensor. The
// image tells what it measured when it is stopped at full speed. Then the same with noise on the lines: glitches
// shorter than what counts, between the pulses.

import { blobOf, predict, scene } from '../bench/host.mjs';
import { log } from '../bench/log.mjs';
import { CYCLES_PER_S, Machine } from '../bench/machine.mjs';
import * as pins from '../bench/pins.mjs';
import { act } from '../bench/play.mjs';

const MOST_DEG = 0.01;

export const title = 'Index: six cranks at 200 rev/s';

export function run(outcome) {
  const played = scene('two-hundred');
  const predicted = predict(played);
  const clean = measure(played, predicted);
  told(outcome, 'pulses alone', clean, played);
  const noisy = measure(played, predicted, glitches);
  told(outcome, 'with glitches', noisy, played);
}

function told(outcome, name, measured, { toml }) {
  const errors = measured.map((deg, axis) => Math.abs(deg - toml.axis[axis].start_deg));
  const worst = Math.max(...errors);
  outcome.say(`${name}: drift of ${measured.map((deg) => deg.toFixed(4)).join(', ')}°, at most ${worst.toFixed(4)}° off`);
  outcome.check(worst <= MOST_DEG, `${name}: phases are known to ${MOST_DEG}°, not ${worst}`);
  outcome.figure(`index phase at 200 rev/s, ${name}, error, deg`, worst);
}

/** The drifts that the image tells of as it is stopped. */
function measure(played, predicted, disturb = () => {}) {
  const machine = new Machine({ ...played, blob: blobOf(played) });
  machine.boot();
  const began = machine.start();
  disturb(machine, predicted, began);
  act(machine, played, predicted, began);
  const lines = log(machine.board);
  const line = lines.find((text) => /Stop, drift/.test(text));
  if (!line) throw new Error(`the log tells of no stop:\n${lines.join('\n')}`);
  return line.match(/drift \[(.*)\]/)[1].split(',').map(Number);
}

/** Twenty glitches a turn on each line, half a microsecond long, kept clear of the pulses by twice as much. */
function glitches(machine, predicted, began) {
  const length = Math.round(0.5e-6 * CYCLES_PER_S);
  const apart = CYCLES_PER_S / 200 / 20;
  for (let axis = 0; axis < machine.axes; axis += 1) {
    const edges = predicted.edges.get(`index_${axis}`).map(({ cycle }) => cycle);
    const to = edges[edges.length - 1];
    for (let at = 1000 + axis * 77; at < to; at += Math.round(apart * (1 + 0.1 * Math.sin(at)))) {
      if (edges.every((edge) => Math.abs(edge - at) > 4000)) {
        machine.board.stimulus.pulse(began + at, pins.INDEX[axis], length);
      }
    }
  }
}
