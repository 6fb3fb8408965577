// The firmware's part of a USB driver, for tests without firmware. It writes registers and buffers in the order in which
// embassy-rp 0.10 does, and acts on interrupts alone. It is a serial port that sends back each packet it gets.

const REGISTERS = 0x5011_0000;
const SET = 0x2000;
const CLEAR = 0x3000;
const DPRAM = 0x5010_0000;
const IRQ_LINE = 5;
const LATENCY_CYCLES = 125;

export const [ADDR_ENDP, MAIN_CTRL, SIE_CTRL, SIE_STATUS, BUFF_STATUS, EP_STALL_ARM] = [0x00, 0x40, 0x4c, 0x50, 0x58, 0x68];
export const [USB_MUXING, USB_PWR, INTR, INTE, INTS] = [0x74, 0x78, 0x8c, 0x90, 0x98];
export const [BUS_RESET, SETUP_REC, RESUME, SUSPENDED] = [19, 17, 11, 4].map((bit) => 1 << bit);
export const [INT_SETUP, INT_RESUME, INT_SUSPEND, INT_RESET, INT_BUFFERS] = [16, 15, 14, 12, 4].map((bit) => 1 << bit);
export const [FULL, DATA1, STALL, AVAILABLE, LENGTH] = [1 << 15, 1 << 13, 1 << 11, 1 << 10, 0x3ff];
const ENABLE = 1 << 31;
const CONTROL_PACKET = 64;

const [OUT, IN] = [1, 2];
const DEVICE = [18, 1, 0, 2, 0xef, 2, 1, 64, 0x34, 0x12, 0x78, 0x56, 0, 1, 0, 3, 0, 1];
const INTERFACES = [
  [9, 4, 0, 0, 1, 2, 2, 0, 0],
  [7, 5, 0x83, 3, 8, 0, 255],
  [9, 4, 1, 0, 2, 10, 0, 0, 0],
  [7, 5, OUT, 2, 64, 0, 0],
  [7, 5, 0x80 | IN, 2, 64, 0, 0],
].flat();
const CONFIGURATION = [9, 2, 9 + INTERFACES.length, 0, 2, 1, 0, 0xc0, 50, ...INTERFACES];
const NAME = [10, 3, 0x65, 0, 0x63, 0, 0x68, 0, 0x6f, 0]; // "echo"
const DESCRIPTORS = { 1: DEVICE, 2: CONFIGURATION, 3: NAME };

export class UsbDriver {
  /** `override`: whether VBUS is assumed to be present, as embassy-rp does. */
  constructor(board, { override = true } = {}) {
    this.board = board;
    this.override = override;
    /** Events of the bus, as the driver reports them: 'reset', 'suspend', 'resume'. */
    this.events = [];
    this.lines = [];
    this.echoing = true;
    this.packets = [];
    this.poll = null;
  }

  // ---- registers ----

  read(offset) {
    return this.board.chip.readUint32(REGISTERS + offset) >>> 0;
  }

  write(offset, value, alias = 0) {
    this.board.chip.writeUint32(REGISTERS + alias + offset, value >>> 0);
  }

  buffer(endpoint, out) {
    return this.board.chip.readUint32(DPRAM + 0x80 + 8 * endpoint + (out ? 4 : 0)) >>> 0;
  }

  setBuffer(endpoint, out, value) {
    this.board.chip.writeUint32(DPRAM + 0x80 + 8 * endpoint + (out ? 4 : 0), value >>> 0);
  }

  /** The other fields come before AVAILABLE (datasheet, 4.1.2.5.1). */
  give(endpoint, out, value) {
    this.setBuffer(endpoint, out, value);
    this.setBuffer(endpoint, out, value | AVAILABLE);
  }

  enable(endpoint, out, on) {
    const at = DPRAM + 8 * endpoint + (out ? 4 : 0);
    const value = this.board.chip.readUint32(at);
    this.board.chip.writeUint32(at, (on ? value | ENABLE : value & ~ENABLE) >>> 0);
  }

  memory(endpoint) {
    return endpoint === 0 ? 0x100 : 0x180 + 64 * endpoint;
  }

  // ---- the firmware's actions ----

  start() {
    for (let offset = 0; offset < 0x9c; offset += 4) this.write(offset, 0);
    for (let at = 0; at < 0x100; at += 4) this.board.chip.writeUint32(DPRAM + at, 0);
    this.write(USB_MUXING, 9);
    this.write(USB_PWR, this.override ? 0xc : 0);
    this.write(MAIN_CTRL, 1);
    for (const [endpoint, out] of [[OUT, true], [IN, false]]) {
      const control = (1 << 29) | (2 << 26) | this.memory(endpoint);
      this.board.chip.writeUint32(DPRAM + 8 * endpoint + (out ? 4 : 0), control >>> 0);
    }
    this.write(INTE, INT_RESET | INT_BUFFERS | INT_RESUME | INT_SUSPEND | INT_SETUP);
    this.write(SIE_CTRL, (1 << 29) | (1 << 16));
    this.stage = 'idle';
    const poll = this.board.clock.createAlarm(() => {
      if ((this.board.core.lines >>> IRQ_LINE) & 1) this.interrupt();
      poll.schedule(8 * LATENCY_CYCLES);
    });
    this.poll = poll;
    poll.schedule(8 * LATENCY_CYCLES);
    return this;
  }

  interrupt() {
    const raised = this.read(INTS);
    for (const bit of [INT_RESET, INT_RESUME, INT_SUSPEND, INT_SETUP]) if (raised & bit) this.write(INTE, bit, CLEAR);
    if (raised & INT_BUFFERS) this.write(BUFF_STATUS, this.read(BUFF_STATUS));
    this.pollBus();
    this.pollControl();
    this.pollEcho();
  }

  pollBus() {
    for (;;) {
      const status = this.read(SIE_STATUS);
      if (status & RESUME) {
        this.write(SIE_STATUS, RESUME);
        this.events.push('resume');
      } else if (status & BUS_RESET) {
        this.write(SIE_STATUS, BUS_RESET | SETUP_REC);
        this.write(BUFF_STATUS, 0xffff_ffff);
        this.write(ADDR_ENDP, 0);
        this.enable(OUT, true, false);
        this.enable(IN, false, false);
        this.stage = 'idle';
        this.packets = [];
        this.events.push('reset');
      } else if (status & SUSPENDED) {
        this.write(SIE_STATUS, SUSPENDED);
        this.events.push('suspend');
      } else {
        this.write(INTE, INT_RESET | INT_RESUME | INT_SUSPEND, SET);
        return;
      }
    }
  }

  pollControl() {
    if (this.stage === 'data' && !(this.buffer(0, false) & AVAILABLE)) this.nextData();
    if (this.stage === 'data out' && !(this.buffer(0, true) & AVAILABLE)) this.accept();
    if (this.stage === 'status' && !(this.buffer(0, false) & AVAILABLE)) {
      if (this.address !== null) this.write(ADDR_ENDP, this.address);
      this.stage = 'idle';
    }
    if (this.stage !== 'idle') return;
    this.write(INTE, INT_SETUP, SET);
    if (!(this.read(SIE_STATUS) & SETUP_REC)) return;
    const setup = this.board.chip.usbDPRAM.slice(0, 8);
    this.write(SIE_STATUS, SETUP_REC);
    this.setBuffer(0, false, 0);
    this.setBuffer(0, true, 0);
    this.handle(setup[0], setup[1], setup[2] | (setup[3] << 8), setup[4], setup[6] | (setup[7] << 8));
  }

  handle(type, request, value, index, length) {
    this.address = null;
    if (type === 0x80 && request === 6 && DESCRIPTORS[value >> 8]) {
      this.data = DESCRIPTORS[value >> 8].slice(0, length);
      this.stage = 'data';
      this.nextData();
    } else if (type === 0 && request === 5) {
      this.address = value;
      this.accept();
    } else if (type === 0 && request === 9) {
      this.configure();
      this.accept();
    } else if (type === 2 && request === 1) {
      this.setBuffer(index & 15, !(index & 0x80), this.buffer(index & 15, !(index & 0x80)) & ~STALL);
      this.accept();
    } else if (type === 0x21 && length > 0) {
      this.stage = 'data out';
      this.give(0, true, DATA1 | CONTROL_PACKET);
    } else if (type === 0x21) {
      this.lines.push(value);
      this.accept();
    } else {
      this.write(EP_STALL_ARM, 3, SET);
      for (const out of [true, false]) this.setBuffer(0, out, this.buffer(0, out) | STALL);
    }
  }

  nextData() {
    if (this.data === null) {
      this.stage = 'idle';
      return;
    }
    const chunk = this.data.splice(0, CONTROL_PACKET);
    this.board.chip.usbDPRAM.set(chunk, this.memory(0));
    this.give(0, false, (~this.buffer(0, false) & DATA1) | FULL | chunk.length);
    if (this.data.length === 0) {
      this.data = null;
      this.give(0, true, DATA1);
    }
  }

  accept() {
    this.stage = 'status';
    this.give(0, false, DATA1 | FULL);
  }

  configure() {
    this.enable(IN, false, true);
    this.setBuffer(IN, false, DATA1);
    this.enable(OUT, true, true);
    this.give(OUT, true, 64);
  }

  pollEcho() {
    if (!this.echoing) return;
    const [out, back] = [this.buffer(OUT, true), this.buffer(IN, false)];
    const enabled = this.board.chip.readUint32(DPRAM + 8 * OUT + 4) & ENABLE;
    if (enabled && !(out & AVAILABLE) && this.packets.length < 2) {
      const at = this.memory(OUT);
      const bytes = this.board.chip.usbDPRAM.slice(at, at + (out & LENGTH));
      this.packets.push(bytes);
      // A packet that fills its buffer is followed by an empty one, so that the other end recognises the end of the
      // data.
      if (bytes.length === 64) this.packets.push(new Uint8Array(0));
      this.give(OUT, true, (~out & DATA1) | 64);
    }
    if (this.packets.length > 0 && !(back & AVAILABLE)) this.send(this.packets.shift());
  }

  /** Gives the controller a packet to send. */
  send(bytes) {
    this.board.chip.usbDPRAM.set(bytes, this.memory(IN));
    this.give(IN, false, (~this.buffer(IN, false) & DATA1) | FULL | bytes.length);
  }

  stall(endpoint, out) {
    this.setBuffer(endpoint, out, this.buffer(endpoint, out) | STALL);
  }
}
