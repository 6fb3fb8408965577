// The call profile: callers, callees and number of calls. No cycle is lost or counted twice.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { CallProfile, ENTRY, placeOf } from '../board/profile.mjs';
import * as t from '../support/thumb.mjs';

const THREAD = 0;
const at = (name, offset, size) => ({ name, address: t.CODE + offset, size });

/** Calls two deep, a tail call at the end, and again. */
const CODE = [
  t.NOP, //       main; outside of exceptions the first instruction counts as the entry
  ...t.bl(6), //  calls outer
  t.b(-4), //     and again
  t.push(14), // outer
  ...t.bl(6), //  calls inner
  t.pop(15),
  t.addsImm(0, 1), // inner
  t.b(2), //      jumps to tail, which returns for it
  t.addsImm(0, 1), // tail
  t.bx(14),
];
const FUNCTIONS = [at('main', 0, 8), at('outer', 8, 8), at('inner', 16, 4), at('tail', 20, 4)];

function profile(cycles) {
  const board = t.boardWith(CODE);
  board.profile = new CallProfile(FUNCTIONS, THREAD);
  board.run({ cycles });
  board.profile.finish();
  return board;
}

function pathOf({ nodes }, node) {
  const names = [];
  for (let i = node; i > 0; i = nodes[i].parent) names.unshift(FUNCTIONS[nodes[i].fn].name);
  return names.join(' ');
}

test('calls, returns and tail calls make a tree, and each call is counted', () => {
  const { profile: found, core } = profile(2000);
  const [call] = found.calls;
  const times = new Map();
  for (let i = 0; i < call.calls.length; i += 2) times.set(pathOf(found, call.calls[i]), call.calls[i + 1]);
  const rounds = times.get('main outer');
  assert.ok(rounds > 50, `${rounds} rounds`);
  assert.deepEqual([...times.keys()], ['main', 'main outer', 'main outer inner', 'main outer inner tail']);
  assert.equal(times.get('main'), 1, 'a return comes back to the node that called');
  for (const path of ['main outer inner', 'main outer inner tail']) {
    assert.ok(Math.abs(times.get(path) - rounds) <= 1, `${path}: ${times.get(path)} of ${rounds}`);
  }
  assert.ok(Math.abs(core.registers[0] / 2 - rounds) <= 1, 'the code ran as it is meant to');
});

test('every cycle is counted once', () => {
  const { profile: found, cycle } = profile(2000);
  const [{ cycles, own }] = found.calls;
  let sum = 0;
  for (let i = 1; i < cycles.length; i += 2) sum += cycles[i];
  assert.equal(sum, own);
  assert.equal(sum, cycle);
  assert.equal(found.keys[0].pc, ENTRY);
});

test('an address outside every function belongs to no function', () => {
  assert.equal(placeOf(FUNCTIONS, t.CODE + 8), 1);
  assert.equal(placeOf(FUNCTIONS, t.CODE + 23), 3);
  assert.equal(placeOf(FUNCTIONS, t.CODE + 24), -1);
  assert.equal(placeOf(FUNCTIONS, t.CODE - 2), -1);
});
