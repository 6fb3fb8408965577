// The board's USB connector: the traffic on the cable, and its duration. It belongs to the board, not to the chip: a cable stays
// plugged in over resets.
//
// One transaction at a time, at full speed (12 Mbit/s), each within a frame of 1 ms. A transaction takes (13 + n) bytes for n
// bytes of data: three synchronisation patterns and PIDs, address and CRCs, turn-arounds (USB 2.0, 5.8.4). Stuffed bits are not
// counted. The host's tries that are answered with NAK take no time: a transaction begins as soon as the endpoint is ready and the
// wire is free.
//
// The port calls `host` (bench/usb-host.mjs) back: attached(), detached() for the pull-up; changed() when the answer of an
// endpoint may have changed; answered(transaction, answer).

import { CYCLES_PER_SECOND, NANOS_PER_CYCLE } from './clock.mjs';
import { J, K, SE0 } from './usb-device.mjs';

const BITS_PER_SECOND = 12e6;
const OVERHEAD_BYTES = 13;
const FRAME_CYCLES = CYCLES_PER_SECOND / 1000;
/** SYNC, PID, frame number and CRC, end of packet, and the gap behind it. */
const START_OF_FRAME_BYTES = 6;
const FRAME_MASK = 0x7ff;

const cyclesFor = (bytes) => Math.ceil((bytes * 8 * CYCLES_PER_SECOND) / BITS_PER_SECOND);

/** Cycles of a transaction with so many bytes of data. */
export const transactionCycles = (bytes) => cyclesFor(OVERHEAD_BYTES + bytes);

export class UsbPort {
  constructor(board) {
    this.board = board;
    this.host = null;
    this.device = null;
    this.plugged = false;
    /** True while the host sends frames: after a reset, unless suspended. */
    this.running = false;
    this.line = J;
    this.frameOrigin = 0;
    /** The device's pull-up, and whether a host detects it. */
    this.pulling = false;
    this.attached = false;
    /** The transaction on the wire, or null, and the alarm of its end. */
    this.transaction = null;
    this.end = null;
    /** Transactions from now on that are lost to noise. */
    this.noisy = 0;
  }

  /** A chip came out of reset: its controller is on the port now, with its pull-up off. */
  connect(device) {
    this.device = device;
    this.pullChanged();
  }

  // ---- called by the device ----

  /** An endpoint has a buffer, stalls or is enabled, or the address changed. */
  changed() {
    if (this.running) this.host?.changed();
  }

  /** The pull-up may have been switched. */
  pullChanged() {
    const pulling = this.device.pullsUp;
    if (pulling && !this.pulling && !this.running) this.device.idle();
    this.pulling = pulling;
    const attached = this.plugged && pulling;
    if (attached === this.attached) return;
    this.attached = attached;
    if (attached) {
      this.host.attached();
    } else {
      this.silence();
      this.host.detached();
    }
  }

  get lineState() {
    if (!this.device.pullsUp) return SE0;
    return this.plugged ? this.line : J;
  }

  /** Number of the present frame. */
  get frame() {
    if (!this.running) return 0;
    return Math.floor((this.board.clock.cycle - this.frameOrigin) / FRAME_CYCLES) & FRAME_MASK;
  }

  // ---- called by the host ----

  plug(host) {
    this.host = host;
    this.plugged = true;
    this.device.plugChanged();
    this.pullChanged();
  }

  /** Without a host a device that still pulls up is on an idle bus. */
  unplug() {
    this.plugged = false;
    this.silence();
    this.device.plugChanged();
    this.device.idle();
    this.pullChanged();
  }

  /** The host drives SE0, which is a reset, until `endReset`. */
  beginReset() {
    this.silence();
    this.line = SE0;
    this.device.busReset();
  }

  endReset() {
    this.line = J;
    this.start();
  }

  /** The host stops sending frames. */
  suspend() {
    this.silence();
    this.device.idle();
  }

  /** The host drives K, which resumes, until `endResume`. */
  beginResume() {
    this.line = K;
    this.device.active(true);
  }

  endResume() {
    this.line = J;
    this.start();
  }

  start() {
    this.running = true;
    this.frameOrigin = this.board.clock.cycle;
    this.device.active(false);
    this.host.changed();
  }

  silence() {
    this.running = false;
    this.line = J;
    this.transaction = null;
    this.end?.cancel();
    this.end = null;
  }

  /**
   * Carries out { kind: 'setup' | 'out' | 'in', address, endpoint, data1, bytes } on the wire. At its end `host.answered` gets it
   * with { answer: 'ack' | 'data' | 'nak' | 'stall' | 'none' | 'babble', data1, bytes }. `length` is that of the received packet,
   * for 'in'.
   */
  transact(transaction, length) {
    if (!this.running || this.transaction) throw new Error('USB: a transaction while the wire is not free');
    const duration = transactionCycles(length);
    const { cycle } = this.board.clock;
    const into = (cycle - this.frameOrigin) % FRAME_CYCLES;
    const begin = Math.max(into, cyclesFor(START_OF_FRAME_BYTES));
    const wait = begin + duration > FRAME_CYCLES ? FRAME_CYCLES - into + cyclesFor(START_OF_FRAME_BYTES) : begin - into;
    this.transaction = transaction;
    this.end = this.board.clock.later((wait + duration) * NANOS_PER_CYCLE, () => this.complete());
  }

  complete() {
    const { transaction, device } = this;
    const { kind, address, endpoint, data1, bytes } = transaction;
    this.transaction = null;
    this.end = null;
    const lost = this.noisy > 0;
    if (lost) this.noisy -= 1;
    let answer;
    if (kind === 'in') {
      answer = device.in(address, endpoint, lost);
    } else if (lost) {
      device.corrupted();
      answer = { answer: 'none' };
    } else {
      answer = { answer: kind === 'setup' ? device.setup(address, bytes) : device.out(address, endpoint, data1, bytes) };
    }
    this.host.answered(transaction, answer);
  }
}
