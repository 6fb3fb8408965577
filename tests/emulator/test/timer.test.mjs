// The microsecond timer: the times at which it counts, and at which its alarms come.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Board } from '../board/board.mjs';

const TIMER = 0x4005_4000;
const [ALARM0, ARMED, TIME, INTR, INTE] = [0x10, 0x20, 0x28, 0x34, 0x38].map((offset) => TIMER + offset);

test('the timer counts every 125 cycles from reset', () => {
  const board = new Board({ bare: true });
  for (const [cycle, micros] of [
    [0, 0],
    [124, 0],
    [125, 1],
    [125_000_000, 1_000_000],
  ]) {
    board.run({ untilCycle: cycle });
    assert.equal(board.peek(TIME), micros);
  }
});

test('an alarm is raised when the count reaches its value, at whichever cycle it was set', () => {
  for (const into of [0, 1, 70, 124]) {
    const board = new Board({ bare: true });
    board.poke(INTE, 1);
    board.run({ untilCycle: 500 + into });
    board.poke(ALARM0, 10);
    board.run({ untilCycle: 1250 });
    assert.equal(board.peek(INTR), 0, 'not before its microsecond');
    board.run({ cycles: 1 });
    assert.equal(board.peek(INTR), 1);
    assert.equal(board.core.pendingInterrupts & 1, 1);
    assert.equal(board.peek(ARMED), 0);
  }
});

test('an alarm for the present microsecond is raised at once, and one in the past is not', () => {
  const board = new Board({ bare: true });
  board.run({ untilCycle: 1300 });
  board.poke(ALARM0, 9);
  board.run({ cycles: 100_000 });
  assert.equal(board.peek(INTR), 0);
  board.poke(ALARM0, Math.floor(board.cycle / 125));
  board.run({ cycles: 2 });
  assert.equal(board.peek(INTR), 1);
});
