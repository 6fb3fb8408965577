// The program that plays step runs, on three machines of each block, against a model of its required behaviour.
//
// If one of these fails, edges that the bench reports differ from those of the hardware, and no comparison of the
// firmware with the host's prediction is valid.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Board } from '../board/board.mjs';
import * as pio from '../support/pio-words.mjs';

const [RUN, FWD, BACK, AGAIN, EDGES, WAIT] = [0, 6, 8, 10, 11, 12];
const WRAP_TOP = 14;
// prettier-ignore
const PROGRAM = [
  pio.pull(), pio.out('x', 13), pio.out('y', 18), pio.jmp('x--', EDGES), pio.out('x', 1), pio.jmp('!x', BACK),
  pio.side(pio.jmp('y--', FWD), 1), pio.jmp('always', RUN),
  pio.side(pio.jmp('y--', BACK), 0), pio.jmp('always', RUN),
  pio.delay(pio.mov('y', 'isr'), 3),
  pio.mov('isr', 'y'),
  pio.jmp('y--', WAIT), pio.mov('pins', 'pins', pio.INVERT), pio.jmp('x--', AGAIN),
];

const run = (edges, period) => edges | ((period - 8) << 13);
const pause = (length, dir) => (((length - 8) << 13) | (dir << 31)) >>> 0;

const AXES = [0, 1, 2, 3, 4, 5].map((axis) => ({
  axis,
  block: axis < 3 ? 0 : 1,
  machine: axis % 3,
  step: 2 * axis,
  dir: 2 * axis + 1,
}));
const PINS = Object.fromEntries(
  AXES.flatMap(({ axis, step, dir }) => [
    [`step${axis}`, step],
    [`dir${axis}`, dir],
  ]),
);

/** Edges that `words` must make when the first is pulled in cycle `start`: toggles of STEP, changes of DIR. */
function model(words, start, dirBefore = 0) {
  const step = [];
  const dir = [];
  let at = start;
  let level = dirBefore;
  for (const word of words) {
    const edges = word & 0x1fff;
    const cycles = ((word >>> 13) & 0x3_ffff) + 8;
    // Three cycles to decode the word and one to decide, two to turn STEP round and count, two around the wait.
    for (let i = 1; i <= edges; i += 1) step.push(at + i * cycles - 2);
    if (edges === 0 && word >>> 31 !== level) {
      level ^= 1;
      dir.push(at + 6);
    }
    at += Math.max(edges, 1) * cycles;
  }
  return { step, dir, end: at };
}

function setUp(options = {}) {
  const board = new Board({ bare: true, pins: PINS, ...options });
  for (const block of [0, 1]) pio.load(board, block, PROGRAM);
  for (const { block, machine, step, dir } of AXES) {
    pio.givePins(board, block, [step, dir]);
    pio.makeOutputs(board, block, machine, [step, dir]);
    pio.configure(board, block, machine, {
      wrapTop: WRAP_TOP,
      sideOptional: true,
      sideCount: 2,
      sideBase: dir,
      outBase: step,
      outCount: 1,
      inBase: step,
      joinTx: true,
    });
  }
  return board;
}

const feed = (board, { block, machine }, word) => board.poke(pio.PIO_BASE[block] + pio.TXF + 4 * machine, word);
const level = (board, { block, machine }) => (board.peek(pio.PIO_BASE[block] + pio.FLEVEL) >>> (8 * machine)) & 0xf;

/** Plays lists of words on all axes, keeping each FIFO from underrunning; gives the cycle of the first pull. */
function play(board, lists, length) {
  const queues = lists.map((list) => [...list]);
  const fill = () => {
    AXES.forEach((axis, i) => {
      while (queues[i].length > 0 && level(board, axis) < 8) feed(board, axis, queues[i].shift());
    });
  };
  fill();
  board.run({ cycles: 100 });
  const start = board.cycle;
  pio.enable(board, 0, 0b111);
  pio.enable(board, 1, 0b111);
  const end = start + length;
  while (board.cycle < end) {
    board.run({ cycles: 8 });
    fill();
  }
  return start;
}

/** A reproducible source of numbers below `n`. */
function source(seed) {
  let state = seed;
  return (n) => {
    state = (Math.imul(state, 1_664_525) + 1_013_904_223) >>> 0;
    return Math.floor((state / 0x1_0000_0000) * n);
  };
}

function randomWords(seed, count) {
  const below = source(seed);
  return Array.from({ length: count }, () => {
    if (below(3) === 0) return pause(8 + below(300), below(2));
    return run(1 + below(12), 8 + below(below(2) ? 4 : 200));
  });
}

function check(board, lists, start) {
  AXES.forEach(({ axis }, i) => {
    const expected = model(lists[i], start);
    assert.deepEqual(board.edges.track(`step${axis}`).cycles, expected.step, `STEP of axis ${axis}`);
    assert.deepEqual(board.edges.track(`dir${axis}`).cycles, expected.dir, `DIR of axis ${axis}`);
  });
}

test('six axes play words, pauses and changes of direction exactly as the model says', () => {
  const board = setUp();
  const lists = AXES.map(({ axis }) => randomWords(axis + 1, 200));
  const length = Math.max(...lists.map((list) => model(list, 0).end)) + 10;
  check(board, lists, play(board, lists, length));
});

test('stepping every cycle gives the same edges as skipping from event to event', () => {
  const lists = AXES.map(({ axis }) => randomWords(100 + axis, 40));
  const length = Math.max(...lists.map((list) => model(list, 0).end)) + 10;
  const [plain, skipping] = [false, true].map((fastForward) => {
    const board = setUp({ fastForward });
    play(board, lists, length);
    return board.edges.tracks;
  });
  assert.deepEqual(plain, skipping);
});

test('the least period of 8 cycles is kept over a whole run of 8191 edges', () => {
  const board = setUp();
  const lists = AXES.map(() => [run(8191, 8), run(3, 8)]);
  check(board, lists, play(board, lists, 8 * 8194 + 10));
});

test('the longest period is 262,151 cycles', () => {
  const board = setUp();
  const lists = AXES.map(() => [run(2, 262_151), pause(262_151, 1)]);
  check(board, lists, play(board, lists, 3 * 262_151 + 10));
});

test('a FIFO underrun stops the pulses and is flagged, and a later word plays from its arrival', () => {
  const board = setUp();
  const [axis] = AXES;
  feed(board, axis, run(2, 20));
  const start = board.cycle;
  pio.enable(board, 0, 0b001);
  const emptyFrom = start + 40;
  assert.equal(board.peek(pio.PIO_BASE[0] + pio.FDEBUG) & (1 << 24), 0, 'no stall before the first pull');
  board.run({ untilCycle: emptyFrom });
  assert.equal(board.peek(pio.PIO_BASE[0] + pio.FDEBUG) & (1 << 24), 0, 'no stall while the word lasts');
  board.run({ untilCycle: emptyFrom + 1 });
  assert.equal(board.peek(pio.PIO_BASE[0] + pio.FDEBUG) & (1 << 24), 1 << 24, 'stalled on the empty FIFO');
  board.poke(pio.PIO_BASE[0] + pio.FDEBUG, 1 << 24);
  assert.notEqual(board.peek(pio.PIO_BASE[0] + pio.FDEBUG) & (1 << 24), 0, 'not to be cleared while it lasts');
  board.run({ untilCycle: 1000 });
  feed(board, axis, run(1, 30));
  board.run({ cycles: 100 });
  const steps = [...model([run(2, 20)], start).step, ...model([run(1, 30)], 1000).step];
  assert.deepEqual(board.edges.track('step0').cycles, steps);
});

test('machines enabled by one store begin in one cycle, and two stores cause skew between the blocks', () => {
  const board = setUp();
  for (const axis of AXES) feed(board, axis, run(4, 50));
  const start = board.cycle;
  pio.enable(board, 0, 0b111);
  board.run({ cycles: 2 });
  pio.enable(board, 1, 0b111);
  board.run({ cycles: 300 });
  const first = AXES.map(({ axis }) => board.edges.track(`step${axis}`).cycles[0] - start);
  assert.deepEqual(first, [48, 48, 48, 50, 50, 50]);
});
