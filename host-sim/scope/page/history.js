// Samples of the last minutes, in ring buffers of typed arrays.

/** Number of samples that are kept: 131 s at 2 kHz. */
const CAPACITY = 1 << 18;

export class History {
  /** Number of samples added so far, and number of samples missing between them. */
  end = 0;
  missing = 0;
  /** Number of times that the history was emptied. */
  generation = 0;
  /** Changes of the state: number of the sample, and the new state. */
  changes = [];

  /**
   * @param {string[]} names Names of the columns.
   * @param {number} tickHz Ticks a second.
   * @param {number} capacity Samples to keep, a power of two.
   */
  constructor(names, tickHz, capacity = CAPACITY) {
    this.names = names;
    this.tickHz = tickHz;
    this.capacity = capacity;
    this.mask = capacity - 1;
    this.ticks = new Uint32Array(capacity);
    // Steps need more digits than 32 bits have. All other columns are drawn and read with fewer digits.
    this.columns = names.map((name) => (name.startsWith('steps') ? new Float64Array(capacity) : new Float32Array(capacity)));
    this.places = new Map(names.map((name, i) => [name, i]));
  }

  /** Adds a batch, in the order of its ticks. */
  add({ tick, every, count, columns }) {
    if (this.end > 0) {
      const expected = this.ticks[(this.end - 1) & this.mask] + every;
      if (tick < expected) {
        this.clear(); // The controller has restarted.
      } else {
        this.missing += (tick - expected) / every;
      }
    }
    for (let i = 0; i < count; i++) {
      this.ticks[(this.end + i) & this.mask] = tick + i * every;
    }
    for (let c = 0; c < columns.length; c++) {
      const [to, from] = [this.columns[c], columns[c]];
      for (let i = 0; i < count; i++) {
        to[(this.end + i) & this.mask] = from[i];
      }
    }
    const states = columns[this.places.get('state_code')];
    for (let i = 0; i < count; i++) {
      if (this.changes.at(-1)?.state !== states[i]) {
        this.changes.push({ i: this.end + i, state: states[i] });
      }
    }
    this.end += count;
    this.every = every;
    // The state at the oldest sample is that of the last change before it.
    while (this.changes.length > 1 && this.changes[1].i <= this.start) {
      this.changes.shift();
    }
  }

  clear() {
    this.end = 0;
    this.missing = 0;
    this.generation += 1;
    this.changes = [];
  }

  /** Returns the number of the oldest sample. */
  get start() {
    return Math.max(0, this.end - this.capacity);
  }

  get isEmpty() {
    return this.end === 0;
  }

  /** Returns the time of sample number `i`, s. */
  time(i) {
    return this.ticks[i & this.mask] / this.tickHz;
  }

  /** Returns the time of the newest sample, s. */
  get now() {
    return this.isEmpty ? 0 : this.time(this.end - 1);
  }

  /** Returns the value of a column in sample number `i`. */
  value(name, i) {
    return this.columns[this.places.get(name)][i & this.mask];
  }

  /** Returns the number of the first sample at or after a time, s. */
  find(time) {
    const tick = Math.ceil(time * this.tickHz - 1e-6);
    let [low, high] = [this.start, this.end];
    while (low < high) {
      const middle = (low + high) >>> 1;
      if (this.ticks[middle & this.mask] < tick) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low;
  }

  /** Returns the number of the sample nearest to a time; `undefined` if there is no sample. */
  nearest(time) {
    const after = this.find(time);
    if (after > this.start && (after === this.end || time - this.time(after - 1) < this.time(after) - time)) {
      return after - 1;
    }
    return after < this.end ? after : undefined;
  }

  /** Returns a copy of the samples of a window, which later samples do not change. */
  copy(from, to) {
    const [first, end] = [this.find(from), this.find(to)];
    const count = end - first;
    const capacity = 2 ** Math.ceil(Math.log2(Math.max(count, 1)));
    const copy = new History(this.names, this.tickHz, capacity);
    copy.every = this.every;
    copy.end = count;
    copy.changes = this.changes.map(({ i, state }) => ({ i: Math.max(i - first, 0), state }));
    for (let i = 0; i < count; i++) {
      copy.ticks[i] = this.ticks[(first + i) & this.mask];
    }
    this.columns.forEach((column, c) => {
      for (let i = 0; i < count; i++) {
        copy.columns[c][i] = column[(first + i) & this.mask];
      }
    });
    return copy;
  }
}
