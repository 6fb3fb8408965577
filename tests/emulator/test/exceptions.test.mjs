// Interrupts and sleep: priorities, preemption, masking, pending by software and by line, events, SysTick.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { CHAIN_CYCLES, ENTRY_CYCLES, EXIT_CYCLES } from '../board/core-exceptions.mjs';
import * as t from '../support/thumb.mjs';

const ISER = 0xe000_e100;
const ISPR = 0xe000_e200;
const ICPR = 0xe000_e280;
const IPR6 = 0xe000_e418;
const SYST_CSR = 0xe000_e010;
const SYST_RVR = 0xe000_e014;
const SYST_CVR = 0xe000_e018;
const [SWI0, SWI1] = [26, 27];
const [E0, E1] = [16 + SWI0, 16 + SWI1];
const RETURN = t.bx(14);

/** A handler that adds one to the word at r7 + 4 * slot and does `more`. */
const counted = (slot, more = []) => [t.ldr(0, 7, 4 * slot), t.addsImm(0, 1), t.str(0, 7, 4 * slot), ...more, RETURN];
const COUNTERS = 0x2000_0000;

function idle(handlers, { code = [t.b(0)], priorities = [0, 0] } = {}) {
  const board = t.boardWith(code, { handlers, options: { watched: [E0, E1] } });
  board.core.registers[7] = COUNTERS;
  for (const slot of [0, 1, 2]) board.poke(COUNTERS + 4 * slot, 0);
  board.poke(ISER, (1 << SWI0) | (1 << SWI1));
  board.poke(IPR6, (priorities[0] << 22) | (priorities[1] << 30));
  return board;
}

const count = (board, slot) => board.peek(COUNTERS + 4 * slot);
const pend = (board, ...irqs) =>
  board.poke(
    ISPR,
    irqs.reduce((mask, irq) => mask | (1 << irq), 0),
  );

test('an interrupt pended by software runs its handler once, after 15 cycles', () => {
  const board = idle({ [E0]: counted(0) });
  pend(board, SWI0);
  const from = board.cycle;
  board.run({ cycles: 100 });
  assert.equal(count(board, 0), 1);
  const [call] = board.usage.calls.get(E0);
  assert.equal(call.entry, from);
  // Entry, LDR 2, ADDS 1, STR 2, BX 2, exit.
  assert.equal(call.own, ENTRY_CYCLES + 2 + 1 + 2 + 2 + EXIT_CYCLES);
});

test('a hardware interrupt pended by software also runs only once', () => {
  const board = idle({ 17: counted(0) });
  board.poke(ISER, 1 << 1);
  pend(board, 1);
  board.run({ cycles: 300 });
  assert.equal(count(board, 0), 1);
});

test('an interrupt runs again while its line is high, and stays pending if the line falls while masked', () => {
  const board = idle({ 17: counted(0) });
  board.poke(ISER, 1 << 1);
  board.chip.setInterrupt(1, true);
  board.run({ cycles: 200 });
  assert.ok(count(board, 0) > 3);
  board.chip.setInterrupt(1, false);
  board.run({ cycles: 100 });
  const before = count(board, 0);
  board.core.PM = true;
  board.chip.setInterrupt(1, true);
  board.chip.setInterrupt(1, false);
  board.run({ cycles: 50 });
  assert.equal(count(board, 0), before);
  board.core.PM = false;
  board.core.interruptsUpdated = true;
  board.run({ cycles: 100 });
  assert.equal(count(board, 0), before + 1);
});

test('pending is cleared by ICPR', () => {
  const board = idle({ [E0]: counted(0) });
  board.core.PM = true;
  pend(board, SWI0);
  assert.equal(board.peek(ISPR), 1 << SWI0);
  board.poke(ICPR, 1 << SWI0);
  board.core.PM = false;
  board.run({ cycles: 100 });
  assert.equal(count(board, 0), 0);
});

test('a lower-priority handler is preempted, and its own cycles exclude the preempting handler', () => {
  const spin = Array(40).fill(t.NOP);
  const board = idle({ [E0]: counted(0, spin), [E1]: counted(1) }, { priorities: [2, 1] });
  pend(board, SWI0);
  board.run({ cycles: 30 });
  pend(board, SWI1);
  board.run({ cycles: 200 });
  const [low] = board.usage.calls.get(E0);
  const [high] = board.usage.calls.get(E1);
  assert.ok(high.entry > low.entry && high.end < low.end, 'nested');
  assert.equal(low.own, ENTRY_CYCLES + 7 + 40 + EXIT_CYCLES);
  assert.equal(low.end - low.entry, low.own + high.own);
});

test('an interrupt of the same priority waits and follows without stacking again', () => {
  const spin = Array(40).fill(t.NOP);
  const board = idle({ [E0]: counted(0, spin), [E1]: counted(1) }, { priorities: [1, 1] });
  pend(board, SWI0);
  board.run({ cycles: 30 });
  pend(board, SWI1);
  board.run({ cycles: 200 });
  const [first] = board.usage.calls.get(E0);
  const [second] = board.usage.calls.get(E1);
  assert.equal(second.entry, first.end);
  assert.equal(first.own, ENTRY_CYCLES + 7 + 40);
  assert.equal(second.own, CHAIN_CYCLES + 7 + EXIT_CYCLES);
});

test('of two pending interrupts the lower priority number runs first, then the lower interrupt number', () => {
  for (const [priorities, first] of [
    [[2, 1], E1],
    [[1, 1], E0],
  ]) {
    const board = idle({ [E0]: counted(0), [E1]: counted(1) }, { priorities });
    board.core.PM = true;
    pend(board, SWI0, SWI1);
    board.core.PM = false;
    board.run({ cycles: 16 });
    assert.equal(board.core.IPSR, first);
  }
});

test('PRIMASK holds interrupts off until it is cleared', () => {
  const board = idle({ [E0]: counted(0) }, { code: [t.CPSID, ...Array(50).fill(t.NOP), t.CPSIE, t.NOP] });
  board.run({ cycles: 2 });
  pend(board, SWI0);
  board.run({ cycles: 40 });
  assert.equal(count(board, 0), 0);
  board.run({ cycles: 100 });
  assert.equal(count(board, 0), 1);
});

test('SVC is taken at once; where its priority forbids it, it is a HardFault', () => {
  const board = idle({ 11: counted(0) }, { code: [t.svc(3), t.NOP] });
  board.run({ cycles: 100 });
  assert.equal(count(board, 0), 1);
  const masked = idle({}, { code: [t.CPSID, t.svc(3)] });
  masked.run({ cycles: 100 });
  assert.equal(masked.core.IPSR, 3);
});

const SLEEP_LOOP = [t.WFE, t.ldr(1, 7, 8), t.addsImm(1, 1), t.str(1, 7, 8), t.b(-8)];

test('SEV makes the next WFE pass, once', () => {
  const board = idle({}, { code: [t.SEV, ...SLEEP_LOOP] });
  board.run({ cycles: 1000 });
  assert.equal(count(board, 2), 1);
  assert.equal(board.core.waiting, true);
});

test('an interrupt ends WFE, and the return from its handler is another event', () => {
  const board = idle({ [E0]: counted(0) }, { code: SLEEP_LOOP });
  board.run({ cycles: 500 });
  assert.equal(count(board, 2), 0);
  pend(board, SWI0);
  board.run({ cycles: 500 });
  assert.equal(count(board, 0), 1);
  assert.equal(count(board, 2), 2, 'once past the WFE that slept, once past the next by the event of the return');
});

test('with PRIMASK set an interrupt ends WFI without its handler and does not end WFE', () => {
  for (const [instruction, ends] of [
    [t.WFI, true],
    [t.WFE, false],
  ]) {
    const board = idle({ [E0]: counted(0) }, { code: [t.CPSID, instruction, ...SLEEP_LOOP.slice(1, 4)] });
    board.run({ cycles: 100 });
    assert.equal(board.core.waiting, true);
    pend(board, SWI0);
    board.run({ cycles: 100 });
    assert.equal(count(board, 0), 0, 'masked');
    assert.equal(count(board, 2), ends ? 1 : 0);
  }
});

test('cycles asleep and awake are counted separately and add up to all cycles', () => {
  const board = idle({ [E0]: counted(0) }, { code: SLEEP_LOOP });
  board.run({ cycles: 10_000 });
  pend(board, SWI0);
  board.run({ cycles: 10_000 });
  const { cycles, asleep, awake, own } = board.usage.sums();
  assert.equal(cycles, board.cycle);
  assert.equal(asleep + awake, cycles);
  assert.ok(awake < 100, `${awake} awake`);
  assert.equal(own.get(E0).entries, 1);
});

test('SysTick counts from its reload value down to zero and pends its exception every reload + 1 cycles', () => {
  const board = idle({ 15: counted(0) });
  board.poke(SYST_RVR, 999);
  board.poke(SYST_CVR, 5);
  board.poke(SYST_CSR, 7);
  const zero = board.cycle;
  for (const cycles of [1, 100]) {
    board.run({ cycles });
    assert.equal(board.peek(SYST_CVR), 999 - (board.cycle - zero - 1));
  }
  board.run({ cycles: 10_000 });
  assert.equal(count(board, 0), 10);
});

test('the stack depth is its maximum, interrupts included', () => {
  const board = idle({ [E0]: [t.push(4, 5, 6, 14), t.pop(4, 5, 6, 15)] });
  pend(board, SWI0);
  board.run({ cycles: 200 });
  assert.equal(board.stackDepth, 32 + 16);
});
