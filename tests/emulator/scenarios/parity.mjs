// Parity: every edge of STEP and DIR comes at the cycle that the host predicts.
//
// A scene's settings file is placed in the flash, the button is pressed, and the scene's inputs and the host's index pulses
// are played. Then the edges of each pin are compared, one by one. Their number must be equal, and all must be off by the
// same number of cycles on a PIO block. That number is the time between a deadline of the timer and the first cycle of the
// tick that begins there.

import fs from 'node:fs';
import path from 'node:path';
import { convert, predict, scene, settingsOf } from '../bench/host.mjs';
import { Machine } from '../bench/machine.mjs';
import { BUILT_IN } from '../bench/paths.mjs';
import * as pins from '../bench/pins.mjs';
import { act } from '../bench/play.mjs';

const SCENES = ['start-stop', 'band', 'reversal', 'index', 'gears', 'fast'];

/** Programs of built-in scenes are shortened to levels of so many seconds: they are made for the desk, where time costs less. */
const HOLD_S = 0.25;

/** Edges compared in all must be at least this many. */
const MIN_EDGES = 100_000;

/** Edges due at one instant, across blocks: at most this far apart. */
const MAX_SKEW = 0;

/** From a deadline to the first cycle of its tick: the few cycles in which the step machines are released. */
const MAX_OFFSET = 25;

export const title = 'Parity: edges against the host’s prediction';

export function run(outcome) {
  const played = [own(outcome, SCENES), own(outcome, builtIn(), shortened)];
  const total = played.reduce((sum, some) => sum + some.total, 0);
  const skew = Math.max(...played.map((some) => some.skew));
  outcome.check(total >= MIN_EDGES, `at least ${MIN_EDGES} edges are compared, not ${total}`);
  outcome.figure('parity edges', total, 'higher');
  outcome.figure('skew across blocks, cycles', skew);
}

/** The same for any scenes: names of the bench's scenes, or files. `change` modifies their content. */
export function own(outcome, scenes, change = () => {}) {
  let total = 0;
  let skew = 0;
  for (const name of scenes) {
    const before = outcome.failures.length;
    const { edges, offsets } = compare(outcome, scene(name, change));
    const off = outcome.failures.length > before ? 'not all where they should be' : '0 cycles off';
    total += edges;
    const [first, second = first] = offsets;
    outcome.check(first >= 0 && first <= MAX_OFFSET, `${name}: a tick begins at its deadline, not ${first} cycles from it`);
    skew = Math.max(skew, Math.abs(first - second));
    outcome.say(`${path.basename(name, '.toml').padEnd(12)} ${edges.toString().padStart(8)} edges, ${off} (blocks begin at ${offsets.join(', ')})`);
  }
  outcome.say(`${total} edges compared; skew within a block 0 cycles, across blocks ${skew}`);
  outcome.check(skew <= MAX_SKEW, `blocks are at most ${MAX_SKEW} cycles apart, not ${skew}`);
  return { total, skew };
}

/** Mechanism, or other machine, of a scene, and its drive. */
function kindOf({ name, machine, axes }) {
  return `${machine ? machine.mechanism ?? 'slider-crank' : name} ${axes.drive}`;
}

/** Built-in scenes without faults that the board can run: one of each kind that the bench's own scenes do not have. */
function builtIn() {
  const kinds = new Set(SCENES.map((name) => kindOf(scene(name).toml)));
  const files = fs.readdirSync(BUILT_IN).sort().map((file) => path.join(BUILT_IN, file));
  return files.filter((file) => {
    const played = scene(file);
    const kind = kindOf(played.toml);
    if (kinds.has(kind) || played.toml.fault || convert(played).refused) return false;
    kinds.add(kind);
    return true;
  });
}

function shortened({ program, segments = program }) {
  for (const entry of segments) {
    if (entry.segments) shortened(entry);
    else if (entry.hold_s > HOLD_S) entry.hold_s = HOLD_S;
  }
}

function compare(outcome, played) {
  const predicted = predict(played);
  const machine = new Machine({ ...played, settings: settingsOf(played) });
  machine.boot();
  const began = machine.start();
  act(machine, played, predicted, began);
  const { edges, offsets, wrong } = compared(machine, played, predicted, began);
  for (const text of wrong) outcome.check(false, text);
  return { edges, offsets };
}

/** Edges of a run that are as predicted: their number, and a description of the first edge that is not. */
export function edgesOff(machine, played, predicted, began) {
  const { edges, wrong } = compared(machine, played, predicted, began);
  return { edges, off: wrong[0] ?? null };
}

function compared(machine, played, predicted, began) {
  const offsets = [];
  const wrong = [];
  let count = 0;
  for (let axis = 0; axis < played.axes; axis += 1) {
    for (const wire of [`step_${axis}`, `dir_${axis}`]) {
      const expected = predicted.edges.get(wire);
      const actual = machine.board.edges.of(wire).filter(({ cycle }) => cycle >= began);
      const where = `${played.name}, ${wire}`;
      if (actual.length !== expected.length) wrong.push(`${where}: ${expected.length} edges, not ${actual.length}`);
      const block = pins.blockOf(axis);
      const worst = { at: -1, off: 0 };
      for (let i = 0; i < Math.min(actual.length, expected.length); i += 1) {
        const off = actual[i].cycle - began - expected[i].cycle;
        offsets[block] ??= off;
        if (off !== offsets[block] || actual[i].level !== expected[i].level) {
          worst.at = i;
          worst.off = off;
          break;
        }
      }
      if (worst.at >= 0) wrong.push(`${where}: edge ${worst.at} is ${worst.off} cycles from its prediction, as are all before it by ${offsets[block]}`);
      count += actual.length;
    }
  }
  return { edges: count, offsets, wrong };
}
