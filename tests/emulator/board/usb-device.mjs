// The USB controller as a device: registers, buffers by ownership, and the answer of each endpoint to the host. It replaces
// rp2040js's own, which gives an OUT buffer back as soon as the firmware makes it available. A driver that waits for AVAILABLE to
// fall (embassy-rp) then takes each buffer for a packet. rp2040js's own also has no bus reset after the first, and no suspend.
//
// A buffer is the controller's from the store that sets AVAILABLE to the end of the transaction that fills or empties it.
// `usb-port.mjs` determines when transactions happen; this file determines their effect.
//
// Convention, where the datasheet (RP2040, 4.1) does not say: a packet with the other DATA PID than that of the buffer control is
// acknowledged and dropped, as USB 2.0 (8.6.4) has it, and sets DATA_SEQ_ERROR. SETUP leaves buffers of endpoint 0 alone.
// SUSPENDED falls with the bus's next activity, unless software has cleared it before.

import { BasePeripheral } from 'rp2040js';

const IRQ_USBCTRL = 5;
const SUSPEND_AFTER_NANOS = 3e6; // USB 2.0, 7.1.7.6

const [ADDR_ENDP, MAIN_CTRL, SOF_RD, SIE_CTRL, SIE_STATUS] = [0x00, 0x40, 0x48, 0x4c, 0x50];
const [BUFF_STATUS, EP_ABORT, EP_STALL_ARM, EP_STATUS_STALL_NAK] = [0x58, 0x60, 0x68, 0x70];
const [USB_PWR, INTR, INTE, INTF, INTS] = [0x78, 0x8c, 0x90, 0x94, 0x98];

const HOST_MODE = 1 << 1;
const SIE_PULLUP = 1 << 16;
const SIE_EP0_PER_BUFFER = 1 << 29;
const SIE_EP0_STALL = 1 << 31;
/** Direct control of the pins, host mode's own bits, remote wake-up, NAK interrupts, two buffers on endpoint 0. */
const SIE_REFUSED = (1 << 30) | (1 << 28) | (1 << 27) | (1 << 26) | (1 << 15) | (1 << 13) | (1 << 12) | (1 << 0);
const PWR_VBUS = 1 << 3;
const PWR_VBUS_OVERRIDE = 1 << 2;

const DATA_SEQ_ERROR = 1 << 31;
const ACK_REC = 1 << 30;
const RX_TIMEOUT = 1 << 27;
const CRC_ERROR = 1 << 24;
const BUS_RESET = 1 << 19;
const TRANS_COMPLETE = 1 << 18;
const SETUP_REC = 1 << 17;
const CONNECTED = 1 << 16;
const RESUME = 1 << 11;
const SUSPENDED = 1 << 4;
const VBUS_DETECTED = 1 << 0;
const LINE_STATE_SHIFT = 2;
/** Bits of SIE_STATUS that software clears by writing ones. */
const WRITE_CLEARS = 0xff0f_0b10 | 0;
/** Interrupts that follow a bit of SIE_STATUS: [bit of SIE_STATUS, bit of INTR]. */
const FOLLOW = [
  [SETUP_REC, 16],
  [RESUME, 15],
  [SUSPENDED, 14],
  [BUS_RESET, 12],
  [CRC_ERROR, 9],
  [RX_TIMEOUT, 6],
  [DATA_SEQ_ERROR, 5],
  [TRANS_COMPLETE, 3],
];
const INT_DEV_CONN_DIS = 13;
const INT_VBUS_DETECT = 11;
const INT_BUFF_STATUS = 4;
const INT_EP_STALL_NAK = 19;
const INT_DEV_SOF = 1 << 17;

const BUFFERS = 0x80;
const BUFFERS_END = 0x100;
const EP0_BUFFER = 0x100;
const [LENGTH, AVAILABLE, STALL, DATA1, LAST, FULL] = [0x3ff, 1 << 10, 1 << 11, 1 << 13, 1 << 14, 1 << 15];
const ENABLE = 1 << 31;
const DOUBLE_BUFFER = 1 << 30;
const PER_BUFFER = 1 << 29;
const TYPE_SHIFT = 26;
const ISOCHRONOUS = 1;
const ON_STALL = 1 << 17;
const ON_NAK = 1 << 16;
const ADDRESS_MASK = 0xffc0;

/** Levels of D+ and D− as SIE_STATUS encodes them. */
export const SE0 = 0;
export const J = 1;
export const K = 2;

const name = (endpoint, out) => `endpoint ${endpoint} ${out ? 'OUT' : 'IN'}`;

export class UsbDevice extends BasePeripheral {
  constructor(rp2040, port) {
    super(rp2040, 'USB');
    this.port = port;
    this.registers = new Map();
    this.address = 0;
    this.control = 0;
    this.status = 0;
    this.connectionChanged = false;
    this.bufferStatus = 0;
    this.stallArm = 0;
    this.stallStatus = 0;
    this.power = 0;
    this.enabled = 0;
    this.forced = 0;
    this.idleAlarm = rp2040.clock.createAlarm(() => this.raise(SUSPENDED));
    port.connect(this);
  }

  // ---- the device on the bus ----

  /** VBUS for the controller: the override of USB_PWR, or else whether the cable is plugged in. */
  get vbus() {
    return this.power & PWR_VBUS_OVERRIDE ? (this.power & PWR_VBUS) !== 0 : this.port.plugged;
  }

  /** True if the device pulls D+ up, which a host detects. */
  get pullsUp() {
    return (this.control & SIE_PULLUP) !== 0 && this.vbus;
  }

  /** The answer of an endpoint: 'ready', 'nak', 'stall', or 'none' if it does not answer. */
  answer(address, endpoint, out) {
    if (address !== this.address || !this.pullsUp) return 'none';
    const buffer = this.bufferControl(endpoint, out);
    if (endpoint !== 0 && !(this.endpointControl(endpoint, out) & ENABLE)) return 'none';
    const armed = endpoint !== 0 || this.stallArm & (out ? 2 : 1);
    if (buffer & STALL && armed) return 'stall';
    const given = out ? AVAILABLE : AVAILABLE | FULL;
    return (buffer & given) === given ? 'ready' : 'nak';
  }

  /** Bytes of the packet with which an endpoint will answer IN. */
  packetBytes(endpoint, answer) {
    return answer === 'ready' ? this.bufferControl(endpoint, false) & LENGTH : 0;
  }

  /** SETUP: always taken. Gives the answer. */
  setup(address, bytes) {
    if (address !== this.address || !this.pullsUp) return 'none';
    this.rp2040.usbDPRAM.set(bytes, 0);
    this.stallArm &= ~3;
    this.raise(SETUP_REC);
    return 'ack';
  }

  /** OUT: `data1` is the packet's PID. Gives 'ack', 'nak', 'stall', 'none', or 'babble' if it does not fit the buffer. */
  out(address, endpoint, data1, bytes) {
    const answer = this.answer(address, endpoint, true);
    if (answer === 'stall') this.stalled(endpoint, true);
    if (answer !== 'ready') return answer;
    const buffer = this.bufferControl(endpoint, true);
    if (bytes.length > (buffer & LENGTH)) return 'babble';
    if (((buffer & DATA1) !== 0) !== data1) {
      this.raise(DATA_SEQ_ERROR);
      return 'ack';
    }
    this.rp2040.usbDPRAM.set(bytes, this.bufferAddress(endpoint, true));
    this.handBack(endpoint, true, (buffer & ~LENGTH) | FULL | bytes.length);
    return 'ack';
  }

  /** IN: gives { answer, data1, bytes }; the packet is acknowledged by the host unless `lost`. */
  in(address, endpoint, lost) {
    const answer = this.answer(address, endpoint, false);
    if (answer === 'stall') this.stalled(endpoint, false);
    if (answer !== 'ready') return { answer };
    const buffer = this.bufferControl(endpoint, false);
    const at = this.bufferAddress(endpoint, false);
    const bytes = this.rp2040.usbDPRAM.slice(at, at + (buffer & LENGTH));
    if (lost) {
      this.raise(RX_TIMEOUT);
      return { answer: 'none' };
    }
    this.raise(ACK_REC);
    this.handBack(endpoint, false, buffer & ~FULL);
    return { answer: 'data', data1: (buffer & DATA1) !== 0, bytes };
  }

  /** A packet of the host arrived with a wrong CRC. Nothing answers it. */
  corrupted() {
    this.raise(CRC_ERROR);
  }

  busReset() {
    this.active(false);
    this.setConnected(true);
    this.raise(BUS_RESET);
  }

  /** The bus is idle: there are no more starts of frame, and no other packets. */
  idle() {
    if (this.pullsUp) this.idleAlarm.schedule(SUSPEND_AFTER_NANOS);
  }

  /** The host sends again: it resumes a suspended bus (`resuming`) or goes on after a reset. */
  active(resuming) {
    this.idleAlarm.cancel();
    this.status &= ~SUSPENDED;
    if (resuming) this.status |= RESUME;
    this.update();
  }

  /** The cable was plugged in or out. */
  plugChanged() {
    if (!this.vbus) {
      this.idleAlarm.cancel();
      this.setConnected(false);
    }
    this.update();
  }

  setConnected(connected) {
    if (connected === ((this.status & CONNECTED) !== 0)) return;
    this.status ^= CONNECTED;
    this.connectionChanged = true;
    this.update();
  }

  // ---- buffers ----

  bufferControl(endpoint, out) {
    return this.rp2040.usbDPRAMView.getUint32(BUFFERS + 8 * endpoint + (out ? 4 : 0), true);
  }

  endpointControl(endpoint, out) {
    return this.rp2040.usbDPRAMView.getUint32(8 * endpoint + (out ? 4 : 0), true);
  }

  bufferAddress(endpoint, out) {
    return endpoint === 0 ? EP0_BUFFER : this.endpointControl(endpoint, out) & ADDRESS_MASK;
  }

  /** The buffer is the firmware's again. */
  handBack(endpoint, out, buffer) {
    const value = (buffer & ~AVAILABLE) >>> 0;
    this.rp2040.usbDPRAMView.setUint32(BUFFERS + 8 * endpoint + (out ? 4 : 0), value, true);
    if (buffer & LAST) this.status |= TRANS_COMPLETE;
    const perBuffer = endpoint === 0 ? this.control & SIE_EP0_PER_BUFFER : this.endpointControl(endpoint, out) & PER_BUFFER;
    if (perBuffer) this.bufferStatus |= bitOf(endpoint, out);
    this.update();
  }

  stalled(endpoint, out) {
    const enabled = endpoint === 0 ? this.control & SIE_EP0_STALL : this.endpointControl(endpoint, out) & ON_STALL;
    if (enabled) this.stallStatus |= bitOf(endpoint, out);
    this.update();
  }

  /** Called by rp2040js after each write to the controller's memory. */
  DPRAMUpdated(offset, value) {
    if (offset >= BUFFERS && offset < BUFFERS_END) {
      if (value & (AVAILABLE << 16)) throw new Error('USB: the second of two buffers is not modelled');
      if (value & (AVAILABLE | STALL)) this.port.changed();
    } else if (offset >= 8 && offset < BUFFERS) {
      const which = name(offset >> 3, (offset & 4) !== 0);
      if (value & (DOUBLE_BUFFER | ON_NAK)) throw new Error(`USB: ${which}: two buffers and NAK interrupts are not modelled`);
      if (((value >>> TYPE_SHIFT) & 3) === ISOCHRONOUS) throw new Error(`USB: ${which}: isochronous transfers are not modelled`);
      if (value & ENABLE) this.port.changed();
    }
  }

  // ---- registers ----

  get raised() {
    let bits = 0;
    for (const [status, bit] of FOLLOW) if (this.status & status) bits |= 1 << bit;
    if (this.connectionChanged) bits |= 1 << INT_DEV_CONN_DIS;
    if (this.vbus) bits |= 1 << INT_VBUS_DETECT;
    if (this.bufferStatus !== 0) bits |= 1 << INT_BUFF_STATUS;
    if (this.stallStatus !== 0) bits |= 1 << INT_EP_STALL_NAK;
    return bits;
  }

  get interrupts() {
    return (this.raised & this.enabled) | this.forced;
  }

  raise(bit) {
    this.status |= bit;
    this.update();
  }

  update() {
    this.rp2040.setInterrupt(IRQ_USBCTRL, this.interrupts !== 0);
  }

  readUint32(offset) {
    switch (offset) {
      case ADDR_ENDP:
        return this.address;
      case SOF_RD:
        return this.port.frame;
      case SIE_CTRL:
        return this.control;
      case SIE_STATUS:
        return this.status | (this.port.lineState << LINE_STATE_SHIFT) | (this.vbus ? VBUS_DETECTED : 0);
      case BUFF_STATUS:
        return this.bufferStatus;
      case EP_STALL_ARM:
        return this.stallArm;
      case EP_STATUS_STALL_NAK:
        return this.stallStatus;
      case USB_PWR:
        return this.power;
      case INTR:
        return this.raised;
      case INTE:
        return this.enabled;
      case INTF:
        return this.forced;
      case INTS:
        return this.interrupts;
      default:
        return this.registers.get(offset) ?? 0;
    }
  }

  writeUint32(offset, value) {
    switch (offset) {
      case ADDR_ENDP:
        this.address = value & 0x7f;
        this.port.changed();
        return;
      case MAIN_CTRL:
        if (value & HOST_MODE) throw new Error('USB: host mode is not modelled');
        this.registers.set(offset, value);
        return;
      case SIE_CTRL:
        this.writeControl(value);
        return;
      case SIE_STATUS:
        if (this.rawWriteValue & CONNECTED) this.connectionChanged = false;
        this.status &= ~(this.rawWriteValue & WRITE_CLEARS & ~CONNECTED);
        break;
      case BUFF_STATUS:
        this.bufferStatus &= ~this.rawWriteValue;
        break;
      case EP_ABORT:
        if (value !== 0) throw new Error('USB: EP_ABORT is not modelled');
        break;
      case EP_STALL_ARM:
        this.stallArm = value & 3;
        this.port.changed();
        break;
      case EP_STATUS_STALL_NAK:
        this.stallStatus &= ~this.rawWriteValue;
        break;
      case USB_PWR:
        this.power = value;
        this.port.pullChanged();
        break;
      case INTE:
        if (value & INT_DEV_SOF) throw new Error('USB: the interrupt of each start of frame is not modelled');
        this.enabled = value;
        break;
      case INTF:
        this.forced = value;
        break;
      case INTR:
      case INTS:
        break;
      default:
        this.registers.set(offset, value);
        return;
    }
    this.update();
  }

  writeControl(value) {
    const refused = value & SIE_REFUSED;
    if (refused !== 0) throw new Error(`USB: bits 0x${(refused >>> 0).toString(16)} of SIE_CTRL are not modelled`);
    this.control = value;
    this.port.pullChanged();
  }
}

const bitOf = (endpoint, out) => 1 << (2 * endpoint + (out ? 1 : 0));
