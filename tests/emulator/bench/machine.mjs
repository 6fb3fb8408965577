// A board with the firmware in its flash, settings in a slot, and an operator at its inputs.

import fs from 'node:fs';
import { Board } from '../board/board.mjs';
import { CYCLES_PER_US } from '../board/clock.mjs';
import { FLASH_SIZE } from '../board/elf.mjs';
import { TIMER_IRQ_1 } from '../board/usage.mjs';
import { MISS_CYCLES } from '../board/xip-cache.mjs';
import * as pins from './pins.mjs';
import { FIRMWARE } from './paths.mjs';

export const CYCLES_PER_S = 1e6 * CYCLES_PER_US;

/** Offsets of the settings slots in the flash (firmware/link/src/layout.rs). */
export const SLOT_A = 0x1f_0000;
export const SLOT_B = 0x1f_8000;

/** Number of runs of the loop among which at least one begins without delay. The first run after a reset is at no deadline. */
const RUNS = 8;

/** The button must be steady this long to count (firmware/core/src/panel.rs), and a little more. */
const STEADY_S = 0.0105;

let elf;

/** The firmware's bytes. */
export function firmware() {
  elf ??= fs.readFileSync(FIRMWARE);
  return elf;
}

/** A flash with a settings file placed in the first slot, as `probe-rs download` would. */
export function flashWith(settings) {
  const flash = new Uint8Array(FLASH_SIZE).fill(0xff);
  if (settings) flash.set(settings, SLOT_A);
  return flash;
}

export class Machine {
  /**
   * `scene` and `settings` as in host.mjs; `flash`: a flash to use instead of one with the settings; `options` go to the board.
   * Levels here are those of the usual wiring: `inverted` pins have the others.
   */
  constructor({ axes, tickHz, settings, flash, inverted = new Set(), options = {} }) {
    this.axes = axes;
    this.inverted = inverted;
    this.tick = CYCLES_PER_S / tickHz;
    this.board = new Board({
      elf: firmware(),
      flash: flash ?? flashWith(settings),
      pins: pins.outputs(axes),
      watched: [TIMER_IRQ_1],
      missCycles: MISS_CYCLES,
      ...options,
    });
    for (const track of this.board.edges.tracks ?? []) track.first ^= Number(inverted.has(track.pin));
    this.set(pins.ENABLE, 0);
    this.set(pins.STOP, 0);
    this.set(pins.START, 1);
    for (let axis = 0; axis < axes; axis += 1) this.set(pins.ALARM[axis], 0);
  }

  /** Sets an input, now or at a cycle; null is a broken wire. */
  set(pin, level, cycle = this.board.cycle) {
    const isInverted = level !== null && this.inverted.has(pin);
    this.board.stimulus.at(cycle, pin, isInverted ? 1 - Number(level) : level);
  }

  run(seconds) {
    return this.board.run({ cycles: Math.round(seconds * CYCLES_PER_S) });
  }

  level(name) {
    return this.board.edges.levelAt(name, this.board.cycle);
  }

  /** Runs until the loop meets its deadlines. */
  boot() {
    const { calls } = this.board.usage;
    const met = (board) => board.usage.calls.get(TIMER_IRQ_1).length > 3;
    const { reason } = this.board.run({ cycles: 2 * CYCLES_PER_S, until: met });
    if (reason !== 'until') throw new Error(`the loop did not begin within 2 s: ${reason}, ${calls.get(TIMER_IRQ_1).length} calls`);
  }

  /** Releases, presses and releases the button. Afterwards its command has been given. */
  press() {
    this.set(pins.START, 1);
    this.run(STEADY_S);
    this.set(pins.START, 0);
    this.run(STEADY_S);
    this.set(pins.START, 1);
  }

  /**
   * Starts the machine. Gives the cycle of the deadline at which the loop read the start, taken from its interrupt. All times of
   * the host count from this cycle.
   */
  start() {
    this.set(pins.START, 1);
    this.run(STEADY_S);
    this.set(pins.START, 0);
    const began = this.begins();
    this.set(pins.START, 1);
    return began;
  }

  /** Runs until a start switches the drives on. Gives the same cycle as `start`. */
  begins() {
    const on = (board) => board.edges.levelAt('enable', board.cycle) === 1;
    const { reason } = this.board.run({ cycles: 0.1 * CYCLES_PER_S, until: on, every: 500 });
    if (reason !== 'until') throw new Error('the start did not switch the drives on');
    const [rise] = this.board.edges.to('enable', 1).slice(-1);
    // The run of the loop that switched the drives on may still be under way.
    const { calls, stack } = this.board.usage;
    const runs = [...calls.get(TIMER_IRQ_1), ...stack.filter(({ number }) => number === TIMER_IRQ_1)];
    const { entry } = runs.findLast((run) => run.entry <= rise);
    // An interrupt may begin late while others are blocked. The earliest interrupts begin at the deadline.
    const late = (other) => ((((entry - other) % this.tick) + 1.5 * this.tick) % this.tick) - this.tick / 2;
    return entry - Math.max(...runs.slice(-RUNS).map((run) => late(run.entry)));
  }

  /** Stops the processor for `seconds`, or up to a reset, while everything else goes on. */
  freeze(seconds) {
    const { board } = this;
    const end = board.cycle + Math.round(seconds * CYCLES_PER_S);
    while (board.cycle < end && board.pendingReset === null) {
      board.cycle = Math.min(end, board.cycle + CYCLES_PER_US);
      board.catchUp(board.cycle);
    }
  }

  /** Steps that each axis has made, in its own sense, since the recording began; DIR high is forward. */
  steps(reversed = []) {
    const { edges } = this.board;
    return Array.from({ length: this.axes }, (_, axis) => {
      const forward = (cycle) => edges.levelAt(`dir_${axis}`, cycle) !== Number(reversed[axis] ?? 0);
      return edges.to(`step_${axis}`, 1).reduce((sum, cycle) => sum + (forward(cycle) ? 1 : -1), 0);
    });
  }

  /** The loop's runs from a cycle on: [{ entry, own, end }]; `own` is what a control tick costs the processor. */
  ticks(from = 0) {
    return this.board.usage.calls.get(TIMER_IRQ_1).filter(({ entry }) => entry >= from);
  }
}
