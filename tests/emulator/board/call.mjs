// Calls one function of a firmware, alone on the chip: for measuring routines.
//
// The function runs with interrupts masked, statics initialised as by the start-up code, and nothing else happening.
// Arguments and results are those of the procedure call standard (AAPCS): r0 to r3, then the stack; r0 and r1.

import { Board } from './board.mjs';

/** A branch to itself in the bench's ROM: the return address of called functions. */
const RETURN_TO = 0x80;
const RAM_BASE = 0x2000_0000;
const STACK_TOP = 0x2004_2000;

export class Caller {
  constructor(elf) {
    this.board = new Board({ elf, bare: true, rtt: false });
    const { board } = this;
    board.sram.fill(0);
    for (const { virtual, bytes } of board.elf.segments) {
      if (virtual >= RAM_BASE && virtual < STACK_TOP) board.sram.set(bytes, virtual - RAM_BASE);
    }
    board.core.PM = true;
    board.core.waiting = false;
  }

  /** Address of a function by its symbol's name; throws when there is none. */
  addressOf(symbol) {
    const found = this.board.elf.symbols.get(symbol);
    if (!found) throw new Error(`the firmware has no symbol ${symbol}`);
    return found.address;
  }

  /**
   * Calls `target` (a symbol or an address) with `args` in r0 to r3 and `stack` words for the rest. Gives
   * { r0, r1, cycles, stackBytes }: the cycles from its first instruction to its return, both included, without the
   * call itself; and the depth of its stack. Throws when it faults or takes more than `mostCycles`.
   */
  call(target, args = [], { stack = [], maxCycles = 10_000_000 } = {}) {
    const { board } = this;
    const { core } = board;
    const address = typeof target === 'string' ? this.addressOf(target) : target & ~1;
    const top = (STACK_TOP - 4 * stack.length) & ~7;
    stack.forEach((word, i) => core.writeUint32(top + 4 * i, word));
    args.forEach((value, i) => (core.registers[i] = value));
    core.registers[13] = top;
    core.registers[14] = RETURN_TO | 1;
    core.registers[15] = address;
    core.minSP = top;
    const from = board.cycle;
    while (core.registers[15] !== RETURN_TO) {
      board.runTo(board.cycle + 1);
      if (board.cycle - from > maxCycles) throw new Error(`${target} did not return in ${maxCycles} cycles`);
      if (core.IPSR !== 0 || board.stopped) throw new Error(`${target}: ${board.events.at(-1).text}`);
    }
    return {
      r0: core.registers[0],
      r1: core.registers[1],
      cycles: board.cycle - from,
      stackBytes: top - core.minSP,
    };
  }
}
