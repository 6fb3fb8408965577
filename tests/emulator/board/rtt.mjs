// The log: the bytes that the firmware writes into its RTT up channel, with the cycle of each piece.
//
// By default the host's side is ideal: the channel is emptied in the cycle in which the firmware moves its write offset,
// so nothing is ever lost and each piece has its exact cycle. With `interval` it is emptied every so many cycles, like a
// probe does. Then the firmware's behaviour with a full channel can be observed.

const UP_CHANNEL = 24;
const BUFFER = 4;
const SIZE = 8;
const WRITE = 12;
const READ = 16;

export class Rtt {
  /** `address` of `_SEGGER_RTT`; `interval` in cycles, or 0 for the ideal host. */
  constructor(board, address, interval = 0) {
    this.board = board;
    this.channel = address + UP_CHANNEL;
    this.interval = interval;
    /** [{ cycle, bytes }] */
    this.pieces = [];
  }

  /** Binds to a chip that has just been reset. */
  attach() {
    const { core, clock } = this.board;
    if (this.interval === 0) {
      core.watch = this.channel + WRITE;
      core.onWatch = () => this.drain();
      return;
    }
    const alarm = clock.createAlarm(() => {
      this.drain();
      alarm.at(clock.cycle + this.interval);
    });
    alarm.at(clock.cycle + this.interval);
  }

  /** Stops the host's reading and fills the channel, up to the next reset. */
  stall() {
    const { core } = this.board;
    core.watch = -1;
    const at = (offset) => (this.channel + offset - 0x2000_0000) >>> 2;
    core.ram32[at(READ)] = (core.ram32[at(WRITE)] + 1) % core.ram32[at(SIZE)];
  }

  /** Takes the channel's content and moves the read offset. */
  drain() {
    const { core } = this.board;
    const field = (offset) => core.ram32[(this.channel + offset - 0x2000_0000) >>> 2];
    const [buffer, size, write, read] = [BUFFER, SIZE, WRITE, READ].map(field);
    if (size === 0 || write >= size || read >= size || write === read) return;
    const at = buffer - 0x2000_0000;
    const bytes = [];
    for (let i = read; i !== write; i = (i + 1) % size) bytes.push(core.ram8[at + i]);
    core.ram32[(this.channel + READ - 0x2000_0000) >>> 2] = write;
    this.pieces.push({ cycle: this.board.cycle, bytes: Uint8Array.from(bytes) });
  }

  /** Everything so far, in one array. */
  get bytes() {
    const length = this.pieces.reduce((sum, { bytes }) => sum + bytes.length, 0);
    const all = new Uint8Array(length);
    let at = 0;
    for (const { bytes } of this.pieces) {
      all.set(bytes, at);
      at += bytes.length;
    }
    return all;
  }
}
