// The other end of a UART's two wires. It belongs to the board, not to the chip, so a reset does not stop it.
//
// Frames come one after another, as fast as the line allows. `onData(byte)` gets each byte that has left the chip, at the end
// of its frame. `onBreak(on)` gets the beginning and the end of a break.

/** For a UART whose divider is not set yet. */
const DEFAULT_BAUD = 115_200;
const NANOS_PER_SECOND = 1e9;

/** Errors that a frame can have when it arrives. */
export const FRAME_ERRORS = ['framing', 'parity', 'break'];

export class UartLine {
  constructor(board, index) {
    this.board = board;
    this.index = index;
    /** Baud rate of this end; null for that of the chip. */
    this.baud = null;
    this.waiting = [];
    this.onData = () => {};
    this.onBreak = () => {};
  }

  get uart() {
    return this.board.chip.uart[this.index];
  }

  get bitNanos() {
    if (this.baud !== null) return NANOS_PER_SECOND / this.baud;
    return this.uart.bitNanos || NANOS_PER_SECOND / DEFAULT_BAUD;
  }

  send(bytes) {
    for (const data of bytes) this.queue({ data, error: null });
  }

  /** Sends one frame that arrives with an error: 'framing', 'parity' or 'break'. */
  sendWithError(error, data = 0) {
    if (!FRAME_ERRORS.includes(error)) throw new Error(`no error is called ${error}: use one of ${FRAME_ERRORS.join(', ')}`);
    this.queue({ data: error === 'break' ? 0 : data, error });
  }

  queue(frame) {
    this.waiting.push(frame);
    if (this.waiting.length === 1) this.next();
  }

  next() {
    this.board.clock.later(this.uart.frameBits * this.bitNanos, () => this.arrived());
  }

  arrived() {
    const { data, error } = this.waiting.shift();
    if (this.waiting.length > 0) this.next();
    this.uart.receive(data, error, this.bitNanos);
  }
}
