// Faults: each reaction that this board can have, on host and firmware alike, from one and the same scene file.
//
// The host plays the scene with its `[[fault]]`. The firmware's pins get the index pulses of the host's cranks, its alarms and its
// inputs. For the faults that need it, the processor is kept from its deadlines, or a channel from its axis. Host and firmware must then
// be in the same state at every tick, report the same events in the same tick, and step alike: to the cycle. Where a correction follows a
// measurement, steps may differ by the error with which the firmware may read a pulse.
//
// One fault cannot be reproduced exactly: a stopped channel costs its axis other steps, and at another moment of the tick, than half a
// tick of a simulated axis. There the states and events are compared, which may be a few ticks apart, and the steps up to then.

import { predict, scene, settingsOf } from '../bench/host.mjs';
import { log } from '../bench/log.mjs';
import { CYCLES_PER_S, Machine } from '../bench/machine.mjs';
import * as pins from '../bench/pins.mjs';
import { feed } from '../bench/play.mjs';
import { starve } from '../bench/starve.mjs';
import { eventsOfHost, eventsOfLog } from '../bench/events.mjs';
import { offsetOf } from './index.mjs';

/** The greatest difference of events' sizes and phases, host against firmware. Builds differ by where in a tick the lines are sampled, and
 * have shown 0.0001 to 0.00026. */
const MAX_DEG = 0.0005;

/** Error of a correction that follows a measurement: the firmware samples a line every 7 cycles, 3 cycles late, on each of two axes. */
const READING_CYCLES = 2 * (7 + 3);

/** From a deadline to the first cycle of its tick: as in parity.mjs. */
const MAX_OFFSET = 25;

/** Ticks by which the firmware may report later if a fault cannot be reproduced exactly. */
const MAX_LATER = 2;

/** Time until all events are in the log. */
const REPORTING_S = 0.03;

const stops = ['homing', 'run', 'stop', 'fault'];
const parks = ['homing', 'run', 'stop', 'parked'];
const disables = ['homing', 'run', 'fault'];
const refuses = ['homing', 'stop', 'fault'];

/** The scenes with their expected ends: states in turn, the events, and the reaction to them. */
const CASES = [
  ['lost-steps', 'correct', parks, ['lost-steps'], { corrects: true }],
  ['lost-steps-beyond-limit', 'stop', stops, ['index-timeout', 'lost-steps']],
  ['slip', 'correct', parks, ['slip', 'slip'], { corrects: true }],
  ['slip-beyond-limit', 'correct, stop', stops, ['slip', 'index-timeout', 'slip'], { corrects: true }],
  ['stuck', 'stop', stops, ['index-timeout']],
  ['runaway', 'stop, disable', stops, ['slip', 'runaway']],
  ['index-missing', 'stop', stops, ['index-timeout', 'index-missing']],
  ['index-dead', 'stop', stops, ['index-timeout']],
  ['index-extra', 'report', parks, ['index-extra']],
  ['index-noisy', 'report, stop', stops, ['index-extra', 'index-extra', 'index-extra', 'index-extra']],
  ['common-lag', 'stop', stops, ['common-lag']],
  ['swapped-wiring', 'stop in homing', refuses, ['swapped-wiring'], { corrects: true }],
  ['homing-range-exceeded', 'stop in homing', refuses, ['homing-range-exceeded']],
  ['start-out', 'corrected in homing', parks, [], { corrects: true }],
  ['drive-alarm', 'stop', stops, ['drive-alarm']],
  ['drive-alarm-short', 'stop', stops, ['drive-alarm']],
  ['at-once', 'stop', stops, ['drive-alarm', 'stop-input']],
  ['overrun', 'stop', stops, ['overrun'], { stands: true }],
  ['step-fifo-underrun', 'stop', stops, ['step-fifo-underrun'], { differs: true }],
  ['enable-loss', 'disable', disables, ['enable-loss']],
  ['stop-input', 'park', parks, ['stop-input']],
];

/** Faults that need hardware which the board does not have. */
const NOT_HERE = 'stuck, reversed, encoder-glitch by an encoder; tilt, warp, common-lag of servos: no inputs for encoders, no outputs for servos';

export const title = 'Faults: the same reactions on host and firmware';

export function run(outcome) {
  let turned;
  outcome.say(`${'scene'.padEnd(16)} ${'reaction'.padEnd(18)} ${'events'.padEnd(44)} states (ticks after the start)`);
  let alike = 0;
  let longest = { own: 0 };
  let worst = 0;
  for (const [name, reaction, states, expected, how = {}] of CASES) {
    const played = scene(`faults/${name}`);
    const predicted = predict(played);
    const settings = settingsOf(played);
    const started = () => {
      const machine = new Machine({ ...played, settings });
      machine.boot();
      return [machine, machine.start()];
    };
    turned ??= offsetOf(...started(), predicted);
    const [machine, began] = started();
    const wrong = [];
    put(machine, played, predicted, began, turned);
    const firmware = eventsOfLog(log(machine.board), wrong);
    const host = eventsOfHost(predicted);
    worst = Math.max(worst, compare(firmware, host, how, wrong));
    const inTurn = host.states.map(({ state }) => state);
    if (inTurn.join() !== states.join()) wrong.push(`it goes through ${states.join(', ')}, not ${inTurn.join(', ')}`);
    const kinds = host.events.map(({ kind }) => kind);
    if (kinds.join() !== expected.join()) wrong.push(`it reports ${expected.join(', ') || 'nothing'}, not ${kinds.join(', ')}`);
    for (const { own } of machine.ticks(began)) if (own > longest.own) longest = { own, name };
    const steps = stepsAlike(machine, played, predicted, began, how, wrong);
    const words = firmware.events.map(({ kind, axis, tick }) => `${kind}${axis === undefined ? '' : ` ${axis}`} @${tick}`).join(', ');
    const passed = firmware.states.map(({ tick, state }) => `${state} ${tick}`).join(', ');
    outcome.say(`${name.padEnd(16)} ${reaction.padEnd(18)} ${words.padEnd(44)} ${passed}; ${steps}`);
    for (const text of wrong) outcome.check(false, `${name}: ${text}`);
    if (wrong.length === 0) alike += 1;
  }
  outcome.say(`${alike} of ${CASES.length} alike; sizes and phases at most ${worst.toFixed(4)}° apart. Not on this board: ${NOT_HERE}`);
  outcome.say(`the longest of their ticks is one of ${longest.name}: ${longest.own} cycles`);
  outcome.figure('faults whose reactions are alike on host and firmware', alike, 'higher');
  outcome.figure('tick of 4 axes with a fault in it, worst, cycles', longest.own);
  outcome.figure('sizes and phases of events, host against firmware, deg', worst, 'neither');
}

/** Applies the host's inputs and faults to the firmware, and runs it to the end of the host's prediction. */
function put(machine, played, predicted, began, turned) {
  const last = feed(machine, played, predicted, began, turned);
  const at = (seconds) => began + Math.round(seconds * CYCLES_PER_S);
  const held = (pin, on, off, { at_s: from, for_s: length }) => {
    machine.set(pin, on, at(from));
    if (length !== undefined) machine.set(pin, off, at(from + length));
  };
  for (const fault of played.toml.fault ?? []) {
    const { kind, axis, at_s: from, count = 3 } = fault;
    if (kind === 'drive-alarm') held(pins.ALARM[axis], 1, 0, fault);
    if (kind === 'enable-loss') held(pins.ENABLE, 1, 0, fault);
    if (kind === 'stop-input') held(pins.STOP, 1, 0, fault);
    if (kind === 'overrun') {
      // From before the first deadline that the host misses to a tenth of a tick after the last.
      machine.board.run({ untilCycle: at(from) });
      const deadline = Math.ceil((at(from) - began) / machine.tick) + count;
      machine.freeze((began + (deadline + 0.1) * machine.tick - machine.board.cycle) / CYCLES_PER_S);
    }
    if (kind === 'step-fifo-underrun') {
      machine.board.run({ untilCycle: at(from) });
      starve(machine, axis);
    }
  }
  machine.board.run({ untilCycle: Math.max(last, machine.board.cycle) + Math.round(REPORTING_S * CYCLES_PER_S) });
}

/** Checks that states, their ticks and the events are the same. Gives the largest difference of sizes and phases, degrees. */
function compare(firmware, host, { differs = false }, wrong) {
  const later = differs ? MAX_LATER : 0;
  const near = (a, b) => Math.abs(a - b) <= later;
  const names = (events) => events.map(({ kind, axis = '', latched }) => `${latched ? 'fault' : 'reported'}: ${kind} ${axis}`.trim()).join(', ');
  const walk = ({ states }) => states.map(({ tick, state }) => `${state} ${tick}`).join(', ');
  const sameStates = firmware.states.length === host.states.length
    && firmware.states.every(({ tick, state }, i) => state === host.states[i].state && (differs || tick === host.states[i].tick));
  if (!sameStates) wrong.push(`states and ticks of the host, ${walk(host)}; not ${walk(firmware)}`);
  if (names(firmware.events) !== names(host.events)) {
    wrong.push(`the host's events, ${names(host.events)}; not ${names(firmware.events)}`);
    return 0;
  }
  let worst = 0;
  firmware.events.forEach((event, i) => {
    const other = host.events[i];
    if (!near(event.tick, other.tick)) wrong.push(`${event.kind} at tick ${other.tick}, not ${event.tick}`);
    if (differs) return;
    const apart = Math.max(Math.abs(event.sizeDeg - other.sizeDeg), nearest(event.phaseDeg - other.phaseDeg));
    if (apart > MAX_DEG) wrong.push(`${event.kind} of ${other.sizeDeg}° at ${other.phaseDeg}°, not ${event.sizeDeg}° at ${event.phaseDeg}°`);
    worst = Math.max(worst, apart);
  });
  return worst;
}

const nearest = (deg) => Math.abs(deg - 360 * Math.round(deg / 360));

/** Checks that step edges are as predicted. Gives a description of the result. */
function stepsAlike(machine, { toml }, predicted, began, { corrects = false, differs = false, stands = false }, wrong) {
  const perStep = 360 / toml.axes.steps_per_turn;
  const max = { cycles: 0, deg: 0 };
  let count = 0;
  let compared = Infinity;
  for (let axis = 0; axis < machine.axes; axis += 1) {
    const wire = `step_${axis}`;
    const expected = predicted.edges.get(wire).filter(({ level }) => level === 1).map(({ cycle }) => cycle);
    const actual = machine.board.edges.to(wire, 1).filter((cycle) => cycle >= began);
    if (!differs && actual.length !== expected.length) wrong.push(`${wire}: ${expected.length} steps, not ${actual.length}`);
    const offset = actual[0] - began - expected[0];
    for (let i = 0; i < Math.min(actual.length, expected.length); i += 1) {
      const off = Math.abs(actual[i] - began - expected[i] - offset);
      if (off > 0 && differs) {
        compared = Math.min(compared, expected[i]);
        break;
      }
      count += 1;
      // The longer interval of those before and after this step. Where the crank comes to rest, the time of a step is arbitrary.
      const apart = Math.max((expected[i + 1] ?? Infinity) - expected[i], expected[i] - (expected[i - 1] ?? -Infinity));
      max.cycles = Math.max(max.cycles, off);
      max.deg = Math.max(max.deg, (off / apart) * perStep);
    }
  }
  // After a standstill all machines begin again, some cycles after a deadline, as at the start.
  if (stands && max.cycles <= MAX_OFFSET) max.cycles = 0;
  const until = compared < Infinity ? ` up to tick ${Math.floor(compared / machine.tick)}` : '';
  if (!corrects) {
    if (max.cycles > 0) wrong.push(`steps come to the cycle, not ${max.cycles} off`);
    return `${count} steps${until}, 0 cycles off`;
  }
  const allowed = (READING_CYCLES / CYCLES_PER_S) * toml.limits.speed_hz * 360;
  if (max.deg > allowed) wrong.push(`cranks are within ${allowed.toFixed(4)}° of the host's, not ${max.deg.toFixed(4)}`);
  return `${count} steps, ${max.deg.toFixed(4)}° off`;
}
