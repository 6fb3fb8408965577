// PIO instructions as numbers, for tests that need no assembler; and a block driven by poking its registers.
// Encodings: RP2040 datasheet, 3.4.

const JMP = { always: 0, '!x': 1, 'x--': 2, '!y': 3, 'y--': 4, 'x!=y': 5, pin: 6, '!osre': 7 };
const IN = { pins: 0, x: 1, y: 2, null: 3, isr: 6, osr: 7 };
const OUT = { pins: 0, x: 1, y: 2, null: 3, pindirs: 4, pc: 5, isr: 6, exec: 7 };
const MOV_TO = { pins: 0, x: 1, y: 2, exec: 4, pc: 5, isr: 6, osr: 7 };
const MOV_FROM = { pins: 0, x: 1, y: 2, null: 3, status: 5, isr: 6, osr: 7 };
const SET = { pins: 0, x: 1, y: 2, pindirs: 4 };

export const jmp = (condition, target) => (JMP[condition] << 5) | target;
export const waitFor = (polarity, kind, index) =>
  (1 << 13) | (polarity << 7) | ({ gpio: 0, pin: 1, irq: 2 }[kind] << 5) | index;
export const shiftIn = (source, count) => (2 << 13) | (IN[source] << 5) | (count & 31);
export const out = (to, count) => (3 << 13) | (OUT[to] << 5) | (count & 31);
export const push = ({ block = true, ifFull = false } = {}) => (4 << 13) | (ifFull << 6) | (block << 5);
export const pull = ({ block = true, ifEmpty = false } = {}) => (4 << 13) | 0x80 | (ifEmpty << 6) | (block << 5);
export const mov = (to, from, operation = 0) => (5 << 13) | (MOV_TO[to] << 5) | (operation << 3) | MOV_FROM[from];
export const INVERT = 1;
export const REVERSE = 2;
export const irq = (index, { clear = false, wait = false } = {}) => (6 << 13) | (clear << 6) | (wait << 5) | index;
export const set = (to, value) => (7 << 13) | (SET[to] << 5) | value;
export const delay = (instruction, cycles) => instruction | (cycles << 8);
/** Side-set of one optional pin, leaving three bits of delay. */
export const side = (instruction, level) => instruction | (1 << 12) | (level << 11);

export const PIO_BASE = [0x5020_0000, 0x5030_0000];
export const CTRL = 0x00;
export const FSTAT = 0x04;
export const FDEBUG = 0x08;
export const FLEVEL = 0x0c;
export const TXF = 0x10;
export const RXF = 0x20;
export const IRQ = 0x30;
const MEMORY = 0x48;
const SM = 0xc8;
export const SM_BYTES = 0x18;
export const machineRegister = (block, machine, offset) => PIO_BASE[block] + SM + machine * SM_BYTES + offset;
export const ADDR = 0x0c;
export const INSTR = 0x10;

export function load(board, block, program) {
  program.forEach((word, i) => board.poke(PIO_BASE[block] + MEMORY + 4 * i, word));
}

/** Sets a machine up; every option is a field of its registers. */
export function configure(board, block, machine, options) {
  const {
    wrapBottom = 0,
    wrapTop = 31,
    sideOptional = false,
    sideCount = 0,
    sideBase = 0,
    outBase = 0,
    outCount = 0,
    setBase = 0,
    setCount = 0,
    inBase = 0,
    jmpPin = 0,
    inRight = true,
    outRight = true,
    joinTx = false,
    joinRx = false,
    divider = 1,
    start = 0,
  } = options;
  const write = (offset, value) => board.poke(machineRegister(block, machine, offset), value >>> 0);
  write(0x00, divider * 0x1_0000);
  write(0x04, (sideOptional << 30) | (jmpPin << 24) | (wrapTop << 12) | (wrapBottom << 7));
  write(0x08, (joinRx << 31) | (joinTx << 30) | (outRight << 19) | (inRight << 18));
  const pins = (setCount << 26) | (outCount << 20) | (inBase << 15) | (sideBase << 10) | (setBase << 5) | outBase;
  write(0x14, (sideCount << 29) | pins);
  write(INSTR, jmp('always', start));
}

/** Gives pins to a PIO block, with the levels and directions that its machine last set. */
export function givePins(board, block, pins) {
  for (const pin of pins) board.poke(0x4001_4004 + 8 * pin, 6 + block);
}

/** Makes pins outputs, low, by instructions forced on a machine. */
export function makeOutputs(board, block, machine, pins) {
  for (const pin of pins) {
    const register = machineRegister(block, machine, 0x14);
    const before = board.peek(register);
    board.poke(register, ((1 << 26) | (pin << 5)) >>> 0);
    board.poke(machineRegister(block, machine, INSTR), set('pins', 0));
    board.poke(machineRegister(block, machine, INSTR), set('pindirs', 1));
    board.poke(register, before);
  }
}

export const enable = (board, block, mask) => board.poke(PIO_BASE[block] + CTRL, mask);
