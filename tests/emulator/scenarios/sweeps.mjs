// Sweeps: the failures of scenarios/safety.mjs, and others, at many moments instead of one.
//
// Failures of loop, interrupts, DMA and machines depend on the moment. So each failure is tried at moments spread over a tick,
// from one and the same state of the machine. bench/sweep.mjs describes how to run more of them, and how to run one alone.

import { predict, scene, settingsOf } from '../bench/host.mjs';
import { CYCLES_PER_S, Machine } from '../bench/machine.mjs';
import * as pins from '../bench/pins.mjs';
import { isSelected } from '../bench/sweep.mjs';
import { Snapshot } from '../board/snapshot.mjs';
import { alarms } from '../sweeps/alarms.mjs';
import { enablePulses } from '../sweeps/enable.mjs';
import { Follow } from '../sweeps/follow.mjs';
import { freezes } from '../sweeps/freezes.mjs';
import { noise } from '../sweeps/noise.mjs';
import { panics } from '../sweeps/panics.mjs';
import { releases, starts } from '../sweeps/release.mjs';
import { stops } from '../sweeps/stops.mjs';
import { offsetOf, standsFor } from './index.mjs';

export const title = 'Sweeps: failures at every moment';

export function run(outcome) {
  if (isSelected('freezes', 'releases', 'enable', 'alarms', 'panics', 'starts')) {
    const played = scene('sweep');
    const settings = settingsOf(played);
    const predicted = predict(played);
    const fresh = () => new Machine({ ...played, settings });
    if (isSelected('freezes', 'releases', 'enable', 'alarms', 'panics')) {
      const moving = running(played, fresh(), 0.09, predicted);
      freezes(outcome, moving);
      releases(outcome, moving);
      enablePulses(outcome, moving);
      alarms(outcome, moving);
      panics(outcome, moving);
    }
    starts(outcome, { fresh, predicted });
  }
  if (isSelected('stops')) {
    const played = scene('hold', quick);
    stops(outcome, running(played, new Machine({ ...played, settings: settingsOf(played) }), 0.12));
  }
  if (isSelected('noise')) noise(outcome, aboutToStop());
}

/** The scene `hold` with gears. It reaches its level and rest quickly. */
function quick(toml) {
  toml.limits.acceleration_hz_per_s = 400;
  toml.limits.jerk_hz_per_s2 = 40_000;
  toml.program[0].ramp_s = 0.05;
  toml.axis.push({ number: 1, gear: [3, 2] }, { number: 3, gear: [1, 4], steps_per_turn: 25_600 });
}

/** The scene, `seconds` after its start, shortly before a deadline. */
function running(played, machine, seconds, predicted) {
  machine.boot();
  const began = machine.start();
  const deadline = began + Math.round(seconds * played.tickHz) * machine.tick;
  machine.board.run({ untilCycle: deadline - machine.tick / 8 });
  const follow = predicted && new Follow(machine, predicted, began);
  const wrong = follow?.compare().wrong ?? [];
  if (wrong.length > 0) throw new Error(`not as predicted before anything happened: ${wrong.join('; ')}`);
  const perTurn = Array.from({ length: played.axes }, (_, axis) => {
    const own = played.toml.axis.find(({ number }) => number === axis) ?? {};
    const [motor, crank] = own.gear ?? played.toml.axes.gear ?? [1, 1];
    return ((own.steps_per_turn ?? played.toml.axes.steps_per_turn) * motor) / crank;
  });
  const reversed = perTurn.map((_, axis) => Number(played.toml.axis.some((own) => own.number === axis && own.reversed)));
  const parkDeg = played.toml.machine.park_deg ?? 180;
  return { machine, follow, deadline, parkDeg, perTurn, reversed, snapshot: new Snapshot(machine.board) };
}

/** Shortens the scene: only its end matters here. */
function shorter(toml) {
  toml.program[0].hold_s = 0.15;
  toml.input[0].at_s = 0.30012;
}

/** The scene `two-hundred`, shortly before the last pulses that come before its stop. */
function aboutToStop() {
  const played = scene('two-hundred', shorter);
  const predicted = predict(played);
  const settings = settingsOf(played);
  const started = () => {
    const machine = new Machine({ ...played, settings });
    machine.boot();
    return [machine, machine.start()];
  };
  const offset = offsetOf(...started(), predicted);
  const [machine, deadline] = started();
  const began = deadline + offset;
  const [{ at_s: seconds }] = played.inputs;
  const stop = began + Math.round(seconds * CYCLES_PER_S);
  machine.set(pins.STOP, 1, stop);
  const pulses = [];
  for (let axis = 0; axis < played.axes; axis += 1) {
    const edges = predicted.edges.get(`index_${axis}`);
    for (const { cycle, level } of edges) machine.set(pins.INDEX[axis], level, began + cycle);
    const at = edges.findLastIndex(({ cycle, level }) => level === 1 && began + cycle < stop - machine.tick);
    pulses.push([at - 2, at].map((i) => ({ rise: began + edges[i].cycle, fall: began + edges[i + 1].cycle })));
  }
  const first = Math.min(...pulses.map(([{ rise }]) => rise));
  machine.board.run({ untilCycle: first - machine.tick / 4 });
  const end = stop + Math.round(0.009 * CYCLES_PER_S);
  return { machine, pulses, end, stands: standsFor(played, predicted), snapshot: new Snapshot(machine.board) };
}
