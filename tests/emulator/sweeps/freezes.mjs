// The processor stands, at any moment of a tick and for any time, while everything else goes on.
//
// A machine of four axes speeds up. After it, all edges must be where they are predicted but for whole ticks of standstill, as
// many as the log counts; or the machine has stopped with a fault: in step, or with an axis behind, and then that is the fault.

import { log } from '../bench/log.mjs';
import { sweep, isSelected } from '../bench/sweep.mjs';
import { Follow, inProportion, missed } from './follow.mjs';

/** Cases, and the longest that the processor stands, in ticks. */
const FREEZES = 60;
const LONGEST = 3.3;

/** More missed deadlines in a row are a fault (firmware/core/src/controller/punctuality.rs). */
const MOST_MISSED = 2;

/** Until all is logged, and until a machine that stops has stopped. */
const LOGGED_S = 0.008;
const STOPPED_S = 0.15;

/** `scene` is one that is running: { machine, snapshot, follow, deadline, perTurn }. */
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

/** In step and logged, or a fault and logged. */
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
    if (stood > MOST_MISSED) wrong.push(`the machine stood for ${stood} ticks, and there is no fault`);
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
