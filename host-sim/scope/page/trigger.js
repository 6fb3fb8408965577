// Trigger: stops the window when a signal crosses a level, or a fault latches.

import { unitOf } from './signals.js';

export class Trigger {
  #history;
  #view;
  #next = 0;
  /** Time at which the trigger fired, s, and time at which the window is complete. */
  #fired;
  /** `off`, `level` or `fault`. */
  kind = 'off';
  column;
  rising = true;
  /** Level, in the unit of the plots. */
  level = 0;
  /** Part of the window before the trigger. */
  before = 0.25;

  constructor(history, view) {
    this.#history = history;
    this.#view = view;
  }

  /** Waits for the next trigger, from the newest sample on. */
  arm() {
    this.#next = this.#history.end;
    this.#fired = undefined;
  }

  get isWaiting() {
    return this.kind !== 'off' && !this.#view.isPaused;
  }

  /** Handles an event. A fault has its tick, so a late event does not matter. */
  event(event) {
    const isNew = this.#next < this.#history.end ? event.t_s >= this.#history.time(this.#next) : true;
    if (this.kind === 'fault' && event.kind === 'fault' && isNew && !this.#view.isPaused) {
      this.#fired ??= event.t_s;
    }
  }

  /** Checks the new samples. */
  update() {
    if (!this.isWaiting) {
      this.#next = this.#history.end;
      return;
    }
    if (this.kind === 'level' && this.#fired === undefined) {
      this.#fired = this.#crossing();
    }
    const { span } = this.#view;
    const to = this.#fired === undefined ? Infinity : this.#fired + (1 - this.before) * span;
    if (this.#history.now >= to) {
      const at = this.#fired;
      this.#fired = undefined;
      this.kind = 'off';
      this.#view.stopAt(at, to);
    }
  }

  #crossing() {
    const history = this.#history;
    const { scale } = unitOf(this.column);
    const sign = this.rising ? 1 : -1;
    for (let i = Math.max(this.#next, history.start + 1, 1); i < history.end; i++) {
      const [before, now] = [history.value(this.column, i - 1), history.value(this.column, i)];
      if (sign * (before * scale - this.level) < 0 && sign * (now * scale - this.level) >= 0) {
        return history.time(i);
      }
    }
    this.#next = history.end;
    return undefined;
  }
}
