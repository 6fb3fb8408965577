// A USB host at the board's connector: attachment, reset, suspend, control transfers, and pipes of bulk packets. The driver for a
// serial port is in usb-cdc.mjs.
//
// All state is kept in properties, none in variables of functions, so that a snapshot of the board includes it (board.usb.host).

const NANOS_PER_MS = 1e6;
const MAX_TRIES = 3; // USB 2.0, 10.2.6
const CONTROL_PACKET = 64;
const TO_HOST = 0x80;
const SET_ADDRESS = 5;
const CLEAR_FEATURE = 1;
const ENDPOINT_RECIPIENT = 2;

/** The shortest times of USB 2.0, 7.1.7, that a host may use, milliseconds. A request ends after 5 s at most (9.2.6.1). */
const TIMES_MS = { debounce: 100, reset: 10, recovery: 10, resume: 20, resumeRecovery: 10, address: 2, request: 5000 };

/** One endpoint's packets: those to send, or whether packets are fetched. */
class Pipe {
  constructor(endpoint, out, packetBytes) {
    this.endpoint = endpoint;
    this.out = out;
    this.packetBytes = packetBytes;
    this.data1 = false;
    this.packets = [];
    this.reading = false;
    this.halted = false;
    this.tries = 0;
    this.done = 0;
  }

  get active() {
    return !this.halted && (this.out ? this.packets.length > 0 : this.reading);
  }

  toString() {
    return `endpoint ${this.endpoint} ${this.out ? 'OUT' : 'IN'}`;
  }
}

export class UsbHost {
  /** `times`: milliseconds that differ from those above. */
  constructor(board, times = {}) {
    this.board = board;
    this.port = board.usb;
    this.times = { ...TIMES_MS, ...times };
    /** Errors, oldest first: [{ cycle, text }]. */
    this.errors = [];
    this.suspended = false;
    this.timer = null;
    this.turn = 0;
    this.forget();
  }

  // ---- methods that a class driver overrides ----

  /** The device has been reset, and has address 0. */
  onReset() {}

  /** The device is gone or was reset: its former state is no longer valid. */
  onLost() {}

  /** A packet came from `pipe`. */
  onPacket(_pipe, _bytes) {}

  /** A packet for `pipe` was taken. */
  onSent(_pipe) {}

  /** `pipe` was stalled by the device. */
  onHalt(_pipe) {}

  /** An error that the host cannot handle. */
  onError(text) {
    throw new Error(`USB: ${text}`);
  }

  // ---- the cable ----

  plug() {
    this.port.plug(this);
  }

  unplug() {
    this.port.unplug();
  }

  resetBus() {
    if (!this.port.attached) throw new Error('USB: no device is there to reset: plug it in, and let its firmware attach');
    this.forget();
    this.onLost();
    this.suspended = false;
    this.port.beginReset();
    this.after(this.times.reset, 'resetEnds');
  }

  suspend() {
    if (!this.port.running) throw new Error('USB: the bus carries nothing that could be suspended: plug the device in, or resume it first');
    if (this.control || this.settling) throw new Error('USB: a request is under way: suspend the bus when it has ended');
    this.suspended = true;
    this.port.suspend();
  }

  resume() {
    if (!this.suspended) throw new Error('USB: the bus is not suspended');
    this.port.beginResume();
    this.after(this.times.resume, 'resumeEnds');
  }

  resumeEnds() {
    this.suspended = false;
    this.port.endResume();
  }

  /** Calls the method `name` after some milliseconds. Replaces the call that was scheduled before. */
  after(ms, name) {
    this.timer?.cancel();
    this.timer = this.board.clock.later(ms * NANOS_PER_MS, () => this[name]());
  }

  attached() {
    this.after(this.times.debounce, 'resetBus');
  }

  detached() {
    this.timer?.cancel();
    this.suspended = false;
    this.forget();
    this.onLost();
  }

  resetEnds() {
    this.port.endReset();
    this.after(this.times.recovery, 'onReset');
  }

  forget() {
    this.address = 0;
    this.pipes = [];
    this.control = null;
    this.requests = [];
    /** True while a device may still be changing to its new address. */
    this.settling = false;
    this.deadline?.cancel();
    this.deadline = null;
  }

  // ---- control transfers ----

  /**
   * Queues a request of the default pipe: { type, request, value, index, length, data }. `done(data)` gets the received data. A
   * request that fails is passed to `failed(text)`, or is an error.
   */
  request(setup, done, failed = (text) => this.error(text)) {
    this.requests.push({ value: 0, index: 0, data: [], ...setup, done, failed });
    this.nextRequest();
  }

  nextRequest() {
    if (this.control || this.settling || this.requests.length === 0) return;
    const transfer = this.requests.shift();
    const toHost = (transfer.type & TO_HOST) !== 0;
    const length = toHost ? transfer.length : transfer.data.length;
    const { type, request, value, index } = transfer;
    const setup = [type, request, value & 0xff, value >> 8, index & 0xff, index >> 8, length & 0xff, length >> 8];
    this.control = { transfer, toHost, length, setup: Uint8Array.from(setup), stage: 'setup', data1: false, bytes: [], at: 0, tries: 0 };
    this.deadline = this.board.clock.later(this.times.request * NANOS_PER_MS, () => this.abandon('no answer in time'));
    this.pump();
  }

  /** The next transaction of the control transfer under way. */
  controlTransaction() {
    const { stage, toHost, setup, data1, at, transfer } = this.control;
    if (stage === 'setup') return { kind: 'setup', bytes: setup };
    if (stage === 'data' && !toHost) return { kind: 'out', data1, bytes: Uint8Array.from(transfer.data.slice(at, at + CONTROL_PACKET)) };
    if (stage === 'data') return { kind: 'in', data1 };
    return toHost ? { kind: 'out', data1: true, bytes: new Uint8Array(0) } : { kind: 'in', data1: true };
  }

  controlAnswered({ kind, bytes }, answer) {
    const { control } = this;
    if (answer.answer === 'stall') return this.abandon('the device refused it (STALL)');
    if (answer.answer === 'nak') return undefined;
    if (answer.answer !== 'ack' && answer.answer !== 'data') {
      control.tries += 1;
      if (control.tries < MAX_TRIES) return undefined;
      return this.abandon(`no answer from address ${this.address} in its ${control.stage} stage, ${MAX_TRIES} times`);
    }
    control.tries = 0;
    if (kind === 'in' && answer.data1 !== control.data1) return this.abandon(`a packet of its ${control.stage} stage has the wrong DATA PID`);
    if (control.stage === 'status') return this.controlDone();
    if (control.stage === 'setup') {
      control.stage = control.length > 0 ? 'data' : 'status';
      control.data1 = true;
      return undefined;
    }
    control.data1 = !control.data1;
    const packet = answer.bytes ?? bytes;
    control.at += packet.length;
    if (kind === 'in') control.bytes.push(...packet);
    if (control.at >= control.length || (kind === 'in' && packet.length < CONTROL_PACKET)) {
      control.stage = 'status';
      control.data1 = true;
    }
    return undefined;
  }

  controlDone() {
    const { transfer, bytes } = this.control;
    this.endControl();
    if (transfer.type === 0 && transfer.request === SET_ADDRESS) {
      this.address = transfer.value;
      this.settling = true;
      this.after(this.times.address, 'settled');
    }
    transfer.done?.(bytes);
    this.nextRequest();
  }

  settled() {
    this.settling = false;
    this.nextRequest();
  }

  endControl() {
    this.deadline.cancel();
    this.control = null;
  }

  abandon(why) {
    const { transfer } = this.control;
    const { type, request, value } = transfer;
    this.endControl();
    const hex = (number) => `0x${number.toString(16)}`;
    transfer.failed(`request ${hex(request)} (type ${hex(type)}, value ${hex(value)}) failed: ${why}`);
    this.nextRequest();
  }

  // ---- pipes ----

  openPipe(endpoint, out, packetBytes) {
    const pipe = new Pipe(endpoint, out, packetBytes);
    this.pipes.push(pipe);
    return pipe;
  }

  /** Sends bytes as packets, the last of them short: empty if need be and `zlp`. */
  write(pipe, bytes, zlp = false) {
    for (let at = 0; at < bytes.length; at += pipe.packetBytes) pipe.packets.push(Uint8Array.from(bytes.slice(at, at + pipe.packetBytes)));
    if (zlp && bytes.length % pipe.packetBytes === 0) pipe.packets.push(new Uint8Array(0));
    this.pump();
  }

  /** Fetches packets of an IN pipe, or leaves them with the device. */
  read(pipe, on) {
    pipe.reading = on;
    this.pump();
  }

  /** Ends a stall of a pipe; its packets begin with DATA0 again (USB 2.0, 9.4.5). */
  clearHalt(pipe) {
    const index = pipe.endpoint | (pipe.out ? 0 : TO_HOST);
    this.request({ type: ENDPOINT_RECIPIENT, request: CLEAR_FEATURE, index }, () => {
      pipe.halted = false;
      pipe.data1 = false;
      this.pump();
    });
  }

  pipeAnswered(pipe, answer) {
    switch (answer.answer) {
      case 'ack':
        this.advance(pipe);
        pipe.packets.shift();
        this.onSent(pipe);
        break;
      case 'data':
        if (answer.data1 !== pipe.data1) {
          this.error(`${pipe}: a packet with the wrong DATA PID, which a host drops as one that it has`);
          break;
        }
        this.advance(pipe);
        this.onPacket(pipe, answer.bytes);
        break;
      case 'stall':
        pipe.halted = true;
        this.onHalt(pipe);
        break;
      case 'babble':
        pipe.halted = true;
        this.error(`${pipe}: a packet of ${pipe.packets[0].length} bytes does not fit the device's buffer`);
        break;
      case 'none':
        pipe.tries += 1;
        if (pipe.tries < MAX_TRIES) break;
        pipe.halted = true;
        this.error(`${pipe}: no answer from address ${this.address}, ${MAX_TRIES} times`);
        break;
      default:
    }
  }

  advance(pipe) {
    pipe.data1 = !pipe.data1;
    pipe.tries = 0;
    pipe.done += 1;
  }

  // ---- the wire ----

  /** Begins the next transaction if the wire is free: the default pipe first, then the others in turn. */
  pump() {
    const { port } = this;
    if (!port.running || port.transaction) return;
    if (this.control && this.begin(0, this.controlTransaction(), null)) return;
    for (let i = 0; i < this.pipes.length; i += 1) {
      const at = (this.turn + i) % this.pipes.length;
      const pipe = this.pipes[at];
      if (!pipe.active) continue;
      const packet = pipe.out ? { kind: 'out', data1: pipe.data1, bytes: pipe.packets[0] } : { kind: 'in', data1: pipe.data1 };
      if (this.begin(pipe.endpoint, packet, pipe)) {
        this.turn = at + 1;
        return;
      }
    }
  }

  /** Puts a transaction on the wire unless the device would answer it with NAK. */
  begin(endpoint, packet, pipe) {
    const { device } = this.port;
    const out = packet.kind !== 'in';
    const state = packet.kind === 'setup' ? 'ready' : device.answer(this.address, endpoint, out);
    if (state === 'nak') return false;
    const length = out ? packet.bytes.length : device.packetBytes(endpoint, state);
    this.port.transact({ ...packet, address: this.address, endpoint, pipe }, length);
    return true;
  }

  answered(transaction, answer) {
    if (transaction.pipe) this.pipeAnswered(transaction.pipe, answer);
    else if (this.control) this.controlAnswered(transaction, answer);
    this.pump();
  }

  changed() {
    this.pump();
  }

  error(text) {
    this.errors.push({ cycle: this.board.cycle, text });
    this.onError(text);
  }
}
