// Safety: failures, the state in which the machine ends, and its log.
//
// A machine of four axes turns at a constant speed. Then one failure occurs. Each must end in the state that docs/firmware.md states for
// it, with the reason in the log. "In step" means that all axes have made the same number of steps when they stand. Times of the drives'
// enable line run from the failure to its fall.

import { scene, settingsOf } from '../bench/host.mjs';
import { log } from '../bench/log.mjs';
import { CYCLES_PER_S, Machine } from '../bench/machine.mjs';
import * as pins from '../bench/pins.mjs';
import { starve } from '../bench/starve.mjs';
import { MIN_PULSE } from '../sweeps/alarms.mjs';

/** Halfway into a tick, so that nothing is decided by a race with the deadline. */
const HALF_TICK_S = 250e-6;

export const title = 'Safety: what goes wrong, and where it ends';

export function run(outcome) {
  const played = scene('hold');
  const settings = settingsOf(played);
  for (const [name, happens, ends] of CASES) {
    const machine = new Machine({ ...played, settings });
    machine.boot();
    machine.start();
    machine.run(0.25);
    machine.happened = machine.board.cycle;
    happens(machine);
    const wrong = [];
    const end = ends(machine, (holds, text) => holds || wrong.push(text)) ?? '';
    const lines = log(machine.board);
    outcome.say(`${name.padEnd(24)} ${end}`);
    for (const text of wrong) outcome.check(false, `${name}: ${text}; the log:\n    ${lines.slice(-6).join('\n    ')}`);
  }
}

// ---- failures ----

const halfATickLater = (machine) => machine.board.cycle + Math.round(HALF_TICK_S * CYCLES_PER_S);

/** Sets an input halfway into a tick, and records the time. */
const input = (pin, level) => (machine) => {
  machine.happened = halfATickLater(machine);
  machine.set(pin, level, machine.happened);
};

/** A line is active for two cycles, halfway between two readings. */
const between = (pin) => (machine) => {
  const [last] = machine.ticks().slice(-1);
  machine.happened = last.entry + machine.tick + Math.round(machine.tick / 2);
  machine.board.stimulus.pulse(machine.happened, pin, MIN_PULSE);
};

// ---- expected ends ----

const logs = (machine, pattern) => log(machine.board).some((line) => pattern.test(line));

function drivesFell(machine, must, maxS) {
  const [fall] = machine.board.edges.to('enable', 0).filter((cycle) => cycle >= machine.happened);
  must(fall !== undefined, 'the drives are switched off');
  const seconds = (fall - machine.happened) / CYCLES_PER_S;
  must(seconds <= maxS, `the drives are off within ${maxS * 1e6} µs, not ${seconds * 1e6}`);
  return `drives off after ${(seconds * 1e6).toFixed(1)} µs`;
}

function inStep(machine, must) {
  const steps = machine.steps([0, 0, 1, 0]);
  must(new Set(steps).size === 1, `all axes made the same steps, not ${steps.join(', ')}`);
  const before = machine.board.edges.to('step_0', 1).length;
  machine.run(0.05);
  must(machine.board.edges.to('step_0', 1).length === before, 'nothing moves any more');
}

/** A coordinated stop on request: at rest, in step, drives on. */
function parks(machine, must) {
  machine.run(0.5);
  must(logs(machine, /: Parked/), 'the log says Parked');
  must(machine.level('enable') === 1, 'the drives hold');
  inStep(machine, must);
  return 'parked in step, drives on';
}

/** A fault that stops all axes together, and then either keeps the drives on or switches them off. */
const faults = (pattern, holds) => (machine, must) => {
  machine.run(0.5);
  must(logs(machine, pattern), `the log says ${pattern}`);
  const ends = stands(machine, must, holds);
  inStep(machine, must);
  resets(machine, must);
  return `stopped in step, ${ends}: ${pattern.source}`;
};

/** The state fault, with the drives on or off. */
function stands(machine, must, holds) {
  const drives = holds ? 'on' : 'off';
  must(logs(machine, new RegExp(`: Fault, .*drives ${drives}`)), `the log says Fault, drives ${drives}`);
  must(machine.level('enable') === Number(holds), `the drives are ${drives}`);
  return holds ? 'drives hold' : 'then drives off';
}

/** A fault that holds. The enable input then switches the drives off, and the fault stays. */
const holdsUntilEnableOpens = (pattern) => (machine, must) => {
  machine.run(0.5);
  must(logs(machine, pattern), `the log says ${pattern}`);
  const ends = stands(machine, must, true);
  input(pins.ENABLE, 1)(machine);
  machine.run(0.05);
  const fall = drivesFell(machine, must, 20e-6);
  must(logs(machine, /reported: enable-loss/), 'the log says enable-loss');
  machine.set(pins.ENABLE, 0);
  machine.run(0.05);
  must(machine.level('enable') === 0, 'the drives stay off');
  resets(machine, must);
  return `stopped in step, ${ends}; enable lost: ${fall}`;
};

/** Drives off at once, and nothing waits for the shaft. */
const cuts = (pattern, maxS) => (machine, must) => {
  machine.run(0.1);
  const fall = drivesFell(machine, must, maxS);
  must(logs(machine, pattern), `the log says ${pattern}`);
  must(machine.level('enable') === 0, 'the drives stay off');
  machine.set(pins.ENABLE, 0);
  resets(machine, must);
  return `${fall}: ${pattern.source}`;
};

/** A fault latches: the first press resets, the second starts. */
function resets(machine, must) {
  for (const pin of [pins.STOP, ...pins.ALARM.slice(0, machine.axes)]) machine.set(pin, 0);
  machine.press();
  must(machine.level('enable') === 0, 'a reset does not switch the drives on');
  machine.press();
  must(machine.level('enable') === 1, 'after a reset, a start does');
}

/** Missed deadlines that are no fault yet: all axes pause together, continue together, and the log reports the deadlines. */
function goesOn(machine, must) {
  machine.run(0.1);
  must(logs(machine, /deadlines missed/), 'the log says so');
  must(machine.level('enable') === 1, 'the drives are on');
  const skew = Math.max(...[1, 2, 3].map((axis) => skewAfter(machine, axis)));
  must(skew === 0, `the axes step together, not ${skew} cycles apart`);
  input(pins.STOP, 1)(machine);
  return `logged, and ${parks(machine, must)}`;
}

/** The largest number of cycles between the edges of axis 0 and of another axis after the failure. */
function skewAfter(machine, axis) {
  const from = machine.happened + 0.01 * CYCLES_PER_S;
  const edges = (name) => machine.board.edges.to(name, 1).filter((cycle) => cycle >= from);
  const other = edges(`step_${axis}`);
  return edges('step_0').reduce((max, cycle, i) => Math.max(max, Math.abs((other[i] ?? cycle) - cycle)), 0);
}

/** Checks the stop after a stopped channel: its axis has lost steps, and the fault reports it. */
function runsEmpty(machine, must) {
  machine.run(0.5);
  must(logs(machine, /step-fifo-underrun on axis 1/), 'the log says step-fifo-underrun on axis 1');
  const ends = stands(machine, must, true);
  const before = machine.board.edges.to('step_0', 1).length;
  machine.run(0.05);
  must(machine.board.edges.to('step_0', 1).length === before, 'nothing moves any more');
  resets(machine, must);
  return `stopped, ${ends}: step-fifo-underrun on axis 1`;
}

/** The loop's work takes longer than a tick. It misses one deadline of four or two, at any place in a tick, and never three in a row. */
function stumble(machine) {
  for (let i = 0; i < 8; i += 1) {
    machine.freeze(0.0012);
    machine.run(0.0008);
  }
}

/** The processor executes an undefined instruction, as after a panic. */
function breakIn(machine) {
  const UNDEFINED = 0x1_0000 * 0xde00 + 0xde00;
  const nowhere = 0x2003_f000;
  machine.board.poke(nowhere, UNDEFINED);
  machine.board.core.registers[15] = nowhere;
  machine.board.core.waiting = false;
}

/** The enable input is lost for 20 µs, 40 µs after a deadline: in the middle of the loop's tick. */
function losesEnableInATick(machine) {
  const [last] = machine.ticks().slice(-1);
  machine.happened = last.entry + machine.tick + Math.round(40e-6 * CYCLES_PER_S);
  machine.board.stimulus.pulse(machine.happened, pins.ENABLE, Math.round(20e-6 * CYCLES_PER_S));
}

/** The watchdog restarts the controller: drives off from then on, until it is reset and started. */
const restarts = (failure, maxS) => (machine, must) => {
  machine.run(0.5);
  const fall = drivesFell(machine, must, maxS);
  must(machine.board.events.some(({ kind, text }) => kind === 'reset' && text === 'watchdog'), 'the watchdog resets it');
  must(logs(machine, new RegExp(`reset by the watchdog.*Run.*${failure}`)), `the log says what the machine was doing, and ${failure}`);
  must(logs(machine, /fault: watchdog-reset/), 'the log says watchdog-reset');
  must(machine.level('enable') === 0, 'the drives stay off');
  resets(machine, must);
  return `${fall}, reset by the watchdog: ${failure}; stays off until reset`;
};

const CASES = [
  ['stop input', input(pins.STOP, 1), parks],
  ['stop, broken wire', input(pins.STOP, null), parks],
  ['enable lost', input(pins.ENABLE, 1), cuts(/enable-loss/, 20e-6)],
  ['enable, broken wire', input(pins.ENABLE, null), cuts(/enable-loss/, 20e-6)],
  [
    'enable lost for 20 µs',
    (machine) => {
      machine.happened = halfATickLater(machine);
      machine.board.stimulus.pulse(machine.happened, pins.ENABLE, Math.round(20e-6 * CYCLES_PER_S));
    },
    cuts(/enable-loss/, 20e-6),
  ],
  ['… while the loop computes', losesEnableInATick, cuts(/enable-loss/, 20e-6)],
  ['drive alarm', input(pins.ALARM[1], 1), faults(/drive-alarm on axis 1/, false)],
  ['alarm, broken wire', input(pins.ALARM[3], null), faults(/drive-alarm on axis 3/, false)],
  ['alarm between readings', between(pins.ALARM[2]), faults(/drive-alarm on axis 2/, false)],
  ['stop between readings', between(pins.STOP), parks],
  ['loop late by a deadline', (machine) => machine.freeze(0.0012), goesOn],
  ['loop overrun', (machine) => machine.freeze(0.0031), faults(/overrun/, true)],
  ['… again and again', stumble, faults(/overrun/, true)],
  ['… then enable lost', (machine) => machine.freeze(0.0031), holdsUntilEnableOpens(/overrun/)],
  ['FIFO underrun', (machine) => starve(machine, 1), runsEmpty],
  ['loop hangs', (machine) => machine.freeze(0.03), restarts('Hang', 0.0101)],
  ['a fault of the core', breakIn, restarts('CoreFault', 20e-6)],
];
