// Index: the firmware's evaluation of pulses at known times, from six cranks at 200 rev/s at once.
//
// The host gives the cycle at which each crank passes its sensor, and the commanded phase of each axis at that cycle. The
// phase error of the pulse is the difference between the sensor's phase and the commanded phase. The firmware reports its
// measured phase error when it is stopped at full speed. The second part repeats this with noise on the lines: glitches
// shorter than the minimum width.

import { predict, scene, settingsOf } from '../bench/host.mjs';
import { log } from '../bench/log.mjs';
import { CYCLES_PER_S, Machine } from '../bench/machine.mjs';
import * as pins from '../bench/pins.mjs';
import { act } from '../bench/play.mjs';

export const MAX_DEG = 0.01;

/** Speed of the scene `two-hundred`. */
export const TURN_HZ = 200;

export const title = 'Index: six cranks at 200 rev/s';

export function run(outcome) {
  const played = scene('two-hundred');
  const predicted = predict(played);
  const stands = standsFor(played, predicted);
  for (const [name, disturb] of [['pulses alone', () => {}], ['with glitches', glitches]]) {
    const measured = measure(played, predicted, disturb);
    const worst = Math.max(...measured.map((deg, axis) => Math.abs(deg - stands[axis])));
    outcome.say(`${name}: drifts of ${measured.map((deg) => deg.toFixed(4)).join(', ')}°, at most ${worst.toFixed(4)}° off`);
    outcome.check(worst <= MAX_DEG, `${name}: phases are known to ${MAX_DEG}°, not ${worst}`);
    outcome.figure(`index phase at 200 rev/s, ${name}, error, deg`, worst);
  }
}

/** The phase error for each axis's last pulse before the stop: the sensor's phase less the commanded one. */
export function standsFor({ toml, inputs, tickHz, axes }, { edges, trace }) {
  const [{ at_s: stop }] = inputs;
  return Array.from({ length: axes }, (_, axis) => {
    const rises = edges.get(`index_${axis}`).filter(({ level }) => level === 1);
    const pulse = rises.findLast(({ cycle }) => cycle < (stop - 1 / tickHz) * CYCLES_PER_S);
    const ticks = (pulse.cycle / CYCLES_PER_S) * tickHz;
    const turns = (tick) => Number(trace[tick][`command_turns_${axis}`]);
    const row = trace.findIndex(({ t_s: seconds }) => Math.round(Number(seconds) * tickHz) === Math.floor(ticks));
    const command = turns(row) + (ticks - Math.floor(ticks)) * (turns(row + 1) - turns(row));
    const index = toml.axis[axis].index_deg ?? 0;
    return nearest(index - command * 360);
  });
}

const nearest = (deg) => deg - 360 * Math.round(deg / 360);

/** The phase errors that the firmware reports as it is stopped. */
function measure(played, predicted, disturb) {
  const settings = settingsOf(played);
  const started = () => {
    const machine = new Machine({ ...played, settings });
    machine.boot();
    return [machine, machine.start()];
  };
  const [first, began] = started();
  const offset = offsetOf(first, began, predicted);
  const [machine] = started();
  disturb(machine, predicted, began + offset);
  act(machine, played, predicted, began + offset);
  const lines = log(machine.board);
  const line = lines.find((text) => /Stop, phase error/.test(text));
  if (!line) throw new Error(`the log reports no stop:\n${lines.join('\n')}`);
  return line.match(/phase error \[(.*)\]/)[1].split(',').map(Number);
}

/** Cycles from the deadline to the first step. The cranks turn with the steps. The number is the same each time. */
export function offsetOf(machine, began, predicted) {
  machine.run(0.02);
  return machine.board.edges.of('step_0')[0].cycle - began - predicted.edges.get('step_0')[0].cycle;
}

/** Twenty glitches a turn on each line, half a microsecond long, kept clear of the pulses themselves. */
function glitches(machine, predicted, began) {
  const length = Math.round(0.5e-6 * CYCLES_PER_S);
  const spacing = CYCLES_PER_S / 200 / 20;
  const clear = 4000;
  for (let axis = 0; axis < machine.axes; axis += 1) {
    const edges = predicted.edges.get(`index_${axis}`).map(({ cycle }) => cycle);
    let next = 0;
    for (let at = 1000 + axis * 77; at < edges[edges.length - 1]; at += Math.round(spacing * (1 + 0.1 * Math.sin(at)))) {
      while (edges[next] < at - clear) next += 1;
      if (edges[next] > at + clear) machine.board.stimulus.pulse(began + at, pins.INDEX[axis], length);
    }
  }
}
