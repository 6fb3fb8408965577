// DMA: pacing by the FIFOs, one transfer a cycle over all channels, rings, chains and aborts.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Board } from '../board/board.mjs';
import { LATENCY_CYCLES } from '../board/dma.mjs';
import * as pio from '../support/pio-words.mjs';

const channel = (n, register) => 0x5000_0000 + 0x40 * n + register;
const [READ, WRITE, COUNT, TRIGGER, CONTROL] = [0, 4, 8, 12, 16];
const INTR = 0x5000_0400;
const ABORT = 0x5000_0444;
const RAM = 0x2000_0000;
const PERMANENT = 63;
const BUSY = 1 << 24;

const control = ({ dreq = PERMANENT, increment = 'both', chain, ring = 0, ringWrite = false }) =>
  (dreq << 15) |
  (chain << 11) |
  (Number(ringWrite) << 10) |
  (ring << 6) |
  ((increment === 'both' || increment === 'write' ? 1 : 0) << 5) |
  ((increment === 'both' || increment === 'read' ? 1 : 0) << 4) |
  (2 << 2) |
  1;

function start(board, n, from, to, count, options = {}) {
  board.poke(channel(n, READ), from);
  board.poke(channel(n, WRITE), to);
  board.poke(channel(n, COUNT), count);
  board.poke(channel(n, TRIGGER), control({ chain: n, ...options }));
}

const words = (board, address, count) => Array.from({ length: count }, (_, i) => board.peek(address + 4 * i));

function withData() {
  const board = new Board({ bare: true });
  for (let i = 0; i < 64; i += 1) board.poke(RAM + 4 * i, 1000 + i);
  return board;
}

test('an unpaced copy moves one word a cycle, and raises its interrupt at the end', () => {
  const board = withData();
  const from = board.cycle;
  start(board, 0, RAM, RAM + 0x1000, 16);
  board.run({ untilCycle: from + LATENCY_CYCLES + 15 });
  assert.equal(board.peek(channel(0, TRIGGER)) & BUSY, BUSY);
  board.run({ cycles: 1 });
  assert.equal(board.peek(channel(0, TRIGGER)) & BUSY, 0);
  assert.equal(board.peek(INTR), 1);
  assert.deepEqual(words(board, RAM + 0x1000, 16), words(board, RAM, 16));
});

test('two concurrent copies take turns on the bus and together take twice as long', () => {
  const board = withData();
  const from = board.cycle;
  start(board, 0, RAM, RAM + 0x1000, 16);
  start(board, 1, RAM, RAM + 0x2000, 16);
  board.run({ untilCycle: from + LATENCY_CYCLES + 30 });
  assert.notEqual(board.peek(INTR), 3);
  board.run({ cycles: 4 });
  assert.equal(board.peek(INTR), 3);
});

test('a channel paced by a TX FIFO keeps it full without overflow and ends at its count', () => {
  const board = withData();
  pio.load(board, 0, [pio.delay(pio.pull(), 20), pio.jmp('always', 0)]);
  pio.configure(board, 0, 0, { wrapTop: 1, joinTx: true });
  const flevel = () => board.peek(pio.PIO_BASE[0] + pio.FLEVEL) & 0xf;
  start(board, 0, RAM, pio.PIO_BASE[0] + pio.TXF, 20, { dreq: 0, increment: 'read' });
  board.run({ cycles: 50 });
  assert.equal(flevel(), 8);
  assert.equal(board.peek(channel(0, COUNT)), 12);
  pio.enable(board, 0, 1);
  let min = 8;
  for (let i = 0; i < 11 * 22; i += 1) {
    board.run({ cycles: 1 });
    min = Math.min(min, flevel());
  }
  assert.equal(min, 7, 'a word pulled is replaced before the next is');
  board.run({ cycles: 1000 });
  assert.equal(board.peek(pio.PIO_BASE[0] + pio.FDEBUG) & (1 << 16), 0, 'no overflow');
  assert.equal(board.peek(channel(0, COUNT)), 0);
  assert.equal(flevel(), 0);
});

test('a ring wraps its address, and a chain starts the next channel', () => {
  const board = withData();
  board.poke(channel(1, READ), RAM);
  board.poke(channel(1, WRITE), RAM + 0x3000);
  board.poke(channel(1, COUNT), 2);
  board.poke(channel(1, CONTROL), control({ chain: 1 }));
  start(board, 0, RAM, RAM + 0x1000, 12, { ring: 4, chain: 1 });
  board.run({ cycles: 100 });
  assert.deepEqual(
    words(board, RAM + 0x1000, 12).map((w) => w - 1000),
    [0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3],
  );
  assert.deepEqual(words(board, RAM + 0x3000, 2), [1000, 1001]);
});

test('a channel triggered with a count of zero is not busy', () => {
  const board = withData();
  start(board, 0, RAM, RAM + 0x1000, 0);
  assert.equal(board.peek(channel(0, TRIGGER)) & BUSY, 0);
});

test('an abort stops one channel, and CHAN_ABORT reads zero', () => {
  const board = withData();
  for (const n of [0, 1]) start(board, n, RAM, pio.PIO_BASE[0] + pio.TXF, 20, { dreq: 0, increment: 'read' });
  board.run({ cycles: 20 });
  assert.equal(board.peek(ABORT), 0);
  board.poke(ABORT, 1);
  assert.equal(board.peek(channel(0, TRIGGER)) & BUSY, 0);
  assert.equal(board.peek(channel(1, TRIGGER)) & BUSY, BUSY);
});

test('a bus error of a channel and an unmodelled register end the run with a message', () => {
  const board = withData();
  start(board, 0, 0x3000_0000, RAM, 1);
  assert.throws(() => board.run({ cycles: 10 }), /DMA channel 0/);
  assert.throws(() => withData().poke(0x5000_0420, 1), /not modelled/);
});
