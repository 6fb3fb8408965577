// Recorder of edges. For each named pin: its level at the start, and every change as (cycle, level).

export class Edges {
  /** `pins`: { name: GPIO number }; `start`: cycle and levels (bit mask) to begin with. */
  constructor(pins, { cycle = 0, levels = 0 } = {}) {
    this.tracks = Object.entries(pins).map(([name, pin]) => ({
      name,
      pin,
      first: (levels >>> pin) & 1,
      cycles: [],
    }));
    this.byPin = new Map(this.tracks.map((track) => [track.pin, track]));
    if (this.byPin.size !== this.tracks.length) throw new Error('two names for one pin');
    this.start = cycle;
    this.mask = this.tracks.reduce((mask, { pin }) => mask | (1 << pin), 0);
  }

  /** Called by the board on each change of levels. */
  record(stamp, changed) {
    for (let rest = changed & this.mask; rest !== 0; rest &= rest - 1) {
      this.byPin.get(31 - Math.clz32(rest & -rest)).cycles.push(stamp);
    }
  }

  track(name) {
    const track = this.tracks.find((t) => t.name === name);
    if (!track) throw new Error(`no pin called ${name} is recorded`);
    return track;
  }

  /** Every edge of a pin, as [{ cycle, level }]; levels alternate. */
  of(name) {
    const { first, cycles } = this.track(name);
    return cycles.map((cycle, i) => ({ cycle, level: first ^ ((i + 1) & 1) }));
  }

  /** Cycles of the edges of a pin to `level` (1 rising, 0 falling). */
  to(name, level) {
    const { first, cycles } = this.track(name);
    return cycles.filter((_, i) => (first ^ ((i + 1) & 1)) === level);
  }

  /** Level of a pin after the edges with stamps up to `cycle`. */
  levelAt(name, cycle) {
    const { first, cycles } = this.track(name);
    let low = 0;
    let high = cycles.length;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if (cycles[middle] <= cycle) low = middle + 1;
      else high = middle;
    }
    return first ^ (low & 1);
  }
}

const NANOS_PER_CYCLE = 8;

/** The edges as a VCD file, for GTKWave, PulseView and sigrok. Time unit: 1 ns. */
export function toVcd(edges, module = 'board') {
  const id = (i) =>
    String.fromCharCode(33 + (i % 94)) + (i >= 94 ? String.fromCharCode(33 + Math.floor(i / 94)) : '');
  const lines = ['$timescale 1 ns $end', `$scope module ${module} $end`];
  edges.tracks.forEach(({ name }, i) => lines.push(`$var wire 1 ${id(i)} ${name} $end`));
  lines.push('$upscope $end', '$enddefinitions $end', `#${edges.start * NANOS_PER_CYCLE}`, '$dumpvars');
  edges.tracks.forEach(({ first }, i) => lines.push(`${first}${id(i)}`));
  lines.push('$end');

  const changes = edges.tracks.flatMap(({ first, cycles }, i) =>
    cycles.map((cycle, n) => ({ cycle, text: `${first ^ ((n + 1) & 1)}${id(i)}` })),
  );
  changes.sort((a, b) => a.cycle - b.cycle);
  let last = -1;
  for (const { cycle, text } of changes) {
    if (cycle !== last) lines.push(`#${cycle * NANOS_PER_CYCLE}`);
    last = cycle;
    lines.push(text);
  }
  return `${lines.join('\n')}\n`;
}
