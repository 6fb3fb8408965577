// Tables of a call profile: cycles by function, as linked and as written.
//
// *Self* cycles are those of a function's own instructions; *inclusive* cycles add those of the functions that it calls. A
// function *as linked* has its own symbol, and includes the cycles of the functions inlined into it. *As written* splits
// these by the debug information.

import { spawnSync } from 'node:child_process';
import { ENTRY } from '../board/profile.mjs';
import { FIRMWARE, INSPECT } from './paths.mjs';

const ENTERED = '(exception entry)';

/** The names at each address: the linked function, then those inlined into it there, the outermost first. */
export function namesAt(addresses) {
  const done = spawnSync(INSPECT, ['frames', FIRMWARE, '-'], {
    input: addresses.map((pc) => pc.toString(16)).join('\n'),
    encoding: 'utf8',
    maxBuffer: 1 << 28,
  });
  if (done.error) throw done.error;
  if (done.status !== 0) throw new Error(`firmware-inspect frames ended with ${done.status}:\n${done.stderr}`);
  const lines = done.stdout.trimEnd().split('\n');
  return new Map(addresses.map((pc, i) => [pc, lines[i].split('\t')]));
}

/** A call profile whose addresses have names. */
export class Named {
  constructor(profile) {
    this.profile = profile;
    const sites = profile.nodes.map(({ site }) => site);
    const addresses = new Set([...sites, ...profile.keys.map(({ pc }) => pc)]);
    addresses.delete(ENTRY);
    this.names = namesAt([...addresses]);
    this.names.set(ENTRY, [ENTERED]);
    // Functions on the stack at each key, each name once: as linked and as written.
    this.stacks = profile.keys.map(({ node, pc }) => this.stackAt(node, pc));
  }

  stackAt(node, pc) {
    const { nodes } = this.profile;
    const linked = [];
    const written = [];
    for (let at = node, site = pc; at > 0 || site === ENTRY; { parent: at, site } = nodes[at]) {
      const names = this.names.get(site);
      linked.unshift(names[0]);
      written.unshift(...names);
      if (at === 0) break;
    }
    return { linked, written };
  }

  /**
   * The mean over `calls` of the profile, by function: [{ name, self, inclusive, calls }], the largest `self` first.
   * `how` is 'linked' or 'written'; only linked functions have `calls`.
   */
  table(calls, how) {
    const rows = new Map();
    const row = (name) => {
      if (!rows.has(name)) rows.set(name, { name, self: 0, inclusive: 0, calls: 0 });
      return rows.get(name);
    };
    sums(calls.map(({ cycles }) => cycles)).forEach((cycles, key) => {
      const stack = this.stacks[key][how];
      row(stack[stack.length - 1]).self += cycles / calls.length;
      for (const name of new Set(stack)) row(name).inclusive += cycles / calls.length;
    });
    if (how === 'linked') {
      sums(calls.map(({ calls: times }) => times)).forEach((times, node) => {
        row(this.nameOf(node)).calls += times / calls.length;
      });
    }
    return [...rows.values()].sort((a, b) => b.self - a.self);
  }

  nameOf(node) {
    const { nodes } = this.profile;
    const [key] = nodes[node].keys.keys();
    return this.names.get(key)[0];
  }
}

/** Sums arrays of pairs by the first number of each pair. */
function sums(arrays) {
  const all = new Map();
  for (const pairs of arrays) {
    for (let i = 0; i < pairs.length; i += 2) all.set(pairs[i], (all.get(pairs[i]) ?? 0) + pairs[i + 1]);
  }
  return all;
}

/** Both tables side by side, as Markdown: `mean` over many ticks, `worst` of one. Rows below `least` cycles are left out. */
export function markdown(mean, worst, { least, withCalls }) {
  const byName = new Map(worst.map((row) => [row.name, row]));
  const none = { self: 0, inclusive: 0, calls: 0 };
  const names = [...new Set([...mean, ...worst].map(({ name }) => name))];
  const rows = names
    .map((name) => ({ name, mean: mean.find((row) => row.name === name) ?? none, worst: byName.get(name) ?? none }))
    .filter((row) => Math.max(row.mean.self, row.worst.self, row.mean.inclusive, row.worst.inclusive) >= least)
    .sort((a, b) => b.mean.inclusive - a.mean.inclusive || b.worst.inclusive - a.worst.inclusive);
  const calls = ({ calls: times }) => (withCalls ? ` ${Number(times.toFixed(2))} |` : '');
  const cells = (row) => `${calls(row)} ${row.self.toFixed(0)} | ${row.inclusive.toFixed(0)} |`;
  const head = withCalls ? ['calls', 'self', 'inclusive'] : ['self', 'inclusive'];
  const columns = [...head.map((name) => `mean ${name}`), ...head.map((name) => `worst tick ${name}`)];
  return [
    `| function | ${columns.join(' | ')} |`,
    `| --- |${' ---: |'.repeat(columns.length)}`,
    ...rows.map((row) => `| \`${row.name}\` |${cells(row.mean)}${cells(row.worst)}`),
  ].join('\n');
}
