// The host link of an emulated board as a pipe of bytes, over USB or over a UART. Both have: `open()` and `close()`, as a
// program opens and closes a serial port; `ready`, true while the port exists; `send(bytes)`; `pending`, bytes not sent
// yet; `setReading(on)`; and the callbacks `onData(bytes)`, `onReady()` and `onGone()`.

import { CdcHost } from './usb-cdc.mjs';

export const TRANSPORTS = ['usb', 'uart'];

/** `uart`: which of the two; `baud`: rate of this end, null for the chip's; `times`: see usb-host.mjs. */
export function linkTo(board, { transport, uart = 1, baud = null, times }) {
  if (transport === 'uart') return new SerialLink(board.serial[uart], baud);
  if (transport !== 'usb') throw new Error(`no transport is called ${transport}: use one of ${TRANSPORTS.join(', ')}`);
  const host = new CdcHost(board, times);
  host.plug();
  return host;
}

/** Two wires: always present, and without flow control. */
class SerialLink {
  constructor(line, baud) {
    this.line = line;
    this.ready = true;
    this.onData = () => {};
    this.onReady = () => {};
    this.onGone = () => {};
    line.baud = baud;
    line.onData = (byte) => this.onData(Uint8Array.of(byte));
  }

  open() {}

  close() {}

  send(bytes) {
    this.line.send(bytes);
  }

  get pending() {
    return this.line.waiting.length;
  }

  setReading() {}
}
