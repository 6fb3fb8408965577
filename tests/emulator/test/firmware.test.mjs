// Readers of a firmware: ELF files, the RTT channel, interrupts of pins. If an ELF is at hand, also
// checks that the firmware runs the same with and without skipping.

import assert from 'node:assert/strict';
import fs from 'node:fs';
import { test } from 'node:test';
import { Board } from '../board/board.mjs';
import { Caller } from '../board/call.mjs';
import { readElf } from '../board/elf.mjs';
import { Rtt } from '../board/rtt.mjs';
import * as t from '../support/thumb.mjs';

/** An ELF file of one segment and the given symbols: [name, address, size, type]. */
function elfFile(physical, content, symbols) {
  const names = `\0${symbols.map(([name]) => `${name}\0`).join('')}`;
  const [segmentAt, dataAt] = [52, 84];
  const tableAt = (dataAt + content.length + 3) & ~3;
  const namesAt = tableAt + 16 * (symbols.length + 1);
  const sectionsAt = (namesAt + names.length + 3) & ~3;
  const bytes = new Uint8Array(sectionsAt + 3 * 40);
  const view = new DataView(bytes.buffer);
  const word = (at, ...values) => values.forEach((value, i) => view.setUint32(at + 4 * i, value, true));
  const half = (at, ...values) => values.forEach((value, i) => view.setUint16(at + 2 * i, value, true));
  bytes.set([0x7f, 0x45, 0x4c, 0x46, 1, 1, 1]);
  word(24, physical, segmentAt, sectionsAt, 0);
  half(40, 52, 32, 1, 40, 3, 0);
  word(segmentAt, 1, dataAt, physical, physical, content.length, content.length, 5, 4);
  bytes.set(content, dataAt);
  let nameAt = 1;
  symbols.forEach(([name, address, size, type], i) => {
    word(tableAt + 16 * (i + 1), nameAt, address, size);
    bytes[tableAt + 16 * (i + 1) + 12] = type;
    nameAt += name.length + 1;
  });
  bytes.set(new TextEncoder().encode(names), namesAt);
  word(sectionsAt + 40 + 4, 2, 0, 0, tableAt, 16 * (symbols.length + 1), 2);
  word(sectionsAt + 80 + 4, 3, 0, 0, namesAt, names.length, 0);
  return bytes;
}

/** Thumb code as bytes, behind a vector table that starts it. */
function firmwareBytes(...halves) {
  const bytes = new Uint8Array(0x100 + 2 * halves.length);
  const view = new DataView(bytes.buffer);
  view.setUint32(0, t.STACK_TOP, true);
  view.setUint32(4, 0x1000_0200 | 1, true);
  halves.forEach((value, i) => view.setUint16(0x100 + 2 * i, value, true));
  return bytes;
}

test('segments and symbols of an ELF file are read, and other files are refused', () => {
  const file = elfFile(0x1000_0100, firmwareBytes(t.b(0)), [
    ['late', 0x1000_0301, 4, 2],
    ['early', 0x1000_0201, 8, 2],
    ['COUNT', 0x2000_0000, 4, 1],
  ]);
  const elf = readElf(file);
  assert.deepEqual(
    elf.segments.map(({ physical, bytes }) => [physical, bytes.length]),
    [[0x1000_0100, 0x102]],
  );
  assert.deepEqual(
    elf.functions.map(({ name, address }) => [name, address]),
    [
      ['early', 0x1000_0200],
      ['late', 0x1000_0300],
    ],
  );
  assert.equal(elf.symbols.get('COUNT').address, 0x2000_0000);
  assert.throws(() => readElf(new Uint8Array(100)), /not a 32-bit/);
});

test('a firmware overwrites only its part of the flash and runs from its vector table', () => {
  const flash = new Uint8Array(0x10_000).fill(0x77);
  const board = new Board({ elf: elfFile(0x1000_0100, firmwareBytes(t.movs(3, 9), t.b(0)), []), flash });
  board.run({ cycles: 10 });
  assert.equal(board.core.registers[3], 9);
  assert.equal(flash[0x8000], 0x77);
});

test('a routine called by its symbol returns its results, cycles and stack depth', () => {
  const LDR_R1_SP = 0x9900;
  const code = [t.push(4, 14), 0x9902, t.adds(0, 0, 1), t.pop(4, 15), t.b(0)];
  const symbols = [
    ['add_fifth', 0x1000_0201, 8, 2],
    ['forever', 0x1000_0209, 2, 2],
  ];
  const caller = new Caller(elfFile(0x1000_0100, firmwareBytes(...code), symbols));
  assert.equal(code[1], LDR_R1_SP | 2, 'behind the two words pushed');
  const result = caller.call('add_fifth', [40, 0, 0, 0], { stack: [2] });
  // PUSH 3, LDR 2, ADDS 1, POP with PC 5.
  assert.deepEqual(result, { r0: 42, r1: 2, cycles: 11, stackBytes: 8 });
  assert.throws(() => caller.call('absent'), /no symbol absent/);
  assert.throws(() => caller.call('forever', [], { maxCycles: 1000 }), /did not return/);
});

const BLOCK = 0x2000_0100;
const BUFFER = 0x2000_0200;

/** A bare board with an RTT channel of 16 bytes in RAM; `say` writes to it like the firmware. */
function talker(interval) {
  const board = new Board({ bare: true });
  [BUFFER - 4, BUFFER, 16, 0, 0, 1].forEach((value, i) => board.poke(BLOCK + 24 + 4 * i, value));
  const rtt = new Rtt(board, BLOCK, interval);
  rtt.attach();
  const say = (...bytes) => {
    let at = board.core.readUint32(BLOCK + 36);
    for (const byte of bytes) {
      board.core.writeUint8(BUFFER + at, byte);
      at = (at + 1) % 16;
    }
    board.core.writeUint32(BLOCK + 36, at);
  };
  return { board, rtt, say };
}

test('the log is read in the cycle in which it is written, also where the buffer wraps', () => {
  const { board, rtt, say } = talker(0);
  say(1, 2, 3, 4, 5, 6, 7, 8, 9, 10);
  board.run({ cycles: 100 });
  say(11, 12, 13, 14, 15, 16, 17, 18);
  assert.deepEqual(
    rtt.pieces.map(({ cycle, bytes }) => [cycle, bytes.length]),
    [
      [0, 10],
      [100, 8],
    ],
  );
  assert.deepEqual([...rtt.bytes], [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18]);
  assert.equal(board.peek(BLOCK + 40), board.peek(BLOCK + 36), 'read offset follows');
});

test('a host with a poll interval reads the log at its next poll', () => {
  const { board, rtt, say } = talker(1000);
  say(1, 2, 3);
  board.run({ cycles: 900 });
  assert.equal(rtt.pieces.length, 0);
  board.run({ cycles: 200 });
  assert.deepEqual([...rtt.bytes], [1, 2, 3]);
});

test('a pin interrupt is raised by edges and by a level that was present before it was enabled', () => {
  const LEVEL_LOW = 1;
  const EDGE_HIGH = 8;
  const board = new Board({ bare: true });
  const line = () => (board.core.lines >>> 13) & 1;
  board.poke(0x4001_4104, LEVEL_LOW << 8);
  assert.equal(line(), 1, 'GPIO 10 is low');
  board.stimulus.at(50, 10, 1);
  board.run({ untilCycle: 60 });
  assert.equal(line(), 0);
  board.poke(0x4001_40f4, EDGE_HIGH << 8);
  board.poke(0x4001_4104, EDGE_HIGH << 8);
  assert.equal(line(), 0, 'an edge that was acknowledged');
  board.stimulus.pulse(100, 10, 10, 0);
  board.run({ untilCycle: 120 });
  assert.equal(line(), 1);
});

const FIRMWARE =
  process.env.COPHASE_ELF ?? new URL('../../../target/thumbv6m-none-eabi/firmware/cophase-firmware', import.meta.url);

test(
  'the firmware runs the same whether every cycle is stepped or not',
  { skip: !fs.existsSync(FIRMWARE) && 'no firmware built' },
  () => {
    const pins = Object.fromEntries([...Array(30).keys()].map((pin) => [`gpio${pin}`, pin]));
    const [plain, skipping] = [false, true].map((fastForward) => {
      const board = new Board({
        elf: fs.readFileSync(FIRMWARE),
        pins,
        fastForward,
        flashTimes: { eraseSector: 100_000 },
      });
      board.run({ cycles: 10_000_000 });
      return {
        tracks: board.edges.tracks,
        log: board.rtt?.pieces,
        usage: board.usage.sums(),
        registers: board.core.registers,
      };
    });
    assert.deepEqual(skipping, plain);
  },
);
