// Window of time and trigger.

import { unitOf } from './signals.js';
import { SPANS } from './view.js';

export class Toolbar {
  #view;
  #trigger;
  #element;

  constructor(root, view, trigger, configs) {
    this.#view = view;
    this.#trigger = trigger;
    this.#element = (id) => root.getElementById(id);
    const element = this.#element;
    const name = (span) => (span < 1 ? `${+(span * 1e3).toPrecision(3)} ms` : `${+span.toPrecision(3)} s`);
    element('span').replaceChildren(...SPANS.map((span) => new Option(name(span), String(span))));
    element('span').addEventListener('change', ({ target }) => {
      const span = Number(target.value);
      view.show(view.to - span, span);
    });
    element('pause').addEventListener('click', () => this.togglePause());
    element('zoom-in').addEventListener('click', () => view.zoom(-1));
    element('zoom-out').addEventListener('click', () => view.zoom(1));
    element('clear-cursors').addEventListener('click', () => this.clearCursors());
    element('trigger-signal').replaceChildren(
      ...configs.flatMap((config) => config.signals.map((signal) => new Option(`${config.title}, ${signal.name}`, signal.column))));
    for (const id of ['trigger-kind', 'trigger-signal', 'trigger-edge', 'trigger-value']) {
      element(id).addEventListener('change', () => this.#armTrigger());
    }
    view.onChange(() => this.#update());
    this.#update();
  }

  togglePause() {
    if (this.#view.isPaused) {
      this.#view.resume();
      this.#armTrigger();
    } else {
      this.#view.pause();
    }
  }

  clearCursors() {
    this.#view.setCursor(0, undefined);
    this.#view.setCursor(1, undefined);
  }

  #armTrigger() {
    const element = this.#element;
    const trigger = this.#trigger;
    trigger.kind = element('trigger-kind').value;
    trigger.column = element('trigger-signal').value;
    trigger.rising = element('trigger-edge').value === 'rising';
    trigger.level = Number(element('trigger-value').value);
    element('trigger-level').hidden = trigger.kind !== 'level';
    element('trigger-unit').textContent = unitOf(trigger.column).unit;
    trigger.arm();
    if (trigger.kind !== 'off' && this.#view.isPaused) {
      this.#view.resume();
    }
  }

  #update() {
    const element = this.#element;
    const { isPaused, span } = this.#view;
    element('pause').textContent = isPaused ? 'Go on' : 'Pause';
    element('pause').setAttribute('aria-pressed', String(isPaused));
    const known = SPANS.find((known) => Math.abs(known / span - 1) < 1e-6);
    element('span').value = known === undefined ? '' : String(known);
  }

  /** Shows the state of the trigger. */
  draw() {
    const state = this.#trigger.isWaiting ? 'waiting' : this.#view.trigger === undefined ? '' : `at ${this.#view.trigger.toFixed(4)} s`;
    const element = this.#element('trigger-state');
    if (element.textContent !== state) element.textContent = state;
  }
}
