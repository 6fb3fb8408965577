// Thumb instructions as numbers, and boards that run a few of them: for tests of the processor without a compiler.
// Encodings: ARMv6-M Architecture Reference Manual, A6.7.

import { Board } from '../board/board.mjs';

const data = (code) => (rd, rm) => 0x4000 | (code << 6) | (rm << 3) | rd;
export const [ands, eors, lsls, lsrs, asrs, adcs, sbcs, rors] = [0, 1, 2, 3, 4, 5, 6, 7].map(data);
export const [tst, rsbs, cmp, cmn, orrs, muls, bics, mvns] = [8, 9, 10, 11, 12, 13, 14, 15].map(data);
export const movs = (rd, imm) => 0x2000 | (rd << 8) | imm;
export const addsImm = (rd, imm) => 0x3000 | (rd << 8) | imm;
export const subsImm = (rd, imm) => 0x3800 | (rd << 8) | imm;
export const adds = (rd, rn, rm) => 0x1800 | (rm << 6) | (rn << 3) | rd;
export const subs = (rd, rn, rm) => 0x1a00 | (rm << 6) | (rn << 3) | rd;
export const lslsImm = (rd, rm, imm) => (imm << 6) | (rm << 3) | rd;
export const lsrsImm = (rd, rm, imm) => 0x0800 | (imm << 6) | (rm << 3) | rd;
export const asrsImm = (rd, rm, imm) => 0x1000 | (imm << 6) | (rm << 3) | rd;
export const ldr = (rt, rn, offset = 0) => 0x6800 | ((offset / 4) << 6) | (rn << 3) | rt;
export const str = (rt, rn, offset = 0) => 0x6000 | ((offset / 4) << 6) | (rn << 3) | rt;
/** From the literal `offset` bytes behind the aligned PC. */
export const ldrLiteral = (rt, offset) => 0x4800 | (rt << 8) | (offset / 4);
export const push = (...registers) => 0xb400 | registers.reduce((m, r) => m | (r === 14 ? 0x100 : 1 << r), 0);
export const pop = (...registers) => 0xbc00 | registers.reduce((m, r) => m | (r === 15 ? 0x100 : 1 << r), 0);
export const ldm = (rn, ...registers) => 0xc800 | (rn << 8) | registers.reduce((m, r) => m | (1 << r), 0);
export const stm = (rn, ...registers) => 0xc000 | (rn << 8) | registers.reduce((m, r) => m | (1 << r), 0);
export const bx = (rm) => 0x4700 | (rm << 3);
export const blx = (rm) => 0x4780 | (rm << 3);
/** Branches by `offset` bytes from the instruction itself. */
export const b = (offset) => 0xe000 | (((offset - 4) >> 1) & 0x7ff);
export const beq = (offset) => 0xd000 | (((offset - 4) >> 1) & 0xff);
export const NOP = 0xbf00;
export const WFE = 0xbf20;
export const WFI = 0xbf30;
export const SEV = 0xbf40;
export const CPSIE = 0xb662;
export const CPSID = 0xb672;
export const UDF = 0xde00;
export const BKPT = 0xbe00;
export const svc = (imm) => 0xdf00 | imm;
export const DSB = [0xf3bf, 0x8f4f];
export const bl = (offset) => {
  const value = (offset - 4) >> 1;
  return [0xf000 | ((value >> 11) & 0x7ff), 0xf800 | (value & 0x7ff)];
};
export const mrs = (rd, special) => [0xf3ef, 0x8000 | (rd << 8) | special];
export const msr = (special, rn) => [0xf380 | rn, 0x8800 | special];
export const MSP = 8;
export const PRIMASK = 16;

export const STACK_TOP = 0x2000_4000;
export const CODE = 0x1000_0200;
const VECTORS = 0x1000_0100;
const HANDLERS = 0x1000_1000;
const HANDLER_BYTES = 0x100;

/**
 * A board whose flash holds `code` (half-words; pairs for wide instructions) at CODE, and handlers:
 * { exception number: code }. Exceptions without one loop in place. Words of `literals` follow the code, at an address
 * given by `literalsAt(code)`.
 */
export function boardWith(code, { handlers = {}, options = {}, literals = [] } = {}) {
  const flash = new Uint8Array(0x10_000).fill(0xff);
  const view = new DataView(flash.buffer);
  const place = (address, halves) =>
    halves.flat().forEach((half, i) => view.setUint16((address & 0xff_ffff) + 2 * i, half, true));
  const word = (address, value) => view.setUint32(address & 0xff_ffff, value, true);
  word(VECTORS, STACK_TOP);
  word(VECTORS + 4, CODE | 1);
  for (let number = 2; number < 48; number += 1) {
    const at = HANDLERS + number * HANDLER_BYTES;
    word(VECTORS + 4 * number, at | 1);
    place(at, handlers[number] ?? [b(0)]);
  }
  place(CODE, [...code, b(0)]);
  literals.forEach((value, i) => word(literalsAt(code) + 4 * i, value));
  return new Board({ flash, ...options });
}

export const literalsAt = (code) => (CODE + 2 * (code.flat().length + 1) + 3) & ~3;
