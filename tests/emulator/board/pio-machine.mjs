// A PIO state machine in cycles. rp2040js's own does not record when an instruction executes.
//
// Words:
// - an instruction *executes* in one cycle, `due`; its outputs and side-set take that cycle as their stamp; the next
//   executes 1 + delay cycles later (times the clock divider);
// - an instruction *stalls* when it cannot complete: it has side-set in its first cycle, and is tried again in the
//   cycle after its condition may have become true;
// - a *quiet* instruction uses nothing but the machine's own registers, and depends on nothing else but the pins;
// - *running ahead*: after each instruction the quiet ones that follow are executed at once, up to the next one that
//   is not quiet, which is then due in its own cycle. If an input pin that they read changes, or the registers are
//   read, they are reset to their earlier values and advanced to that cycle (`settle`). So only the speed differs.
//
// Integer clock dividers are modelled. Fractional ones, autopull and OUT_STICKY are refused. Running ahead requires
// that no other machine drives the pins that this one side-sets.

import { FDEBUG, INPUT, NONE, Operations, RX, TX } from './pio-operations.mjs';
import { FIFO } from 'rp2040js';

const EXECCTRL_STALLED = 0x8000_0000;
const OUT_STICKY = (1 << 17) | (1 << 18);
const MAX_AHEAD = 2048;
const MIN_AHEAD = 16;

const LOUD = 0;
const QUIET = 1;
const COUNTED_JMP = 2;
const JMP_PIN = 3;
const IN = 4;
const IN_PINS = 5;
const MOV_PINS = 6;

/** By instruction, less its delay and side-set: whether it is quiet, and how running ahead must treat it. */
const KIND = Uint8Array.from({ length: 0x1_0000 }, (_, opcode) => {
  const to = (opcode >>> 5) & 7;
  const from = opcode & 7;
  switch (opcode >>> 13) {
    case 0:
      return to === 2 || to === 4 ? COUNTED_JMP : to === 6 ? JMP_PIN : QUIET;
    case 2:
      return to === 0 ? IN_PINS : IN;
    case 3:
      return [1, 2, 3, 5, 6].includes(to) ? QUIET : LOUD;
    case 5:
      if (![1, 2, 5, 6, 7].includes(to) || from === 5) return LOUD;
      return from === 0 ? MOV_PINS : QUIET;
    case 7:
      return to === 1 || to === 2 ? QUIET : LOUD;
    default:
      return LOUD;
  }
});

export class Machine extends Operations {
  constructor(block, index) {
    super(block, index);
    this.dreqTx = block.dreqTx[index];
    this.dreqRx = block.dreqRx[index];
    this.enabled = false;
    /** Cycle in which the next instruction executes; Infinity while stalled or disabled. */
    this.due = Infinity;
    this.stall = NONE;
    /** Cycles left of a delay when the machine was disabled. */
    this.held = 0;
    /** The cycle in which the divided clock's grid begins. */
    this.phase = 0;
    /** While ahead: the registers as they were in cycle `from`, the levels of the pins, and which of them are read. */
    this.saved = { ahead: false, from: 0, inputs: 0, x: 0, y: 0, pc: 0, isr: 0, isrCount: 0, osr: 0, osrCount: 0 };
    this.pinsRead = 0;
    this.maxAhead = MAX_AHEAD;
    this.updateTx();
    this.updateRx();
  }

  refuseUnmodelled() {
    const name = `${this.block.name} state machine ${this.index}`;
    if ((this.clkdiv >>> 8) & 0xff) throw new Error(`${name}: fractional clock dividers are not modelled`);
    if (this.shiftctrl & (1 << 17)) throw new Error(`${name}: autopull is not modelled`);
    if (this.execctrl & OUT_STICKY) throw new Error(`${name}: OUT_STICKY is not modelled`);
  }

  // ---- FIFOs ----

  updateTx() {
    const { dma } = this.block.rp2040;
    if (this.txFIFO.full) dma.clearDREQ(this.dreqTx);
    else dma.setDREQ(this.dreqTx);
  }

  updateRx() {
    const { dma } = this.block.rp2040;
    if (this.rxFIFO.empty) dma.clearDREQ(this.dreqRx);
    else dma.setDREQ(this.dreqRx);
  }

  /** Bits 30 and 31 of SHIFTCTRL join the FIFOs into one of eight words; a change empties both. */
  join() {
    const joinTx = (this.shiftctrl >>> 30) & 1;
    const joinRx = (this.shiftctrl >>> 31) & 1;
    this.txFIFO = new FIFO(joinRx ? 0 : joinTx ? 8 : 4);
    this.rxFIFO = new FIFO(joinTx ? 0 : joinRx ? 8 : 4);
    this.updateTx();
    this.updateRx();
    this.block.checkInterrupts();
  }

  writeFIFO(value) {
    if (this.txFIFO.full) {
      this.flagDebug(FDEBUG.txOver);
      return;
    }
    this.txFIFO.push(value);
    this.updateTx();
    this.block.checkInterrupts();
    this.retry(TX);
  }

  readFIFO() {
    if (this.rxFIFO.empty) {
      this.flagDebug(FDEBUG.rxUnder);
      return 0;
    }
    const value = this.rxFIFO.pull();
    this.updateRx();
    this.block.checkInterrupts();
    this.retry(RX);
    return value;
  }

  get fifoStat() {
    const { txFIFO, rxFIFO } = this;
    const bits =
      (txFIFO.empty ? 1 << 24 : 0) |
      (txFIFO.full ? 1 << 16 : 0) |
      (rxFIFO.empty ? 1 << 8 : 0) |
      (rxFIFO.full ? 1 : 0);
    return bits << this.index;
  }

  // ---- time ----

  setDue(cycle) {
    this.due = cycle;
    this.block.onDue(cycle);
  }

  /** Tries a stalled instruction again in `cycle`, or on the divider's grid: its condition may hold now. */
  retry(kind, cycle = this.block.stampNow() + 1) {
    if (this.stall !== kind || (!this.enabled && this.forced < 0)) return;
    this.setDue(this.onGrid(cycle));
  }

  /** The first cycle from `cycle` on in which the divided clock ticks. */
  onGrid(cycle) {
    const { divider, phase } = this;
    return divider === 1 ? cycle : phase + Math.ceil((cycle - phase) / divider) * divider;
  }

  enable(on, now) {
    if (on === this.enabled) return;
    this.settle(now);
    this.enabled = on;
    if (on) {
      this.refuseUnmodelled();
      this.phase = now;
      this.setDue(this.onGrid(now + this.held));
      this.held = 0;
    } else {
      this.held = this.due === Infinity ? 0 : Math.max(0, this.due - now);
      this.due = Infinity;
    }
  }

  restart(now) {
    this.settle(now);
    this.isr = 0;
    this.isrCount = 0;
    this.osrCount = 32;
    this.forced = -1;
    this.flagSet = false;
    this.held = 0;
    this.stall = NONE;
    this.execctrl &= ~EXECCTRL_STALLED;
    if (this.enabled) this.setDue(this.onGrid(now));
  }

  /**
   * An instruction written by the processor executes at the end of the store's last cycle, the one before `now`. The
   * state of the program does not matter.
   */
  force(opcode, now) {
    this.settle(now);
    this.stall = NONE;
    this.forced = opcode;
    this.block.begin(now - 1);
    this.execute(now - 1);
    this.block.end(now - 1);
    this.execctrl = this.stall === NONE ? this.execctrl & ~EXECCTRL_STALLED : this.execctrl | EXECCTRL_STALLED;
  }

  /** Executes the instruction that is due in `cycle`. */
  execute(cycle) {
    this.saved.ahead = false;
    const isForced = this.forced >= 0;
    const opcode = isForced ? this.forced : this.block.instructions[this.pc];
    this.forced = -1;
    this.jumped = isForced;
    this.stall = this.operate(opcode);
    // After the instruction's own outputs: on a pin that both write, side-set wins (datasheet 3.5.1).
    const field = (opcode >>> 8) & 0x1f;
    if (this.hasSide && (!this.sideOptional || field & 0x10)) {
      const value = (field >>> this.sideShift) & ((1 << this.sidePins) - 1);
      if (this.sideToDirections) this.block.setDirections(value, this.sideBase, this.sidePins);
      else this.block.setPins(value, this.sideBase, this.sidePins);
    }
    if (this.stall !== NONE) {
      if (isForced) this.forced = opcode;
      this.due = Infinity;
      if (this.stall === INPUT && this.block.inputsUnsettled(cycle)) this.setDue(this.onGrid(cycle + 1));
      return;
    }
    this.flagSet = false;
    this.execctrl &= ~EXECCTRL_STALLED;
    if (!this.jumped) this.nextPc();
    if (!this.enabled) {
      this.due = Infinity;
      return;
    }
    this.due = this.onGrid(cycle + this.divider * (this.forced >= 0 ? 1 : 1 + (field & this.delayMask)));
    if (this.block.fastForward && this.forced < 0 && KIND[this.block.instructions[this.pc]] !== LOUD) this.runAhead();
    this.block.onDue(this.due);
  }

  nextPc() {
    this.pc = this.pc === this.wrapTop ? this.wrapBottom : (this.pc + 1) & 0x1f;
  }

  // ---- running ahead ----

  runAhead() {
    const { saved } = this;
    saved.from = this.due;
    saved.x = this.x;
    saved.y = this.y;
    saved.pc = this.pc;
    saved.isr = this.isr;
    saved.isrCount = this.isrCount;
    saved.osr = this.osr;
    saved.osrCount = this.osrCount;
    saved.inputs = this.block.steadyInputs();
    this.pinsRead = 0;
    this.quietUntil(Infinity);
    saved.ahead = this.due !== saved.from;
    if (saved.ahead && this.maxAhead < MAX_AHEAD) this.maxAhead *= 2;
  }

  /** Sets the registers to their values at the start of `now`. */
  settle(now) {
    const { saved } = this;
    if (!saved.ahead) return;
    saved.ahead = false;
    if (now >= this.due) return;
    this.x = saved.x;
    this.y = saved.y;
    this.pc = saved.pc;
    this.isr = saved.isr;
    this.isrCount = saved.isrCount;
    this.osr = saved.osr;
    this.osrCount = saved.osrCount;
    this.due = saved.from;
    if (this.due < now) this.quietUntil(now);
    this.maxAhead = Math.max(MIN_AHEAD, this.maxAhead >> 1);
    this.block.onDue(this.due);
  }

  /** Executes quiet instructions due before `limit`. */
  quietUntil(limit) {
    const { block } = this;
    const present = block.cycle;
    let at = this.due;
    for (let left = MAX_AHEAD; left > 0 && at < limit; left -= 1) {
      if (limit === Infinity && left <= MAX_AHEAD - this.maxAhead) break;
      const opcode = block.instructions[this.pc];
      const kind = KIND[opcode];
      if (kind === LOUD || (kind >= IN && kind <= IN_PINS && this.autopush)) break;
      const field = (opcode >>> 8) & 0x1f;
      if (this.hasSide && (!this.sideOptional || field & 0x10) && !this.sideHolds(field)) break;
      const period = this.divider * (1 + (field & this.delayMask));
      if (kind === COUNTED_JMP && (opcode & 0x1f) === this.pc) {
        const rounds = Math.min((opcode >>> 5) & 4 ? this.y : this.x, Math.ceil((limit - at) / period));
        if (rounds > 0) {
          if ((opcode >>> 5) & 4) this.y -= rounds;
          else this.x -= rounds;
          at += rounds * period;
          continue;
        }
      } else if (kind >= JMP_PIN && kind !== IN) {
        // Running ahead may only read steady pins. A repeated run reads the pins at their earlier levels.
        const pins = this.pinsOf(kind, opcode);
        if (limit === Infinity && block.inputsMoving(at, pins)) break;
        this.pinsRead |= pins;
        block.fixInputs(at, this.saved.inputs);
      }
      this.jumped = false;
      this.operate(opcode);
      if (!this.jumped) this.nextPc();
      at += period;
    }
    block.cycle = present;
    block.sampledIn = -1;
    this.due = at;
  }

  /** True if the pins already have what this side-set gives them. */
  sideHolds(field) {
    const value = (field >>> this.sideShift) & ((1 << this.sidePins) - 1);
    const pins = this.sideToDirections ? this.block.pinDirections : this.block.pinValues;
    const turned = this.sideBase === 0 ? pins : (pins >>> this.sideBase) | (pins << (32 - this.sideBase));
    return (turned & ((1 << this.sidePins) - 1)) === value;
  }

  /** Mask of the pins that an instruction reads. */
  pinsOf(kind, opcode) {
    if (kind === JMP_PIN) return 1 << this.jmpPin;
    const count = opcode & 0x1f;
    if (kind === MOV_PINS || count === 0) return -1;
    const mask = (1 << count) - 1;
    return this.inBase === 0 ? mask : (mask << this.inBase) | (mask >>> (32 - this.inBase));
  }
}
