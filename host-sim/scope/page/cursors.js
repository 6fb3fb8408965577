// Tables of the values at both cursors, with their difference and unit.

import { unitOf } from './signals.js';

const HEAD = ['signal', 'A', 'B', 'B − A', 'unit'];

export class Cursors {
  #element;
  #view;
  #plots;

  /** @param {object[]} plots Plots, as `plots` of signals.js returns them. */
  constructor(element, view, plots) {
    this.#element = element;
    this.#view = view;
    this.#plots = plots;
  }

  update() {
    const { cursors, history } = this.#view;
    const places = cursors.map((time) => (time === undefined ? undefined : history.nearest(time)));
    this.#element.hidden = places.every((place) => place === undefined);
    if (this.#element.hidden) return;
    const [a, b] = cursors;
    const times = [
      row('time', a, b, 's', 4),
      row('1 / difference', undefined, undefined, 'Hz', 3, 1 / Math.abs(b - a)),
    ];
    const rows = this.#plots.map((plot) => plot.signals.map((signal) => {
      const { unit, scale, digits } = unitOf(signal.column);
      const [one, other] = places.map((i) => (i === undefined ? undefined : history.value(signal.column, i) * scale));
      const line = row(`${plot.title}, ${signal.short ?? signal.name}`, one, other, unit, digits);
      line.firstChild.style.setProperty('--color', `var(${signal.color})`);
      line.firstChild.className = 'signal';
      return line;
    }));
    // The left table shows the motion. The right table shows the differences between cranks.
    this.#element.replaceChildren(table([times, ...rows.slice(0, 2)]), table(rows.slice(2)));
  }
}

function table(groups) {
  const element = document.createElement('table');
  const head = element.createTHead().insertRow();
  for (const name of HEAD) {
    const cell = document.createElement('th');
    cell.scope = 'col';
    cell.textContent = name;
    head.append(cell);
  }
  element.createTBody().append(...groups.flat());
  return element;
}

/** Returns the text of a number with a number of digits. Zero has no sign. */
function text(value, digits) {
  const digitsOnly = value.toFixed(digits);
  return Number(digitsOnly) === 0 ? digitsOnly.replace('-', '') : digitsOnly.replace('-', '−');
}

function row(name, a, b, unit, digits, difference = b - a) {
  const line = document.createElement('tr');
  const head = document.createElement('th');
  head.scope = 'row';
  head.textContent = name;
  line.append(head);
  for (const value of [a, b, difference]) {
    line.insertCell().textContent = Number.isFinite(value) ? text(value, digits) : '';
  }
  const cell = line.insertCell();
  cell.className = 'unit';
  cell.textContent = unit;
  return line;
}
