// The driver of a serial port over USB (CDC-ACM), like that of a PC. It finds the device's interfaces, configures it, sets
// the line coding and DTR, and exchanges bytes.

import { UsbHost } from './usb-host.mjs';

const [DEVICE, CONFIGURATION, STRING, INTERFACE, ENDPOINT] = [1, 2, 3, 4, 5];
const [GET_DESCRIPTOR, SET_ADDRESS, SET_CONFIGURATION] = [6, 5, 9];
const [SET_LINE_CODING, SET_CONTROL_LINE_STATE] = [0x20, 0x22];
const [FROM_DEVICE, CLASS_INTERFACE] = [0x80, 0x21];
const [CLASS_COMM, CLASS_DATA] = [2, 10];
const BULK = 2;
const ADDRESS = 1;
const ENGLISH = 0x0409;
const DEVICE_BYTES = 18;
const HEADER_BYTES = 9;
/** 115,200 baud, one stop bit, no parity, 8 bits: the default of a PC. */
const LINE_CODING = [0x00, 0xc2, 0x01, 0x00, 0, 0, 8];
const DTR_AND_RTS = 3;

export class CdcHost extends UsbHost {
  constructor(board, times) {
    super(board, times);
    /** True while a program has the port open: DTR and RTS. */
    this.opened = false;
    this.reading = true;
    /** Identity of the device, once configured: { vendor, product, name, serial }. */
    this.identity = null;
    this.ready = false;
    /** Called with bytes from the device; when the device becomes usable; when it is no longer usable. */
    this.onData = () => {};
    this.onReady = () => {};
    this.onGone = () => {};
  }

  // ---- for users ----

  /** A program opens the port. */
  open() {
    this.opened = true;
    if (this.ready) this.setLines();
  }

  close() {
    this.opened = false;
    if (this.ready) this.setLines();
  }

  send(bytes, zlp = false) {
    if (!this.ready) throw new Error('USB: nothing can be sent before the device is configured');
    this.write(this.bulkOut, bytes, zlp);
  }

  /** Bytes that the device has not taken yet. */
  get pending() {
    return this.ready ? this.bulkOut.packets.reduce((sum, packet) => sum + packet.length, 0) : 0;
  }

  /** False for a host that does not fetch the device's packets. */
  setReading(on) {
    this.reading = on;
    if (this.ready) this.read(this.bulkIn, on);
  }

  // ---- enumeration ----

  onReset() {
    this.descriptor(DEVICE, 0, CONTROL_MAX, (bytes) => this.readDevice(bytes));
  }

  descriptor(kind, number, length, done, language = 0) {
    this.request({ type: FROM_DEVICE, request: GET_DESCRIPTOR, value: (kind << 8) | number, index: language, length }, done);
  }

  readDevice(first) {
    if (first.length < DEVICE_BYTES) return this.error(`the device descriptor has ${first.length} bytes, not ${DEVICE_BYTES}`);
    this.request({ type: 0, request: SET_ADDRESS, value: ADDRESS });
    this.descriptor(DEVICE, 0, DEVICE_BYTES, (bytes) => {
      const word = (at) => bytes[at] | (bytes[at + 1] << 8);
      this.identity = { vendor: word(8), product: word(10), name: null, serial: null };
      const [nameAt, serialAt] = [bytes[15], bytes[16]];
      if (nameAt) this.string(nameAt, 'name');
      if (serialAt) this.string(serialAt, 'serial');
      this.descriptor(CONFIGURATION, 0, HEADER_BYTES, (header) => {
        this.descriptor(CONFIGURATION, 0, header[2] | (header[3] << 8), (all) => this.configure(all));
      });
    });
    return undefined;
  }

  string(number, key) {
    const use = (bytes) => {
      this.identity[key] = new TextDecoder('utf-16le').decode(Uint8Array.from(bytes.slice(2)));
    };
    this.descriptor(STRING, number, 255, use, ENGLISH);
  }

  configure(bytes) {
    const found = portOf(bytes);
    if (found.problem) return this.error(found.problem);
    this.interface = found.interface;
    this.request({ type: 0, request: SET_CONFIGURATION, value: bytes[5] }, () => {
      this.bulkOut = this.openPipe(found.out.endpoint, true, found.out.packetBytes);
      this.bulkIn = this.openPipe(found.in.endpoint, false, found.in.packetBytes);
    });
    this.request({ type: CLASS_INTERFACE, request: SET_LINE_CODING, index: this.interface, data: LINE_CODING }, () => {
      this.ready = true;
      this.read(this.bulkIn, this.reading);
      if (this.opened) this.setLines();
      this.onReady();
    });
    return undefined;
  }

  setLines() {
    const value = this.opened ? DTR_AND_RTS : 0;
    this.request({ type: CLASS_INTERFACE, request: SET_CONTROL_LINE_STATE, value, index: this.interface });
  }

  // ---- called by the host ----

  onPacket(pipe, bytes) {
    if (bytes.length > 0) this.onData(bytes);
  }

  onHalt(pipe) {
    this.errors.push({ cycle: this.board.cycle, text: `${pipe} was stalled by the device; the host clears it` });
    this.clearHalt(pipe);
  }

  onLost() {
    const was = this.ready;
    this.ready = false;
    this.bulkOut = null;
    this.bulkIn = null;
    if (was) this.onGone();
  }
}

const CONTROL_MAX = 64;

/** Interface and endpoints of the serial port in a configuration descriptor, or { problem }. */
function portOf(bytes) {
  const found = { interface: null, in: null, out: null };
  let data = false;
  for (let at = 0; at + 1 < bytes.length; at += bytes[at]) {
    if (bytes[at] < 2) return { problem: `the configuration descriptor has an entry of ${bytes[at]} bytes at ${at}` };
    const kind = bytes[at + 1];
    if (kind === INTERFACE) {
      data = bytes[at + 5] === CLASS_DATA;
      if (bytes[at + 5] === CLASS_COMM) found.interface = bytes[at + 2];
    }
    if (kind === ENDPOINT && data && (bytes[at + 3] & 3) === BULK) {
      const end = { endpoint: bytes[at + 2] & 15, packetBytes: bytes[at + 4] | (bytes[at + 5] << 8) };
      if (bytes[at + 2] & 0x80) found.in = end;
      else found.out = end;
    }
  }
  const missing = Object.entries(found).filter(([, value]) => value === null);
  if (missing.length > 0) return { problem: `the device is no serial port: its configuration lacks ${missing.map(([key]) => key).join(', ')}` };
  return found;
}
