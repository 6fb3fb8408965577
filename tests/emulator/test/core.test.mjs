// The processor's instructions: results, flags and cycles.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import * as pio from '../support/pio-words.mjs';
import * as t from '../support/thumb.mjs';

const CORNERS = [0, 1, 2, 31, 32, 33, 255, 256, 0x7fff_ffff, 0x8000_0000, 0x8000_0001, 0xffff_fffe, 0xffff_ffff];

/** Executes one instruction with r0 = a, r1 = b and the carry flag; gives r0, flags and cycles. */
function execute(core, instruction, a, b, carry) {
  const at = 0x2000_1000;
  core.writeUint16(at, instruction);
  core.registers[15] = at;
  core.registers[0] = a;
  core.registers[1] = b;
  Object.assign(core, { N: false, Z: false, C: carry === 1, V: false });
  const cycles = core.step();
  const { N, Z, C, V } = core;
  return { result: core.registers[0], flags: { N, Z, C, V }, cycles };
}

/** ARMv6-M manual, AddWithCarry. */
function addWithCarry(x, y, carry) {
  const result = (x + y + carry) >>> 0;
  return {
    result,
    C: x + y + carry > 0xffff_ffff,
    V: (x | 0) + (y | 0) + carry !== (result | 0),
  };
}

const wide = (value) => BigInt(value);
const logic = (result) => ({ result: result >>> 0 });

/** Shift by a register: the bottom byte counts; the carry is the last bit out, and stays for a count of zero. */
function shift(kind) {
  return (x, y, carry) => {
    const by = y & 0xff;
    if (by === 0) return { result: x, C: carry === 1 };
    const n = wide(by);
    if (kind === 'lsl')
      return { result: Number((wide(x) << n) & 0xffff_ffffn), C: ((wide(x) << n) >> 32n) % 2n === 1n };
    if (kind === 'ror') {
      const turn = by % 32;
      const result = Number((((wide(x) << 32n) | wide(x)) >> wide(turn)) & 0xffff_ffffn);
      return { result, C: result >= 0x8000_0000 };
    }
    const value = kind === 'asr' ? wide(x | 0) : wide(x);
    return { result: Number(BigInt.asUintN(32, value >> n)), C: BigInt.asUintN(1, value >> (n - 1n)) === 1n };
  };
}

const OPERATIONS = {
  'ADCS r0, r1': [t.adcs(0, 1), addWithCarry],
  'SBCS r0, r1': [t.sbcs(0, 1), (x, y, c) => addWithCarry(x, ~y >>> 0, c)],
  'ADDS r0, r0, r1': [t.adds(0, 0, 1), (x, y) => addWithCarry(x, y, 0)],
  'SUBS r0, r0, r1': [t.subs(0, 0, 1), (x, y) => addWithCarry(x, ~y >>> 0, 1)],
  'SUBS r0, #200': [t.subsImm(0, 200), (x) => addWithCarry(x, ~200 >>> 0, 1)],
  'CMP r0, r1': [t.cmp(0, 1), (x, y) => ({ ...addWithCarry(x, ~y >>> 0, 1), kept: x })],
  'CMN r0, r1': [t.cmn(0, 1), (x, y) => ({ ...addWithCarry(x, y, 0), kept: x })],
  'RSBS r0, r1, #0': [t.rsbs(0, 1), (x, y) => addWithCarry(~y >>> 0, 0, 1)],
  'ANDS r0, r1': [t.ands(0, 1), (x, y) => logic(x & y)],
  'ORRS r0, r1': [t.orrs(0, 1), (x, y) => logic(x | y)],
  'EORS r0, r1': [t.eors(0, 1), (x, y) => logic(x ^ y)],
  'BICS r0, r1': [t.bics(0, 1), (x, y) => logic(x & ~y)],
  'MVNS r0, r1': [t.mvns(0, 1), (x, y) => logic(~y)],
  'TST r0, r1': [t.tst(0, 1), (x, y) => ({ ...logic(x & y), kept: x })],
  'MULS r0, r1': [t.muls(0, 1), (x, y) => logic(Math.imul(x, y))],
  'LSLS r0, r1': [t.lsls(0, 1), shift('lsl')],
  'LSRS r0, r1': [t.lsrs(0, 1), shift('lsr')],
  'ASRS r0, r1': [t.asrs(0, 1), shift('asr')],
  'RORS r0, r1': [t.rors(0, 1), shift('ror')],
  'LSLS r0, r0, #7': [t.lslsImm(0, 0, 7), (x, _, c) => shift('lsl')(x, 7, c)],
  'LSRS r0, r0, #7': [t.lsrsImm(0, 0, 7), (x, _, c) => shift('lsr')(x, 7, c)],
  'LSRS r0, r0, #32': [t.lsrsImm(0, 0, 0), (x, _, c) => shift('lsr')(x, 32, c)],
  'ASRS r0, r0, #7': [t.asrsImm(0, 0, 7), (x, _, c) => shift('asr')(x, 7, c)],
  'ASRS r0, r0, #32': [t.asrsImm(0, 0, 0), (x, _, c) => shift('asr')(x, 32, c)],
};

test('arithmetic, logic and shifts give correct results and flags for corner values in one cycle', () => {
  const { core } = t.boardWith([]);
  for (const [name, [instruction, reference]] of Object.entries(OPERATIONS)) {
    for (const x of CORNERS) {
      for (const y of CORNERS) {
        for (const carry of [0, 1]) {
          const actual = execute(core, instruction, x, y, carry);
          const { result, C = carry === 1, V = false, kept = result } = reference(x, y, carry);
          const expected = { result: kept, flags: { N: result >= 0x8000_0000, Z: result === 0, C, V }, cycles: 1 };
          assert.deepEqual(actual, expected, `${name} with ${x.toString(16)}, ${y.toString(16)}, carry ${carry}`);
        }
      }
    }
  }
});

test('REV and extend instructions give correct results', () => {
  const { core } = t.boardWith([]);
  const cases = {
    REV: [0xba08, (x) => ((x << 24) | ((x & 0xff00) << 8) | ((x >>> 8) & 0xff00) | (x >>> 24)) >>> 0],
    REV16: [0xba48, (x) => (((x & 0x00ff_00ff) << 8) | ((x >>> 8) & 0x00ff_00ff)) >>> 0],
    REVSH: [0xbac8, (x) => ((((x & 0xff) << 24) >> 16) | ((x >>> 8) & 0xff)) >>> 0],
    SXTH: [0xb208, (x) => ((x << 16) >> 16) >>> 0],
    SXTB: [0xb248, (x) => ((x << 24) >> 24) >>> 0],
    UXTH: [0xb288, (x) => x & 0xffff],
    UXTB: [0xb2c8, (x) => x & 0xff],
  };
  for (const [name, [instruction, reference]] of Object.entries(cases)) {
    for (const x of [...CORNERS, 0x1234_5678, 0x89ab_cdef, 0x0000_80ff]) {
      const { result } = execute(core, instruction, 0, x, 0);
      assert.equal(result, reference(x), `${name} of ${x.toString(16)}`);
    }
  }
});

test('each condition branches on its flags and on no others', () => {
  const { core } = t.boardWith([]);
  const holds = [
    ({ Z }) => Z,
    ({ C }) => C,
    ({ N }) => N,
    ({ V }) => V,
    ({ C, Z }) => C && !Z,
    ({ N, V }) => N === V,
    ({ N, V, Z }) => N === V && !Z,
  ];
  const at = 0x2000_1000;
  for (let condition = 0; condition < 14; condition += 1) {
    for (let bits = 0; bits < 16; bits += 1) {
      const flags = { N: (bits & 8) !== 0, Z: (bits & 4) !== 0, C: (bits & 2) !== 0, V: (bits & 1) !== 0 };
      core.writeUint16(at, 0xd000 | (condition << 8) | 0x80);
      Object.assign(core, flags);
      core.registers[15] = at;
      core.step();
      const taken = holds[condition >> 1](flags) !== ((condition & 1) === 1);
      assert.equal(core.registers[15], taken ? at + 4 - 256 : at + 2, `condition ${condition}, flags ${bits}`);
    }
  }
});

test('BL branches forward and backward and links to the next instruction', () => {
  const { core } = t.boardWith([]);
  const at = 0x2000_1000;
  for (const offset of [4, 0x2000, -0x800, 0x3_0000 - 4, -0x0fe0]) {
    t.bl(offset).forEach((half, i) => core.writeUint16(at + 2 * i, half));
    core.registers[15] = at;
    core.step();
    assert.deepEqual([core.registers[15], core.registers[14]], [at + offset, (at + 4) | 1], `${offset}`);
  }
});

test('loads of signed bytes and half-words extend the sign', () => {
  const { core } = t.boardWith([]);
  core.writeUint32(RAM, 0x8081_ff7f);
  const load = (instruction, index) => execute(core, instruction, RAM, index, 0).result;
  const [LDRSB, LDRSH, LDRB, LDRH] = [0x5640, 0x5e40, 0x5c40, 0x5a40];
  assert.deepEqual(
    [0, 1, 2, 3].map((i) => load(LDRSB, i)),
    [0x7f, 0xffff_ffff, 0xffff_ff81, 0xffff_ff80],
  );
  assert.deepEqual(
    [0, 2].map((i) => load(LDRSH, i)),
    [0xffff_ff7f, 0xffff_8081],
  );
  assert.deepEqual(
    [0, 3].map((i) => load(LDRB, i)),
    [0x7f, 0x80],
  );
  assert.deepEqual(
    [0, 2].map((i) => load(LDRH, i)),
    [0xff7f, 0x8081],
  );
});

const RAM = 0x2000_2000;
const TIMER = 0x4005_4028;
const PIO = 0x5020_0004;
const SIO = 0xd000_0004;

/** Cycles of a sequence's first instruction, with r2 = pointer. */
function cyclesOf(code, pointer = RAM, prepare = () => {}) {
  const { core } = t.boardWith([code]);
  core.registers[2] = pointer;
  core.registers[3] = t.CODE | 1;
  core.registers[14] = t.CODE | 1;
  prepare(core);
  return core.step();
}

test('cycles are those of the Cortex-M0+ manual, table 3-1, with a bus that never waits', () => {
  assert.equal(cyclesOf(t.movs(0, 1)), 1);
  assert.equal(cyclesOf(t.muls(0, 1)), 1);
  assert.equal(cyclesOf(t.ldr(0, 2)), 2, 'LDR');
  assert.equal(cyclesOf(t.str(0, 2)), 2, 'STR');
  assert.equal(cyclesOf(t.ldr(0, 2), SIO), 1, 'LDR of SIO');
  assert.equal(cyclesOf(t.str(0, 2), SIO + 0x18), 1, 'STR to SIO');
  assert.equal(cyclesOf(t.ldr(0, 2), PIO), 2, 'LDR of a PIO');
  assert.equal(cyclesOf(t.ldr(0, 2), TIMER), 4, 'LDR over the APB bridge: three cycles of the bus (datasheet 2.1.3)');
  assert.equal(cyclesOf(t.str(0, 2), TIMER + 0x10), 5, 'STR over the APB bridge: four');
  assert.equal(cyclesOf(t.ldm(2, 0, 1, 3)), 4, 'LDM: 1 + N');
  assert.equal(cyclesOf(t.stm(2, 0, 1, 3)), 4, 'STM: 1 + N');
  assert.equal(cyclesOf(t.push(0, 1, 14)), 4, 'PUSH: 1 + N, LR counted');
  assert.equal(cyclesOf(t.pop(0, 1)), 3, 'POP: 1 + N');
  const returnTo = (core) => {
    core.registers[13] = RAM;
    core.writeUint32(RAM + 8, t.CODE | 1);
  };
  assert.equal(cyclesOf(t.pop(0, 1, 15), RAM, returnTo), 6, 'POP with PC: 3 + N, PC counted');
  assert.equal(cyclesOf(t.b(8)), 2);
  assert.equal(
    cyclesOf(t.beq(8), RAM, (core) => (core.Z = true)),
    2,
    'taken',
  );
  assert.equal(
    cyclesOf(t.beq(8), RAM, (core) => (core.Z = false)),
    1,
    'not taken',
  );
  assert.equal(cyclesOf(t.bl(8)), 3);
  assert.equal(cyclesOf(t.bx(3)), 2);
  assert.equal(cyclesOf(t.blx(3)), 2);
  assert.equal(cyclesOf(t.mrs(0, t.MSP)), 3);
  assert.equal(cyclesOf(t.msr(t.PRIMASK, 0)), 3);
  assert.equal(cyclesOf(t.DSB), 3);
  assert.equal(cyclesOf(t.CPSID), 1);
  assert.equal(cyclesOf(t.SEV), 1);
});

test('STM with its base as the first register stores the original base and writes back', () => {
  const { core } = t.boardWith([t.stm(0, 0, 1)]);
  core.registers[0] = RAM;
  core.registers[1] = 7;
  core.step();
  assert.deepEqual([core.readUint32(RAM), core.readUint32(RAM + 4), core.registers[0]], [RAM, 7, RAM + 8]);
});

test('a store takes effect at the end of its last cycle, and a load reads at the start of its last cycle', () => {
  // Each store toggles GPIO 9: the stamps are the last cycles of the two one-cycle stores.
  const board = t.boardWith([t.NOP, t.str(1, 0, 0x1c), t.NOP, t.str(1, 0, 0x1c)], { options: { pins: { out: 9 } } });
  board.poke(0x4001_4004 + 8 * 9, 5);
  board.poke(0xd000_0020, 1 << 9);
  board.core.registers[0] = 0xd000_0000;
  board.core.registers[1] = 1 << 9;
  board.run({ cycles: 10 });
  assert.deepEqual(board.edges.track('out').cycles, [1, 3]);

  // The timer counts 125 cycles a microsecond; a load of four cycles from cycle 122 has its last in 125.
  const timed = t.boardWith([t.ldr(1, 0)]);
  timed.core.registers[0] = TIMER;
  timed.cycle = 122;
  timed.run({ cycles: 4 });
  assert.equal(timed.core.registers[1], 1);
  const early = t.boardWith([t.ldr(1, 0)]);
  early.core.registers[0] = TIMER;
  early.cycle = 121;
  early.run({ cycles: 4 });
  assert.equal(early.core.registers[1], 0);
});

test('two stores that enable a machine in each block start them two cycles apart, after the end of each store', () => {
  const board = t.boardWith([t.NOP, t.str(2, 0), t.str(2, 1)], { options: { pins: { a: 4, b: 5 } } });
  [0, 1].forEach((block) => {
    pio.givePins(board, block, [4 + block]);
    pio.makeOutputs(board, block, 0, [4 + block]);
    pio.load(board, block, [pio.set('pins', 1), pio.jmp('always', 1)]);
    pio.configure(board, block, 0, { wrapTop: 1, setBase: 4 + block, setCount: 1 });
    board.core.registers[block] = pio.PIO_BASE[block];
  });
  board.core.registers[2] = 1;
  board.run({ cycles: 12 });
  // NOP in cycle 0, stores in 1 to 2 and 3 to 4; the first instruction in the cycle after.
  assert.deepEqual([board.edges.to('a', 1), board.edges.to('b', 1)], [[3], [5]]);
});

test('instructions that fault on the chip fault here and stack their address', () => {
  const cases = {
    'unaligned load': [t.ldr(0, 2), RAM + 2],
    'unmapped load': [t.ldr(0, 2), 0x3000_0000],
    'store to flash': [t.str(0, 2), 0x1000_0000],
    'undefined instruction': [t.UDF, RAM],
    breakpoint: [t.BKPT, RAM],
    'branch to ARM state': [t.bx(2), RAM],
  };
  for (const [name, [instruction, pointer]] of Object.entries(cases)) {
    const board = t.boardWith([t.NOP, instruction]);
    board.core.registers[2] = pointer;
    board.run({ cycles: 30 });
    assert.equal(board.core.IPSR, 3, name);
    assert.equal(board.core.readUint32(board.core.registers[13] + 0x18), t.CODE + 2, name);
    assert.equal(board.events.filter(({ kind }) => kind === 'fault').length, 1, name);
  }
});

test('a fault within HardFault locks the processor up, which ends the run', () => {
  const board = t.boardWith([t.UDF], { handlers: { 3: [t.UDF] } });
  assert.equal(board.run({ cycles: 1000 }).reason, 'lockup');
});
