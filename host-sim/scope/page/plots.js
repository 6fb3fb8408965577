// Plots over time. All share one window and its cursors.

/* global uPlot */
import { Decimation } from './decimation.js';
import { unitOf } from './signals.js';

/** Width of the scale at the left, CSS pixels. */
export const LEFT = 58;

/** Returns a colour of style.css in the current theme. */
export function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

export class Plot {
  #element;
  #plot;
  #view;
  #config;
  #hidden = new Set();
  #hasTimes;
  #decimation;
  /** Points that were drawn last, in the form for uPlot. Tests read them. */
  data = [[]];

  /** @param {boolean} hasTimes True if this plot has the scale of time. */
  constructor(parent, config, view, hasTimes) {
    this.#hasTimes = hasTimes;
    this.#view = view;
    this.#config = config;
    this.#decimation = new Decimation(config.signals.map((signal) => signal.column));
    this.#element = document.createElement('figure');
    this.#element.className = 'plot';
    this.#element.dataset.plot = config.id;
    this.#element.style.flexGrow = config.share;
    const marks = config.marks.flatMap(({ name }) => name ?? []);
    this.#element.setAttribute('aria-label', [`${config.title} over time, ${config.unit}`, ...marks].join('; '));
    const head = document.createElement('figcaption');
    const title = document.createElement('strong');
    title.textContent = config.title;
    const unit = document.createElement('span');
    unit.className = 'unit';
    unit.textContent = config.unit;
    head.append(title, unit, ...config.signals.map((signal, i) => this.#legend(signal, i)));
    this.canvas = document.createElement('div');
    this.canvas.className = 'canvas';
    this.#element.append(head, this.canvas);
    parent.append(this.#element);
  }

  /** A switch for each signal, which shows its colour. */
  #legend(signal, i) {
    const button = document.createElement('button');
    button.type = 'button';
    button.className = 'legend';
    button.setAttribute('aria-pressed', 'true');
    button.style.setProperty('--color', `var(${signal.color})`);
    button.textContent = signal.name;
    button.addEventListener('click', () => {
      const isHidden = !this.#hidden.delete(i) && Boolean(this.#hidden.add(i));
      button.setAttribute('aria-pressed', String(!isHidden));
      this.#plot?.setSeries(i + 1, { show: !isHidden });
    });
    return button;
  }

  /** Makes the plot again, in the colours of the theme. */
  build() {
    this.#plot?.destroy();
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const axis = {
      stroke: color('--muted'),
      grid: { stroke: color('--grid'), width: 1 },
      ticks: { show: false },
      font: '11px system-ui, sans-serif',
    };
    const { signals } = this.#config;
    this.#plot = new uPlot(
      {
        width,
        height,
        padding: [8, 8, this.#hasTimes ? 0 : 8, 0],
        legend: { show: false },
        cursor: { show: true, points: { show: false }, drag: { x: true, y: false, setScale: false }, sync: { key: 'time' } },
        select: { show: true },
        scales: { x: { time: false, auto: false }, y: { range: (_, min, max) => range(min, max, this.#config) } },
        axes: [
          { ...axis, size: this.#hasTimes ? 20 : 0, gap: 3, values: (_, ticks) => ticks.map((t) => (this.#hasTimes ? `${+t.toFixed(4)} s` : '')) },
          { ...axis, size: LEFT, gap: 4, values: (_, ticks) => ticks.map((y) => String(+y.toPrecision(6))) },
        ],
        series: [
          {},
          ...signals.map((signal, i) => ({
            stroke: color(signal.color),
            width: 1.5,
            dash: signal.dash,
            points: { show: false },
            show: !this.#hidden.has(i),
            spanGaps: false,
          })),
        ],
        hooks: {
          drawAxes: [(plot) => this.#drawMarks(plot)],
          draw: [(plot) => this.#drawNames(plot), (plot) => this.#drawCursors(plot)],
          setSelect: [(plot) => this.#select(plot)],
        },
      },
      [[]],
      this.canvas,
    );
    this.canvas.onclick = (event) => this.#place(event);
    this.canvas.onwheel = (event) => {
      event.preventDefault();
      this.#view.zoom(Math.sign(event.deltaY), this.#view.isPaused ? this.#timeAt(event) : undefined);
    };
  }

  resize() {
    this.#plot?.setSize({ width: this.canvas.clientWidth, height: this.canvas.clientHeight });
  }

  draw() {
    const { from, to, history } = this.#view;
    if (!this.#plot || history.isEmpty) {
      return;
    }
    const pixels = Math.max(Math.floor(this.#plot.bbox.width / devicePixelRatio), 1);
    this.data = this.#decimation.points(history, from, to, pixels);
    this.#config.signals.forEach(({ column: name }, c) => {
      const { scale } = unitOf(name);
      if (scale !== 1) {
        const column = this.data[c + 1];
        for (let i = 0; i < column.length; i++) {
          column[i] = column[i] === null ? null : column[i] * scale;
        }
      }
    });
    this.#plot.batch(() => {
      this.#plot.setData(this.data, false);
      this.#plot.setScale('x', { min: from, max: to });
    });
  }

  #timeAt(event) {
    const box = this.#plot.over.getBoundingClientRect();
    return this.#plot.posToVal(event.clientX - box.left, 'x');
  }

  /** Places cursor A on a click, or cursor B on a click with Shift. A drag is no click. */
  #place(event) {
    if (!this.wasDragged) {
      this.#view.setCursor(event.shiftKey ? 1 : 0, this.#timeAt(event));
    }
    this.wasDragged = false;
  }

  /** Zooms to the range of a drag. */
  #select(plot) {
    const { left, width } = plot.select;
    if (width < 4) {
      return;
    }
    this.wasDragged = true;
    const [from, to] = [plot.posToVal(left, 'x'), plot.posToVal(left + width, 'x')];
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    this.#view.pause();
    this.#view.show(from, to - from);
  }

  /** Draws limits as dashed lines and forbidden bands as areas, behind the curves. */
  #drawMarks(plot) {
    const { ctx, bbox } = plot;
    const { min, max } = plot.scales.y;
    ctx.save();
    ctx.fillStyle = color('--warn');
    ctx.strokeStyle = color('--warn');
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
    for (const { from, to } of this.#config.marks) {
      ctx.globalAlpha = 0.15;
      ctx.fillRect(bbox.left, place(plot, to), bbox.width, place(plot, from) - place(plot, to));
      ctx.globalAlpha = 1;
      for (const edge of new Set([from, to])) {
        if (edge < min || edge > max) continue;
        const y = Math.round(place(plot, edge)) + 0.5;
        ctx.beginPath();
        ctx.moveTo(bbox.left, y);
        ctx.lineTo(bbox.left + bbox.width, y);
        ctx.stroke();
      }
    }
    ctx.restore();
  }

  /** Names the limits and bands, in front of the curves. An arrow names what is beyond the scale. */
  #drawNames(plot) {
    const { ctx, bbox } = plot;
    const { min, max } = plot.scales.y;
    const line = 13 * devicePixelRatio;
    /** Left ends of the names so far, by the lines of text in which they are. */
    const lefts = [];
    ctx.save();
    ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.textAlign = 'right';
    for (const { name, from, to } of this.#config.marks) {
      if (name === undefined) continue;
      const text = from > max ? `↑ ${name}` : to < min ? `↓ ${name}` : name;
      // A name is above the upper edge if there is room, and left of another name.
      const top = place(plot, to);
      const y = top - line >= bbox.top ? top - 3 * devicePixelRatio : top + line;
      const row = Math.round(y / line);
      const right = Math.min(...[row - 1, row, row + 1].map((near) => lefts[near] ?? bbox.left + bbox.width)) - line / 2;
      lefts[row] = right - ctx.measureText(text).width;
      ctx.fillStyle = color('--panel');
      ctx.globalAlpha = 0.8;
      ctx.fillRect(lefts[row], y - line + 3 * devicePixelRatio, right - lefts[row], line);
      ctx.globalAlpha = 1;
      ctx.fillStyle = color('--warn');
      ctx.fillText(text, right, y);
    }
    ctx.restore();
  }

  #drawCursors(plot) {
    const { ctx, bbox } = plot;
    const marks = [
      ...this.#view.cursors.map((time, i) => ({ time, name: 'AB'[i], color: color('--cursor') })),
      { time: this.#view.trigger, name: 'T', color: color('--trigger') },
    ];
    ctx.save();
    ctx.font = `bold ${11 * devicePixelRatio}px system-ui, sans-serif`;
    for (const mark of marks) {
      if (mark.time === undefined || mark.time < this.#view.from || mark.time > this.#view.to) {
        continue;
      }
      const x = Math.round(plot.valToPos(mark.time, 'x', true)) + 0.5;
      ctx.strokeStyle = mark.color;
      ctx.fillStyle = mark.color;
      ctx.lineWidth = devicePixelRatio;
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
      ctx.fillText(mark.name, x + 3 * devicePixelRatio, bbox.top + 10 * devicePixelRatio);
    }
    ctx.restore();
  }
}

/** Returns the place of a value on the canvas; that of the nearer end of the scale if it is beyond. */
function place(plot, value) {
  const { top, height } = plot.bbox;
  return Math.min(Math.max(plot.valToPos(value, 'y', true), top), top + height);
}

/** A limit is part of the scale if the values reach this part of it. A limit far beyond would flatten the curves. */
const NEAR = 1 / 3;

/**
 * Returns the range of the scale: all values with some room, at least ±`min`, wide enough to keep noise small, and the edges of
 * limits and bands that are near.
 */
function range(min, max, { min: side = 0, marks }) {
  if (min === null || max === null) {
    return [-Math.max(side, 1), Math.max(side, 1)];
  }
  const size = Math.max(Math.abs(min), Math.abs(max));
  const near = marks.filter(({ from }) => Math.abs(from) * NEAR <= size).flatMap(({ from, to }) => [from, to]);
  const [low, high] = [Math.min(min, ...near), Math.max(max, ...near)];
  const room = Math.max(0.08 * (high - low), 0.02 * Math.max(Math.abs(low), Math.abs(high)), 0.01);
  return [Math.min(low - room, -side), Math.max(high + room, side)];
}
