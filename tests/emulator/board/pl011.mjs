// The UART of the RP2040 (PL011, ARM DDI 0183; RP2040 datasheet, 4.2): FIFOs of 32, bytes that take time on the wire, interrupts
// at levels, the receive timeout, errors with their bytes, DREQs. It replaces rp2040js's own, which sends in no time, raises TXRIS
// again at every look, and has no receive timeout. With that one, the tail of a message never reaches a driver that waits for
// either (embassy-rp's BufferedUart).
//
// Loopback, IrDA, and flow control by RTS and CTS are not modelled, and refused. Modem signals read as off. The levels of the pins
// do not follow the frames.

import { BasePeripheral } from 'rp2040js';
import { NANOS_PER_CYCLE } from './clock.mjs';

const IRQ_UART0 = 20;
const DREQ_UART0_TX = 20;
const FUNCTION_UART = 2;

const [DR, RSR, FR, IBRD, FBRD, LCR_H, CR] = [0x00, 0x04, 0x18, 0x24, 0x28, 0x2c, 0x30];
const [IFLS, IMSC, RIS, MIS, ICR, DMACR] = [0x34, 0x38, 0x3c, 0x40, 0x44, 0x48];
const IDENTITY = 0xfe0;
const IDENTITY_BYTES = [0x11, 0x10, 0x34, 0x00, 0x0d, 0xf0, 0x05, 0xb1];

const [RX, TX, TIMEOUT, FRAMING, PARITY, BREAK, OVERRUN] = [4, 5, 6, 7, 8, 9, 10].map((bit) => 1 << bit);
/** Bits 8 to 11 of DR, and 0 to 3 of RSR. */
const [FRAMING_BYTE, PARITY_BYTE, BREAK_BYTE, OVERRUN_BYTE] = [8, 9, 10, 11].map((bit) => 1 << bit);
const ERRORS_OF = {
  framing: [FRAMING_BYTE, FRAMING],
  parity: [PARITY_BYTE, PARITY],
  break: [BREAK_BYTE | FRAMING_BYTE, BREAK | FRAMING],
};
const [FR_TXFE, FR_RXFF, FR_TXFF, FR_RXFE, FR_BUSY] = [7, 6, 5, 4, 3].map((bit) => 1 << bit);
const [LCR_BREAK, LCR_PARITY, LCR_STOP2, LCR_FIFOS] = [0, 1, 3, 4].map((bit) => 1 << bit);
const LCR_WORD_SHIFT = 5;
const [CR_ENABLE, CR_TX, CR_RX] = [0, 8, 9].map((bit) => 1 << bit);
/** IrDA, loopback, RTS and CTS flow control. */
const CR_REFUSED = (1 << 1) | (1 << 2) | (1 << 7) | (1 << 14) | (1 << 15);
const [DMA_RX, DMA_TX] = [1, 2];

const FIFO_BYTES = 32;
/** Levels of a FIFO by the setting of IFLS: an eighth, a quarter, a half, three quarters, seven eighths. */
const LEVELS = [4, 8, 16, 24, 28];
const TIMEOUT_BITS = 32;
const SAMPLES_PER_BIT = 16;
/** A frame is read in the middle of its last bit, half a bit from its edge. */
const MAX_SKEW_BITS = 0.5;

export class Pl011 extends BasePeripheral {
  constructor(rp2040, index, line) {
    super(rp2040, `UART${index}`);
    const { clock } = rp2040;
    this.index = index;
    this.line = line;
    this.irq = IRQ_UART0 + index;
    this.dreqTx = DREQ_UART0_TX + 2 * index;
    this.dreqRx = this.dreqTx + 1;
    this.integer = 0;
    this.fraction = 0;
    /** The divider in use: the value written before the last write to LCR_H. */
    this.divider = 0;
    this.lineControl = 0;
    this.control = CR_TX | CR_RX;
    this.levels = 0x12;
    this.mask = 0;
    this.raised = 0;
    this.dmaControl = 0;
    this.receiveStatus = 0;
    this.tx = [];
    /** Received characters: data in bits 0 to 7, errors above. */
    this.rx = [];
    this.shifting = null;
    this.overrun = false;
    this.sentAlarm = clock.createAlarm(() => this.sent());
    this.timeoutAlarm = clock.createAlarm(() => this.raise(TIMEOUT));
  }

  get depth() {
    return this.lineControl & LCR_FIFOS ? FIFO_BYTES : 1;
  }

  get txLevel() {
    return this.depth === 1 ? 0 : this.level(this.levels & 7);
  }

  get rxLevel() {
    return this.depth === 1 ? 1 : this.level((this.levels >>> 3) & 7);
  }

  level(setting) {
    if (setting >= LEVELS.length) throw new Error(`${this.name}: IFLS has the reserved setting ${setting}`);
    return LEVELS[setting];
  }

  get bitNanos() {
    return SAMPLES_PER_BIT * this.divider * NANOS_PER_CYCLE;
  }

  /** Bits of a frame: start, data, parity, stop. */
  get frameBits() {
    const { lineControl } = this;
    return 1 + 5 + ((lineControl >>> LCR_WORD_SHIFT) & 3) + (lineControl & LCR_PARITY ? 1 : 0) + (lineControl & LCR_STOP2 ? 2 : 1);
  }

  get dataMask() {
    return (1 << (5 + ((this.lineControl >>> LCR_WORD_SHIFT) & 3))) - 1;
  }

  /** True if a pin carries the signal: TX on GPIO 0, 12, 16, 28 of UART0, 4, 8, 20, 24 of UART1; RX on the next pin. */
  hasPin(offset) {
    return this.rp2040.gpio.some(
      ({ index, functionSelect }) =>
        functionSelect === FUNCTION_UART && index % 4 === offset && (((index + 4) >> 3) & 1) === this.index,
    );
  }

  /** Called by rp2040js; the board's clocks are always at 125 MHz. */
  clkPeriChanged() {}

  // ---- the wires ----

  /** A frame has arrived from the line, whose bits last `bitNanos`. */
  receive(data, error, bitNanos) {
    if (!(this.control & CR_ENABLE) || !(this.control & CR_RX) || !this.hasPin(1)) return;
    const skewBits = (Math.abs(bitNanos - this.bitNanos) / this.bitNanos) * (this.frameBits - 0.5);
    const [flags, interrupts] = ERRORS_OF[skewBits > MAX_SKEW_BITS ? 'framing' : error] ?? [0, 0];
    this.raised |= interrupts;
    if (this.rx.length >= this.depth) {
      this.overrun = true;
      this.raise(OVERRUN);
      return;
    }
    // The overrun is reported with the first character that fits again.
    this.rx.push((data & this.dataMask) | flags | (this.overrun ? OVERRUN_BYTE : 0));
    this.overrun = false;
    this.timeoutAlarm.schedule(TIMEOUT_BITS * this.bitNanos);
    if (this.rx.length >= this.rxLevel) this.raised |= RX;
    this.update();
  }

  /** Begins the next frame if there is one. */
  start() {
    const enabled = this.control & CR_ENABLE && this.control & CR_TX && !(this.lineControl & LCR_BREAK);
    if (this.shifting !== null || this.tx.length === 0 || !enabled) return;
    if (this.divider < 1) throw new Error(`${this.name}: a byte is sent while the baud rate divider is ${this.divider}`);
    const before = this.tx.length;
    this.shifting = this.tx.shift();
    // The transition through the level raises the interrupt, not the level itself.
    if (before > this.txLevel && this.tx.length <= this.txLevel) this.raised |= TX;
    this.sentAlarm.schedule(this.frameBits * this.bitNanos);
  }

  sent() {
    const byte = this.shifting & this.dataMask;
    this.shifting = null;
    this.start();
    this.update();
    if (this.hasPin(0)) this.line.onData(byte);
    else this.warn('a byte was sent, and no pin has its TX');
  }

  // ---- registers ----

  raise(bits) {
    this.raised |= bits;
    this.update();
  }

  update() {
    const { dma } = this.rp2040;
    const request = (on, channel) => (on ? dma.setDREQ(channel) : dma.clearDREQ(channel));
    const on = this.control & CR_ENABLE;
    request(on && this.dmaControl & DMA_TX && this.tx.length < this.depth, this.dreqTx);
    request(on && this.dmaControl & DMA_RX && this.rx.length > 0, this.dreqRx);
    this.rp2040.setInterrupt(this.irq, (this.raised & this.mask) !== 0);
  }

  readData() {
    const character = this.rx.shift() ?? 0;
    this.receiveStatus = character >>> 8;
    if (this.rx.length < this.rxLevel) this.raised &= ~RX;
    if (this.rx.length === 0) {
      this.raised &= ~TIMEOUT;
      this.timeoutAlarm.cancel();
    }
    this.update();
    return character;
  }

  get flags() {
    const { tx, rx, depth } = this;
    return (
      (tx.length === 0 ? FR_TXFE : 0) |
      (rx.length >= depth ? FR_RXFF : 0) |
      (tx.length >= depth ? FR_TXFF : 0) |
      (rx.length === 0 ? FR_RXFE : 0) |
      (this.shifting !== null || tx.length > 0 ? FR_BUSY : 0)
    );
  }

  readUint32(offset) {
    switch (offset) {
      case DR:
        return this.readData();
      case RSR:
        return this.receiveStatus;
      case FR:
        return this.flags;
      case IBRD:
        return this.integer;
      case FBRD:
        return this.fraction;
      case LCR_H:
        return this.lineControl;
      case CR:
        return this.control;
      case IFLS:
        return this.levels;
      case IMSC:
        return this.mask;
      case RIS:
        return this.raised;
      case MIS:
        return this.raised & this.mask;
      case ICR:
        return 0;
      case DMACR:
        return this.dmaControl;
      default:
        return IDENTITY_BYTES[(offset - IDENTITY) / 4] ?? super.readUint32(offset);
    }
  }

  writeUint32(offset, value) {
    switch (offset) {
      case DR:
        if (this.tx.length < this.depth) this.tx.push(value & 0xff);
        else this.warn('a byte was written to a full FIFO');
        if (this.tx.length > this.txLevel) this.raised &= ~TX;
        this.start();
        break;
      case RSR:
        this.receiveStatus = 0;
        break;
      case IBRD:
        this.integer = value & 0xffff;
        break;
      case FBRD:
        this.fraction = value & 0x3f;
        break;
      case LCR_H:
        this.writeLineControl(value & 0xff);
        break;
      case CR:
        if (value & CR_REFUSED) throw new Error(`${this.name}: bits 0x${(value & CR_REFUSED).toString(16)} of CR are not modelled`);
        this.control = value & 0xffff;
        this.start();
        break;
      case IFLS:
        this.levels = value & 0x3f;
        break;
      case IMSC:
        this.mask = value & 0x7ff;
        break;
      case ICR:
        this.raised &= ~this.rawWriteValue;
        break;
      case DMACR:
        this.dmaControl = value & 7;
        break;
      default:
        super.writeUint32(offset, value);
        return;
    }
    this.update();
  }

  writeLineControl(value) {
    const changed = this.lineControl ^ value;
    this.lineControl = value;
    this.divider = this.integer + this.fraction / 64;
    if (changed & LCR_BREAK && this.hasPin(0)) this.line.onBreak((value & LCR_BREAK) !== 0);
    this.start();
  }
}
