// Snapshots: a restored machine goes on as it did, bit for bit, after any change in between.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Board } from '../board/board.mjs';
import { FLASH_SIZE } from '../board/elf.mjs';
import { Snapshot } from '../board/snapshot.mjs';
import * as t from '../support/thumb.mjs';

/** A flash with a firmware that counts in register 0, for ever. */
function counting() {
  const flash = new Uint8Array(FLASH_SIZE).fill(0xff);
  const view = new DataView(flash.buffer);
  view.setUint32(0x100, t.STACK_TOP, true);
  view.setUint32(0x104, 0x1000_0200 | 1, true);
  view.setUint16(0x200, 0x3001, true); // ADDS r0, #1
  view.setUint16(0x202, 0xe7fd, true); // B to it
  return flash;
}

const stateOf = (board) => [board.cycle, ...board.core.registers, board.edges.of('ten').length, board.peek(0x2000_0100)];

test('a restored snapshot repeats the same run, resets, stimuli and memory included', () => {
  const board = new Board({ flash: counting(), pins: { ten: 10 } });
  board.stimulus.burst(500, 10, { count: 1000, period: 100 });
  board.run({ cycles: 10_000 });
  const snapshot = new Snapshot(board);
  const goOn = () => {
    board.run({ cycles: 10_000 });
    return stateOf(board);
  };
  const first = goOn();
  snapshot.restore();
  assert.deepEqual(goOn(), first);
  snapshot.restore();
  board.poke(0x2000_0100, 4711);
  board.stimulus.pulse(board.cycle + 7, 10, 3);
  board.requestReset('system');
  goOn();
  assert.notDeepEqual(stateOf(board), first);
  snapshot.restore();
  assert.deepEqual(goOn(), first);
});
