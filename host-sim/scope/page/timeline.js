// States of the machine as a band over time, and events as marks on it.

import { LEFT, color } from './plots.js';

/** Room at the right, CSS pixels, equal to that of the plots. */
const RIGHT = 8;

export class Timeline {
  #canvas;
  #view;
  #states;
  #list;
  #events = new Map();

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {HTMLElement} list Element for the list of events, the newest first.
   * @param {string[]} states Names of the states.
   */
  constructor(canvas, list, view, states) {
    this.#canvas = canvas;
    this.#list = list;
    this.#view = view;
    this.#states = states;
  }

  /** Adds an event. An event that the server repeats is ignored. */
  add(event) {
    if (this.#events.has(event.number)) {
      return;
    }
    this.#events.set(event.number, event);
    const row = document.createElement('li');
    row.dataset.kind = event.kind;
    const time = document.createElement('button');
    time.type = 'button';
    time.className = 'time';
    time.textContent = `${event.t_s.toFixed(3)} s`;
    time.title = 'Place cursor A here';
    time.addEventListener('click', () => this.#view.setCursor(0, event.t_s));
    const text = document.createElement('span');
    text.textContent = event.text;
    row.append(time, text);
    this.#list.prepend(row);
  }

  clear() {
    this.#events.clear();
    this.#list.replaceChildren();
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    const [w, h] = [Math.round(width * devicePixelRatio), Math.round(height * devicePixelRatio)];
    if (this.#canvas.width !== w || this.#canvas.height !== h) {
      [this.#canvas.width, this.#canvas.height] = [w, h];
    }
    const ctx = this.#canvas.getContext('2d');
    ctx.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
    ctx.clearRect(0, 0, width, height);
    const { from, to, history } = this.#view;
    if (history.isEmpty) {
      return;
    }
    const right = width - RIGHT;
    const x = (time) => LEFT + ((time - from) / (to - from)) * (right - LEFT);
    ctx.font = '11px system-ui, sans-serif';
    ctx.textBaseline = 'middle';
    ctx.fillStyle = color('--muted');
    ctx.fillText('state', 8, height / 2);
    ctx.save();
    ctx.beginPath();
    ctx.rect(LEFT, 0, right - LEFT, height);
    ctx.clip();
    for (const { state, first, last } of runs(history, from, to)) {
      const name = this.#states[state] ?? String(state);
      const [left, end] = [x(first), Math.max(x(last), x(first) + 1)];
      ctx.fillStyle = color(`--state-${name}`);
      ctx.fillRect(left, 3, end - left, height - 6);
      if (end - Math.max(left, LEFT) > 6 + 6.5 * name.length) {
        ctx.fillStyle = color('--state-text');
        ctx.fillText(name, Math.max(left, LEFT) + 5, height / 2);
      }
    }
    for (const event of this.#events.values()) {
      if (event.kind !== 'state' && event.t_s >= from && event.t_s <= to) {
        ctx.fillStyle = color(event.kind === 'fault' ? '--bad' : '--warn');
        const at = x(event.t_s);
        ctx.beginPath();
        ctx.moveTo(at, height - 4);
        ctx.lineTo(at - 5, 1);
        ctx.lineTo(at + 5, 1);
        ctx.fill();
      }
    }
    ctx.restore();
  }
}

/** Returns the runs of the same state in a window. */
function runs(history, from, to) {
  return history.changes
    .map(({ i, state }, k, all) => ({
      state,
      first: history.time(Math.max(i, history.start)),
      last: k + 1 < all.length ? history.time(all[k + 1].i) : history.now,
    }))
    .filter(({ first, last }) => last >= from && first <= to);
}
