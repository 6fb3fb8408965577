// Each PIO instruction against the text of the RP2040 datasheet, chapters 3.4 and 3.5.
//
// A machine's registers are read as software does it: by forcing MOV ISR and PUSH, and reading the FIFO.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Board } from '../board/board.mjs';
import * as pio from '../support/pio-words.mjs';

const BASE = pio.PIO_BASE[0];
const OUT_PIN = 5;

function machine(
  program,
  options = {},
  board = new Board({ bare: true, pins: { out: OUT_PIN, next: OUT_PIN + 1 } }),
) {
  pio.load(board, 0, program);
  pio.givePins(board, 0, [OUT_PIN, OUT_PIN + 1]);
  pio.makeOutputs(board, 0, 0, [OUT_PIN, OUT_PIN + 1]);
  const wrapTop = options.wrapTop ?? program.length - 1;
  pio.configure(board, 0, 0, { outBase: OUT_PIN, outCount: 1, setBase: OUT_PIN, setCount: 1, ...options, wrapTop });
  return board;
}

const force = (board, instruction) => board.poke(pio.machineRegister(0, 0, pio.INSTR), instruction);
const start = (board) => pio.enable(board, 0, 1);
const send = (board, word) => board.poke(BASE + pio.TXF, word);
const receive = (board) => board.peek(BASE + pio.RXF);
const pc = (board) => board.peek(pio.machineRegister(0, 0, pio.ADDR));
const received = (board) => (board.peek(BASE + pio.FLEVEL) >>> 4) & 0xf;

function register(board, name) {
  pio.enable(board, 0, 0);
  force(board, pio.mov('isr', name));
  force(board, pio.push());
  return receive(board);
}

const load = (board, name, value) => {
  send(board, value);
  force(board, pio.pull());
  force(board, pio.mov(name, 'osr'));
};

test('JMP X-- tests X before it decrements it, and decrements it also when it does not jump', () => {
  const board = machine([pio.jmp('x--', 2), pio.jmp('always', 1), pio.jmp('always', 2)]);
  load(board, 'x', 0);
  start(board);
  board.run({ cycles: 5 });
  assert.equal(pc(board), 1, 'X was zero: no jump');
  assert.equal(register(board, 'x'), 0xffff_ffff);

  load(board, 'x', 1);
  force(board, pio.jmp('always', 0));
  start(board);
  board.run({ cycles: 5 });
  assert.equal(pc(board), 2, 'X was one: jump');
  assert.equal(register(board, 'x'), 0);
});

test('JMP Y-- to itself takes Y + 1 cycles, and Y reads correctly during the loop', () => {
  const board = machine([pio.jmp('y--', 0), pio.set('pins', 1), pio.jmp('always', 2)]);
  load(board, 'y', 1000);
  const from = board.cycle;
  start(board);
  board.run({ cycles: 400 });
  assert.equal(register(board, 'y'), 600);
  assert.equal(pc(board), 0);
  start(board);
  board.run({ cycles: 1000 });
  assert.deepEqual(board.edges.to('out', 1), [from + 1001]);
});

test('the delay of JMP X-- to itself applies in every iteration', () => {
  const board = machine([pio.delay(pio.jmp('x--', 0), 2), pio.set('pins', 1), pio.jmp('always', 2)]);
  load(board, 'x', 10);
  const from = board.cycle;
  start(board);
  board.run({ cycles: 100 });
  assert.deepEqual(board.edges.to('out', 1), [from + 3 * 11]);
});

test('MOV inverts and reverses bits', () => {
  const board = machine([pio.jmp('always', 0)]);
  load(board, 'x', 0x0000_0013);
  force(board, pio.mov('y', 'x', pio.INVERT));
  assert.equal(register(board, 'y'), 0xffff_ffec);
  force(board, pio.mov('y', 'x', pio.REVERSE));
  assert.equal(register(board, 'y'), 0xc800_0000);
});

test('MOV PINS, ~PINS toggles: a pin reads what the machine itself drives, three cycles later', () => {
  const board = machine([pio.mov('pins', 'pins', pio.INVERT)], { inBase: OUT_PIN });
  const from = board.cycle;
  start(board);
  board.run({ cycles: 12 });
  // Every cycle writes the inverse of the level that was decided three cycles before.
  assert.deepEqual(
    board.edges.track('out').cycles,
    [0, 3, 6, 9].map((c) => from + c),
  );
});

test('OUT shifts right from bit 0, or left from bit 31, and 32 bits at once', () => {
  for (const [outRight, x, y] of [
    [true, 0x678, 0x12345],
    [false, 0x123, 0x45678],
  ]) {
    const board = machine([pio.pull(), pio.out('x', 12), pio.out('y', 20), pio.jmp('always', 3)], { outRight });
    send(board, 0x1234_5678);
    start(board);
    board.run({ cycles: 8 });
    assert.equal(register(board, 'x'), x);
    assert.equal(register(board, 'y'), y);
    send(board, 0x89ab_cdef);
    force(board, pio.pull());
    force(board, pio.out('x', 32));
    assert.equal(register(board, 'x'), 0x89ab_cdef);
  }
});

test('IN OSR, 26 after IN PINS, 6 makes a word of six pins above 26 bits, shifting left', () => {
  const board = machine([pio.jmp('always', 0)], { inRight: false, inBase: 16 });
  board.stimulus.at(board.cycle, 16, 1).at(board.cycle, 21, 1);
  board.run({ cycles: 10 });
  load(board, 'osr', 0xfeed_cafe);
  force(board, pio.mov('isr', 'null'));
  force(board, pio.shiftIn('pins', 6));
  force(board, pio.shiftIn('osr', 26));
  force(board, pio.push());
  assert.equal(receive(board), (0b100001 * 2 ** 26 + (0xfeed_cafe & 0x3ff_ffff)) >>> 0);
});

test('IN shifts right into bit 31', () => {
  const board = machine([pio.jmp('always', 0)], { inRight: true });
  load(board, 'x', 0x5);
  force(board, pio.mov('isr', 'null'));
  force(board, pio.shiftIn('x', 4));
  force(board, pio.push());
  assert.equal(receive(board), 0x5000_0000);
});

test('PULL on an empty FIFO stalls until a word comes, and pulls it in the cycle after', () => {
  const board = machine([pio.pull(), pio.set('pins', 1), pio.jmp('always', 2)]);
  start(board);
  board.run({ cycles: 50 });
  assert.equal(pc(board), 0);
  const now = board.cycle;
  send(board, 7);
  board.run({ cycles: 10 });
  assert.deepEqual(board.edges.to('out', 1), [now + 1]);
  assert.equal(register(board, 'osr'), 7);
});

test('PULL NOBLOCK on an empty FIFO copies X to OSR', () => {
  const board = machine([pio.jmp('always', 0)]);
  load(board, 'x', 99);
  force(board, pio.pull({ block: false }));
  assert.equal(register(board, 'osr'), 99);
});

test('PUSH NOBLOCK on a full FIFO drops the word, empties ISR and flags it once', () => {
  const board = machine([pio.mov('isr', 'x'), pio.push({ block: false }), pio.set('pins', 1), pio.jmp('always', 3)]);
  for (const word of [1, 2, 3, 4]) {
    load(board, 'isr', word);
    force(board, pio.push());
  }
  load(board, 'x', 5);
  start(board);
  board.run({ cycles: 10 });
  assert.equal(pc(board), 3, 'it does not stall');
  assert.equal(board.peek(BASE + pio.FDEBUG) & 1, 1);
  board.poke(BASE + pio.FDEBUG, 1);
  assert.equal(board.peek(BASE + pio.FDEBUG) & 1, 0, 'the flag can be cleared');
  assert.deepEqual(
    [1, 2, 3, 4].map(() => receive(board)),
    [1, 2, 3, 4],
  );
});

test('PUSH on a full FIFO stalls until there is room', () => {
  const board = machine([pio.mov('isr', 'x'), pio.push(), pio.jmp('always', 0)]);
  load(board, 'x', 5);
  start(board);
  board.run({ cycles: 100 });
  assert.equal(received(board), 4);
  assert.equal(pc(board), 1);
  receive(board);
  board.run({ cycles: 10 });
  assert.equal(received(board), 4);
});

test('joined FIFOs hold eight words one way and none the other', () => {
  const board = machine([pio.jmp('always', 0)], { joinTx: true });
  for (let i = 0; i < 9; i += 1) send(board, i);
  assert.equal(board.peek(BASE + pio.FLEVEL) & 0xf, 8);
  assert.equal((board.peek(BASE + pio.FSTAT) >>> 16) & 1, 1, 'TX full');
  assert.equal((board.peek(BASE + pio.FDEBUG) >>> 16) & 1, 1, 'the ninth was an overflow');
  assert.equal(board.peek(BASE + pio.FSTAT) & 0x101, 0x101, 'RX both full and empty');
});

test('side-set acts in the first cycle of its instruction, also with a stall or a delay', () => {
  const program = [pio.side(pio.delay(pio.jmp('always', 1), 3), 1), pio.side(pio.pull(), 0), pio.jmp('always', 2)];
  const board = machine(program, { sideOptional: true, sideCount: 2, sideBase: OUT_PIN + 1 });
  const from = board.cycle;
  start(board);
  board.run({ cycles: 30 });
  // Up with the first instruction; its delay is three cycles; down with the PULL, which never completes.
  assert.deepEqual(board.edges.track('next').cycles, [from, from + 4]);
  assert.equal(pc(board), 1);
});

test('on one pin side-set wins over SET in the same instruction', () => {
  const board = machine([pio.side(pio.set('pins', 1), 0), pio.jmp('always', 1)], {
    sideOptional: true,
    sideCount: 2,
    sideBase: OUT_PIN,
  });
  start(board);
  board.run({ cycles: 10 });
  assert.equal(board.edges.track('out').cycles.length, 0);
});

test('the program wraps from its top to its bottom without a cycle lost', () => {
  const board = machine([pio.set('x', 0), pio.set('pins', 1), pio.set('pins', 0)], { wrapBottom: 1, wrapTop: 2 });
  const from = board.cycle;
  start(board);
  board.run({ cycles: 6 });
  assert.deepEqual(
    board.edges.track('out').cycles,
    [1, 2, 3, 4, 5].map((c) => from + c),
  );
});

test('WAIT on a pin ends three cycles after the pin changed: two flip-flops and the cycle itself', () => {
  const board = machine([pio.waitFor(1, 'gpio', 20), pio.set('pins', 1), pio.jmp('always', 2)]);
  start(board);
  board.stimulus.at(1000, 20, 1);
  board.run({ untilCycle: 1100 });
  assert.deepEqual(board.edges.to('out', 1), [1000 + 3 + 1]);
});

test('IRQ raises a flag that the processor sees; with WAIT it stalls until the flag is cleared', () => {
  const board = machine([pio.irq(2, { wait: true }), pio.set('pins', 1), pio.jmp('always', 2)]);
  start(board);
  board.run({ cycles: 10 });
  assert.equal(board.peek(BASE + pio.IRQ), 4);
  assert.equal(pc(board), 0);
  board.poke(BASE + pio.IRQ, 4);
  board.run({ cycles: 10 });
  assert.equal(board.edges.to('out', 1).length, 1);
});

test('a clock divider of three stretches every instruction threefold', () => {
  const board = machine([pio.set('pins', 1), pio.set('pins', 0)], { divider: 3 });
  const from = board.cycle;
  start(board);
  board.run({ cycles: 12 });
  assert.deepEqual(
    board.edges.track('out').cycles,
    [0, 3, 6, 9].map((c) => from + c),
  );
});

test('a disabled machine keeps the rest of its delay', () => {
  const board = machine([pio.delay(pio.set('x', 0), 20), pio.set('pins', 1), pio.jmp('always', 2)]);
  const from = board.cycle;
  start(board);
  board.run({ cycles: 5 });
  pio.enable(board, 0, 0);
  board.run({ cycles: 100 });
  start(board);
  board.run({ cycles: 100 });
  assert.deepEqual(board.edges.to('out', 1), [from + 21 + 100]);
});

test('unmodelled PIO features are refused', () => {
  for (const [register, value, refusal] of [
    [0x00, 0x0001_8000, /fractional/],
    [0x08, 1 << 17, /autopull/],
    [0x04, 1 << 17, /OUT_STICKY/],
  ]) {
    const board = machine([pio.jmp('always', 0)]);
    board.poke(pio.machineRegister(0, 0, register), value);
    assert.throws(() => start(board), refusal);
  }
});
