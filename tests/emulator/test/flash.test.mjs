// The boot ROM's functions, found as a firmware finds them, and flash that behaves like real flash, also at a power
// failure.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Board } from '../board/board.mjs';
import { Caller } from '../board/call.mjs';
import * as t from '../support/thumb.mjs';

const RAM = 0x2000_1000;
const SECTOR = 4096;
const TIMES = { eraseSector: 40_000, programPage: 1000 };

/** Calls ROM functions on a board; `rom('RE', …)` looks the code up through the ROM's own table and routine. */
function romOf(board) {
  const caller = Object.assign(Object.create(Caller.prototype), { board });
  board.core.PM = true;
  board.core.waiting = false;
  const half = (address) => board.core.readUint16(address);
  const lookup = (code) => {
    const tag = code.charCodeAt(0) | (code.charCodeAt(1) << 8);
    return caller.call(half(0x18), [half(0x14), tag]).r0;
  };
  const rom = (code, ...args) => caller.call(lookup(code), args);
  return Object.assign(rom, { lookup });
}

function flashBoard(size = 0x10_000) {
  const board = new Board({ flash: new Uint8Array(size).fill(0xff), flashTimes: TIMES, bare: true });
  const rom = romOf(board);
  const data = (bytes) => bytes.forEach((byte, i) => board.core.writeUint8(RAM + i, byte));
  return { board, rom, data };
}

test('functions are found by their two letters, and unknown letters give null', () => {
  const { rom } = flashBoard();
  for (const code of ['IF', 'EX', 'RE', 'RP', 'FC', 'CX', 'MS', 'MC', 'S4', 'C4', 'P3', 'R3', 'L3', 'T3']) {
    assert.equal(rom.lookup(code) & 1, 1, `${code}: a Thumb address`);
  }
  assert.equal(rom.lookup('zz'), 0);
});

test('memory copy and set write exactly the requested bytes for any alignment and length', () => {
  const { board, rom, data } = flashBoard();
  const SIZE = 64;
  const TO = RAM + 256;
  const source = Array.from({ length: SIZE }, (_, i) => i + 1);
  const result = () => Array.from({ length: SIZE }, (_, i) => board.core.readUint8(TO + i));
  for (const copy of [true, false]) {
    for (const [from, to] of [
      [0, 0],
      [4, 8],
      [1, 0],
      [0, 3],
      [3, 3],
    ]) {
      for (const length of [0, 1, 3, 4, 7, 8, 15, 16, 17, 37]) {
        data(source);
        for (let i = 0; i < SIZE; i += 1) board.core.writeUint8(TO + i, 0xee);
        const { r0 } = copy ? rom('MC', TO + to, RAM + from, length) : rom('MS', TO + to, 0x1234_5678, length);
        const expected = Array(SIZE).fill(0xee);
        for (let i = 0; i < length; i += 1) expected[to + i] = copy ? source[from + i] : 0x78;
        assert.deepEqual(result(), expected, `${copy ? 'copy' : 'set'} ${length} bytes from ${from} to ${to}`);
        assert.equal(r0, TO + to);
      }
    }
  }
});

test('floating point of the ROM is refused', () => {
  const { board, rom } = flashBoard();
  const caller = Object.assign(Object.create(Caller.prototype), { board });
  const code = 'S'.charCodeAt(0) | ('F'.charCodeAt(0) << 8);
  const table = caller.call(board.core.readUint16(0x18), [board.core.readUint16(0x16), code]).r0;
  assert.throws(() => caller.call(board.core.readUint32(table), [0, 0]), /floating point/);
  assert.equal(rom.lookup('SF'), 0, 'not among the functions');
});

test('bit functions of the ROM give correct results', () => {
  const { rom } = flashBoard();
  assert.equal(rom('P3', 0xf0f0).r0, 8);
  assert.equal(rom('R3', 1).r0, 0x8000_0000);
  assert.equal(rom('L3', 1).r0, 31);
  assert.equal(rom('T3', 0).r0, 32);
});

test('erasing sets bits, programming only clears them, and both take at least the specified time', () => {
  const { board, rom, data } = flashBoard();
  board.flash.fill(0x0f, SECTOR, 2 * SECTOR);
  rom('EX');
  assert.ok(rom('RE', SECTOR, SECTOR, 1 << 31, 0).cycles >= TIMES.eraseSector);
  assert.ok(board.flash.subarray(SECTOR, 2 * SECTOR).every((byte) => byte === 0xff));
  data(Array(256).fill(0x3c));
  assert.ok(rom('RP', SECTOR, RAM, 256).cycles >= TIMES.programPage);
  data(Array(256).fill(0x0f));
  rom('RP', SECTOR, RAM, 256);
  assert.equal(board.flash[SECTOR], 0x0c);
  assert.equal(board.flash[SECTOR + 256], 0xff);
});

test('flash operations that would corrupt it silently are refused', () => {
  const { rom } = flashBoard();
  assert.throws(() => rom('RE', SECTOR, SECTOR), /without flash_exit_xip/);
  rom('EX');
  assert.throws(() => rom('RP', 100, RAM, 256), /units of 256/);
  assert.throws(() => rom('RE', 256, SECTOR), /units of 4096/);
  assert.throws(() => rom('RE', 0x10_000, SECTOR), /beyond the end/);
});

test('reading flash between flash_exit_xip and the return to XIP is a fault', () => {
  const { board, rom } = flashBoard();
  board.flash.fill(0x12, 0, 4);
  rom('EX');
  assert.throws(() => board.core.readUint32(0x1000_0000), /XIP is off/);
  rom('CX');
  assert.equal(board.core.readUint32(0x1000_0000), 0x1212_1212);
});

test('a power cut during an erase leaves it incomplete, and the next board has that flash', () => {
  const { board, rom } = flashBoard();
  board.flash.fill(0x00, 0, SECTOR);
  rom('EX');
  board.rom.cutPower({ operation: 1, bytes: 1000 });
  rom('RE', SECTOR, SECTOR);
  const before = board.cycle;
  assert.throws(() => rom('RE', 0, SECTOR), /after 1000 of 4096 bytes/);
  assert.equal(board.stopped.reason, 'power-cut');
  assert.ok(board.cycle - before < TIMES.eraseSector / 3, 'it ends the run where it happens');
  const next = new Board({ flash: board.flash, bare: true });
  assert.deepEqual(
    [999, 1000, 1001].map((i) => next.flash[i]),
    [0xff, 0x55, 0x00],
  );
});

test('a power cut during programming leaves a prefix and one half-written byte', () => {
  const { board, rom, data } = flashBoard();
  data(Array(512).fill(0x00));
  rom('EX');
  board.rom.cutPower({ operation: 0, bytes: 300 });
  assert.throws(() => rom('RP', 0, RAM, 512), /power-cut|after 300/);
  assert.deepEqual(
    [299, 300, 301].map((i) => board.flash[i]),
    [0x00, 0x55, 0xff],
  );
});

test('an interrupt taken while XIP is off locks the processor up, as its vector is in flash', () => {
  const board = t.boardWith([t.b(0)]);
  board.core.xipOff = true;
  board.core.registers[15] = RAM;
  board.core.writeUint16(RAM, t.b(0));
  board.poke(0xe000_e100, 1 << 26);
  board.poke(0xe000_e200, 1 << 26);
  assert.equal(board.run({ cycles: 100 }).reason, 'lockup');
});

test('a read past the cache waits for the flash each time, and takes no line of the cache', () => {
  const { core } = new Board({ flash: new Uint8Array(0x1_0000), missCycles: 56, bare: true });
  const waitAt = (address) => {
    core.extra = 0;
    core.readUint32(address);
    return core.extra;
  };
  assert.deepEqual([0x1000_0000, 0x1000_0000].map(waitAt), [56, 0]);
  assert.deepEqual([0x1300_0100, 0x1300_0100, 0x1000_0100, 0x1000_0000].map(waitAt), [56, 56, 56, 0]);
});
