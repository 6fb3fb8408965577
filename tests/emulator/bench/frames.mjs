// A second implementation of the host link's frames (docs/link.md). It checks the encoding of the firmware's own crate.

import { crc32 } from './crc.mjs';

const NUMBER_BYTES = 2;
const CRC_BYTES = 4;

/** A frame with its number and payload, as bytes on the line. */
export function encode(number, payload) {
  const body = Buffer.from([number & 0xff, (number >> 8) & 0xff, ...payload]);
  const plain = Buffer.concat([body, Buffer.from(Uint32Array.of(crc32(body)).buffer)]);
  const out = [];
  let block = [];
  const flush = () => {
    out.push(block.length + 1, ...block);
    block = [];
  };
  for (const byte of plain) {
    if (byte === 0) flush();
    else block.push(byte);
    if (block.length === 254) {
      out.push(255, ...block);
      block = [];
    }
  }
  flush();
  return Uint8Array.from([...out, 0]);
}

/** Receives frames: `onFrame(number, payload)` for each intact one. */
export class Receiver {
  constructor(onFrame) {
    this.onFrame = onFrame;
    this.bytes = [];
    this.bad = 0;
    this.missing = 0;
    this.next = null;
  }

  push(bytes) {
    for (const byte of bytes) {
      if (byte !== 0) this.bytes.push(byte);
      else if (this.bytes.length > 0) this.frame(this.bytes.splice(0));
    }
  }

  frame(coded) {
    const plain = [];
    for (let at = 0; at < coded.length; ) {
      const length = coded[at];
      plain.push(...coded.slice(at + 1, at + length));
      at += length;
      if (length < 255 && at < coded.length) plain.push(0);
    }
    const body = Buffer.from(plain.slice(0, -CRC_BYTES));
    const crc = Buffer.from(plain.slice(-CRC_BYTES)).readUInt32LE();
    if (crc !== crc32(body)) {
      this.bad += 1;
      return;
    }
    const number = body.readUInt16LE();
    this.missing += this.next === null ? 0 : (number - this.next + 0x1_0000) % 0x1_0000;
    this.next = (number + 1) % 0x1_0000;
    this.onFrame(number, body.subarray(NUMBER_BYTES));
  }
}

/** Variants of a request and of its fields, as `Request` in firmware/link/src/message.rs numbers them. */
const VARIANTS = {
  identify: 0,
  read: 1,
  beginWrite: 2,
  write: 3,
  finishWrite: 4,
  restart: 5,
  control: 6,
  arm: 7,
  start: 9,
  stop: 10,
  override: 14,
  home: 15,
  jog: 16,
  counters: 17,
  stream: 19,
  streamStatus: 20,
  inputs: 22,
  unlock: 23,
  output: 24,
  onlyAxis: 25,
};

/** A number in postcard's encoding: seven bits a byte, the lowest first. */
export function varint(value) {
  const bytes = [];
  let rest = value;
  for (; rest > 0x7f; rest = Math.floor(rest / 128)) bytes.push((rest % 128) | 0x80);
  return [...bytes, rest];
}

const request = (name, ...fields) => [VARIANTS[name], ...fields.flat()];

export const SETTINGS = 0;
export const PROGRAM = 1;

/** Payloads of requests. */
export const requests = {
  identify: (version = 2) => request('identify', varint(version)),
  read: (file, offset) => request('read', file, varint(offset)),
  beginWrite: (file, bytes) => request('beginWrite', file, varint(bytes.length), varint(crc32(bytes))),
  write: (offset, bytes) => request('write', varint(offset), varint(bytes.length), [...bytes]),
  finishWrite: () => request('finishWrite'),
  takeControl: () => request('control', 0),
  arm: () => request('arm'),
  start: () => request('start'),
  /** `kind`: 0 at the parking phase, 1 now. */
  stop: (kind) => request('stop', kind),
  override: (permille) => request('override', varint(permille)),
  restart: () => request('restart'),
  home: () => request('home'),
  jog: () => request('jog'),
  inputs: () => request('inputs'),
  unlock: () => request('unlock'),
  /** `line`: one of OUTPUTS, with an axis for step and dir. */
  output: (line, active) => request('output', line, Number(active)),
  onlyAxis: (axis) => request('onlyAxis', axis),
  counters: () => request('counters'),
  stream: (channels, every) => request('stream', varint(channels), varint(every)),
  streamStatus: (milliseconds) => request('streamStatus', varint(milliseconds)),
};

/** Outputs, as `Output` numbers them. */
export const OUTPUTS = { step: (axis) => [0, axis], dir: (axis) => [1, axis], driveEnable: [2], sync: [3] };

/** Kind of a message of the controller, and its remaining bytes: [kind, rest]. */
export const MESSAGE = { reply: 0, status: 1, samples: 2, event: 3 };
