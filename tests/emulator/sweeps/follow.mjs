// Edges against the host's prediction, with standstills in between.
//
// A machine that misses deadlines stands for whole ticks and goes on. So each edge is a whole number of ticks later than
// predicted. This number is the same for all edges of a tick, on all axes, and never smaller than in the tick before. To a
// tick belong the edges after its first cycle, up to the first of the next.
//
// Blocks that were released together run together to the cycle. Between the two stores that release them, a delay may occur
// that is too short to be detected (firmware/src/board/steps/release.rs). Then the blocks are apart by that delay.

import * as pins from '../bench/pins.mjs';

/** From a deadline to the first cycle of its tick, where all machines begin again: as in scenarios/parity.mjs. */
const MAX_OFFSET = 25;

/** The longest delay between the two releases that is not detected, cycles. */
const MAX_APART = 31;

export class Follow {
  /** Follows a machine that has made some steps, which are `predicted`, from `began` on. */
  constructor(machine, predicted, began) {
    const { edges } = machine.board;
    this.machine = machine;
    this.origin = undefined;
    this.wires = [];
    for (let axis = 0; axis < machine.axes; axis += 1) {
      for (const name of [`step_${axis}`, `dir_${axis}`]) {
        const expected = Float64Array.from(predicted.edges.get(name), ({ cycle }) => cycle);
        const { cycles } = edges.track(name);
        const before = cycles.findIndex((cycle) => cycle >= began);
        const first = before < 0 ? cycles.length : before;
        this.wires.push({ name, expected, first, block: pins.blockOf(axis) });
        if (name === 'step_0') this.origin = cycles[first] - expected[0];
      }
    }
  }

  /**
   * All edges so far: { stood: ticks that the machine stood for, apart: cycles between the blocks, last: the last tick with an
   * edge, wrong }.
   */
  compare() {
    const { tick } = this.machine;
    const late = new Map();
    const wrong = [];
    let next = Infinity;
    let apart = 0;
    for (const { name, expected, first, block } of this.wires) {
      const { cycles } = this.machine.board.edges.track(name);
      for (let i = first; i < cycles.length; i += 1) {
        const due = expected[i - first];
        if (due === undefined) {
          wrong.push(`${name} has an edge more than predicted, at ${cycles[i]}`);
          break;
        }
        const number = Math.ceil(due / tick) - 1;
        const by = cycles[i] - this.origin - due;
        const others = late.get(number);
        if (others === undefined) late.set(number, { by, name, block });
        else if (others.by !== by && block !== others.block && Math.abs(others.by - by) <= MAX_APART) {
          apart = Math.max(apart, Math.abs(others.by - by));
        } else if (others.by !== by) {
          wrong.push(`in tick ${number}, ${name} is ${by} cycles late, and ${others.name} ${others.by}`);
          break;
        }
      }
      // A missing edge at the end: the first edge that has not come, of the wire that is the furthest behind.
      next = Math.min(next, expected[cycles.length - first] ?? Infinity);
    }
    let stood = 0;
    let last = 0;
    for (const [number, { by }] of [...late].sort(([a], [b]) => a - b)) {
      const ticks = Math.round(by / tick);
      const rest = Math.abs(by - ticks * tick);
      if (ticks < stood) wrong.push(`tick ${number} is ${ticks} late, and the one before it ${stood}`);
      if (rest > MAX_OFFSET + MAX_APART) wrong.push(`tick ${number} is ${by - ticks * tick} cycles off the deadlines' grid`);
      stood = Math.max(stood, ticks);
      last = number;
    }
    if (wrong.length === 0 && last * tick > next) wrong.push(`an edge of cycle ${next} is missing`);
    return { stood, apart, wrong, last };
  }
}

/** Deadlines missed since power-up, by the log. */
export function missed(lines) {
  const counts = lines.map((line) => line.match(/(\d+) deadlines missed in all/)).filter(Boolean);
  return counts.length === 0 ? 0 : Number(counts[counts.length - 1][1]);
}

/**
 * True if the axes at rest are at the positions that one phase of the master gives, each within a step. `perTurn`: steps of
 * each axis for a turn of the master.
 */
export function inProportion(steps, perTurn) {
  const min = Math.max(...steps.map((count, axis) => (count - 1) / perTurn[axis]));
  const max = Math.min(...steps.map((count, axis) => (count + 1) / perTurn[axis]));
  return min <= max;
}

