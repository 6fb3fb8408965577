// Random programs, inputs and interference: running ahead must not change the result of any program.
//
// Each seed makes two machines with programs of random instructions, toggles pins that they read, writes and reads
// their FIFOs, forces instructions, stops and starts them, and reads their program counters; once stepping every
// cycle, once running ahead. Everything that can be observed is compared.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Board } from '../board/board.mjs';
import * as pio from '../support/pio-words.mjs';

const SEEDS = 150;
const LENGTH = 12;
const CYCLES = 4000;
const INPUTS = [16, 17, 18, 19];
const PINS = Object.fromEntries([...Array(12).keys()].map((pin) => [`gpio${pin}`, pin]));

/** A reproducible source of numbers below `n`. */
function source(seed) {
  let state = Math.imul(seed, 0x9e37_79b1) | 1;
  return (n) => {
    state ^= state << 13;
    state ^= state >>> 17;
    state ^= state << 5;
    return (state >>> 0) % n;
  };
}

const pick = (below, list) => list[below(list.length)];

function instruction(below) {
  const field = below(3) === 0 ? below(32) << 8 : 0;
  const registers = ['x', 'y', 'isr', 'osr'];
  const kinds = [
    () => pio.jmp(pick(below, ['always', '!x', 'x--', '!y', 'y--', 'x!=y', 'pin', '!osre']), below(LENGTH)),
    () => pio.jmp(pick(below, ['x--', 'y--', 'x!=y']), below(LENGTH)),
    () =>
      pio.mov(pick(below, [...registers, 'pins']), pick(below, [...registers, 'pins', 'null', 'status']), below(3)),
    () => pio.mov(pick(below, registers), pick(below, registers), below(3)),
    () => pio.shiftIn(pick(below, ['pins', 'x', 'y', 'osr', 'null']), below(32)),
    () => pio.out(pick(below, ['pins', 'x', 'y', 'null', 'isr', 'pindirs', 'pc', 'exec']), below(32)),
    () => pio.set(pick(below, ['pins', 'x', 'y']), below(32)),
    () => pio.push({ block: below(2) === 1, ifFull: below(2) === 1 }),
    () => pio.pull({ block: below(3) === 0, ifEmpty: below(2) === 1 }),
    () => pio.waitFor(below(2), 'gpio', pick(below, INPUTS)),
    () => pio.irq(below(4), { clear: below(2) === 1, wait: below(4) === 0 }),
  ];
  return pick(below, kinds)() | field;
}

/** Everything observable of one run. */
function play(seed, fastForward) {
  const below = source(seed);
  const board = new Board({ bare: true, fastForward, pins: PINS });
  const results = [];
  pio.load(
    board,
    0,
    Array.from({ length: LENGTH }, () => instruction(below)),
  );
  for (const machine of [0, 1]) {
    const base = 6 * machine;
    const own = [0, 1, 2, 3, 4, 5].map((pin) => base + pin);
    pio.givePins(board, 0, own);
    pio.makeOutputs(board, 0, machine, own);
    pio.configure(board, 0, machine, {
      wrapTop: LENGTH - 1 - below(3),
      wrapBottom: below(4),
      sideOptional: below(2) === 1,
      sideCount: below(3),
      sideBase: base + 4,
      outBase: base,
      outCount: 2,
      setBase: base + 2,
      setCount: 2,
      inBase: pick(below, [0, 16, 30]),
      jmpPin: pick(below, INPUTS),
      inRight: below(2) === 1,
      outRight: below(2) === 1,
      divider: below(4) === 0 ? 1 + below(3) : 1,
    });
  }
  for (let i = 0; i < 60; i += 1) {
    board.stimulus.at(board.cycle + below(CYCLES), pick(below, INPUTS), below(2));
  }
  pio.enable(board, 0, 0b11);
  while (board.cycle < CYCLES) {
    board.run({ cycles: 1 + below(90) });
    const machine = below(2);
    const act = below(12);
    if (act < 5) board.poke(pio.PIO_BASE[0] + pio.TXF + 4 * machine, below(0xffff_ffff) >>> below(32));
    else if (act < 8) results.push(board.peek(pio.PIO_BASE[0] + pio.RXF + 4 * machine));
    else if (act < 9) results.push(board.peek(pio.machineRegister(0, machine, pio.ADDR)));
    else if (act < 10) board.poke(pio.machineRegister(0, machine, pio.INSTR), instruction(below));
    else if (act < 11) pio.enable(board, 0, below(4));
    else board.poke(pio.PIO_BASE[0] + pio.IRQ, 0xff);
    if (act === 10) pio.enable(board, 0, 0b11);
    results.push(board.peek(pio.PIO_BASE[0] + pio.FLEVEL), board.peek(pio.PIO_BASE[0] + pio.FDEBUG));
  }
  return { results, edges: board.edges.tracks };
}

test('random programs do the same whether every cycle is stepped or not', () => {
  let edges = 0;
  for (let seed = 1; seed <= SEEDS; seed += 1) {
    const ahead = play(seed, true);
    assert.deepEqual(ahead, play(seed, false), `seed ${seed}`);
    edges += ahead.edges.reduce((sum, { cycles }) => sum + cycles.length, 0);
  }
  assert.ok(edges > 40_000, `too little happens for a comparison: ${edges} edges`);
});
