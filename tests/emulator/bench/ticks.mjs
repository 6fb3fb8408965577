// Runs a scene on the firmware, and gives for each tick its cost, its state, and the number of index pulses that it confirmed.

import { VECTOR_TABLE } from '../board/chip.mjs';
import { CallProfile } from '../board/profile.mjs';
import { eventsOfLog } from './events.mjs';
import { log } from './log.mjs';
import { DMA_IRQ_1, TIMER_IRQ_1 } from '../board/usage.mjs';
import { CYCLES_PER_S, Machine } from './machine.mjs';
import { act } from './play.mjs';

/** The loop's alarm, and the end of a step buffer. Interrupts of the host link and of its timers have a lower priority. */
const LOOP = [TIMER_IRQ_1, DMA_IRQ_1];

/** Exceptions of the processor, and 32 interrupts. */
const VECTORS = 16 + 32;

/** The default of `index.width_us` (docs/scenes.md): how long a level lasts before it counts. */
const WIDTH_US = 2;

/**
 * Runs the scene to its end; `prepare(machine)` comes before its start. Gives { machine, lines: the log, period: cycles of a tick, ticks, profile: null unless
 * requested, awake: cycles in which the processor did not sleep, reads: of the flash by the loop's interrupts, [{ pc, address, count, cycles waited }] }; ticks:
 * [{ number, own, late, state, pulses, call: of the profile }], numbered from the deadline at which the start was read; `late` is by how many
 * cycles more than that one the tick began behind its deadline.
 */
export function run(played, predicted, settings, { profile = false, prepare = () => {} } = {}) {
  const machine = new Machine({ ...played, settings });
  const { board } = machine;
  machine.boot();
  prepare(machine);
  if (profile) board.profile = new CallProfile(board.elf.functions);
  const began = machine.start();
  const before = board.usage.sums();
  board.core.handlerReads.clear();
  act(machine, played, predicted, began);
  board.profile?.finish();
  const after = board.usage.sums();
  const lines = log(board);
  const { states } = eventsOfLog(lines, []);
  const stateAt = (number) => states.findLast(({ tick }) => tick <= number)?.state ?? 'idle';
  const confirmed = confirmations(played, predicted, machine.tick);
  const calls = new Map((board.profile?.calls ?? []).map((call) => [call.entry, call]));
  const ticks = machine.ticks(began).map(({ entry, own }) => {
    const number = Math.floor((entry - began) / machine.tick);
    const late = ((entry - began + machine.tick / 2) % machine.tick) - machine.tick / 2;
    return { number, own, late, state: stateAt(number), pulses: confirmed.get(number) ?? 0, call: calls.get(entry) };
  });
  return {
    machine,
    lines,
    ticks,
    profile: board.profile,
    period: machine.tick,
    awake: after.awake - before.awake,
    reads: [...board.core.handlerReads.values()].filter(({ exception, address }) => LOOP.includes(exception) && !isVector(address)),
  };
}

/** True for an address in the vector table, which the processor reads at each exception. */
const isVector = (address) => address >= VECTOR_TABLE && address < VECTOR_TABLE + 4 * VECTORS;

/** Summarizes ticks: { worst, mean, late: the latest beginning, pulses: index pulses that were confirmed in the worst }, in cycles. */
export function summary(ticks) {
  const worst = ticks.reduce((max, tick) => (tick.own > max.own ? tick : max));
  const mean = ticks.reduce((sum, { own }) => sum + own, 0) / ticks.length;
  const late = ticks.reduce((max, tick) => Math.max(max, tick.late), 0);
  return { worst: worst.own, mean, late, pulses: worst.pulses };
}

/**
 * Number of index pulses confirmed in each tick, by its number. A pulse is confirmed at the first deadline at which its level has lasted
 * long enough.
 */
function confirmations({ toml, axes }, { edges }, period) {
  const width = ((toml.index?.width_us ?? WIDTH_US) / 1e6) * CYCLES_PER_S;
  const counts = new Map();
  for (let axis = 0; axis < axes; axis += 1) {
    for (const { cycle, level } of edges.get(`index_${axis}`) ?? []) {
      const number = Math.ceil((cycle + width) / period);
      if (level === 1) counts.set(number, (counts.get(number) ?? 0) + 1);
    }
  }
  return counts;
}
