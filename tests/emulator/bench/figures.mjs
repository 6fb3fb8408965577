// The stored figures: docs/emulated.csv, and their table in docs/firmware.md.

import fs from 'node:fs';
import path from 'node:path';
import { DOCS } from './paths.mjs';

const CSV = path.join(DOCS, 'emulated.csv');
const PAGE = path.join(DOCS, 'firmware.md');
const BEGIN = '<!-- written by tests/emulator/run --write -->';
const END = '<!-- end -->';

/** A figure may get worse by this fraction before the check fails. */
const MAX_WORSE = 0.05;

/** The stored figures: name to number. */
function kept() {
  if (!fs.existsSync(CSV)) return new Map();
  const [, ...rows] = fs.readFileSync(CSV, 'utf8').trimEnd().split('\n');
  return new Map(rows.map((row) => row.match(/^"(.*)",(.*),(.*)$/)).map(([, name, value]) => [name, Number(value)]));
}

/** Figures that got worse, as sentences. */
export function worse(figures) {
  const before = kept();
  return figures.flatMap(({ name, value, better }) => {
    const was = before.get(name);
    if (was === undefined) return [`${name}: ${value} is not kept yet; --write keeps it`];
    if (better === 'neither') return [];
    const by = better === 'lower' ? value / was - 1 : was / value - 1;
    return by > MAX_WORSE ? [`${name}: ${value}, and was ${was}: worse by ${(by * 100).toFixed(1)} %`] : [];
  });
}

/** Stores all figures. */
export function write(figures) {
  const rows = figures.map(({ name, value, better }) => `"${name}",${value},${better}`);
  fs.writeFileSync(CSV, `figure,value,better\n${rows.join('\n')}\n`);
  const table = ['| figure, emulated | |', '| --- | ---: |', ...figures.filter(({ inDocs }) => inDocs).map(row)];
  const page = fs.readFileSync(PAGE, 'utf8');
  const [head, rest] = page.split(BEGIN);
  const [, tail] = rest.split(END);
  fs.writeFileSync(PAGE, `${head}${BEGIN}\n\n${table.join('\n')}\n\n${END}${tail}`);
}

function row({ name, value, goal }) {
  const reached = goal === undefined ? '' : `, goal at most ${grouped(goal)}: ${value <= goal ? 'met' : 'missed'}`;
  return `| ${name}${reached} | ${grouped(value)} |`;
}

const grouped = (value) => (Number.isInteger(value) ? value.toLocaleString('en-US') : String(value));
