// The host's part of a scene: its settings file, and the edges that `cophase run` predicts.

import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parse, stringify } from 'smol-toml';
import { BUILT_IN, COPHASE, SCENES } from './paths.mjs';
import { inverted } from './pins.mjs';

const NANOS_PER_CYCLE = 8;

/**
 * Loads a scene by its name (one of the bench or a built-in one) or by its file. `change` may modify its content. Gives the content and
 * the properties that the bench needs.
 */
export function scene(name, change = () => {}) {
  const named = [SCENES, BUILT_IN].map((folder) => path.join(folder, `${name}.toml`));
  const file = name.endsWith('.toml') ? name : (named.find((file) => fs.existsSync(file)) ?? named[0]);
  const toml = parse(fs.readFileSync(file, 'utf8'));
  change(toml);
  return {
    name,
    text: stringify(toml),
    toml,
    axes: toml.axes.count,
    tickHz: toml.control?.tick_hz ?? 2000,
    inputs: toml.input ?? [],
    inverted: inverted(toml.wiring),
  };
}

/** The same scene with fewer axes: those with the lowest numbers. */
export function withAxes(count) {
  return (toml) => {
    toml.axes.count = count;
    toml.axis = (toml.axis ?? []).filter(({ number }) => number < count);
    if (toml.fault) toml.fault = toml.fault.filter(({ axis = 0 }) => axis < count);
  };
}

/** The same scene with all index sensors at one crank angle, and without user trims: all pulses come in one tick. */
export function sensorsAlike(toml) {
  toml.axis = Array.from({ length: toml.axes.count }, (_, number) => {
    const { trim_deg: _trim, ...own } = toml.axis?.find((axis) => axis.number === number) ?? {};
    return { ...own, number, index_deg: 15 };
  });
}

function cophase(args, statuses) {
  const done = spawnSync(COPHASE, args, { encoding: 'utf8', maxBuffer: 1 << 26 });
  if (done.error) throw done.error;
  if (!statuses.includes(done.status)) {
    throw new Error(`cophase ${args.join(' ')} ended with ${done.status}:\n${done.stderr}`);
  }
  return done.stdout;
}

function withScene({ text }, use) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'cophase-bench-'));
  try {
    const file = path.join(folder, 'scene.toml');
    fs.writeFileSync(file, text);
    return use(file, folder);
  } finally {
    fs.rmSync(folder, { recursive: true });
  }
}

/** The scene's settings as the firmware takes them. */
export function settingsOf(played) {
  return withScene(played, (file, folder) => {
    const settings = path.join(folder, 'scene.settings');
    cophase(['settings', file, '-o', settings], [0, 1]);
    return fs.readFileSync(settings);
  });
}

/**
 * What `cophase settings` makes of a scene: { settings: the file, bound: cycles of the longest tick on the board }, or { refused: why,
 * mostHz: the highest tick rate that the board takes, if the rate is refused }.
 */
export function convert(played) {
  return withScene(played, (file, folder) => {
    const settings = path.join(folder, 'scene.settings');
    const done = spawnSync(COPHASE, ['settings', file, '-o', settings], { encoding: 'utf8' });
    if (done.error) throw done.error;
    const bound = done.stdout.match(/Longest tick on the RP2040 board: at most (\d+) of/)?.[1];
    if (done.status === 0 && bound !== undefined) return { settings: fs.readFileSync(settings), bound: Number(bound) };
    const refused = done.status === 2 ? done.stderr : done.stdout;
    const maxHz = refused.match(/control\.tick_hz: .* give at most (\d+) Hz/)?.[1];
    return { refused: refused.trim(), maxHz: maxHz && Number(maxHz), isWritten: fs.existsSync(settings) };
  });
}

/**
 * The whole run as the host plays it: { edges: Map of wire to [{ cycle, level }], trace: rows by column, report }. Cycles count from the
 * deadline at which the host reads the start.
 */
export function predict(played) {
  return withScene(played, (file, folder) => {
    cophase(['run', file, '--out', folder, '--window', 'all', '--every', '1', '--quiet'], [0, 1]);
    return {
      edges: readVcd(fs.readFileSync(path.join(folder, 'steps.vcd'), 'utf8')),
      trace: readCsv(fs.readFileSync(path.join(folder, 'trace.csv'), 'utf8')),
      report: JSON.parse(fs.readFileSync(path.join(folder, 'report.json'), 'utf8')),
    };
  });
}

function readCsv(text) {
  const [header, ...rows] = text.trimEnd().split('\n').map((line) => line.split(','));
  return rows.map((row) => Object.fromEntries(header.map((name, i) => [name, row[i]])));
}

/** Reads the one form of VCD that `cophase` writes: one-bit wires, nanoseconds. */
function readVcd(text) {
  const names = new Map();
  const edges = new Map();
  const levels = new Map();
  let cycle = 0;
  for (const line of text.split('\n')) {
    const wire = line.match(/^\$var wire 1 (\S+) (\S+) \$end$/);
    if (wire) {
      names.set(wire[1], wire[2]);
      edges.set(wire[2], []);
    } else if (line.startsWith('#')) {
      const nanos = Number(line.slice(1));
      if (nanos % NANOS_PER_CYCLE !== 0) throw new Error(`an edge at ${nanos} ns, which is no whole cycle`);
      cycle = nanos / NANOS_PER_CYCLE;
    } else if (/^[01]\S+$/.test(line)) {
      const name = names.get(line.slice(1));
      const level = Number(line[0]);
      // The dump at the beginning gives the initial levels. Only a change of level is an edge.
      if (levels.has(name) && levels.get(name) !== level) edges.get(name).push({ cycle, level });
      levels.set(name, level);
    }
  }
  return edges;
}
