// The pins of the firmware, read from its own table, so that the two cannot differ.

import fs from 'node:fs';
import path from 'node:path';
import { ROOT } from './paths.mjs';

const source = fs.readFileSync(path.join(ROOT, 'firmware/src/board/pins.rs'), 'utf8');

function constant(name) {
  const found = source.match(new RegExp(`pub const ${name}: [^=]+= ([^;]+);`));
  if (!found) throw new Error(`pins.rs has no ${name}`);
  return JSON.parse(found[1]);
}

export const STEP = constant('STEP');
export const DIR = constant('DIR');
export const ALARM = constant('ALARM');
export const INDEX = STEP.map((_, axis) => constant('INDEX') + axis);
export const DRIVE_ENABLE = constant('DRIVE_ENABLE');
export const SYNC = constant('SYNC');
export const LED = constant('LED');
export const ENABLE = constant('ENABLE');
export const STOP = constant('STOP');
export const START = constant('START');

/** Axes on the first PIO block; the others are on the second. */
const FIRST_BLOCK = 3;

export const blockOf = (axis) => Math.floor(axis / FIRST_BLOCK);

/** Lines by the keys of a scene's `[wiring]`, and the levels at which they are active without it. */
const LINES = {
  step: [STEP, 'high'],
  drive_enable: [[DRIVE_ENABLE], 'high'],
  index: [INDEX, 'high'],
  alarm: [ALARM, 'high'],
  enable: [[ENABLE], 'low'],
  stop: [[STOP], 'high'],
  start: [[START], 'low'],
};

/** The pins whose active level is not the usual one. */
export function inverted(wiring = {}) {
  return new Set(Object.entries(LINES).flatMap(([key, [pins, usual]]) => ((wiring[key] ?? usual) === usual ? [] : pins)));
}

/** The pins to record for a machine of `axes` axes, by name. */
export function outputs(axes) {
  const pins = { enable: DRIVE_ENABLE, sync: SYNC, led: LED };
  for (let axis = 0; axis < axes; axis += 1) {
    pins[`step_${axis}`] = STEP[axis];
    pins[`dir_${axis}`] = DIR[axis];
  }
  return pins;
}
