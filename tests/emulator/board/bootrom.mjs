// A boot ROM of our own: rp2040js has none, and firmware looks up functions in it.
//
// Its tables are at the places of the RP2040 datasheet (2.8). The functions that move memory are code
// (rom-code.mjs). Other functions are a BKPT, which the core passes to `call`, and BX LR. Bit functions take about
// as long as those of the chip. Flash functions change the board's flash array, and take as long as a flash chip
// does. A call of a floating-point function is refused.

import { LOOKUP, MEMCPY, MEMSET } from './rom-code.mjs';
import { Flash, PAGE_BYTES, SECTOR_BYTES } from './flash.mjs';
import { CYCLES_PER_SECOND, CYCLES_PER_US } from './clock.mjs';

const FUNCTIONS = {
  P3: 'popcount32',
  R3: 'reverse32',
  L3: 'clz32',
  T3: 'ctz32',
  UB: 'resetToUsbBoot',
  IF: 'connectInternalFlash',
  EX: 'flashExitXip',
  RE: 'flashRangeErase',
  RP: 'flashRangeProgram',
  FC: 'flashFlushCache',
  CX: 'flashEnterCmdXip',
};
const CODES = Object.keys(FUNCTIONS);

const MEMCPY_AT = 0x0800;
const MEMSET_AT = 0x0900;
/** Addresses of the functions that are code. */
const ROUTINES = { MC: MEMCPY_AT, C4: MEMCPY_AT, MS: MEMSET_AT, S4: MEMSET_AT };

/** The function that each BKPT calls: those above, and one for all entries of the floating-point tables. */
const STUBS = [...Object.values(FUNCTIONS), 'floatingPoint'];
const FLOAT_FUNCTIONS = 32;

const LOOKUP_AT = 0x0100;
const TABLE_AT = 0x0200;
const DATA_TABLE_AT = 0x0300;
const STUBS_AT = 0x0400;
const FLOATS_AT = 0x0a00;
const ROM_VERSION = 3;
const BX_LR = 0x4770;
const BKPT = 0xbe00;
const B_SELF = 0xe7fe;

function assemble() {
  const words = new Uint32Array(4096);
  const half = new Uint16Array(words.buffer);
  const bytes = new Uint8Array(words.buffer);
  words[0] = 0x2004_1f00;
  half.set([B_SELF], 0x80 / 2);
  for (let vector = 1; vector < 4; vector += 1) words[vector] = 0x81;
  bytes.set([0x4d, 0x75, 0x01, ROM_VERSION], 0x10);
  const entries = [...CODES.map((code, i) => [code, STUBS_AT + 4 * i]), ...Object.entries(ROUTINES)];
  half.set([TABLE_AT, DATA_TABLE_AT, LOOKUP_AT | 1], 0x14 / 2);
  const table = (at, rows) =>
    rows.forEach(([code, pointer], i) => {
      half.set([code.charCodeAt(0) | (code.charCodeAt(1) << 8), pointer], at / 2 + 2 * i);
    });
  table(
    TABLE_AT,
    entries.map(([code, address]) => [code, address | 1]),
  );
  table(DATA_TABLE_AT, [
    ['SF', FLOATS_AT],
    ['SD', FLOATS_AT],
  ]);
  words.fill((STUBS_AT + 4 * CODES.length) | 1, FLOATS_AT / 4, FLOATS_AT / 4 + FLOAT_FUNCTIONS);
  STUBS.forEach((_, i) => half.set([BKPT | i, BX_LR], (STUBS_AT + 4 * i) / 2));
  half.set(LOOKUP, LOOKUP_AT / 2);
  half.set(MEMCPY, MEMCPY_AT / 2);
  half.set(MEMSET, MEMSET_AT / 2);
  return words;
}

/** Typical times of a serial flash of this kind (W25Q16JV, tSE and tPP). */
export const FLASH_TIMES = {
  eraseSector: 0.045 * CYCLES_PER_SECOND,
  programPage: 0.0007 * CYCLES_PER_SECOND,
};

export class RomBench {
  /** `times`: cycles of `eraseSector` and `programPage`. */
  constructor(board, times = {}) {
    this.board = board;
    this.image = assemble();
    this.times = { ...FLASH_TIMES, ...times };
    this.flash = new Flash(board.flash);
    /** Every erase and program so far: [{ cycle, kind, address, length }]. */
    this.operations = [];
    this.cut = null;
  }

  /** Power fails in flash operation number `operation` (the next is 0) from now on, after `bytes` of it. */
  cutPower({ operation, bytes }) {
    this.cut = { operation: this.operations.length + operation, bytes };
  }

  /** Called when the core executes stub `number`. Gives the cycles the function takes. */
  call(number, core) {
    const name = STUBS[number];
    if (!name) throw new Error(`there is no ROM function ${number}`);
    return this[name](core);
  }

  floatingPoint() {
    throw new Error('floating point of the ROM is not modelled');
  }

  popcount32(core) {
    let count = 0;
    for (let rest = core.registers[0]; rest !== 0; rest &= rest - 1) count += 1;
    core.registers[0] = count;
    return 20;
  }

  reverse32(core) {
    const value = core.registers[0];
    let result = 0;
    for (let i = 0; i < 32; i += 1) result |= ((value >>> i) & 1) << (31 - i);
    core.registers[0] = result;
    return 25;
  }

  clz32(core) {
    core.registers[0] = Math.clz32(core.registers[0]);
    return 20;
  }

  ctz32(core) {
    const value = core.registers[0];
    core.registers[0] = value === 0 ? 32 : 31 - Math.clz32(value & -value);
    return 20;
  }

  resetToUsbBoot() {
    this.board.stop('usb-boot', 'the firmware requested BOOTSEL mode');
    return 1;
  }

  connectInternalFlash() {
    return 200;
  }

  flashExitXip(core) {
    core.xipOff = true;
    return 20 * CYCLES_PER_US;
  }

  /** An internal counter clears the tags, one a cycle (RP2040 datasheet, 2.6.3.2). */
  flashFlushCache(core) {
    core.cache.flush();
    return 1024;
  }

  flashEnterCmdXip(core) {
    core.xipOff = false;
    return 100;
  }

  flashRangeErase(core) {
    const [address, length] = core.registers;
    const cycles = (length / SECTOR_BYTES) * this.times.eraseSector;
    return this.operate(core, 'erase', address, length, cycles, (survived) =>
      this.flash.erase(address, length, survived),
    );
  }

  flashRangeProgram(core) {
    const [address, from, length] = core.registers;
    const data = Uint8Array.from({ length }, (_, i) => core.readUint8(from + i));
    const cycles = (length / PAGE_BYTES) * this.times.programPage;
    return this.operate(core, 'program', address, length, cycles, (survived) =>
      this.flash.program(address, data, survived),
    );
  }

  /** Carries out an erase or program, completely or up to the power failure. */
  operate(core, kind, address, length, cycles, act) {
    if (!core.xipOff) throw new Error(`flash ${kind} without flash_exit_xip before it`);
    const number = this.operations.length;
    this.operations.push({ cycle: this.board.cycle, kind, address, length });
    if (this.cut?.operation !== number) {
      act(length);
      return Math.round(cycles);
    }
    const survived = Math.min(this.cut.bytes, length - 1);
    act(survived);
    const spent = Math.round((cycles * survived) / length);
    this.board.stop('power-cut', `in ${kind} at 0x${address.toString(16)}, after ${survived} of ${length} bytes`);
    return spent;
  }
}
