// Window of time that all plots show: live, or stopped on a copy of the samples.

/** Widths of the window, s. */
export const SPANS = [0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60];

export class View {
  #live;
  #stopped;
  #listeners = [];
  span = 10;
  /** Cursors A and B, s; `undefined` until they are placed. */
  cursors = [undefined, undefined];
  /** Time of the trigger that stopped the window, s. */
  trigger = undefined;
  /** Number of changes so far. A stopped window is drawn again only after a change. */
  version = 0;

  constructor(history) {
    this.#live = history;
  }

  get isPaused() {
    return this.#stopped !== undefined;
  }

  /** Returns the samples that are shown. */
  get history() {
    return this.#stopped?.history ?? this.#live;
  }

  get to() {
    return this.#stopped?.to ?? this.#live.now;
  }

  get from() {
    return this.to - this.span;
  }

  onChange(listener) {
    this.#listeners.push(listener);
  }

  #changed() {
    this.version += 1;
    this.#listeners.forEach((listener) => listener());
  }

  /** Stops at the newest sample. Zoom and pan reach all samples that are still kept. */
  pause() {
    if (!this.isPaused) {
      this.#stop(this.#live.now);
    }
  }

  #stop(to) {
    this.#stopped = { history: this.#live.copy(0, Infinity), to };
    this.#changed();
  }

  /** Stops the window, with the time of a trigger at its place in it. */
  stopAt(trigger, to) {
    this.trigger = trigger;
    this.#stop(to);
  }

  resume() {
    this.#stopped = undefined;
    this.trigger = undefined;
    this.#changed();
  }

  /** Zooms by steps of the span. `about` is the time that keeps its place. */
  zoom(steps, about = this.isPaused ? (this.from + this.to) / 2 : this.to) {
    const at = SPANS.findIndex((span) => span >= this.span * (1 - 1e-9));
    const place = Math.min(Math.max((at < 0 ? SPANS.length - 1 : at) + steps, 0), SPANS.length - 1);
    this.show(about - ((about - this.from) * SPANS[place]) / this.span, SPANS[place]);
  }

  /** Shows a window of time. The end of a live window stays at the newest sample. */
  show(from, span) {
    this.span = span;
    if (this.#stopped) {
      this.#stopped.to = from + span;
    }
    this.#changed();
  }

  /** Moves a stopped window by a part of its width. */
  pan(part) {
    this.pause();
    this.show(this.from + part * this.span, this.span);
  }

  /** Places a cursor at the time of the nearest sample. */
  setCursor(number, time) {
    const i = time === undefined ? undefined : this.history.nearest(time);
    this.cursors[number] = i === undefined ? undefined : this.history.time(i);
    this.#changed();
  }

  /** Moves a cursor by samples. */
  stepCursor(number, samples) {
    const { history } = this;
    const time = this.cursors[number] ?? (this.from + this.to) / 2;
    const i = history.nearest(time);
    if (i !== undefined) {
      const next = Math.min(Math.max(i + samples, history.start), history.end - 1);
      this.setCursor(number, history.time(next));
    }
  }
}
