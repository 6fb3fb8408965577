// Resets: the state that a watchdog reset clears, the state that it keeps, and its time.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import * as pio from '../support/pio-words.mjs';
import * as t from '../support/thumb.mjs';

const WATCHDOG = 0x4005_8000;
const [CTRL, LOAD, REASON, SCRATCH0] = [0x00, 0x04, 0x08, 0x0c].map((offset) => WATCHDOG + offset);
const PSM_WDSEL = 0x4001_0008;
const ENABLE = 0x4000_0000;
const TIMER_LOW = 0x4005_4028;
const RAM = 0x2000_3000;
const CYCLES_PER_US = 125;

/** A board on which a PIO drives a pin high, a word is in RAM, and the watchdog runs for `us` microseconds. */
function watched(us) {
  const board = t.boardWith([t.b(0)], { options: { pins: { out: 3 } } });
  pio.givePins(board, 0, [3]);
  pio.makeOutputs(board, 0, 0, [3]);
  pio.load(board, 0, [pio.set('pins', 1), pio.jmp('always', 1)]);
  pio.configure(board, 0, 0, { wrapTop: 1, setBase: 3, setCount: 1 });
  pio.enable(board, 0, 1);
  board.poke(RAM, 0xcafe_f00d);
  board.poke(SCRATCH0, 0x1234);
  board.poke(0xe000_e100, 0xff);
  board.poke(PSM_WDSEL, 0x1_fffc);
  // Erratum E1: it counts down twice a microsecond.
  board.poke(LOAD, 2 * us);
  board.poke(CTRL, ENABLE);
  return board;
}

test('the watchdog resets the chip when its time is up, and not before', () => {
  const board = watched(100);
  const due = board.cycle + 100 * CYCLES_PER_US;
  board.run({ untilCycle: due - 10 });
  assert.equal(board.events.length, 1, 'only the power-up');
  board.run({ cycles: 20 });
  const { cycle, text } = board.events.at(-1);
  assert.equal(text, 'watchdog');
  assert.ok(Math.abs(cycle - due) <= 2, `reset in cycle ${cycle}, due in ${due}`);
});

test('a watchdog that is fed does not reset the chip', () => {
  const board = watched(100);
  for (let i = 0; i < 10; i += 1) {
    board.run({ cycles: 60 * CYCLES_PER_US });
    board.poke(LOAD, 200);
  }
  assert.equal(board.events.length, 1);
});

test('the reset clears processor, PIO, pins and timer, and keeps RAM, reason and scratch', () => {
  const board = watched(100);
  board.run({ cycles: 200 * CYCLES_PER_US });
  assert.equal(board.events.length, 2);
  const resetAt = board.events[1].cycle;
  assert.equal(board.peek(pio.PIO_BASE[0]), 0, 'no machine enabled');
  assert.equal(board.peek(0x4001_4004 + 8 * 3), 0x1f, 'no function on the pin');
  assert.equal(board.edges.of('out').at(-1).level, 0, 'the pin is pulled down again');
  assert.ok(Math.abs(board.edges.of('out').at(-1).cycle - resetAt) <= 1);
  assert.equal(board.peek(0xe000_e100), 0, 'no interrupt enabled');
  assert.ok(board.peek(TIMER_LOW) <= 100, 'time began again');
  assert.equal(board.peek(RAM), 0xcafe_f00d);
  assert.equal(board.peek(REASON), 1, 'the timer, not a forced reset');
  assert.equal(board.peek(SCRATCH0), 0x1234);
  assert.equal(board.peek(CTRL) & ENABLE, 0);
});

test('a watchdog reset with an empty WDSEL is an error', () => {
  const board = watched(100);
  board.poke(PSM_WDSEL, 0);
  assert.throws(() => board.run({ cycles: 200 * CYCLES_PER_US }), /WDSEL/);
});

test('a forced reset has another reason than a timeout', () => {
  const board = watched(1000);
  board.poke(CTRL, 0x8000_0000);
  board.run({ cycles: 10 });
  assert.equal(board.peek(REASON), 2);
});

test('a system reset restarts the processor and leaves the peripherals alone', () => {
  const board = watched(10_000);
  board.run({ cycles: 1000 });
  board.poke(0xe000_ed0c, 0x05fa_0004);
  board.run({ cycles: 10 });
  assert.equal(board.events.at(-1).text, 'system');
  assert.equal(board.peek(pio.PIO_BASE[0]), 1, 'the machine runs on');
  assert.equal(board.edges.of('out').length, 1);
  assert.equal(board.peek(0xe000_e100), 0);
});

test('levels between edges come from the recording', () => {
  const board = watched(100);
  board.run({ cycles: 200 * CYCLES_PER_US });
  const [up, down] = board.edges.track('out').cycles;
  const levels = [up - 1, up, down - 1, down].map((cycle) => board.edges.levelAt('out', cycle));
  assert.deepEqual(levels, [0, 1, 1, 0]);
});

/** If this fails, a board without power drives its pins, or keeps its state over a power cut. */
test('while the power is off nothing runs and no pin is driven', () => {
  const board = watched(10_000);
  board.run({ cycles: 1000 });
  assert.equal(board.edges.levelAt('out', board.cycle), 1);
  board.powerDown();
  const off = board.cycle;
  board.run({ cycles: 1_000_000 });
  assert.deepEqual(board.edges.of('out').slice(-1).map(({ level, cycle }) => [level, cycle - off <= 1]), [[0, true]]);
  assert.equal(board.core.waiting, true);
  board.powerUp();
  board.run({ cycles: 100 });
  assert.notEqual(board.peek(RAM), 0xcafe_f00d);
  assert.equal(board.core.waiting, false, 'its firmware runs');
  assert.deepEqual(board.events.map(({ text }) => text), ['power', 'no power', 'power']);
});

test('power-up fills RAM with arbitrary bytes', () => {
  const board = watched(1000);
  assert.notEqual(board.peek(RAM + 64), 0);
});
