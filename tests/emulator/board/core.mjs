// The processor: rp2040js's core, with corrections for instructions with a wrong result or a wrong time.
//
// Corrected: carry and overflow of ADCS and SBCS with a carry out of the second operand; flags of shifts by register with
// counts 0 and over 32; STM with its base among the registers; the cycles of PUSH and POP with LR or PC; SEV; WFE and
// WFI; undefined instructions, BKPT, branches to ARM state and SVC where it cannot be taken, which fault. Everything else
// is rp2040js's own. Cycles are those of the Cortex-M0+ Technical Reference Manual, table 3-1, and the wait for the
// flash.

import { ExceptionCore } from './core-exceptions.mjs';
import { Fault } from './core-memory.mjs';

const CORRECTED = new Map([
  // name: [mask, pattern, method]
  ['ADCS', [0xffc0, 0x4140]],
  ['SBCS', [0xffc0, 0x4180]],
  ['LSLS', [0xffc0, 0x4080]],
  ['LSRS', [0xffc0, 0x40c0]],
  ['ASRS', [0xffc0, 0x4100]],
  ['RORS', [0xffc0, 0x41c0]],
  ['PUSH', [0xfe00, 0xb400]],
  ['POP', [0xfe00, 0xbc00]],
  ['STM', [0xf800, 0xc000]],
  ['SEV', [0xffff, 0xbf40]],
  ['WFE', [0xffff, 0xbf20]],
  ['WFI', [0xffff, 0xbf30]],
  ['YIELD', [0xffff, 0xbf10]],
  ['BLX', [0xff87, 0x4780]],
  ['UDF', [0xff00, 0xde00]],
  ['UDFW', [0xfff0, 0xf7f0]],
  ['BKPT', [0xff00, 0xbe00]],
  ['SVC', [0xff00, 0xdf00]],
  ['SUBSP', [0xff80, 0xb080]],
  ['MOVSP', [0xff87, 0x4685]],
  ['ADDSP', [0xff87, 0x4485]],
]);

/** For each first half-word of an instruction: 0, or the number of its correction in CORRECTED' order, from 1. */
const CORRECTION_OF = new Uint8Array(0x1_0000);
[...CORRECTED.values()].forEach(([mask, pattern], index) => {
  for (let opcode = 0; opcode < 0x1_0000; opcode += 1) {
    if ((opcode & mask) === pattern) CORRECTION_OF[opcode] = index + 1;
  }
});
const METHOD_OF = [null, ...[...CORRECTED.keys()].map((name) => `do${name}`)];
const ROM_END = 0x4000;

export class BenchCore extends ExceptionCore {
  constructor(rp2040, board) {
    super(rp2040, board);
    /** Least value of the stack pointer since reset. */
    this.minSP = 0xffff_ffff;
    this.methods = METHOD_OF.map((name) => name && this[name]);
  }

  /** Executes one instruction, or enters one exception. Gives the cycles of that. */
  step() {
    if (this.interruptsUpdated) {
      const cycles = this.takeException();
      if (cycles !== 0) return cycles;
    }
    const pc = (this.registers[15] & ~1) >>> 0;
    try {
      const opcode = pc >>> 28 === 1 && !this.xipOff ? this.flash16[this.flashOffset(pc) >>> 1] : this.readUint16(pc);
      const correction = CORRECTION_OF[opcode];
      let cycles;
      if (correction === 0) {
        cycles = this.executeInstruction();
      } else {
        this.registers[15] = pc + 2;
        cycles = this.methods[correction].call(this, opcode, pc);
      }
      if (this.extra !== 0) {
        cycles += this.extra;
        this.extra = 0;
      }
      return cycles;
    } catch (error) {
      if (!(error instanceof Fault)) throw error;
      this.extra = 0;
      return this.hardFault(error, pc);
    }
  }

  noteStack() {
    if (this.registers[13] < this.minSP) this.minSP = this.registers[13];
  }

  setNZ(value) {
    this.N = (value & 0x8000_0000) !== 0;
    this.Z = (value | 0) === 0;
  }

  /** a + b + carry, with flags: ARMv6-M manual, AddWithCarry. */
  addWithCarry(a, b, carry) {
    const unsigned = a + b + carry;
    const signed = (a | 0) + (b | 0) + carry;
    const result = unsigned >>> 0;
    this.setNZ(result);
    this.C = unsigned !== result;
    this.V = signed !== (result | 0);
    return result;
  }

  doADCS(opcode) {
    const { registers } = this;
    const d = opcode & 7;
    registers[d] = this.addWithCarry(registers[d], registers[(opcode >> 3) & 7], this.C ? 1 : 0);
    return 1;
  }

  doSBCS(opcode) {
    const { registers } = this;
    const d = opcode & 7;
    registers[d] = this.addWithCarry(registers[d], ~registers[(opcode >> 3) & 7] >>> 0, this.C ? 1 : 0);
    return 1;
  }

  /** Writes a shift's result; `carry` undefined: the flag stays. */
  shifted(opcode, result, carry) {
    this.registers[opcode & 7] = result;
    this.setNZ(result);
    if (carry !== undefined) this.C = carry;
    return 1;
  }

  doLSLS(opcode) {
    const value = this.registers[opcode & 7];
    const by = this.registers[(opcode >> 3) & 7] & 0xff;
    if (by === 0) return this.shifted(opcode, value, undefined);
    return this.shifted(opcode, by < 32 ? value << by : 0, by <= 32 && ((value >>> (32 - by)) & 1) === 1);
  }

  doLSRS(opcode) {
    const value = this.registers[opcode & 7];
    const by = this.registers[(opcode >> 3) & 7] & 0xff;
    if (by === 0) return this.shifted(opcode, value, undefined);
    return this.shifted(opcode, by < 32 ? value >>> by : 0, by <= 32 && ((value >>> (by - 1)) & 1) === 1);
  }

  doASRS(opcode) {
    const value = this.registers[opcode & 7];
    const by = Math.min(this.registers[(opcode >> 3) & 7] & 0xff, 32);
    if (by === 0) return this.shifted(opcode, value, undefined);
    return this.shifted(opcode, value >> Math.min(by, 31), ((value >>> (by - 1)) & 1) === 1);
  }

  doRORS(opcode) {
    const value = this.registers[opcode & 7];
    const by = this.registers[(opcode >> 3) & 7] & 0xff;
    if (by === 0) return this.shifted(opcode, value, undefined);
    const result = by & 31 ? (value >>> (by & 31)) | (value << (32 - (by & 31))) : value;
    return this.shifted(opcode, result, (result & 0x8000_0000) !== 0);
  }

  doPUSH(opcode) {
    const { registers } = this;
    let address = registers[13];
    let count = 0;
    if (opcode & 0x100) {
      address -= 4;
      count += 1;
      this.writeUint32(address, registers[14]);
    }
    for (let i = 7; i >= 0; i -= 1) {
      if (opcode & (1 << i)) {
        address -= 4;
        count += 1;
        this.writeUint32(address, registers[i]);
      }
    }
    registers[13] = address;
    this.noteStack();
    return 1 + count;
  }

  doPOP(opcode) {
    const { registers } = this;
    let address = registers[13];
    let count = 0;
    for (let i = 0; i < 8; i += 1) {
      if (opcode & (1 << i)) {
        registers[i] = this.readUint32(address);
        address += 4;
        count += 1;
      }
    }
    if (!(opcode & 0x100)) {
      registers[13] = address;
      return 1 + count;
    }
    const target = this.readUint32(address);
    registers[13] = address + 4;
    this.BXWritePC(target);
    return 3 + count + 1;
  }

  doSTM(opcode) {
    const { registers } = this;
    const n = (opcode >> 8) & 7;
    let address = registers[n];
    let count = 0;
    for (let i = 0; i < 8; i += 1) {
      if (opcode & (1 << i)) {
        this.writeUint32(address, registers[i]);
        address += 4;
        count += 1;
      }
    }
    registers[n] = address;
    return 1 + count;
  }

  doSEV() {
    this.eventRegistered = true;
    return 1;
  }

  doWFE() {
    this.sleep(true);
    return 2;
  }

  doWFI() {
    this.sleep(false);
    return 2;
  }

  doYIELD() {
    return 1;
  }

  doBLX(opcode, pc) {
    const target = this.registers[(opcode >> 3) & 0xf];
    this.registers[14] = (pc + 2) | 1;
    this.BXWritePC(target);
    return 2;
  }

  BXWritePC(address) {
    const isReturn = this.IPSR !== 0 && address >>> 28 === 0xf;
    if (!isReturn && !(address & 1)) throw this.fault('branch to ARM state', address);
    super.BXWritePC(address);
  }

  doUDF(opcode, pc) {
    throw this.fault('undefined instruction', pc);
  }

  /** The first half of UDF.W and of some branches with link. Only UDF.W faults. */
  doUDFW(opcode, pc) {
    if (this.readUint16(pc + 2) >>> 12 === 0b1010) throw this.fault('undefined instruction', pc);
    this.registers[15] = pc;
    return this.executeInstruction();
  }

  /** In the ROM a call of the bench; elsewhere a fault, because no debugger is attached. */
  doBKPT(opcode, pc) {
    if (pc >= ROM_END) throw this.fault('breakpoint', pc);
    return 1 + this.board.romCall(opcode & 0xff, this);
  }

  doSVC(opcode, pc) {
    if (this.svCallPriority >= this.executionPriority(true)) throw this.fault('SVC that cannot be taken', pc);
    this.pendingSVCall = true;
    this.interruptsUpdated = true;
    return 1;
  }

  doSUBSP(opcode) {
    this.registers[13] -= (opcode & 0x7f) << 2;
    this.noteStack();
    return 1;
  }

  doMOVSP() {
    return this.stockThenStack();
  }

  doADDSP() {
    return this.stockThenStack();
  }

  stockThenStack() {
    this.registers[15] -= 2;
    const cycles = this.executeInstruction();
    this.noteStack();
    return cycles;
  }
}
