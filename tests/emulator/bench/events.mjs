// States and events of a machine, in one form: from the firmware's log, and from the host's trace and report.
//
// { states: [{ tick, state }], events: [{ kind, axis, sizeDeg, phaseDeg, tick, latched }] }. Ticks count from the one in which the
// start was read. The firmware's events are decoded from their twenty bytes, and compared with the text beside them.

import fs from 'node:fs';

/**
 * The greatest difference between the text of a line and its bytes, degrees. The bytes have a resolution of 2⁻³² turn, the text has a
 * float.
 */
const WORDS_DEG = 1e-3;

const UNITS_A_TURN = 2 ** 32;

/** Kinds by their number on the wire: the table of the manual, which a test of the core compares with its own. */
const KINDS = Array.from(
  fs.readFileSync(new URL('../../../docs/faults.md', import.meta.url), 'utf8').split('<!-- reactions -->')[1].matchAll(/^\| `([a-z-]+)` \| \d+ \|/gm),
  ([, kind]) => kind,
);

const STATE = /tick (\d+): (Idle|Homing|Run|Stop|Parked|Fault), phase error/;
const EVENT = /tick (\d+): (fault|reported): ([a-z-]+)(?: on axis (\d))?, (-?[\d.e-]+) deg, at crank phase ([\d.e-]+) deg \[(.*)\]/;

/** States and events of the firmware's log. `wrong` collects lines whose text and bytes differ. */
export function eventsOfLog(lines, wrong) {
  const states = lines.map((line) => line.match(STATE)).filter(Boolean);
  const all = states.map(([, tick, state]) => ({ tick: Number(tick), state: state.toLowerCase() }));
  const began = all.findLast(({ state }) => state === 'homing')?.tick;
  const events = lines
    .map((line) => [line, line.match(EVENT)])
    .filter(([, match]) => match)
    .map(([line, [, tick, level, name, axis, size, phase, bytes]]) => {
      const fault = decode(bytes.split(', ').map((byte) => parseInt(byte, 16)));
      const near = (a, b) => Math.abs(a - b) <= WORDS_DEG;
      const same = fault.kind === name && String(fault.axis ?? '') === (axis ?? '') && near(fault.sizeDeg, Number(size)) && near(fault.phaseDeg, Number(phase));
      if (!same) wrong.push(`the bytes of a line differ from its words: ${line.trim()}`);
      return { ...fault, tick: fault.tick - began, reportedAt: Number(tick) - began, latched: level === 'fault' };
    });
  return { states: all.map(({ tick, state }) => ({ tick: tick - began, state })).filter(({ tick }) => tick >= 0), events };
}

/** Decodes a fault (Fault::to_bytes). */
function decode(bytes) {
  const view = new DataView(Uint8Array.from(bytes).buffer);
  const axis = view.getUint8(1);
  return {
    kind: KINDS[view.getUint8(0)],
    axis: axis === 0xff ? undefined : axis,
    sizeDeg: (view.getInt32(4, true) / UNITS_A_TURN) * 360,
    phaseDeg: (view.getUint32(8, true) / UNITS_A_TURN) * 360,
    tick: Number(view.getBigUint64(12, true)),
  };
}

/** States and events of the host's prediction. */
export function eventsOfHost({ trace, report }) {
  const states = [];
  trace.forEach(({ state }, tick) => {
    if (state !== (states.at(-1)?.state ?? 'idle')) states.push({ tick, state });
  });
  const latched = report.faults.map(({ kind, tick }) => `${kind} ${tick}`);
  const events = report.reported_faults.map(({ kind, axis, size_deg: sizeDeg, phase_deg: phaseDeg, tick }) => ({
    kind,
    axis: axis ?? undefined,
    sizeDeg,
    phaseDeg,
    tick,
    latched: latched.includes(`${kind} ${tick}`),
  }));
  return { states, events };
}
