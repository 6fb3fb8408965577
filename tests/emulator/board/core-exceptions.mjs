// Exceptions of the Cortex-M0+: their priorities, preemption, timing and cost.
//
// rp2040js keeps interrupts pending by level alone, enters handlers in no time, lets PRIMASK be overridden by a
// wake-up and has no HardFault. Here, after the ARMv6-M Architecture Reference Manual (B1.5, B3.4):
// - an interrupt becomes pending when its line rises, or by software; it is no longer pending once its handler is
//   entered; a line still high when the handler returns makes it pending again;
// - of the pending exceptions, the lowest priority number wins, then the lowest exception number; it preempts only
//   exceptions with a higher priority number, and none while PRIMASK is set, HardFault excepted;
// - WFI ends when an exception could preempt with PRIMASK clear; WFE when an exception does preempt, or on an event,
//   and exception entry and return are events.
//
// Costs: ENTRY is the latency of the Cortex-M0+ Technical Reference Manual with memory without wait states. The costs
// of return and tail-chaining are not documented. EXIT and CHAIN are the bus cycles that they need at least.

import { Fault, MemoryCore } from './core-memory.mjs';

export const ENTRY_CYCLES = 15;
/** Eight words popped and the pipeline filled, beyond the BX or POP that returns. */
export const EXIT_CYCLES = 10;
/** From one handler's return to the next handler's first instruction: vector read and pipeline filled. */
export const CHAIN_CYCLES = 6;

export const HARD_FAULT = 3;
const NMI = 2;
const SVCALL = 11;
const PENDSV = 14;
const SYSTICK = 15;
const FIRST_IRQ = 16;
const THREAD_PRIORITY = 4;

export class ExceptionCore extends MemoryCore {
  constructor(rp2040, board) {
    super(rp2040, board);
    /** Interrupt lines that are high, and interrupts whose handler is entered and not yet left: bit masks. */
    this.lines = 0;
    this.active = 0;
    this.sleepsByEvent = false;
    this.chained = false;
    /** The exception that the present instruction returned from, or 0; the board clears it. */
    this.left = 0;
  }

  /** Drives an interrupt line. */
  setInterrupt(irq, high) {
    const bit = 1 << irq;
    if (!high) {
      this.lines &= ~bit;
    } else if (!(this.lines & bit)) {
      this.lines |= bit;
      this.setPending(bit);
    }
  }

  setPending(bits) {
    this.pendingInterrupts |= bits;
    this.interruptsUpdated = true;
  }

  /** A line that is high keeps its interrupt pending, even if software clears it. */
  clearPending(bits) {
    this.pendingInterrupts &= ~bits | (this.lines & ~this.active);
  }

  /** The present priority, lower numbers first; `masked`: with PRIMASK obeyed. */
  executionPriority(masked) {
    const own = this.IPSR === 0 ? THREAD_PRIORITY : this.exceptionPriority(this.IPSR);
    return masked && this.PM ? Math.min(own, 0) : own;
  }

  /** The exception that would be entered next with `limit` as the present priority, or 0. */
  nextException(limit) {
    if (this.pendingNMI && limit > -2) return NMI;
    let best = 0;
    let bestPriority = limit;
    const consider = (number, priority) => {
      if (priority < bestPriority) {
        best = number;
        bestPriority = priority;
      }
    };
    if (this.pendingSVCall) consider(SVCALL, this.svCallPriority);
    if (this.pendingPendSV) consider(PENDSV, this.pendSVPriority);
    if (this.pendingSystick) consider(SYSTICK, this.systickPriority);
    const irqs = this.pendingInterrupts & this.enabledInterrupts;
    for (let priority = 0; irqs !== 0 && priority < bestPriority; priority += 1) {
      const level = irqs & this.interruptPriorities[priority];
      if (level !== 0) {
        consider(FIRST_IRQ + 31 - Math.clz32(level & -level), priority);
        break;
      }
    }
    return best;
  }

  /** Enters the exception that is due. Gives the cycles of that; 0 if none was due. */
  takeException() {
    this.interruptsUpdated = false;
    const number = this.nextException(this.executionPriority(true));
    if (number === 0) {
      this.chained = false;
      return 0;
    }
    if (number === NMI) this.pendingNMI = false;
    else if (number === SVCALL) this.pendingSVCall = false;
    else if (number === PENDSV) this.pendingPendSV = false;
    else if (number === SYSTICK) this.pendingSystick = false;
    else {
      const bit = 1 << (number - FIRST_IRQ);
      this.pendingInterrupts &= ~bit;
      this.active |= bit;
    }
    const cycles = this.chained ? CHAIN_CYCLES : ENTRY_CYCLES;
    this.chained = false;
    this.exceptionEntry(number);
    return cycles;
  }

  exceptionEntry(number) {
    this.waiting = false;
    this.board.usage.enter(number);
    try {
      super.exceptionEntry(number);
    } catch (error) {
      if (!(error instanceof Fault)) throw error;
      this.board.stop('lockup', `${error.message} while entering exception ${number}`);
      return;
    }
    this.noteStack();
    this.PC &= ~1;
    this.interruptsUpdated = true;
  }

  exceptionReturn(value) {
    const number = this.IPSR;
    super.exceptionReturn(value);
    this.PC &= ~1;
    if (number >= FIRST_IRQ) {
      const bit = 1 << (number - FIRST_IRQ);
      this.active &= ~bit;
      this.pendingInterrupts |= this.lines & bit;
    }
    this.chained = this.nextException(this.executionPriority(true)) !== 0;
    if (!this.chained) this.extra += EXIT_CYCLES;
    this.left = number;
  }

  exceptionPriority(number) {
    return number === HARD_FAULT ? -1 : number === NMI ? -2 : super.exceptionPriority(number);
  }

  /** Takes HardFault for the instruction at `pc`. A fault in HardFault itself locks the processor up. */
  hardFault(error, pc) {
    this.PC = pc;
    const where = `${error.message}, by the instruction at 0x${pc.toString(16)}`;
    this.board.note('fault', where);
    if (this.executionPriority(false) < 0) {
      this.board.stop('lockup', where);
      return 1;
    }
    this.exceptionEntry(HARD_FAULT);
    return ENTRY_CYCLES;
  }

  sleep(byEvent) {
    if (byEvent && this.eventRegistered) {
      this.eventRegistered = false;
      return;
    }
    this.waiting = true;
    this.sleepsByEvent = byEvent;
    this.interruptsUpdated = true;
  }

  /** Ends the sleep if there is a reason. */
  wake() {
    if (this.sleepsByEvent && this.eventRegistered) {
      this.eventRegistered = false;
      this.waiting = false;
    } else if (this.interruptsUpdated) {
      this.interruptsUpdated = false;
      if (this.nextException(this.executionPriority(this.sleepsByEvent)) !== 0) {
        this.waiting = false;
        this.interruptsUpdated = true;
      }
    }
  }
}
