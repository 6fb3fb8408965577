// The SIO's divider, used as compiled code uses it: operands, eight cycles, remainder, quotient.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Board } from '../board/board.mjs';
import * as t from '../support/thumb.mjs';

const SIO = 0xd000_0000;
const CSR = SIO + 0x78;

/** Divides on a bare board; gives [quotient, remainder]. */
function divide(dividend, divisor, signed) {
  const board = new Board({ bare: true });
  board.poke(SIO + (signed ? 0x68 : 0x60), dividend);
  board.poke(SIO + (signed ? 0x6c : 0x64), divisor);
  board.run({ cycles: 8 });
  const remainder = board.peek(SIO + 0x74);
  return [board.peek(SIO + 0x70), remainder];
}

test('quotients and remainders are correct, unsigned, signed and for division by zero', () => {
  assert.deepEqual(divide(0xffff_fffe, 7, false), [0x2492_4924, 2]);
  assert.deepEqual(divide(-100 >>> 0, 7, true), [-14 >>> 0, -2 >>> 0]);
  assert.deepEqual(divide(100, -7 >>> 0, true), [-14 >>> 0, 2]);
  assert.deepEqual(divide(0x8000_0000, 0xffff_ffff, true), [0x8000_0000, 0]);
  assert.deepEqual(divide(5, 0, false), [0xffff_ffff, 5]);
  assert.deepEqual(divide(-5 >>> 0, 0, true), [1, -5 >>> 0]);
  assert.deepEqual(divide(5, 0, true), [0xffff_ffff, 5]);
});

test('a result is ready eight cycles after the operand, and an earlier read is an error', () => {
  for (const [wait, good] of [
    [8, true],
    [7, false],
  ]) {
    // A store of one cycle, the wait, and the load.
    const board = t.boardWith([t.str(1, 0, 0x64), ...Array(wait).fill(t.NOP), t.ldr(2, 0, 0x74)]);
    board.core.registers[0] = SIO;
    board.core.registers[1] = 3;
    const run = () => board.run({ cycles: wait + 2 });
    if (good) run();
    else assert.throws(run, /1 cycles too early/);
  }
});

test('DIRTY is set until the quotient is read, and READY shows when it may be read', () => {
  const board = new Board({ bare: true });
  assert.equal(board.peek(CSR), 1);
  board.poke(SIO + 0x60, 100);
  assert.equal(board.peek(CSR), 2);
  board.run({ cycles: 8 });
  assert.equal(board.peek(CSR), 3);
  board.peek(SIO + 0x70);
  assert.equal(board.peek(CSR), 1);
});
