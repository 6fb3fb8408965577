// Plot of a preview: amplitude and speed against time, the limits, the states, and the times at which a limit takes effect.
//
// It is one SVG, with a coordinate for each pixel up to a width of 900. The browser scales a wider one. A row of the preview is a column of the plot: curves are
// areas between the smallest and the largest value, with an outline, so that no spike is lost.

import { svg } from './html.js';
import { STATES } from './preview.js';
import { digits, max } from './editor-summary.js';

const GRAVITY = 9.80665;
const TURN = 2 * Math.PI;

/** Coordinates of the drawing. */
const WIDTHS = { min: 320, max: 900 };
const LEFT = 104;
const RIGHT = 12;
const PANELS = [
  { name: 'amplitude', label: 'amplitude, g', top: 44, height: 150 },
  { name: 'speed', label: 'speed, rev/s', top: 218, height: 120 },
];
const STATES_TOP = 4;
const LEGEND = 33;
const LANES_TOP = 352;
const LANE = 13;
const LANES = [
  ['is_lagging', 'acceleration limited', 'lagging'],
  ['is_held_at_band', 'held at band', 'held'],
  ['is_crossing_band', 'crossing band', 'crossing'],
];
const AXIS_TOP = LANES_TOP + LANES.length * LANE + 4;
const HEIGHT = AXIS_TOP + 34;

export class Plot {
  #element;
  #readout;
  #drawing = null;
  #cursor = null;

  constructor(element) {
    this.#element = element;
    this.#readout = document.createElement('p');
    this.#readout.className = 'pe-readout';
    this.#readout.textContent = HINT;
    element.tabIndex = 0;
    element.setAttribute('role', 'group');
    element.setAttribute('aria-label', 'Plot of amplitude and speed against time; arrow keys move a cursor');
    element.append(this.#readout);
    element.addEventListener('pointermove', (event) => this.#point(event));
    element.addEventListener('pointerleave', () => this.#moveTo(null));
    element.addEventListener('keydown', (event) => this.#key(event));
    new ResizeObserver(() => {
      if (this.#drawing && this.#drawing.width !== this.#width) this.draw(this.#drawing.rows, this.#drawing.limits);
    }).observe(element);
  }

  get #width() {
    return Math.min(Math.max(this.#element.clientWidth, WIDTHS.min), WIDTHS.max);
  }

  /** True while the text has mistakes. The plot is then that of the last text without mistakes. */
  set isOutdated(isOutdated) {
    this.#element.classList.toggle('is-outdated', isOutdated);
  }

  /** Draws rows with limits (see host-sim/scope/wasm/src/answer.rs). The limits are null while the first preview grows. */
  draw(rows, limits) {
    if (rows.length === 0) return;
    const end_s = rows.last_s(rows.length - 1);
    const width = this.#width;
    const right = width - RIGHT;
    const x = (t_s) => LEFT + ((right - LEFT) * t_s) / end_s;
    const bands = (limits?.bands_rad_s ?? []).map((band) => band.map((edge) => edge / TURN));
    const amplitude = panel(PANELS[0], Math.max(max(rows, 'requested_mps2'), max(rows, 'commanded_mps2')) / GRAVITY, limits && limits.amax_mps2 / GRAVITY);
    const speed = panel(PANELS[1], Math.max(max(rows, 'speed_rad_s') / TURN, ...bands.map(([, to]) => to)), limits && limits.speed_rad_s / TURN);
    const clip = { x: LEFT, width: right - LEFT };
    const picture = svg(
      'svg',
      { viewBox: `0 0 ${width} ${HEIGHT}`, role: 'img', 'aria-label': 'Amplitude and speed against time' },
      ...bands.map(([from, to]) =>
        svg('rect', { ...clip, y: speed.y(to), height: speed.y(from) - speed.y(to), class: 'pe-band' }),
      ),
      ...bands.map(([from, to]) => label(LEFT + 4, speed.y((from + to) / 2) + 4, `band ${digits(from)} to ${digits(to)} rev/s`, 'pe-limit-text')),
      ...frame(amplitude, right),
      ...frame(speed, right),
      ...limit(amplitude, right, 'g at the greatest speed'),
      ...limit(speed, right, 'rev/s'),
      curve(rows, 'requested_mps2', GRAVITY, x, amplitude, 'pe-requested'),
      curve(rows, 'commanded_mps2', GRAVITY, x, amplitude, 'pe-commanded'),
      curve(rows, 'speed_rad_s', TURN, x, speed, 'pe-speed'),
      ...states(rows, x),
      ...LANES.flatMap((lane, i) => lanes(rows, x, lane, LANES_TOP + i * LANE)),
      ...timeAxis(end_s, x, right),
      ...legend(),
    );
    this.#cursor = svg('line', { y1: PANELS[0].top, y2: AXIS_TOP, class: 'pe-cursor', visibility: 'hidden' });
    picture.append(this.#cursor);
    this.#element.querySelector('svg')?.remove();
    this.#element.prepend(picture);
    this.#drawing = { rows, limits, width, x, picture, row: null };
  }

  #point(event) {
    if (!this.#drawing) return;
    this.#readout.removeAttribute('aria-live');
    const { rows, picture, width } = this.#drawing;
    const box = picture.getBoundingClientRect();
    const at = ((event.clientX - box.left) / box.width) * width;
    const part = (at - LEFT) / (width - LEFT - RIGHT);
    const t_s = part * rows.last_s(rows.length - 1);
    this.#moveTo(part < 0 || part > 1 ? null : rowAt(rows, t_s));
  }

  #key(event) {
    const steps = { ArrowLeft: -1, ArrowRight: 1, PageUp: -50, PageDown: 50, Home: -Infinity, End: Infinity };
    const step = steps[event.key];
    if (step === undefined || !this.#drawing || event.target !== this.#element) return;
    event.preventDefault();
    // Values at the pointer are not announced, because they change with every pixel.
    this.#readout.setAttribute('aria-live', 'polite');
    const { rows, row } = this.#drawing;
    this.#moveTo(Math.min(rows.length - 1, Math.max(0, (row ?? 0) + (event.shiftKey ? 10 : 1) * step)));
  }

  #moveTo(row) {
    if (!this.#drawing) return;
    const { rows, x } = this.#drawing;
    this.#drawing.row = row;
    this.#cursor.setAttribute('visibility', row === null ? 'hidden' : 'visible');
    if (row === null) {
      this.#readout.textContent = HINT;
      return;
    }
    const at = x(rows.last_s(row));
    this.#cursor.setAttribute('x1', at);
    this.#cursor.setAttribute('x2', at);
    const g = (channel) => `${digits(rows.high(row, channel) / GRAVITY)} g`;
    const speed = rows.high(row, 'speed_rad_s');
    const active = LANES.filter(([channel]) => rows.high(row, channel) > 0).map(([, words]) => words);
    this.#readout.textContent = [
      `${rows.last_s(row).toFixed(3)} s, ${STATES[rows.high(row, 'state')]}`,
      `requested ${g('requested_mps2')}`,
      `commanded ${g('commanded_mps2')}`,
      `${digits(speed / TURN)} rev/s (${digits(speed)} rad/s)`,
      ...active,
    ].join(' · ');
  }
}

const HINT = 'Point at the plot, or focus it and use the arrow keys, to read values.';

/** Returns the row that contains a time. */
function rowAt(rows, t_s) {
  let [low, high] = [0, rows.length - 1];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (rows.last_s(middle) < t_s) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Returns a panel with its scale. A limit far beyond the data is not drawn, so that it does not flatten the curves. */
function panel(place, max, limit) {
  const isDrawn = Boolean(limit) && limit <= 3 * max;
  const top = Math.max(max, isDrawn ? limit : 0) * 1.08 || 1;
  return { ...place, scale: top, limit, isDrawn, y: (value) => place.top + place.height * (1 - value / top) };
}

function label(x, y, text, className = '', anchor = 'start') {
  return svg('text', { x, y, class: className, 'text-anchor': anchor }, text);
}

function frame({ label: name, top, height, scale, y }, right) {
  const lines = ticks(scale, 4).flatMap((value) => [
    svg('line', { x1: LEFT, x2: right, y1: y(value), y2: y(value), class: 'pe-grid' }),
    label(LEFT - 6, y(value) + 4, digits(value), '', 'end'),
  ]);
  const middle = top + height / 2;
  const title = label(14, middle, name, 'pe-title', 'middle');
  title.setAttribute('transform', `rotate(-90 14 ${middle})`);
  return [...lines, title];
}

function limit({ limit: value, isDrawn, scale, y, top }, right, unit) {
  if (!value) return [];
  const text = `limit ${digits(value)} ${unit}${isDrawn ? '' : ' (beyond)'}`;
  const at = isDrawn ? y(value) : top;
  // The name of a limit that is not drawn is above the panel, where no curve is.
  const words = label(right - 4, isDrawn ? at + 13 : at - 4, text, 'pe-limit-text', 'end');
  if (!isDrawn || value > scale) return [words];
  return [svg('line', { x1: LEFT, x2: right, y1: at, y2: at, class: 'pe-limit' }), words];
}

function curve(rows, channel, unit, x, { y }, className) {
  const point = (row, value) => `${x(rows.last_s(row)).toFixed(1)},${y(value / unit).toFixed(1)}`;
  const all = Array.from({ length: rows.length }, (_, row) => row);
  const upper = all.map((row) => point(row, rows.high(row, channel)));
  const lower = all.map((row) => point(row, rows.low(row, channel))).reverse();
  return svg('path', { d: `M${[...upper, ...lower].join('L')}Z`, class: `pe-curve ${className}` });
}

/** Returns the runs of rows with equal values: first and last row, and the value. */
function runs(rows, value) {
  const found = [];
  for (let row = 0; row < rows.length; row++) {
    const now = value(row);
    if (found.at(-1)?.value === now) found.at(-1).last = row;
    else found.push({ first: row, last: row, value: now });
  }
  return found;
}

function states(rows, x) {
  return runs(rows, (row) => rows.high(row, 'state')).flatMap(({ first, last, value }) => {
    const from = x(rows.first_s(first));
    const width = Math.max(1, x(rows.last_s(last)) - from);
    const name = STATES[value];
    const rect = svg('rect', { x: from, y: STATES_TOP, width, height: 15, class: `pe-state pe-state-${name}` }, svg('title', {}, name));
    return width > 7 * name.length ? [rect, label(from + 4, STATES_TOP + 11.5, name, 'pe-state-text')] : [rect];
  });
}

function lanes(rows, x, [channel, words, className], top) {
  const isSet = runs(rows, (row) => rows.high(row, channel)).filter(({ value }) => value > 0);
  const marks = isSet.map(({ first, last }) => {
    const from = x(rows.first_s(first));
    return svg('rect', { x: from, y: top + 2, width: Math.max(1, x(rows.last_s(last)) - from), height: LANE - 4, class: `pe-lane-${className}` });
  });
  // A lane without marks has no label.
  return marks.length === 0 ? [] : [...marks, label(LEFT - 6, top + LANE - 3, words, 'pe-lane-text', 'end')];
}

function timeAxis(end_s, x, right) {
  const marks = ticks(end_s, Math.round((right - LEFT) / 80)).flatMap((t_s) => [
    svg('line', { x1: x(t_s), x2: x(t_s), y1: PANELS[0].top, y2: AXIS_TOP, class: 'pe-grid' }),
    label(x(t_s), AXIS_TOP + 13, digits(t_s), '', 'middle'),
  ]);
  return [...marks, label((LEFT + right) / 2, AXIS_TOP + 30, 'time since power-up, s', 'pe-title', 'middle')];
}

/** Returns about `count` round numbers from 0 to `max`. */
function ticks(max, count) {
  const raw = max / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= raw);
  return Array.from({ length: Math.floor(max / step + 1e-9) + 1 }, (_, i) => i * step);
}

function legend() {
  return [
    ['pe-requested', 'requested', LEFT],
    ['pe-commanded', 'commanded', LEFT + 90],
  ].flatMap(([className, name, x]) => [
    svg('line', { x1: x, x2: x + 18, y1: LEGEND, y2: LEGEND, class: `pe-curve ${className}` }),
    label(x + 23, LEGEND + 4, name),
  ]);
}
