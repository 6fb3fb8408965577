// The microsecond timer: the times at which it counts, and at which its alarms come.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Board } from '../board/board.mjs';

const TIMER = 0x4005_4000;
const [ALARM0, ARMED, TIME, PAUSE, INTR, INTE] = [0x10, 0x20, 0x28, 0x30, 0x34, 0x38].map((offset) => TIMER + offset);
const [WATCHDOG_CTRL, WATCHDOG_LOAD, TICK] = [0x00, 0x04, 0x2c].map((offset) => 0x4005_8000 + offset);
const [WATCHDOG_ENABLE, TICK_ENABLE] = [1 << 30, 1 << 9];
const PSM_WDSEL = 0x4001_0008;

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

test('the timer and its alarms follow the rate of the tick generator, from the time at which it changes', () => {
  const board = new Board({ bare: true });
  board.poke(INTE, 1);
  board.poke(ALARM0, 30);
  board.run({ untilCycle: 10 * 125 });
  board.poke(TICK, TICK_ENABLE | 24);
  board.run({ untilCycle: 20 * 125 });
  assert.equal(board.peek(TIME), 15);
  board.run({ untilCycle: (10 + 2 * 20) * 125 });
  assert.equal(board.peek(INTR), 0);
  board.run({ cycles: 1 });
  assert.deepEqual([board.peek(TIME), board.peek(INTR)], [30, 1]);
});

test('the timer follows the crystal, if that differs from the clock of the processor', () => {
  const board = new Board({ bare: true });
  board.chip.ticks.change({ rate: 1.01 });
  board.run({ untilCycle: 125_000 });
  assert.equal(board.peek(TIME), 1010);
});

test('a timer that is paused, or gets no ticks, stands with its alarms, and goes on where it stood', () => {
  for (const [address, stops, goes] of [
    [PAUSE, 1, 0],
    [TICK, 12, TICK_ENABLE | 12],
  ]) {
    const board = new Board({ bare: true });
    board.poke(INTE, 1);
    board.poke(ALARM0, 30);
    board.run({ untilCycle: 1250 });
    board.poke(address, stops);
    board.run({ cycles: 1_000_000 });
    assert.deepEqual([board.peek(TIME), board.peek(ARMED), board.peek(INTR)], [10, 1, 0]);
    board.poke(address, goes);
    board.run({ cycles: 20 * 125 + 1 });
    assert.deepEqual([board.peek(TIME), board.peek(INTR)], [30, 1]);
  }
});

test('the watchdog counts the ticks of the generator, and none without it', () => {
  for (const [tick, cycle] of [
    [TICK_ENABLE | 12, 100 * 125],
    [TICK_ENABLE | 6, 50 * 125],
    [12, Infinity],
  ]) {
    const board = new Board({ bare: true });
    board.poke(PSM_WDSEL, 0x1_fffc);
    board.poke(WATCHDOG_LOAD, 200);
    board.poke(WATCHDOG_CTRL, WATCHDOG_ENABLE);
    board.poke(TICK, tick);
    assert.equal(board.peek(WATCHDOG_CTRL) & WATCHDOG_ENABLE, WATCHDOG_ENABLE);
    board.run({ untilCycle: 1_000_000 });
    const reset = board.events.find(({ text }) => text === 'watchdog')?.cycle ?? Infinity;
    assert.ok(reset === cycle || Math.abs(reset - cycle) <= 125, `a reset at ${reset}, not ${cycle}`);
  }
});
