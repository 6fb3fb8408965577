// The processor is stopped for a moment while it releases the step machines: for the first time, and again after a missed
// deadline.
//
// Half of the cases lie around the two stores that release the blocks, where a cycle matters, most of them between the
// two. The others are spread over all code before them. Afterwards both blocks run together, or there is a fault, or, if
// the machine stands, they are released again.

import { log } from '../bench/log.mjs';
import { CYCLES_PER_S } from '../bench/machine.mjs';
import { spread, sweep, isSelected } from '../bench/sweep.mjs';
import { Snapshot } from '../board/snapshot.mjs';
import { Follow } from './follow.mjs';
import { judge } from './freezes.mjs';

const RELEASES = 40;
const STARTS = 16;

/**
 * The loop misses a deadline, and no axis underruns because of that: the beginning and the length of the standstill, in ticks.
 * It begins before the loop has handed over, so no channel waits for a restart.
 */
const FROZEN_FROM = 0.05;
const FROZEN_FOR = 1.2;

/** Times before the stores, which include reading and computing, and after them. */
const BEFORE = 20_000;
const AFTER = 250;
/** Around the stores. */
const NEAR = 32;
/** Lengths of the processor's standstill, cycles: from one to a quarter of a tick. */
const LONGEST = 16_000;

/**
 * From a deadline to the first cycle of its tick: as in scenarios/parity.mjs, plus the longest delay that is not detected.
 */
const MAX_OFFSET = 25 + 31;

/** Moment and length of a case: even numbers close to the stores, others anywhere. */
function moment(number) {
  const near = number % 2 === 0;
  const [u, v] = spread(number >> 1);
  const at = near ? Math.round((2 * u - 1) ** 3 * NEAR) : Math.round(u * (BEFORE + AFTER)) - BEFORE;
  const length = Math.max(1, Math.round(LONGEST ** v));
  return { at, length };
}

const name = ({ at, length }) => `standing for ${length} cycles from ${at} cycles after the machines are let go`;

/** The next cycle in which the machines of the first block are released. */
function letGo(machine) {
  const { board } = machine;
  const on = () => board.pio[0].machines[0].enabled;
  while (on()) machine.run(1e-6);
  while (!on()) board.run({ cycles: 1 });
  return board.cycle;
}

/** The release after the loop was stopped for over a tick. */
export function releases(outcome, running) {
  if (!isSelected('releases')) return;
  const { machine, snapshot } = running;
  const missed = () => {
    snapshot.restore();
    machine.board.run({ untilCycle: running.deadline + FROZEN_FROM * machine.tick });
    machine.freeze((FROZEN_FOR * machine.tick) / CYCLES_PER_S);
  };
  missed();
  const go = letGo(machine);
  machine.run(0.01);
  const { ended, wrong } = judge(running);
  outcome.check(ended === 'in step' && wrong.length === 0, `releases: undisturbed, it goes on in step, not ${ended}: ${wrong.join('; ')}`);
  missed();
  machine.board.run({ untilCycle: go - BEFORE });
  const before = new Snapshot(machine.board);
  sweep(outcome, 'releases', RELEASES, 'cycles between the blocks', (_u, _v, number) => {
    before.restore();
    const when = moment(number);
    machine.board.run({ untilCycle: go + when.at });
    machine.freeze(when.length / CYCLES_PER_S);
    machine.run(0.01);
    const judged = judge(running);
    return { name: name(when), worst: judged.apart, ...judged };
  });
}

/** The first release, at power-up. Then the machine is started. */
export function starts(outcome, { fresh, predicted }) {
  if (!isSelected('starts')) return;
  const go = letGo(fresh());
  const machine = fresh();
  machine.board.run({ untilCycle: go - BEFORE });
  const before = new Snapshot(machine.board);
  sweep(outcome, 'starts', STARTS, 'cycles between the blocks', (_u, _v, number) => {
    before.restore();
    const when = moment(number);
    machine.board.run({ untilCycle: go + when.at });
    machine.freeze(when.length / CYCLES_PER_S);
    machine.run(0.008);
    const lines = log(machine.board);
    const fault = lines.map((line) => line.match(/fault: ([\w-]+)/)).find(Boolean);
    if (fault) return { name: name(when), wrong: [], ended: fault[1], log: () => lines };
    const began = machine.start();
    machine.run(0.03);
    const follow = new Follow(machine, predicted, began);
    const { wrong, apart } = follow.compare();
    const from = follow.origin - began;
    if (from < 0 || from > MAX_OFFSET) wrong.push(`a tick begins ${from} cycles from its deadline`);
    return { name: name(when), wrong, worst: apart, ended: 'in step', log: () => lines };
  });
}
