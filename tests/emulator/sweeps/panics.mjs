// A panic of the firmware, at any moment of a tick: the linked code's own `panic_bounds_check`, called as for an index out of
// bounds. In every other case the log's buffer is full, and no probe empties it.

import { log } from '../bench/log.mjs';
import { CYCLES_PER_S } from '../bench/machine.mjs';
import { sweep, isSelected } from '../bench/sweep.mjs';

const PANICS = 4;

/** The drives must be off within this time, cycles. */
const MAX = 250;
/** Time until the watchdog has reset the controller, and the log has reported it. */
const RESET_S = 0.15;

/** Unused RAM: the place of the panic's arguments. */
const SPARE = 0x2003_e000;
const FILE = 'the-bench.rs';
const LINE = 4711;

export function panics(outcome, running) {
  if (!isSelected('panics')) return;
  const { machine, snapshot } = running;
  const { board } = machine;
  const at = [...board.elf.symbols.values()].find(({ name }) => /panicking18panic_bounds_check/.test(name)).address;
  sweep(outcome, 'panics', PANICS, 'µs to drives off', (u, v, number) => {
    snapshot.restore();
    const isFull = number % 2 === 1;
    board.run({ untilCycle: running.deadline + Math.round(u * machine.tick) });
    if (isFull) board.rtt.stall();
    const began = board.cycle;
    call(board, at);
    machine.run(RESET_S);
    const falls = board.edges.to('enable', 0).filter((cycle) => cycle >= began);
    const lines = log(board);
    const wrong = [];
    const says = (pattern) => lines.some((line) => pattern.test(line)) || wrong.push(`the log does not say ${pattern}`);
    if (!(falls[0] - began <= MAX)) wrong.push(`the drives are off after ${(falls[0] - began) / 125} µs`);
    if (machine.level('enable') !== 0 || falls.length !== 1) wrong.push('the drives do not stay off');
    if (!board.events.some(({ kind, text }) => kind === 'reset' && text === 'watchdog')) wrong.push('the watchdog does not restart it');
    if (!isFull) says(new RegExp(`panicked at ${FILE}:${LINE}`));
    says(/reset by the watchdog.*Run.*Panic/);
    says(/fault: watchdog-reset/);
    return {
      name: `${u.toFixed(4)} ticks after a deadline${isFull ? ', the log full' : ''}`,
      wrong,
      worst: (falls[0] - began) / 125,
      ended: isFull ? 'reset, the message lost' : 'logged and reset',
      log: () => lines,
    };
  });
}

/** Calls `panic_bounds_check(7, 3, location)`, whatever code is being executed. */
function call(board, address) {
  const { core } = board;
  const bytes = Buffer.from(`${FILE}\0\0\0\0`);
  for (let i = 0; i + 3 < bytes.length; i += 4) board.poke(SPARE + 64 + i, bytes.readUInt32LE(i));
  [SPARE + 64, FILE.length, LINE, 1].forEach((word, i) => board.poke(SPARE + 4 * i, word));
  core.registers.set([7, 3, SPARE]);
  core.registers[15] = address;
  core.waiting = false;
}
