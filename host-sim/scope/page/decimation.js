// Conversion of samples to points: two for each pixel, the least and the greatest value in it. So even short peaks are drawn.
//
// A pixel has a whole number of ticks, and begins at a multiple of them. So a point does not change while the window moves, and
// only new samples have to be visited.

export class Decimation {
  #names;
  #key = {};
  /** Pixel in each place of the ring; −1 for none. */
  #pixels;
  #lows;
  #highs;
  /** True if the least value came first. */
  #order;
  /** Number of the next sample to visit, and first complete pixel. */
  #next;
  #first;

  /** @param {string[]} names Names of the columns. */
  constructor(names) {
    this.#names = names;
  }

  /**
   * Returns the points of a window: the times, then the columns, in the form for uPlot. Pixels without a sample are gaps. If a pixel
   * has fewer than two samples, these are the points.
   */
  points(history, from, to, pixels) {
    const { tickHz, every } = history;
    const ticks = Math.ceil(((to - from) * tickHz) / pixels / every) * every;
    if (ticks < 2 * every) {
      return samples(history, this.#names, from, to);
    }
    const first = Math.floor((from * tickHz) / ticks);
    const last = Math.floor((to * tickHz) / ticks);
    this.#follow(history, ticks, first, last);
    const times = [];
    const values = this.#names.map(() => []);
    const mask = this.#pixels.length - 1;
    for (let pixel = first; pixel <= last; pixel++) {
      const place = pixel & mask;
      const isThere = this.#pixels[place] === pixel;
      times.push(((pixel + 0.25) * ticks) / tickHz, ((pixel + 0.75) * ticks) / tickHz);
      for (let c = 0; c < values.length; c++) {
        const low = isThere ? this.#lows[c][place] : Infinity;
        if (low === Infinity) {
          values[c].push(null, null); // No sample, or none that is a number.
        } else if (this.#order[c][place]) {
          values[c].push(low, this.#highs[c][place]);
        } else {
          values[c].push(this.#highs[c][place], low);
        }
      }
    }
    return [times, ...values];
  }

  /** Visits the samples of pixels up to `last` that were not visited yet. */
  #follow(history, ticks, first, last) {
    const key = { history, ticks, generation: history.generation };
    const isSame = Object.keys(key).every((name) => this.#key[name] === key[name]);
    if (!isSame || first < this.#first || last - first >= this.#pixels.length) {
      this.#key = key;
      this.#first = first;
      const size = 2 ** Math.ceil(Math.log2(last - first + 2));
      this.#pixels = new Int32Array(size).fill(-1);
      this.#lows = this.#names.map(() => new Float64Array(size));
      this.#highs = this.#names.map(() => new Float64Array(size));
      this.#order = this.#names.map(() => new Uint8Array(size));
      this.#next = history.find((first * ticks) / history.tickHz);
    }
    const columns = this.#names.map((name) => history.columns[history.places.get(name)]);
    const mask = this.#pixels.length - 1;
    const until = (last + 1) * ticks;
    for (let i = Math.max(this.#next, history.start); i < history.end; i++) {
      const at = i & history.mask;
      if (history.ticks[at] >= until) {
        break;
      }
      const pixel = Math.floor(history.ticks[at] / ticks);
      const place = pixel & mask;
      if (this.#pixels[place] !== pixel) {
        this.#pixels[place] = pixel;
        for (let c = 0; c < columns.length; c++) {
          this.#lows[c][place] = Infinity;
          this.#highs[c][place] = -Infinity;
        }
      }
      for (let c = 0; c < columns.length; c++) {
        const value = columns[c][at];
        if (value < this.#lows[c][place]) {
          this.#lows[c][place] = value;
          this.#order[c][place] = 0;
        }
        if (value > this.#highs[c][place]) {
          this.#highs[c][place] = value;
          this.#order[c][place] = 1;
        }
      }
      this.#next = i + 1;
    }
  }
}

/** Returns all samples of a window, with a gap for missing ones. */
function samples(history, names, from, to) {
  const columns = names.map((name) => history.columns[history.places.get(name)]);
  const { mask, ticks, tickHz, every } = history;
  const times = [];
  const values = columns.map(() => []);
  // One more sample at either side, so that lines do not end inside the window.
  const first = Math.max(history.find(from) - 1, history.start);
  const end = Math.min(history.find(to) + 1, history.end);
  for (let i = first; i < end; i++) {
    const tick = ticks[i & mask];
    if (i > first && tick - ticks[(i - 1) & mask] > every) {
      times.push((tick - every) / tickHz);
      values.forEach((column) => column.push(null));
    }
    times.push(tick / tickHz);
    columns.forEach((column, c) => {
      const value = column[i & mask];
      values[c].push(Number.isNaN(value) ? null : value);
    });
  }
  return [times, ...values];
}
