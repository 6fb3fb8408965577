// A board behind a TCP port on loopback, like a real board behind its serial port. Runs it in slices, at up to real-time speed,
// and passes bytes between the one client and its link.

import net from 'node:net';
import { CYCLES_PER_S } from './machine.mjs';

const SLICE_S = 0.001;
const SLICE_CYCLES = SLICE_S * CYCLES_PER_S;
/** The longest lag behind real time for which the board catches up. */
const MAX_LAG_MS = 50;
/** Time for which a client waits for the previous client to leave. */
const LEAVING_MS = 200;
/** The client is held back above this number of bytes for the board. */
const MAX_PENDING = 4096;

export class Server {
  /**
   * `fast`: run at full speed. `report(line)` gets each event. `ended(problem)` is called once, without an argument if there is no
   * problem.
   */
  constructor(board, link, { fast, report, ended }) {
    Object.assign(this, { board, link, fast, report, ended });
    this.client = null;
    this.closing = false;
    this.ahead = { cycle: board.cycle, wall: performance.now() };
    this.server = net.createServer({ allowHalfOpen: false }, (socket) => this.accept(socket));
    /** Bytes from the board since the last ones were given to the client. */
    this.outbox = [];
    link.onData = (bytes) => this.outbox.push(bytes);
    link.onReady = () => this.report('event ready');
    link.onGone = () => {
      this.report('event gone');
      this.drop();
    };
  }

  get seconds() {
    return this.board.cycle / CYCLES_PER_S;
  }

  /** Listens on `port`, or on any free one for 0; gives which. */
  listen(port) {
    return new Promise((resolve, reject) => {
      this.server.once('error', reject);
      this.server.listen(port, '127.0.0.1', () => resolve(this.server.address().port));
    });
  }

  close(problem) {
    if (this.closing) return;
    this.closing = true;
    this.drop();
    this.server.close();
    this.ended(problem);
  }

  // ---- the client ----

  /** A client may connect before the server has noticed the end of the previous connection. It waits a moment for that. */
  accept(socket) {
    if (!this.client || this.closing) {
      this.enter(socket);
      return;
    }
    socket.pause();
    socket.on('error', () => {});
    setTimeout(() => this.enter(socket), LEAVING_MS);
  }

  enter(socket) {
    if (socket.destroyed) return;
    if (this.client || !this.link.ready) {
      this.report(`event refused: ${this.client ? 'there is a client already' : 'the port is not there'}`);
      socket.destroy();
      return;
    }
    this.client = socket;
    socket.setNoDelay(true);
    this.report('event client');
    this.link.open();
    this.link.setReading(true);
    socket.on('data', (data) => this.fromClient(data));
    socket.resume();
    socket.on('drain', () => this.link.setReading(true));
    socket.on('error', () => {});
    socket.on('close', () => this.left(socket));
  }

  left(socket) {
    if (this.client !== socket) return;
    this.client = null;
    this.report('event client left');
    this.link.close();
    this.link.setReading(true);
  }

  drop() {
    this.client?.destroy();
  }

  fromClient(data) {
    if (!this.link.ready) return;
    this.link.send(data);
    if (this.link.pending > MAX_PENDING) this.client.pause();
  }

  toClient() {
    if (this.outbox.length === 0) return;
    const bytes = Buffer.concat(this.outbox.splice(0));
    if (this.client?.writable && !this.client.write(bytes)) this.link.setReading(false);
  }

  // ---- the board ----

  /** Runs the board until `close`. */
  run() {
    if (this.closing) return;
    let end;
    try {
      end = this.board.run({ cycles: SLICE_CYCLES });
    } catch (error) {
      this.close(error);
      return;
    }
    if (end.reason !== 'cycles') {
      this.close(new Error(`the board stopped after ${this.seconds.toFixed(3)} s: ${end.reason}, ${end.detail ?? ''}`));
      return;
    }
    this.toClient();
    if (this.client?.isPaused() && this.link.pending <= MAX_PENDING) this.client.resume();
    const wait = this.fast ? 0 : this.leadMs();
    if (wait >= 1) setTimeout(() => this.run(), wait);
    else setImmediate(() => this.run());
  }

  /** Time by which the board is ahead of real time. */
  leadMs() {
    const lead = ((this.board.cycle - this.ahead.cycle) / CYCLES_PER_S) * 1000 - (performance.now() - this.ahead.wall);
    if (lead < -MAX_LAG_MS) this.ahead = { cycle: this.board.cycle, wall: performance.now() };
    return lead;
  }
}
