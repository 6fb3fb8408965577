// The cranks of a machine while its firmware runs: they follow STEP and DIR, and their flags drive the index lines. For runs
// that cannot be predicted, because somebody commands the board as it runs. Kinematic: no crank slips or lags.
//
// Replaces the recorder of edges (board.edges). It keeps no edges, because a run may last for hours.

import { CYCLES_PER_US } from '../board/clock.mjs';
import * as pins from './pins.mjs';

/** How long a flag without a length holds its line (docs/scenes.md), at least twice the width that counts. */
const PULSE_US = 20;
const DEFAULT_WIDTH_US = 2;

class Crank {
  /** `axis`: the scene's settings of one axis, its own over those of all. */
  constructor(axis, step, dir, index) {
    Object.assign(this, { step, dir, index });
    this.reversed = axis.reversed ?? false;
    const [motor, crank] = axis.gear ?? [1, 1];
    /** Steps per turn of the crank. */
    this.stepsPerTurn = (axis.steps_per_turn * motor) / crank;
    const steps = (deg) => (deg / 360) * this.stepsPerTurn;
    /** Position in steps. The loop assumes that the crank is at its offset at power-up. */
    this.start = steps((axis.offset_deg ?? 0) + (axis.start_deg ?? 0));
    this.at = this.start;
    this.hasIndex = axis.index ?? true;
    this.flag = steps(axis.index_deg ?? 0);
    this.width = steps(axis.index_width_deg ?? 0);
  }

  /** Steps beyond the beginning of the flag, less than a turn. */
  get beyondFlag() {
    const beyond = (this.at - this.flag) % this.stepsPerTurn;
    return beyond < 0 ? beyond + this.stepsPerTurn : beyond;
  }

  get isOver() {
    return this.beyondFlag < this.width;
  }
}

export class Cranks {
  /** `toml`: a scene; `inverted`: pins of the other active level (pins.mjs). */
  constructor(board, toml, inverted = pins.inverted(toml.wiring)) {
    this.board = board;
    this.inverted = [...inverted].reduce((mask, pin) => mask | (1 << pin), 0);
    this.cranks = Array.from({ length: toml.axes.count }, (_, number) => {
      const own = toml.axis?.find((axis) => axis.number === number);
      return new Crank({ ...toml.axes, ...own }, pins.STEP[number], pins.DIR[number], pins.INDEX[number]);
    });
    this.pulseCycles = Math.round(Math.max(PULSE_US, 2 * (toml.index?.width_us ?? DEFAULT_WIDTH_US)) * CYCLES_PER_US);
    this.mask = this.cranks.reduce((mask, { step }) => mask | (1 << step), 0);
    board.edges = this;
    for (const crank of this.cranks) this.set(board.cycle, crank);
  }

  /** Called by the board on each change of levels. */
  record(stamp, changed) {
    const levels = this.board.pads.levels ^ this.inverted;
    const rising = changed & levels & this.mask;
    if (rising === 0 || !((levels >>> pins.DRIVE_ENABLE) & 1)) return;
    for (const crank of this.cranks) {
      if ((rising >>> crank.step) & 1) this.turn(crank, ((levels >>> crank.dir) & 1) !== Number(crank.reversed), stamp + 1);
    }
  }

  turn(crank, forward, cycle) {
    const was = crank.isOver;
    crank.at += forward ? 1 : -1;
    if (!crank.hasIndex) return;
    if (crank.width > 0) {
      if (crank.isOver !== was) this.set(cycle, crank);
    } else if (forward && crank.beyondFlag < 1) {
      this.board.stimulus.pulse(cycle, crank.index, this.pulseCycles, this.level(crank, true));
    }
  }

  /** Turns the cranks back to their initial positions. */
  place() {
    for (const crank of this.cranks) {
      crank.at = crank.start;
      if (crank.hasIndex) this.set(this.board.cycle, crank);
    }
  }

  /** Level of a crank's index line. */
  level(crank, isOver) {
    return Number(isOver !== Boolean((this.inverted >>> crank.index) & 1));
  }

  set(cycle, crank) {
    this.board.stimulus.at(cycle, crank.index, this.level(crank, crank.isOver));
  }
}
