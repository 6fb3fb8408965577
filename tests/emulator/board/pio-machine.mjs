// A PIO state machine in cycles, after chapter 3 of the RP2040 datasheet. rp2040js's own has no notion of when.
//
// Words:
// - an instruction *executes* in one cycle, `due`; its outputs and side-set take that cycle as their stamp; the next
//   executes 1 + delay cycles later;
// - an instruction *stalls* when it cannot complete: it has side-set in its first cycle, and is tried again in the cycle
//   after what it waits for may have come;
// - a *skip*: `jmp y--` (or x) to itself is not played round by round. The register reads as if it had been, at any
//   moment (`settle`).
//
// Integer clock dividers are modelled; fractional ones and autopull are refused. A skip supposes that no other machine
// drives the pins that the skipped instruction side-sets.

import { FIFO } from 'rp2040js';

const EXECCTRL_STALLED = 0x8000_0000;
const FDEBUG = { txStall: 24, txOver: 16, rxUnder: 8, rxStall: 0 };
const NONE = 0;
const TX = 1;
const RX = 2;
const INPUT = 3;
const FLAG = 4;

function reversed(x) {
  let result = 0;
  for (let i = 0; i < 32; i += 1) result |= ((x >>> i) & 1) << (31 - i);
  return result >>> 0;
}

export class Machine {
  constructor(block, index) {
    this.block = block;
    this.index = index;
    this.dreqTx = block.dreqTx[index];
    this.dreqRx = block.dreqRx[index];
    this.enabled = false;
    this.x = 0;
    this.y = 0;
    this.pc = 0;
    this.isr = 0;
    this.isrCount = 0;
    this.osr = 0;
    this.osrCount = 32;
    this.clkdiv = 1 << 16;
    this.execctrl = 0x1f << 12;
    this.shiftctrl = 0b11 << 18;
    this.pinctrl = 0x5 << 26;
    this.txFIFO = new FIFO(4);
    this.rxFIFO = new FIFO(4);
    /** Cycle in which the next instruction executes; Infinity while stalled or disabled. */
    this.due = Infinity;
    this.stall = NONE;
    /** Cycles left of a delay when the machine was disabled. */
    this.held = 0;
    /** An instruction to execute in place of the program's: from OUT or MOV to EXEC, or written by the processor. */
    this.forced = -1;
    this.flagSet = false;
    this.skip = null;
    /** Where the divided clock's grid begins. */
    this.phase = 0;
    this.decode();
    this.updateTx();
    this.updateRx();
  }

  /** Takes the control registers apart. */
  decode() {
    const { execctrl, shiftctrl, pinctrl } = this;
    const sideCount = pinctrl >>> 29;
    this.sideOptional = (execctrl & (1 << 30)) !== 0;
    this.sideToDirections = (execctrl & (1 << 29)) !== 0;
    this.sideShift = 5 - sideCount;
    this.delayMask = (1 << this.sideShift) - 1;
    this.sidePins = this.sideOptional ? sideCount - 1 : sideCount;
    this.hasSide = sideCount > 0;
    this.jmpPin = (execctrl >>> 24) & 0x1f;
    this.wrapTop = (execctrl >>> 12) & 0x1f;
    this.wrapBottom = (execctrl >>> 7) & 0x1f;
    this.statusRx = (execctrl & 0x10) !== 0;
    this.statusLevel = execctrl & 0xf;
    this.outBase = pinctrl & 0x1f;
    this.setBase = (pinctrl >>> 5) & 0x1f;
    this.sideBase = (pinctrl >>> 10) & 0x1f;
    this.inBase = (pinctrl >>> 15) & 0x1f;
    this.outCount = (pinctrl >>> 20) & 0x3f;
    this.setCount = (pinctrl >>> 26) & 0x7;
    this.autopush = (shiftctrl & (1 << 16)) !== 0;
    this.inRight = (shiftctrl & (1 << 18)) !== 0;
    this.outRight = (shiftctrl & (1 << 19)) !== 0;
    this.pushThreshold = ((shiftctrl >>> 20) & 0x1f) || 32;
    this.pullThreshold = ((shiftctrl >>> 25) & 0x1f) || 32;
    this.divider = this.clkdiv >>> 16 || 0x1_0000;
  }

  refuseUnmodelled() {
    const name = `${this.block.name} state machine ${this.index}`;
    if ((this.clkdiv >>> 8) & 0xff) throw new Error(`${name}: fractional clock dividers are not modelled`);
    if (this.shiftctrl & (1 << 17)) throw new Error(`${name}: autopull is not modelled`);
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

  pullWord() {
    this.osr = this.txFIFO.pull();
    this.osrCount = 0;
    this.updateTx();
    this.block.checkInterrupts();
  }

  pushWord() {
    this.rxFIFO.push(this.isr);
    this.isr = 0;
    this.isrCount = 0;
    this.updateRx();
    this.block.checkInterrupts();
  }

  flagDebug(shift) {
    this.block.fdebug |= 1 << (shift + this.index);
  }

  get fifoStat() {
    const { txFIFO, rxFIFO } = this;
    const bits =
      (txFIFO.empty ? 1 << 24 : 0) | (txFIFO.full ? 1 << 16 : 0) | (rxFIFO.empty ? 1 << 8 : 0) | (rxFIFO.full ? 1 : 0);
    return bits << this.index;
  }

  // ---- time ----

  setDue(cycle) {
    this.due = cycle;
    this.block.onDue(cycle);
  }

  /** What a stalled instruction waits for may have come, at the end of the present cycle. */
  retry(kind, cycle = this.block.stampNow() + 1) {
    if (this.stall !== kind || (!this.enabled && this.forced < 0)) return;
    const grid = this.divider === 1 ? 0 : (cycle - this.phase) % this.divider;
    this.setDue(grid <= 0 ? cycle : cycle + this.divider - grid);
  }

  enable(on, now) {
    if (on === this.enabled) return;
    this.settle(now);
    this.enabled = on;
    if (on) {
      this.refuseUnmodelled();
      this.phase = now;
      this.setDue(now + this.held);
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
    if (this.enabled) this.setDue(now);
  }

  /** Makes the registers what they are at the start of `now`, should a skip be under way. */
  settle(now) {
    const { skip } = this;
    if (skip === null) return;
    const rounds = Math.min(skip.count, Math.max(0, Math.ceil((now - skip.start) / skip.period)));
    this[skip.register] = skip.count - rounds;
    this.skip = null;
    this.setDue(skip.start + rounds * skip.period);
  }

  /** An instruction written by the processor executes at once, whatever the program is doing. */
  force(opcode, now) {
    this.settle(now);
    this.stall = NONE;
    this.forced = opcode;
    this.block.begin(now);
    this.execute(now);
    this.block.end(now);
    this.execctrl = this.stall === NONE ? this.execctrl & ~EXECCTRL_STALLED : this.execctrl | EXECCTRL_STALLED;
  }

  // ---- execution ----

  /** Executes what is due in `cycle`. */
  execute(cycle) {
    this.skip = null;
    const isForced = this.forced >= 0;
    const opcode = isForced ? this.forced : this.block.instructions[this.pc];
    this.forced = -1;
    const field = (opcode >>> 8) & 0x1f;
    const delay = field & this.delayMask;
    this.jumped = isForced;
    const stall = this.operate(opcode, cycle, delay, isForced);
    // After the instruction's own outputs: on a pin that both write, side-set wins (datasheet 3.5.1).
    if (this.hasSide && (!this.sideOptional || field & 0x10)) {
      const value = (field >>> this.sideShift) & ((1 << this.sidePins) - 1);
      if (this.sideToDirections) this.block.setDirections(value, this.sideBase, this.sidePins);
      else this.block.setPins(value, this.sideBase, this.sidePins);
    }
    this.stall = stall;
    if (stall !== NONE) {
      if (isForced) this.forced = opcode;
      this.due = Infinity;
      if (stall === INPUT && this.block.inputsUnsettled(cycle)) this.setDue(cycle + this.divider);
      return;
    }
    this.flagSet = false;
    this.execctrl &= ~EXECCTRL_STALLED;
    if (!this.jumped) this.pc = this.pc === this.wrapTop ? this.wrapBottom : (this.pc + 1) & 0x1f;
    if (this.skip !== null) this.setDue(this.skip.start + this.skip.count * this.skip.period);
    else if (this.enabled) this.setDue(cycle + this.divider * (this.forced >= 0 ? 1 : 1 + delay));
    else this.due = Infinity;
  }

  operate(opcode, cycle, delay, isForced) {
    const argument = (opcode >>> 5) & 7;
    const low = opcode & 0x1f;
    switch (opcode >>> 13) {
      case 0:
        this.jump(argument, low, cycle, delay, isForced);
        return NONE;
      case 1:
        return this.wait(opcode);
      case 2:
        return this.shiftIn(this.source(argument), low || 32);
      case 3:
        this.shiftOut(argument, low || 32);
        return NONE;
      case 4:
        return opcode & 0x80 ? this.pull(opcode) : this.push(opcode);
      case 5:
        this.move(argument, (opcode >>> 3) & 3, this.source(opcode & 7));
        return NONE;
      case 6:
        return this.interrupt(opcode);
      default:
        this.set(argument, low);
        return NONE;
    }
  }

  /** JMP. X-- and Y-- test the register before they decrement it, and decrement it whether they jump or not. */
  jump(condition, target, cycle, delay, isForced) {
    let taken;
    let counted = null;
    switch (condition) {
      case 0:
        taken = true;
        break;
      case 1:
        taken = this.x === 0;
        break;
      case 2:
        counted = 'x';
        break;
      case 3:
        taken = this.y === 0;
        break;
      case 4:
        counted = 'y';
        break;
      case 5:
        taken = this.x !== this.y;
        break;
      case 6:
        taken = ((this.block.inputs >>> this.jmpPin) & 1) === 1;
        break;
      default:
        taken = this.osrCount < this.pullThreshold;
    }
    if (counted !== null) {
      const count = this[counted];
      taken = count !== 0;
      this[counted] = (count - 1) >>> 0;
      if (taken && target === this.pc && !isForced && this.block.fastForward) {
        this.skip = { register: counted, count, start: cycle, period: this.divider * (1 + delay) };
        this[counted] = 0;
      }
    }
    if (taken) {
      this.pc = target;
      this.jumped = true;
    }
  }

  wait(opcode) {
    const polarity = (opcode >>> 7) & 1;
    const index = opcode & 0x1f;
    const kind = (opcode >>> 5) & 3;
    if (kind === 2) {
      const flag = this.flagNumber(index);
      if (((this.block.flags >>> flag) & 1) !== polarity) return FLAG;
      if (polarity) this.block.clearFlag(flag);
      return NONE;
    }
    const pin = kind === 0 ? index : (this.inBase + index) & 0x1f;
    return ((this.block.inputs >>> pin) & 1) === polarity ? NONE : INPUT;
  }

  source(which) {
    switch (which) {
      case 0: {
        const { inputs } = this.block;
        const { inBase } = this;
        return (inBase ? (inputs >>> inBase) | (inputs << (32 - inBase)) : inputs) >>> 0;
      }
      case 1:
        return this.x;
      case 2:
        return this.y;
      case 5:
        return (this.statusRx ? this.rxFIFO : this.txFIFO).itemCount < this.statusLevel ? 0xffff_ffff : 0;
      case 6:
        return this.isr;
      case 7:
        return this.osr;
      default:
        return 0;
    }
  }

  shiftIn(value, count) {
    const full = this.autopush && this.isrCount >= this.pushThreshold;
    if (!full) {
      if (count === 32) {
        this.isr = value;
      } else if (this.inRight) {
        this.isr = ((this.isr >>> count) | (value << (32 - count))) >>> 0;
      } else {
        this.isr = ((this.isr << count) | (value & ((1 << count) - 1))) >>> 0;
      }
      this.isrCount = Math.min(32, this.isrCount + count);
    }
    if (!this.autopush || this.isrCount < this.pushThreshold) return NONE;
    if (this.rxFIFO.full) {
      this.flagDebug(FDEBUG.rxStall);
      return RX;
    }
    this.pushWord();
    return NONE;
  }

  shiftOut(destination, count) {
    let value;
    if (count === 32) {
      value = this.osr;
      this.osr = 0;
    } else if (this.outRight) {
      value = this.osr & ((1 << count) - 1);
      this.osr >>>= count;
    } else {
      value = this.osr >>> (32 - count);
      this.osr = (this.osr << count) >>> 0;
    }
    this.osrCount = Math.min(32, this.osrCount + count);
    switch (destination) {
      case 6:
        this.isr = value;
        this.isrCount = count;
        break;
      case 7:
        this.forced = value & 0xffff;
        break;
      default:
        this.write(destination, value);
    }
  }

  push(opcode) {
    if (opcode & 0x40 && this.isrCount < this.pushThreshold) return NONE;
    if (!this.rxFIFO.full) {
      this.pushWord();
      return NONE;
    }
    this.flagDebug(FDEBUG.rxStall);
    if (opcode & 0x20) return RX;
    this.isr = 0;
    this.isrCount = 0;
    return NONE;
  }

  pull(opcode) {
    if (opcode & 0x40 && this.osrCount < this.pullThreshold) return NONE;
    if (!this.txFIFO.empty) {
      this.pullWord();
      return NONE;
    }
    if (opcode & 0x20) {
      this.flagDebug(FDEBUG.txStall);
      return TX;
    }
    this.osr = this.x;
    this.osrCount = 0;
    return NONE;
  }

  move(destination, operation, value) {
    const result = operation === 1 ? ~value >>> 0 : operation === 2 ? reversed(value) : value;
    switch (destination) {
      case 3:
        break;
      case 4:
        this.forced = result & 0xffff;
        break;
      case 6:
        this.isr = result;
        this.isrCount = 0;
        break;
      case 7:
        this.osr = result;
        this.osrCount = 0;
        break;
      default:
        this.write(destination, result);
    }
  }

  /** What OUT and MOV have in common: pins, x, y, pin directions, pc. */
  write(destination, value) {
    switch (destination) {
      case 0:
        this.block.setPins(value, this.outBase, this.outCount);
        break;
      case 1:
        this.x = value;
        break;
      case 2:
        this.y = value;
        break;
      case 4:
        this.block.setDirections(value, this.outBase, this.outCount);
        break;
      case 5:
        this.pc = value & 0x1f;
        this.jumped = true;
        break;
      default:
    }
  }

  interrupt(opcode) {
    const flag = this.flagNumber(opcode & 0x1f);
    if (opcode & 0x40) {
      this.block.clearFlag(flag);
      return NONE;
    }
    if (!this.flagSet) this.block.raiseFlag(flag);
    if (!(opcode & 0x20)) return NONE;
    const done = this.flagSet && ((this.block.flags >>> flag) & 1) === 0;
    this.flagSet = true;
    return done ? NONE : FLAG;
  }

  flagNumber(index) {
    return index & 0x10 ? (index & 4) | ((index + this.index) & 3) : index & 7;
  }

  set(destination, value) {
    if (destination === 0) this.block.setPins(value, this.setBase, this.setCount);
    else if (destination === 1) this.x = value;
    else if (destination === 2) this.y = value;
    else if (destination === 4) this.block.setDirections(value, this.setBase, this.setCount);
  }
}

export { FDEBUG, FLAG, INPUT, RX, TX };
