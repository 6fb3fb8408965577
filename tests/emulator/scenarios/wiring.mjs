// Wiring: lines of either active level run the same machine, a broken wire is safe with both, and bring-up shows each line
// separately.

import { Cranks } from '../bench/cranks.mjs';
import { OUTPUTS, requests } from '../bench/frames.mjs';
import { predict, scene, settingsOf } from '../bench/host.mjs';
import { LinkHost } from '../bench/link-host.mjs';
import { log } from '../bench/log.mjs';
import { Machine } from '../bench/machine.mjs';
import * as pins from '../bench/pins.mjs';
import { act } from '../bench/play.mjs';
import { MIN_PULSE } from '../sweeps/alarms.mjs';
import { edgesOff } from './parity.mjs';

/** Every line at its unusual level. */
const INVERTED = { step: 'low', drive_enable: 'low', index: 'low', alarm: 'low', enable: 'high', stop: 'low', start: 'high' };

/** Refusals, as firmware/link/src/message.rs numbers them. */
const LOCKED = 16;
const REJECTED = 13;

export const title = 'Wiring: active levels, broken wires, bring-up';

export function run(outcome) {
  levels(outcome);
  for (const wiring of [{}, INVERTED]) brokenWires(outcome, wiring);
  pulls(outcome);
  for (const wiring of [{}, INVERTED]) bringUp(outcome, wiring);
}

const wired = (wiring) => (toml) => {
  toml.wiring = wiring;
};

// ---- active levels ----

function levels(outcome) {
  const played = scene('index', wired(INVERTED));
  const predicted = predict(played);
  const machine = new Machine({ ...played, settings: settingsOf(played) });
  machine.boot();
  const began = machine.start();
  act(machine, played, predicted, began);
  const { edges, off } = edgesOff(machine, played, predicted, began);
  outcome.check(off === null, `all lines inverted: every edge is where \`cophase run\` has it: ${off}`);
  outcome.say(`all lines inverted: ${edges} edges, 0 cycles off`);
}

// ---- broken wires ----

function brokenWires(outcome, wiring) {
  const played = scene('hold', wired(wiring));
  const settings = settingsOf(played);
  const name = wiring === INVERTED ? 'inverted' : 'usual';
  const cases = [
    ['enable', pins.ENABLE, /enable-loss/, 0],
    ['stop', pins.STOP, /: Parked/, 1],
    ['alarm', pins.ALARM[3], /drive-alarm on axis 3/, 0],
  ];
  for (const [line, pin, pattern, drives] of cases) {
    const machine = new Machine({ ...played, settings });
    machine.boot();
    machine.start();
    machine.run(0.2);
    machine.set(pin, null);
    machine.run(0.5);
    const lines = log(machine.board);
    outcome.check(lines.some((text) => pattern.test(text)), `${name} wiring, ${line} broken: the log says ${pattern}, not ${lines.slice(-3).join(' / ')}`);
    outcome.check(machine.level('enable') === drives, `${name} wiring, ${line} broken: the drives are ${drives ? 'on' : 'off'}`);
  }
  const machine = new Machine({ ...played, settings });
  machine.boot();
  machine.start();
  machine.run(0.2);
  const [last] = machine.ticks().slice(-1);
  const amid = last.entry + Math.round(1.5 * machine.tick);
  machine.set(pins.ALARM[2], 1, amid);
  machine.set(pins.ALARM[2], 0, amid + MIN_PULSE);
  machine.run(0.5);
  const short = log(machine.board).some((text) => /drive-alarm on axis 2/.test(text));
  outcome.check(short, `${name} wiring: an alarm between two readings counts`);
  outcome.say(`${name} wiring: a broken wire of ${cases.map(([line]) => line).join(', ')} stops the machine`);
}

/** An input without its pull keeps its last level, because nothing drives it. */
function pulls(outcome) {
  const played = scene('hold', wired({ no_pull: ['stop', 'index'] }));
  const machine = new Machine({ ...played, settings: settingsOf(played) });
  machine.boot();
  const { pullUp, pullDown } = machine.board.pads;
  const pulled = (pin) => ((pullUp | pullDown) >>> pin) & 1;
  for (const pin of [pins.STOP, ...pins.INDEX]) outcome.check(pulled(pin) === 0, `pin ${pin} is not pulled, as the settings say`);
  for (const pin of [pins.ENABLE, pins.START, ...pins.ALARM]) outcome.check((pullUp >>> pin) & 1, `pin ${pin} is pulled up`);
  outcome.say('pull resistors are off where the settings say so');
}

// ---- bring-up ----

const INPUTS = 5;

function bringUp(outcome, wiring) {
  const played = scene('index', (toml) => {
    wired(wiring)(toml);
    toml.axes.count = 4;
    toml.axis = toml.axis.filter(({ number }) => number < 4);
  });
  const name = wiring === INVERTED ? 'inverted' : 'usual';
  const check = (holds, text) => outcome.check(holds, `${name} wiring, bring-up: ${text}`);
  const machine = new Machine({ ...played, settings: settingsOf(played) });
  machine.boot();
  const host = new LinkHost(machine, 'uart');
  host.connect();

  machine.set(pins.INDEX[2], 1);
  machine.set(pins.ALARM[1], 1);
  machine.set(pins.STOP, 1);
  machine.run(0.001);
  const [kind, index, alarm, enable, stop, start] = host.ask(requests.inputs());
  check(kind === INPUTS && [index, alarm, enable, stop, start].join() === '4,2,1,1,0', `inputs are read, not ${[index, alarm, enable, stop, start]}`);
  machine.set(pins.INDEX[2], 0);
  machine.set(pins.ALARM[1], 0);
  machine.set(pins.STOP, 0);

  host.ask(requests.takeControl());
  const hold = (line, active) => requests.output(line, active);
  check(host.refusal(hold(OUTPUTS.step(1), true)) === LOCKED, 'an output needs the unlock');
  host.ask(requests.unlock());
  check(host.refusal(hold(OUTPUTS.step(4), true)) === REJECTED, 'an axis that is not there is refused');
  const active = (wire) => machine.level(wire);
  const reversed = played.toml.axis.filter((axis) => axis.reversed).map(({ number }) => `dir_${number}`);
  for (let axis = 0; axis < 4; axis += 1) {
    for (const [wire, line] of [[`step_${axis}`, OUTPUTS.step(axis)], [`dir_${axis}`, OUTPUTS.dir(axis)]]) {
      const others = Object.keys(pins.outputs(4)).filter((other) => /^(step|dir)/.test(other) && other !== wire);
      host.ask(hold(line, 0)); // releases the line before
      const before = others.map(active).join();
      for (const level of [1, 0, 1]) {
        host.ask(hold(line, level));
        check(active(wire) === (reversed.includes(wire) ? 1 - level : level), `${wire} is held ${level ? 'active' : 'inactive'}`);
      }
      check(others.map(active).join() === before, `no other line moves with ${wire}`);
    }
  }
  const rest = active('step_3');
  machine.run(1.2);
  check(active('dir_3') === 0 && active('step_3') === rest, 'an output is released after a second');
  host.ask(hold(OUTPUTS.driveEnable, true));
  check(active('enable') === 1, 'drives can be switched on');
  machine.set(pins.ENABLE, 1);
  machine.run(0.001);
  check(active('enable') === 0, 'the enable input switches them off');
  machine.set(pins.ENABLE, 0);
  machine.run(1.2);
  check(active('enable') === 0, 'they are off after a second');
  oneAxis(machine, played, host, check);
  outcome.say(`${name} wiring: bring-up reads each input, switches each output alone, and turns one axis of four`);
}

/** Restarts with one axis, and homes and jogs it. */
function oneAxis(machine, played, host, check) {
  const turned = 2;
  followSteps(machine, played);
  host.ask(requests.onlyAxis(turned));
  machine.run(0.5);
  host.connect();
  // All drives are enabled together: those of the other axes must not take noise for steps.
  for (const axis of [0, 1, 3]) check(machine.level(`step_${axis}`) === 0, `STEP of axis ${axis} rests at its inactive level`);
  host.ask(requests.takeControl());
  host.ask(requests.arm());
  const from = machine.board.cycle;
  host.ask(requests.home());
  machine.run(1);
  const wires = stepEdges(machine, from);
  check(wires[turned] > 1000, `axis ${turned} turns: ${wires.join(', ')} edges`);
  check(wires.every((edges, axis) => axis === turned || edges === 0), `no other axis turns: ${wires.join(', ')} edges`);
  const lines = log(machine.board);
  check(lines.some((text) => /: Parked/.test(text)), `it is homed, and parks: ${lines.slice(-4).join(' / ')}`);
  check(machine.level('enable') === 1, 'its drive holds');
  machine.set(pins.ENABLE, 1);
  machine.run(0.01);
  machine.set(pins.ENABLE, 0);
  host.ask(requests.restart());
  machine.run(0.5);
  host.connect();
  host.ask(requests.takeControl());
  host.ask(requests.arm());
  const again = machine.board.cycle;
  host.ask(requests.home());
  machine.run(0.1);
  const all = stepEdges(machine, again);
  check(all.every((edges) => edges > 100), `after another restart all axes turn: ${all.join(', ')} edges`);
}

/** Lets the cranks follow the steps, and keeps the recorder of edges. */
function followSteps({ board }, played) {
  const { edges } = board;
  const cranks = new Cranks(board, played.toml);
  board.edges = Object.assign(Object.create(edges), {
    record(stamp, changed) {
      edges.record(stamp, changed);
      cranks.record(stamp, changed);
    },
  });
}

/** Edges of each axis's STEP from a cycle on. */
function stepEdges(machine, from) {
  return [0, 1, 2, 3].map((axis) => machine.board.edges.of(`step_${axis}`).filter(({ cycle }) => cycle > from).length);
}
