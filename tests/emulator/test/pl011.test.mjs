// The UARTs: times on the wire, the interrupts that a driver relies on, errors, DMA.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Board } from '../board/board.mjs';
import { Snapshot } from '../board/snapshot.mjs';

const [DR, FR, IBRD, FBRD, LCR_H, CR, IFLS] = [0x00, 0x18, 0x24, 0x28, 0x2c, 0x30, 0x34];
const [IMSC, RIS, ICR, DMACR] = [0x38, 0x3c, 0x44, 0x48];
const [RX, TX, TIMEOUT, FRAMING, PARITY, BREAK, OVERRUN] = [4, 5, 6, 7, 8, 9, 10].map((bit) => 1 << bit);
const [TXFE, RXFF, TXFF, RXFE, BUSY] = [7, 6, 5, 4, 3].map((bit) => 1 << bit);
const IO_BANK0 = 0x4001_4000;
const FUNCTION_UART = 2;
const PINS = [
  [0, 1],
  [20, 21],
];
/** 921,600 baud as embassy-rp sets it: 125 MHz / 16 / 921,600 = 8 + 31/64. */
const [INTEGER, FRACTION] = [8, 31];
const BIT = 16 * (INTEGER + FRACTION / 64);
const BYTE = 10 * BIT;
const EIGHT_BITS_AND_FIFOS = 0x70;
const ENABLED = 0x301;

/** UART `index` of a board, set up as embassy-rp's BufferedUart does. */
function rig({ index = 1, lineControl = EIGHT_BITS_AND_FIFOS, route = true } = {}) {
  const board = new Board({ bare: true });
  const base = index === 0 ? 0x4003_4000 : 0x4003_8000;
  const write = (offset, value) => board.poke(base + offset, value);
  const read = (offset) => board.peek(base + offset);
  const line = board.serial[index];
  const out = [];
  line.onData = (byte) => out.push({ byte, cycle: board.clock.cycle });
  if (route) for (const pin of PINS[index]) board.poke(IO_BANK0 + 8 * pin + 4, FUNCTION_UART);
  write(IBRD, INTEGER);
  write(FBRD, FRACTION);
  write(LCR_H, lineControl);
  write(IFLS, (2 << 3) | 2);
  write(CR, ENABLED);
  write(IMSC, RX | TIMEOUT | TX);
  const pending = () => (board.core.lines >>> (20 + index)) & 1;
  const wait = (bytes) => board.run({ cycles: Math.ceil(bytes * BYTE) });
  const drain = () => {
    const characters = [];
    while (!(read(FR) & RXFE)) characters.push(read(DR));
    return characters;
  };
  return { board, write, read, line, out, pending, wait, drain };
}

const bytesOf = (count) => Array.from({ length: count }, (_, i) => (i * 37 + (i >> 8)) & 0xff);

/**
 * If this fails, bytes take another time than on a wire, or none, and the firmware can send a wrong number of bytes in a
 * tick.
 */
test('bytes leave one after another, ten bits each', () => {
  for (const index of [0, 1]) {
    const { board, write, read, out, wait } = rig({ index });
    const from = board.cycle;
    for (const byte of bytesOf(5)) write(DR, byte);
    assert.equal(read(FR) & (TXFE | BUSY), BUSY);
    wait(5.5);
    assert.deepEqual(out.map(({ byte }) => byte), bytesOf(5));
    out.forEach(({ cycle }, i) => assert.ok(Math.abs(cycle - from - (i + 1) * BYTE) <= 1 + i, `byte ${i} in cycle ${cycle - from}`));
    assert.equal(read(FR) & (TXFE | BUSY), TXFE);
  }
});

/** If this fails, a divider takes effect before LCR_H is written. On the chip it does not (ARM DDI 0183, 3.3.6). */
test('a divider takes effect with the next write to LCR_H; parity and stop bits lengthen the frame', () => {
  const { board, write, out } = rig();
  const duration = () => {
    const from = board.cycle;
    write(DR, 1);
    const before = out.length;
    board.run({ cycles: 40 * BYTE, until: () => out.length > before, every: 10 });
    return Math.round((out.at(-1).cycle - from) / 16);
  };
  write(IBRD, 20);
  write(FBRD, 0);
  assert.equal(duration(), Math.round(BYTE / 16));
  write(LCR_H, EIGHT_BITS_AND_FIFOS);
  assert.equal(duration(), 200);
  write(LCR_H, EIGHT_BITS_AND_FIFOS | 0b1010);
  assert.equal(duration(), 240);
});

/**
 * If this fails, a driver that leaves the interrupt on (embassy-rp's) is interrupted for ever: rp2040js raises it at every
 * look.
 */
test('the transmit interrupt is raised once when the FIFO falls to its level', () => {
  const { write, read, wait, pending } = rig();
  assert.equal(read(RIS) & TX, 0, 'an empty FIFO raises nothing');
  for (const byte of bytesOf(20)) write(DR, byte);
  assert.equal(pending(), 0);
  wait(2);
  assert.equal(read(RIS) & TX, 0, '17 in the FIFO');
  wait(1.1);
  assert.equal(read(RIS) & TX, TX, '16 in the FIFO');
  assert.equal(pending(), 1);
  write(ICR, TX);
  assert.equal(pending(), 0);
  wait(30);
  assert.equal(read(RIS) & TX, 0, 'cleared, it stays so');
});

/**
 * If this fails, the end of a message shorter than the level never reaches the firmware: rp2040js has no such interrupt.
 */
test('the receive timeout is raised 32 bits after the last byte and cleared when that byte is read', () => {
  const { board, line, read, wait, pending } = rig();
  line.send([1, 2, 3]);
  wait(3);
  board.run({ cycles: Math.floor(31 * BIT) });
  assert.equal(read(RIS), 0);
  board.run({ cycles: Math.ceil(2 * BIT) });
  assert.equal(read(RIS), TIMEOUT);
  assert.equal(pending(), 1);
  assert.deepEqual([read(DR), read(DR)], [1, 2]);
  assert.equal(pending(), 1, 'a byte is left');
  assert.equal(read(DR), 3);
  assert.equal(pending(), 0);
});

/** If this fails, the interrupt comes for each byte, or too late for the bytes that arrive until the firmware reads. */
test('the receive interrupt is raised at sixteen bytes and cleared below sixteen', () => {
  const { line, read, wait, pending } = rig();
  line.send(bytesOf(16));
  wait(15.5);
  assert.equal(read(RIS), 0);
  wait(0.6);
  assert.equal(read(RIS), RX);
  assert.equal(pending(), 1);
  read(DR);
  assert.equal(read(RIS), 0);
});

/** If this fails, firmware that is late loses bytes without an error, or has the error at the wrong byte. */
test('an overrun drops bytes that do not fit and is flagged on the next byte received', () => {
  const { line, read, wait, drain } = rig();
  line.send(bytesOf(35));
  wait(36);
  assert.equal(read(FR) & RXFF, RXFF);
  assert.equal(read(RIS) & OVERRUN, OVERRUN);
  assert.deepEqual(drain(), bytesOf(32));
  line.send([0xaa, 0xbb]);
  wait(3);
  assert.deepEqual(drain(), [0x8aa, 0xbb]);
});

/** If this fails, the firmware is not tested with the errors of a bad cable. */
test('line errors are flagged on their frames, and a wrong baud rate is a framing error', () => {
  const { line, read, wait, drain, write } = rig();
  for (const [error, flags, interrupts] of [['framing', 0x100, FRAMING], ['parity', 0x200, PARITY], ['break', 0x500, BREAK | FRAMING]]) {
    line.sendWithError(error);
    wait(1.1);
    assert.equal(read(RIS) & (FRAMING | PARITY | BREAK), interrupts, error);
    assert.deepEqual(drain(), [flags], error);
    write(ICR, 0x7ff);
  }
  assert.throws(() => line.sendWithError('noise'), /framing, parity, break/);
  for (const [factor, flags] of [[1.03, 0], [0.97, 0], [1.1, 0x100], [0.5, 0x100]]) {
    line.baud = (factor * 125e6) / BIT;
    line.send([0x41]);
    wait(4);
    assert.deepEqual(drain().map((character) => character & 0xf00), [flags], `${factor} of the rate`);
  }
});

/** If this fails, a break of the firmware does not reach the other end. */
test('a break reaches the other end and delays bytes to be sent', () => {
  const { line, write, wait, out } = rig();
  const breaks = [];
  line.onBreak = (on) => breaks.push(on);
  write(LCR_H, EIGHT_BITS_AND_FIFOS | 1);
  write(DR, 7);
  wait(3);
  assert.deepEqual(out, []);
  write(LCR_H, EIGHT_BITS_AND_FIFOS);
  wait(2);
  assert.deepEqual(breaks, [true, false]);
  assert.deepEqual(out.map(({ byte }) => byte), [7]);
});

/** If this fails, a byte is buffered or lost without FIFOs. */
test('without FIFOs there is room for one byte each way', () => {
  const { line, write, read, wait, out, drain } = rig({ lineControl: 0x60 });
  write(DR, 1);
  assert.equal(read(FR) & TXFF, 0, 'it has gone to the shift register');
  write(DR, 2);
  assert.equal(read(FR) & TXFF, TXFF);
  line.send([8, 9]);
  wait(1.1);
  assert.equal(read(RIS) & RX, RX);
  wait(1.1);
  assert.equal(read(RIS) & OVERRUN, OVERRUN);
  assert.deepEqual(drain(), [8]);
  assert.deepEqual(out.map(({ byte }) => byte), [1, 2]);
});

/** If this fails, firmware that has given its UART no pin works here and nowhere else. */
test('a UART without pins neither sends nor receives', () => {
  const { board, line, write, read, wait, out } = rig({ route: false });
  write(DR, 1);
  line.send([2]);
  wait(10);
  assert.deepEqual(out, []);
  assert.equal(read(FR) & RXFE, RXFE);
  assert.equal([...board.warnings.keys()].filter((text) => /UART1.*no pin has its TX/.test(text)).length, 1);
});

/** If this fails, a driver by interrupts alone stops, or loses bytes: embassy-rp's handler does each of these steps. */
test('an interrupt-driven driver receives and sends every byte', () => {
  const { board, line, write, read, out, pending } = rig();
  const handled = [];
  const queue = [];
  const interrupt = () => {
    write(ICR, read(RIS) & ~(RX | TIMEOUT));
    while (!(read(FR) & RXFE)) queue.push(read(DR));
    while (queue.length > 0 && !(read(FR) & TXFF)) write(DR, queue.shift());
    handled.push(board.cycle);
  };
  line.send(bytesOf(1000));
  const end = board.cycle + 1100 * BYTE;
  while (board.cycle < end) {
    board.run({ cycles: 100 });
    if (pending()) interrupt();
  }
  assert.deepEqual(out.map(({ byte }) => byte), bytesOf(1000));
  assert.ok(handled.length < 250, `${handled.length} interrupts`);
});

const channel = (n, register) => 0x5000_0000 + 0x40 * n + register;
const control = (n, dreq, increment) => (dreq << 15) | (n << 11) | (increment << 4) | 1;

/** If this fails, DMA overruns the FIFO, or moves nothing. */
test('DMA keeps the transmitter busy and empties the receiver, at the pace of the line', () => {
  for (const index of [0, 1]) {
    const { board, line, write, wait, out, read } = rig({ index });
    const base = index === 0 ? 0x4003_4000 : 0x4003_8000;
    bytesOf(100).forEach((byte, i) => board.core.writeUint8(0x2000_0000 + i, byte));
    const start = (n, from, to, ctrl) => [from, to, 100, ctrl].forEach((value, i) => board.poke(channel(n, 4 * i), value));
    start(0, 0x2000_0000, base + DR, control(0, 20 + 2 * index, 1));
    start(1, base + DR, 0x2000_1000, control(1, 21 + 2 * index, 2));
    write(DMACR, 3);
    line.send(bytesOf(100));
    wait(50);
    assert.ok(out.length >= 49 && out.length <= 50, `${out.length} bytes sent in the time of 50`);
    wait(52);
    assert.deepEqual(out.map(({ byte }) => byte), bytesOf(100));
    assert.deepEqual(bytesOf(100).map((_, i) => board.core.readUint8(0x2000_1000 + i)), bytesOf(100));
    assert.equal(read(RIS) & OVERRUN, 0);
  }
});

/** If this fails, a reset stops the other end, or leaves the UART in its old state. */
test('during a reset the other end keeps sending, and its bytes are lost', () => {
  const { board, line, read } = rig();
  line.send(bytesOf(100));
  board.run({ cycles: 20 * BYTE });
  board.poke(0x4001_0008, 0x1_fffc);
  board.requestReset('watchdog');
  board.run({ cycles: 20 * BYTE });
  assert.equal(read(CR), 0x300);
  assert.equal(read(FR) & RXFE, RXFE);
  const left = line.waiting.length;
  assert.ok(left < 80, `${left} bytes are left`);
  board.run({ cycles: 200 * BYTE });
  assert.equal(line.waiting.length < left, true);
});

/** If this fails, a snapshot in the middle of a byte loses it, or duplicates it. */
test('a restored snapshot repeats the same bytes in both directions', () => {
  const { board, line, write, out, drain } = rig();
  line.send(bytesOf(30));
  for (const byte of bytesOf(10)) write(DR, byte);
  board.run({ cycles: 3.3 * BYTE });
  const snapshot = new Snapshot({ board, out });
  const goOn = () => {
    board.run({ cycles: 40 * BYTE });
    return [...drain(), ...out.map(({ byte }) => byte)];
  };
  const first = goOn();
  assert.deepEqual(first, [...bytesOf(30), ...bytesOf(10)]);
  snapshot.restore();
  assert.deepEqual(goOn(), first);
});

/** If this fails, firmware that needs a feature outside the model runs on a wrong model. */
test('loopback, flow control and sending without a baud rate are refused', () => {
  const { write } = rig();
  for (const bit of [7, 14, 15]) assert.throws(() => write(CR, ENABLED | (1 << bit)), /UART1.*not modelled/);
  const bare = new Board({ bare: true });
  bare.poke(0x4003_4000 + CR, ENABLED);
  assert.throws(() => bare.poke(0x4003_4000 + DR, 1), /UART0.*divider is 0/);
});
