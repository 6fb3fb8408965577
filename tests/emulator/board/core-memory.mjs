// The processor's access to memory: RAM at full speed, flash behind its cache, faults where the chip faults, and the right cycle
// for every access to a peripheral.
//
// Words: a *fault* is an event for which a Cortex-M0+ takes HardFault (unaligned or unmapped access, undefined instruction).
// rp2040js logs these and goes on. Here they are thrown, and the core turns them into the exception.

import { RP2040 } from 'rp2040js';
import { XipCache } from './xip-cache.mjs';

/** rp2040js does not export its core class. It is taken from an instance. */
const StockCore = new RP2040().core.constructor;

const ROM_SIZE = 16 * 1024;
const SRAM_BASE = 0x2000_0000;
const SRAM_SIZE = 264 * 1024;
const XIP_BASE = 0x1000_0000;
const XIP_END = 0x1400_0000;
const XIP_MASK = 0x00ff_ffff;
/** Accesses with these bits set do not use the cache, and leave it as it is. */
const XIP_UNCACHED = 0x0300_0000;
/** Registers of the XIP controller and of the flash's serial interface. */
const isXipRegister = (a) => a >>> 16 === 0x1400 || a >>> 16 === 0x1800;

export class Fault extends Error {}

export class MemoryCore extends StockCore {
  /** Calls `beforeRead(address)` and `beforeWrite(address)` of `board` before peripheral accesses. */
  constructor(rp2040, board) {
    super(rp2040);
    this.board = board;
    this.useMemories();
    /** Address of a RAM word whose writes are reported to `onWatch`, or -1. */
    this.watch = -1;
    this.onWatch = () => {};
    /** True while the flash is not readable: between flash_exit_xip and the return to XIP. */
    this.xipOff = false;
    this.cache = new XipCache(board.missCycles);
    /**
     * Reads of the flash by handlers of interrupts since reset, vectors included, by instruction and address:
     * { exception, pc, address, count, cycles waited }.
     */
    this.handlerReads = new Map();
    /** Cycles of the present instruction beyond those of its own table. */
    this.extra = 0;
  }

  /** Takes the arrays of the RP2040 object. Must be called when they are replaced. */
  useMemories() {
    const { sram, flash, bootrom } = this.rp2040;
    this.ram8 = sram;
    this.ram16 = new Uint16Array(sram.buffer, sram.byteOffset, sram.length >> 1);
    this.ram32 = new Uint32Array(sram.buffer, sram.byteOffset, sram.length >> 2);
    this.flash8 = flash;
    this.flash16 = new Uint16Array(flash.buffer, flash.byteOffset, flash.length >> 1);
    this.flash32 = new Uint32Array(flash.buffer, flash.byteOffset, flash.length >> 2);
    this.rom32 = bootrom;
    this.rom16 = new Uint16Array(bootrom.buffer);
    this.rom8 = new Uint8Array(bootrom.buffer);
  }

  readUint32(address) {
    const a = address >>> 0;
    if (a & 3) throw this.fault('unaligned read', a);
    switch (a >>> 28) {
      case 2:
        if (a - SRAM_BASE < SRAM_SIZE) return this.ram32[(a - SRAM_BASE) >>> 2];
        break;
      case 1:
        if (this.inFlash(a)) return this.flash32[this.flashOffset(a) >>> 2];
        if (isXipRegister(a)) return this.rp2040.readUint32(a);
        break;
      case 0:
        if (a < ROM_SIZE) return this.rom32[a >>> 2];
        break;
      case 3:
        break;
      default:
        this.board.beforeRead(a);
        return this.rp2040.readUint32(a);
    }
    throw this.fault('read of nothing', a);
  }

  readUint16(address) {
    const a = address >>> 0;
    if (a & 1) throw this.fault('unaligned read', a);
    switch (a >>> 28) {
      case 1:
        if (this.inFlash(a)) return this.flash16[this.flashOffset(a) >>> 1];
        break;
      case 2:
        if (a - SRAM_BASE < SRAM_SIZE) return this.ram16[(a - SRAM_BASE) >>> 1];
        break;
      case 0:
        if (a < ROM_SIZE) return this.rom16[a >>> 1];
        break;
      case 3:
        break;
      default:
        this.board.beforeRead(a);
        return this.rp2040.readUint16(a);
    }
    throw this.fault('read of nothing', a);
  }

  readUint8(address) {
    const a = address >>> 0;
    switch (a >>> 28) {
      case 2:
        if (a - SRAM_BASE < SRAM_SIZE) return this.ram8[a - SRAM_BASE];
        break;
      case 1:
        if (this.inFlash(a)) return this.flash8[this.flashOffset(a)];
        if (isXipRegister(a)) return this.rp2040.readUint8(a);
        break;
      case 0:
        if (a < ROM_SIZE) return this.rom8[a];
        break;
      case 3:
        break;
      default:
        this.board.beforeRead(a);
        return this.rp2040.readUint8(a);
    }
    throw this.fault('read of nothing', a);
  }

  writeUint32(address, value) {
    const a = address >>> 0;
    if (a & 3) throw this.fault('unaligned write', a);
    if ((a - SRAM_BASE) >>> 0 < SRAM_SIZE) {
      this.ram32[(a - SRAM_BASE) >>> 2] = value;
      if (a === this.watch) this.onWatch();
      return;
    }
    this.writeOutside(a, () => this.rp2040.writeUint32(a, value));
  }

  writeUint16(address, value) {
    const a = address >>> 0;
    if (a & 1) throw this.fault('unaligned write', a);
    if ((a - SRAM_BASE) >>> 0 < SRAM_SIZE) {
      this.ram16[(a - SRAM_BASE) >>> 1] = value;
      return;
    }
    this.writeOutside(a, () => this.rp2040.writeUint16(a, value));
  }

  writeUint8(address, value) {
    const a = address >>> 0;
    if ((a - SRAM_BASE) >>> 0 < SRAM_SIZE) {
      this.ram8[a - SRAM_BASE] = value;
      return;
    }
    this.writeOutside(a, () => this.rp2040.writeUint8(a, value));
  }

  /** A store cannot write flash or ROM. The flash chip is programmed through the ROM's functions. */
  writeOutside(a, write) {
    if (a >>> 28 < 4 && !isXipRegister(a)) throw this.fault('write to nothing', a);
    this.board.beforeWrite(a);
    write();
  }

  /** True if `a` is backed by flash. Reading it while XIP is off would hang or give garbage, so it is a fault. */
  inFlash(a) {
    if (a >= XIP_END || (a & XIP_MASK) >= this.flash8.length) return false;
    if (this.xipOff) throw this.fault('flash read while XIP is off', a);
    return true;
  }

  /** The offset into the flash for the address `a`. Counts the wait of the access. */
  flashOffset(a) {
    const offset = a & XIP_MASK;
    const isUncached = (a & XIP_UNCACHED) === XIP_UNCACHED;
    const wait = isUncached ? this.cache.missCycles : this.cache.wait(offset);
    if (wait !== 0) this.extra += wait;
    if (this.IPSR !== 0) this.countRead(XIP_BASE + offset, wait);
    return offset;
  }

  countRead(address, cycles) {
    const pc = this.registers[15] >>> 0;
    const key = pc * 2 ** 24 + (address & XIP_MASK);
    const read = this.handlerReads.get(key);
    if (read === undefined) this.handlerReads.set(key, { exception: this.IPSR, pc, address, count: 1, cycles });
    else {
      read.count += 1;
      read.cycles += cycles;
    }
  }

  fault(what, address) {
    return new Fault(`${what} at 0x${(address >>> 0).toString(16).padStart(8, '0')}`);
  }
}
