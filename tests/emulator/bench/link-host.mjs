// A host at the link of an emulated board, in step with it. It sends a request, and runs the board until the reply arrives.

import { MESSAGE, Receiver, encode, requests } from './frames.mjs';
import { linkTo } from './link.mjs';
import { CYCLES_PER_S } from './machine.mjs';

/** Time limits on the board's clock: for the configuration of USB, and for a reply. */
const READY_S = 1;

/** Time from the loop's first ticks to a UART that is set up, which no line shows. */
const SET_UP_S = 0.01;
const REPLY_S = 2;

/** Bytes of a file in one request. */
const CHUNK_BYTES = 384;

/** Bytes of a frame besides its payload: number, CRC, COBS and the zero. */
const FRAME_BYTES = 9;

const RESULT_ERROR = 1;
const CHUNK = 2;
const COUNTERS = 3;

export class LinkHost {
  constructor(machine, transport) {
    this.machine = machine;
    this.link = linkTo(machine.board, { transport });
    this.number = 0;
    this.reply = null;
    /** Runs of samples: { tick, every, count }. */
    this.samples = [];
    this.bytes = 0;
    /** Bytes on the line of the frames that carry samples. */
    this.sampleBytes = 0;
    this.receiver = new Receiver((_, payload) => this.message(payload));
    this.link.onData = (bytes) => {
      this.bytes += bytes.length;
      this.receiver.push(bytes);
    };
  }

  get seconds() {
    return this.machine.board.cycle / CYCLES_PER_S;
  }

  /** Waits for the line, and identifies. */
  connect() {
    this.until(() => this.link.ready, READY_S, 'the line is not there');
    this.machine.run(SET_UP_S);
    this.link.open();
    this.link.send([0]);
    return this.ask(requests.identify());
  }

  until(condition, seconds, problem) {
    const { reason } = this.machine.board.run({ cycles: seconds * CYCLES_PER_S, until: condition, every: 500 });
    if (reason !== 'until') throw new Error(`link: ${problem} within ${seconds} s of the board (${reason})`);
  }

  /** Sends a request without waiting for the reply. */
  send(payload) {
    this.link.send(encode(this.number, payload));
    this.number = (this.number + 1) % 0x1_0000;
  }

  /** Makes a request; gives its reply: { result, rest }. */
  exchange(payload) {
    const to = this.number;
    this.reply = null;
    this.send(payload);
    this.until(() => this.reply?.number === to, REPLY_S, `request ${payload[0]} has no reply`);
    return this.reply;
  }

  /** Makes a request that must be refused; gives the number of the refusal, or null. */
  refusal(payload) {
    const { result, rest } = this.exchange(payload);
    return result === RESULT_ERROR ? rest[0] : null;
  }

  /** Makes a request; gives the payload of its reply behind the result's tag. Throws if it is refused. */
  ask(payload) {
    const { result, rest } = this.exchange(payload);
    if (result === RESULT_ERROR) throw new Error(`link: request ${payload[0]} refused: ${[...rest]}`);
    return rest;
  }

  message(payload) {
    const reader = new Reader(payload);
    const kind = reader.varint();
    if (kind === MESSAGE.reply) {
      this.reply = { number: reader.varint(), result: reader.byte(), rest: reader.rest() };
    } else if (kind === MESSAGE.samples) {
      const [tick, every] = [reader.varint(), reader.varint()];
      reader.varint(); // channels
      this.samples.push({ tick, every, count: reader.byte() });
      this.sampleBytes += payload.length + FRAME_BYTES;
    }
  }

  readFile(file) {
    const parts = [];
    for (let offset = 0; ; ) {
      const reader = new Reader(this.ask(requests.read(file, offset)));
      if (reader.varint() !== CHUNK) throw new Error('link: no part of a file');
      reader.varint(); // length of the file
      const bytes = reader.take(reader.varint());
      if (bytes.length === 0) return Buffer.concat(parts);
      parts.push(bytes);
      offset += bytes.length;
    }
  }

  writeFile(file, bytes) {
    this.ask(requests.beginWrite(file, bytes));
    for (let offset = 0; offset < bytes.length; offset += CHUNK_BYTES) {
      this.ask(requests.write(offset, bytes.subarray(offset, offset + CHUNK_BYTES)));
    }
    this.ask(requests.finishWrite());
  }

  /** Serial number of the board, a BigInt. */
  serial() {
    const reader = new Reader(this.ask(requests.identify()));
    reader.varint(); // the kind of the reply
    reader.varint(); // version of the protocol
    reader.take(reader.varint()); // the board's name
    return reader.bigVarint();
  }

  /** Samples that the controller counted as lost. */
  samplesLost() {
    const reader = new Reader(this.ask(requests.counters()));
    if (reader.varint() !== COUNTERS) throw new Error('link: no counters');
    const [, , , , , lost] = Array.from({ length: 6 }, () => reader.varint());
    return lost;
  }
}

/** Reads postcard's numbers. */
class Reader {
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
  }

  byte() {
    this.at += 1;
    return this.bytes[this.at - 1];
  }

  varint() {
    let value = 0;
    for (let scale = 1; ; scale *= 128) {
      const byte = this.byte();
      value += (byte & 0x7f) * scale;
      if (byte < 0x80) return value;
    }
  }

  bigVarint() {
    for (let value = 0n, shift = 0n; ; shift += 7n) {
      const byte = this.byte();
      value |= BigInt(byte & 0x7f) << shift;
      if (byte < 0x80) return value;
    }
  }

  take(count) {
    this.at += count;
    return this.bytes.subarray(this.at - count, this.at);
  }

  rest() {
    return this.bytes.subarray(this.at);
  }
}
