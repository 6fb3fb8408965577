// Connection to the server: requests with their replies, reports, and batches of samples.

const HEADER_WORDS = 4;

/** Time between the end of a connection and the next attempt, ms. */
const AGAIN_MS = 1000;

export class Socket {
  #handlers;
  #socket;
  #next = 1;
  #waiting = new Map();

  /**
   * @param {{ report: (report: object) => void, batch: (batch: object) => void, closed: () => void }} handlers
   */
  constructor(handlers) {
    this.#handlers = handlers;
    this.#open();
  }

  /** Connects to the server, and again whenever the connection ends. */
  #open() {
    // The token is in the path of the page.
    this.#socket = new WebSocket(new URL('socket', location.href.replace(/^http/, 'ws')));
    this.#socket.binaryType = 'arraybuffer';
    this.#socket.addEventListener('message', ({ data }) => {
      if (typeof data !== 'string') {
        this.#handlers.batch(decode(data));
        return;
      }
      const report = JSON.parse(data);
      if (report.type === 'reply') {
        this.#answer(report);
      } else {
        this.#handlers.report(report);
      }
    });
    this.#socket.addEventListener('close', () => {
      for (const { reject } of this.#waiting.values()) {
        reject(new Error('the connection to the server ended before the reply'));
      }
      this.#waiting.clear();
      this.#handlers.closed();
      setTimeout(() => this.#open(), AGAIN_MS);
    });
  }

  /** Makes a request. Fails with the reason if it is refused. */
  request(request, fields = {}) {
    const id = this.#next++;
    return new Promise((resolve, reject) => {
      if (this.#socket.readyState !== WebSocket.OPEN) {
        reject(new Error('there is no connection to the server'));
        return;
      }
      this.#waiting.set(id, { resolve, reject });
      this.#socket.send(JSON.stringify({ id, request, ...fields }));
    });
  }

  #answer({ id, error }) {
    const waiting = this.#waiting.get(id);
    this.#waiting.delete(id);
    if (error === undefined) {
      waiting?.resolve();
    } else {
      waiting?.reject(new Error(error));
    }
  }
}

/** Decodes a batch of samples: first tick, ticks between two, number of samples, and a Float64Array for each column. */
function decode(buffer) {
  const [tick, every, count, columns] = new Uint32Array(buffer, 0, HEADER_WORDS);
  const start = HEADER_WORDS * Uint32Array.BYTES_PER_ELEMENT;
  const bytes = count * Float64Array.BYTES_PER_ELEMENT;
  return {
    tick,
    every,
    count,
    columns: Array.from({ length: columns }, (_, i) => new Float64Array(buffer, start + i * bytes, count)),
  };
}
