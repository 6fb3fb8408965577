// Contact with the controller: it is lost if the socket closes, if the server has no line to the controller, or if no status arrives.

/** Longest time without a status, ms. The server passes a status on every 50 ms. */
const STATUS_WITHIN_MS = 1000;

/** Losses: what is lost, how to restore it, and whether a stop may still reach the controller. */
const LOSSES = {
  server: {
    what: 'No connection to the server',
    remedy: 'The page connects again by itself. If `cophase scope` has ended, start it again, and open its new address.',
    passesStop: false,
  },
  line: {
    what: 'No line to the controller',
    remedy: 'The server waits for the same controller.',
    passesStop: false,
  },
  status: {
    what: 'No status of the controller',
    remedy: 'The server, the controller, or the network between them does not answer.',
    passesStop: true,
  },
};

export class Contact {
  #changed;
  #timer;
  /** Time of the last status, or that of the page's start. */
  #since = new Date();
  /** The loss; `undefined` if there is contact. Until the first status, there is none. */
  #loss = LOSSES.status;

  /**
   * @param {(loss?: { what: string, remedy: string, passesStop: boolean, since: Date, problem?: string }) => void} changed
   *   Called when contact is lost, when its cause changes, and when it is there again.
   */
  constructor(changed) {
    this.#changed = changed;
    this.#watch();
  }

  /** Handles a status: there is contact. */
  status() {
    this.#since = new Date();
    this.#watch();
    if (this.#loss !== undefined) {
      this.#loss = undefined;
      this.#changed(undefined);
    }
  }

  /** Handles a loss: `server` or `line`, with the problem if it is known. Only a status ends it. */
  lose(name, problem) {
    clearTimeout(this.#timer);
    this.#loss = LOSSES[name];
    this.#changed({ ...this.#loss, since: this.#since, problem });
  }

  #watch() {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.lose('status'), STATUS_WITHIN_MS);
  }
}
