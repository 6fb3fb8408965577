// A capture program of the firmware's kind: six pins sampled every 7 cycles, a word pushed at each change, moved to RAM
// by DMA. It is the one program that never waits, so running ahead must be exact here.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Board } from '../board/board.mjs';
import * as pio from '../support/pio-words.mjs';

const FIRST_PIN = 16;
const RING = 0x2000_8000;
const DMA_CH0 = 0x5000_0000;
const DREQ_PIO0_RX3 = 7;

// X: the pins as last pushed. OSR: samples, counted down. One round is seven cycles, with a change eleven.
// prettier-ignore
const PROGRAM = [
  pio.mov('y', 'osr'), pio.jmp('y--', 2), pio.mov('osr', 'y'),
  pio.mov('isr', 'null'), pio.shiftIn('pins', 6), pio.mov('y', 'isr'), pio.jmp('x!=y', 7),
  pio.mov('x', 'y'), pio.shiftIn('osr', 26), pio.push({ block: false }), pio.jmp('always', 0),
];

function capture(fastForward, stimulate) {
  const board = new Board({ bare: true, fastForward });
  pio.load(board, 0, PROGRAM);
  pio.configure(board, 0, 3, { wrapTop: 6, inBase: FIRST_PIN, inRight: false });
  const control = (DREQ_PIO0_RX3 << 15) | (1 << 5) | (2 << 2) | 1;
  board.poke(DMA_CH0, pio.PIO_BASE[0] + pio.RXF + 12);
  board.poke(DMA_CH0 + 4, RING);
  board.poke(DMA_CH0 + 8, 1000);
  board.poke(DMA_CH0 + 12, control);
  stimulate(board.stimulus);
  const start = board.cycle;
  pio.enable(board, 0, 8);
  board.run({ untilCycle: 60_000 });
  const count = 1000 - board.peek(DMA_CH0 + 8);
  const words = Array.from({ length: count }, (_, i) => board.peek(RING + 4 * i));
  return { start, words, at: board.edges };
}

function pulses(stimulus) {
  let state = 12345;
  for (let cycle = 100; cycle < 50_000;) {
    state = (Math.imul(state, 1_103_515_245) + 12_345) >>> 0;
    stimulus.pulse(cycle, FIRST_PIN + ((state >>> 16) % 6), 3 + ((state >>> 20) % 900));
    cycle += 1 + ((state >>> 8) % 2000);
  }
}

test('captured words are the same whether every cycle is stepped or not', () => {
  const [plain, ahead] = [false, true].map((fastForward) => capture(fastForward, pulses));
  assert.ok(plain.words.length > 50, `only ${plain.words.length} words`);
  assert.deepEqual(ahead.words, plain.words);
});

test('a change is captured within one round of seven cycles, with the number of its round', () => {
  for (let offset = 0; offset < 14; offset += 1) {
    const at = 7000 + offset;
    const { start, words } = capture(true, (stimulus) => stimulus.at(at, FIRST_PIN + 2, 1));
    assert.equal(words.length, 1);
    assert.equal(words[0] >>> 26, 0b000100);
    // The sample of round n is taken in cycle start + 7 n + 4 and contains stamps up to three cycles before.
    const round = Math.ceil((at + 3 - 4 - start) / 7);
    assert.equal(-words[0] & 0x3ff_ffff, round + 1, `change in cycle ${at}`);
  }
});
