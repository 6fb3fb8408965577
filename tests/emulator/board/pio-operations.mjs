// Effects of the instructions of a PIO state machine, after chapter 3.4 of the RP2040 datasheet. Their timing is in
// pio-machine.mjs.
//
// All registers are kept as unsigned 32-bit numbers. Autopull is not modelled (it is refused when a machine is
// enabled).

import { FIFO } from 'rp2040js';

/** Positions in FDEBUG of machine 0's flags. */
export const FDEBUG = { txStall: 24, txOver: 16, rxUnder: 8, rxStall: 0 };

/** Causes of a stall. */
export const NONE = 0;
export const TX = 1;
export const RX = 2;
export const INPUT = 3;
export const FLAG = 4;

function reversed(x) {
  let result = 0;
  for (let i = 0; i < 32; i += 1) result |= ((x >>> i) & 1) << (31 - i);
  return result >>> 0;
}

export class Operations {
  constructor(block, index) {
    this.block = block;
    this.index = index;
    this.x = 0;
    this.y = 0;
    this.pc = 0;
    this.isr = 0;
    this.isrCount = 0;
    this.osr = 0;
    this.osrCount = 32;
    this.jumped = false;
    /** An instruction to execute in place of the program's: from OUT or MOV to EXEC, or written by the processor. */
    this.forced = -1;
    /** IRQ with wait has raised its flag and waits for it to be cleared. */
    this.flagSet = false;
    this.clkdiv = 1 << 16;
    this.execctrl = 0x1f << 12;
    this.shiftctrl = 0b11 << 18;
    this.pinctrl = 0x5 << 26;
    this.txFIFO = new FIFO(4);
    this.rxFIFO = new FIFO(4);
    this.decode();
  }

  /** Decodes the control registers. */
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
    this.pushThreshold = (shiftctrl >>> 20) & 0x1f || 32;
    this.pullThreshold = (shiftctrl >>> 25) & 0x1f || 32;
    this.divider = this.clkdiv >>> 16 || 0x1_0000;
  }

  /** Carries one instruction out. Gives the cause of its stall, or NONE; `jumped` is set if it wrote the PC. */
  operate(opcode) {
    const argument = (opcode >>> 5) & 7;
    const low = opcode & 0x1f;
    switch (opcode >>> 13) {
      case 0:
        this.jump(argument, low);
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
  jump(condition, target) {
    let taken;
    switch (condition) {
      case 0:
        taken = true;
        break;
      case 1:
        taken = this.x === 0;
        break;
      case 2:
        taken = this.x !== 0;
        this.x = (this.x - 1) >>> 0;
        break;
      case 3:
        taken = this.y === 0;
        break;
      case 4:
        taken = this.y !== 0;
        this.y = (this.y - 1) >>> 0;
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

  /** Destinations that OUT and MOV share: pins, x, y, pin directions, pc. */
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
}
