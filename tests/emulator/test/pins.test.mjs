// Pins: their drivers, their input levels, their recording.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Board } from '../board/board.mjs';
import { toVcd } from '../board/edges.mjs';

const SIO = 0xd000_0000;
const [GPIO_IN, GPIO_OUT, GPIO_OE] = [0x04, 0x10, 0x20].map((offset) => SIO + offset);
const control = (pin) => 0x4001_4004 + 8 * pin;
const pad = (pin) => 0x4001_c004 + 4 * pin;
const SIO_FUNCTION = 5;
const [PULL_UP, PULL_DOWN, NO_PULL] = [0x5a, 0x56, 0x52];

const read = (board, pin) => {
  board.run({ cycles: 10 });
  return (board.peek(GPIO_IN) >>> pin) & 1;
};

test('an open pin reads the level of its pull, and a driven pin the level of its driver', () => {
  const board = new Board({ bare: true });
  board.poke(pad(4), PULL_UP);
  assert.equal(read(board, 4), 1);
  board.poke(pad(4), PULL_DOWN);
  assert.equal(read(board, 4), 0);
  board.stimulus.at(board.cycle, 4, 1);
  assert.equal(read(board, 4), 1);
  board.stimulus.release(board.cycle, 4);
  assert.equal(read(board, 4), 0);
});

test('with no pull a released pin keeps its level', () => {
  const board = new Board({ bare: true });
  board.poke(pad(4), NO_PULL);
  board.stimulus.at(board.cycle, 4, 1);
  board.run({ cycles: 10 });
  board.stimulus.release(board.cycle, 4);
  assert.equal(read(board, 4), 1);
});

test('after reset pins have their input enabled and are pulled down', () => {
  const board = new Board({ bare: true });
  assert.equal(board.peek(pad(7)), 0x56);
  board.stimulus.at(board.cycle, 7, 1);
  assert.equal(read(board, 7), 1);
});

test('the processor sees a level through two flip-flops', () => {
  const board = new Board({ bare: true });
  board.stimulus.at(1000, 3, 1);
  const sampled = [1001, 1002, 1003, 1004].map((cycle) => {
    board.run({ untilCycle: cycle });
    return (board.peek(GPIO_IN) >>> 3) & 1;
  });
  assert.deepEqual(sampled, [0, 0, 1, 1]);
});

test('outputs are recorded, overrides included, and go to the VCD file', () => {
  const board = new Board({ bare: true, pins: { enable: 9 } });
  board.poke(control(9), SIO_FUNCTION);
  board.run({ untilCycle: 100 });
  board.poke(GPIO_OUT, 1 << 9);
  board.poke(GPIO_OE, 1 << 9);
  board.run({ untilCycle: 200 });
  board.poke(control(9), SIO_FUNCTION | (1 << 8));
  board.run({ untilCycle: 300 });
  assert.deepEqual(board.edges.of('enable'), [
    { cycle: 99, level: 1 },
    { cycle: 199, level: 0 },
  ]);
  assert.match(toVcd(board.edges), /\$var wire 1 ! enable \$end[^]*#792\n1!\n#1592\n0!\n$/);
});

test('a pin driven from both sides is reported', () => {
  const board = new Board({ bare: true });
  board.poke(control(9), SIO_FUNCTION);
  board.poke(GPIO_OE, 1 << 9);
  board.stimulus.at(board.cycle, 9, 1);
  board.run({ cycles: 5 });
  assert.match(board.events.at(-1).text, /pins 9 are driven from both sides/);
});

test('bursts and pulses occur in their cycles, and a stimulus in the past is refused', () => {
  const board = new Board({ bare: true, pins: { in: 2 } });
  board.stimulus.burst(50, 2, { count: 3, period: 10 });
  board.run({ untilCycle: 100 });
  assert.deepEqual(board.edges.track('in').cycles, [50, 55, 60, 65, 70, 75]);
  assert.throws(() => board.stimulus.at(60, 2, 1), /over already/);
});
