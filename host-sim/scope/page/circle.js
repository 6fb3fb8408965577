// The circle of motors, with the phase error of each, and the tilt as a spirit level. Both are SVG.

const SVG = 'http://www.w3.org/2000/svg';

/** Least full scale of a needle, degrees of crank angle. It doubles until the largest phase error fits. */
const MIN_SCALE_DEG = 1;

/** Radius of the circle of motors, in the drawing. */
const RADIUS = 66;

/** Angle of a needle at full scale, degrees. */
const NEEDLE_DEG = 60;

function make(parent, name, attributes = {}, text = undefined) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) {
    element.setAttribute(key, value);
  }
  if (text !== undefined) {
    element.textContent = text;
  }
  parent.append(element);
  return element;
}

/** Writes a text if it differs, so that the browser does not lay out an equal text again. */
function write(element, text) {
  if (element.textContent !== text) {
    element.textContent = text;
  }
}

/** Returns the text of a number with its sign and a number of digits. */
export function signed(value, digits) {
  if (!Number.isFinite(value)) return '–';
  const text = value.toFixed(digits);
  return value >= 0 || Number(text) === 0 ? `+${text.replace('-', '')}` : text.replace('-', '−');
}

export class Circle {
  #motors;
  #scale;
  #crank;

  /** @param {HTMLElement} scale Element for the full scale of the needles. */
  constructor(svg, scale, axes) {
    this.#scale = scale;
    svg.setAttribute('viewBox', '-110 -106 220 218');
    make(svg, 'circle', { r: RADIUS, class: 'mount' });
    make(svg, 'circle', { r: 15, class: 'dial' });
    this.#crank = make(svg, 'line', { x1: 0, y1: 0, x2: 0, y2: -15, class: 'crank' });
    make(svg, 'circle', { r: 2.5, class: 'hub' });
    this.#motors = Array.from({ length: axes }, (_, i) => {
      // Axis 0 is on the x axis. The others follow anticlockwise.
      const angle = (2 * Math.PI * i) / axes;
      const group = make(svg, 'g', { transform: `translate(${RADIUS * Math.cos(angle)} ${-RADIUS * Math.sin(angle)})` });
      group.style.setProperty('--color', `var(--axis-${i})`);
      make(group, 'circle', { r: 23, class: 'motor' });
      for (const end of [-NEEDLE_DEG, 0, NEEDLE_DEG]) {
        make(group, 'line', { x1: 0, y1: -22, x2: 0, y2: -17, class: 'mark', transform: `rotate(${end})` });
      }
      const needle = make(group, 'line', { x1: 0, y1: 0, x2: 0, y2: -20, class: 'needle' });
      make(group, 'text', { y: 16, class: 'name' }, String(i));
      // Values of the upper motors are above them, so that they do not overlap another motor.
      const value = make(group, 'text', { y: Math.sin(angle) > 0.1 ? -28 : 36, class: 'value' });
      return { needle, value };
    });
  }

  /** Shows phase errors, degrees, and the phase of the master, turns. */
  draw(errors, phase) {
    const max = Math.max(MIN_SCALE_DEG, ...errors.map(Math.abs).filter(Number.isFinite));
    const scale = MIN_SCALE_DEG * 2 ** Math.ceil(Math.log2(max / MIN_SCALE_DEG));
    write(this.#scale, `(needles: ±${scale}°)`);
    this.#crank.setAttribute('transform', `rotate(${(phase * 360).toFixed(1)})`);
    errors.forEach((error, i) => {
      const { needle, value } = this.#motors[i];
      needle.setAttribute('transform', `rotate(${((NEEDLE_DEG * error) / scale || 0).toFixed(2)})`);
      write(value, `${signed(error, 2)}°`);
    });
  }
}

export class Level {
  #bubble;
  #value;
  #limit;
  #svg;

  /**
   * @param {HTMLElement} value Element for the tilt.
   * @param {number} limit Limit of the tilt, mrad: the outer ring.
   */
  constructor(svg, value, limit) {
    this.#svg = svg;
    this.#value = value;
    this.#limit = limit;
    svg.setAttribute('viewBox', '-90 -90 180 180');
    make(svg, 'circle', { r: 80, class: 'limit' });
    make(svg, 'circle', { r: 40, class: 'mount' });
    make(svg, 'line', { x1: -80, x2: 80, y1: 0, y2: 0, class: 'mark' });
    make(svg, 'line', { y1: -80, y2: 80, x1: 0, x2: 0, class: 'mark' });
    make(svg, 'text', { y: 60, class: 'limit-name' }, `limit ${+limit.toPrecision(3)} mrad`);
    this.#bubble = make(svg, 'circle', { r: 12, class: 'bubble' });
  }

  /** Shows the tilt along x and y, mrad. The bubble of a tilt beyond the limit is on the ring, and red. */
  draw(x, y) {
    const size = Math.hypot(x, y);
    const place = size > 0 ? Math.min((80 * size) / this.#limit, 80) / size : 0;
    this.#bubble.setAttribute('cx', (place * x || 0).toFixed(1));
    this.#bubble.setAttribute('cy', (-place * y || 0).toFixed(1));
    write(this.#value, Number.isFinite(size) ? `${size.toFixed(3)} mrad` : '');
    this.#svg.classList.toggle('beyond', size > this.#limit);
  }
}
