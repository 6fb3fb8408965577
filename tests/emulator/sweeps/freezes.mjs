// The processor is stopped, at any moment of a tick and for any time, while everything else goes on.
//
// A machine of four axes speeds up. After the standstill, all edges must be as predicted, delayed by whole ticks, as many as
// the log counts. Otherwise the machine must have stopped with a fault: in step, or with an axis behind if that is the fault.

import { log } from '../bench/log.mjs';
import { sweep, isSelected } from '../bench/sweep.mjs';
import { Follow, inProportion, missed } from './follow.mjs';

/** Number of cases, and the longest standstill of the processor, in ticks. */
const FREEZES = 60;
const LONGEST = 3.3;

/** More missed deadlines in a row are a fault (firmware/core/src/controller/deadline_monitor.rs). */
const MAX_MISSED = 2;

/** Time until all is logged, and time until a stopping machine is at rest. */
const LOGGED_S = 0.008;
const STOPPED_S = 0.15;

/** `running`: a scene under way: { machine, snapshot, follow, deadline, perTurn }. */
export function freezes(outcome, running) {
  if (!isSelected('freezes')) return;
  const { machine, snapshot } = running;
  sweep(outcome, 'freezes', FREEZES, 'ticks of standstill', (u, v) => {
    snapshot.restore();
    const ticks = 0.05 + v * (LONGEST - 0.05);
    machine.board.run({ untilCycle: running.deadline + Math.round(u * machine.tick) });
    machine.freeze((ticks * machine.tick) / 125e6);
    machine.run(LOGGED_S + ticks * machine.tick / 125e6);
    const judged = judge(running);
    return { name: `begun ${u.toFixed(4)} ticks after a deadline, for ${ticks.toFixed(4)}`, worst: judged.stood, ...judged };
  });
}

/** Checks that the machine is in step and the log matches, or that there is a fault and the log matches. */
export function judge({ machine, follow, perTurn, reversed }) {
  let lines = log(machine.board);
  const fault = lines.map((line) => line.match(/fault: ([\w-]+)( on axis \d)?/)).find(Boolean);
  if (!fault) {
    const { stood, apart, wrong, last } = follow.compare();
    if (stood === 0 && apart > 0) wrong.push(`the blocks are ${apart} cycles apart`);
    const before = missed(lines);
    if (stood !== before) wrong.push(`the log counts ${before} deadlines missed, and the machine stood for ${stood} ticks`);
    if (machine.level('enable') !== 1) wrong.push('the drives are off, and there is no fault');
    if (last * machine.tick < machine.board.cycle - follow.origin - (stood + 2) * machine.tick) wrong.push(`nothing moves since tick ${last}`);
    if (stood > MAX_MISSED) wrong.push(`the machine stood for ${stood} ticks, and there is no fault`);
    return { wrong, stood, apart, ended: 'in step', log: () => lines };
  }
  const [, kind] = fault;
  machine.run(STOPPED_S);
  lines = log(machine.board);
  const wrong = [];
  if (!['overrun', 'step-fifo-underrun'].includes(kind)) wrong.push(`the fault is ${kind}`);
  if (machine.level('enable') !== 1) wrong.push(`the drives do not hold after ${kind}`);
  const counts = () => machine.board.edges.tracks.map(({ name, cycles }) => (/^(step|dir)/.test(name) ? cycles.length : 0)).join();
  const before = counts();
  machine.run(0.005);
  if (counts() !== before) wrong.push(`something still moves after ${kind}`);
  const steps = machine.steps(reversed);
  if (kind === 'overrun' && !inProportion(steps, perTurn)) wrong.push(`after overrun the axes are not in step: ${steps.join(', ')}`);
  return { wrong, ended: kind, log: () => lines };
}
