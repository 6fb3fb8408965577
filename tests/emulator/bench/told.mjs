// What a machine did and what it said of it: as the image's log has it, and as the host's trace and report have it, in one form.
//
// { states: [{ tick, state }], incidents: [{ kind, axis, sizeDeg, phaseDeg, tick, latched }] }, ticks from the one in which the start was
// read. The image's incidents are read of their twenty bytes, and held against the words beside them.

/** Of a size or a phase, between the words of a line, its bytes, and a report; the bytes have 2⁻³² turn, and words a float. */
const WORDS_DEG = 1e-3;

const UNITS_A_TURN = 2 ** 32;

/** Kinds by their number on the wire: FaultKind::ALL of firmware/core/src/supervisor/fault.rs. */
const KINDS = [
  'tilt', 'warp', 'common-lag', 'lost-steps', 'slip', 'stuck', 'runaway', 'silent', 'index-missing', 'index-extra', 'swapped-wiring',
  'reversed', 'encoder-glitch', 'drive-alarm', 'overrun', 'run-dry', 'enable-loss', 'stop-input', 'too-far-out', 'program-rejected',
  'settings-rejected', 'restarted',
];

const STATE = /tick (\d+): (Idle|Align|Run|Stop|Parked|Fault), drift/;
const INCIDENT = /tick (\d+): (fault|told): ([a-z-]+)(?: on axis (\d))?, (-?[\d.e-]+) deg, at crank phase ([\d.e-]+) deg \[(.*)\]/;

/** Of the image's log; `wrong` gathers lines whose words and bytes are at odds. */
export function ofLog(lines, wrong) {
  const states = lines.map((line) => line.match(STATE)).filter(Boolean);
  const all = states.map(([, tick, state]) => ({ tick: Number(tick), state: state.toLowerCase() }));
  const began = all.findLast(({ state }) => state === 'align')?.tick;
  const incidents = lines
    .map((line) => [line, line.match(INCIDENT)])
    .filter(([, match]) => match)
    .map(([line, [, tick, level, name, axis, size, phase, bytes]]) => {
      const fault = ofBytes(bytes.split(', ').map((byte) => parseInt(byte, 16)));
      const near = (a, b) => Math.abs(a - b) <= WORDS_DEG;
      const same = fault.kind === name && String(fault.axis ?? '') === (axis ?? '') && near(fault.sizeDeg, Number(size)) && near(fault.phaseDeg, Number(phase));
      if (!same) wrong.push(`a line's bytes are not its words: ${line.trim()}`);
      return { ...fault, tick: fault.tick - began, toldAt: Number(tick) - began, latched: level === 'fault' };
    });
  return { states: all.map(({ tick, state }) => ({ tick: tick - began, state })).filter(({ tick }) => tick >= 0), incidents };
}

/** A fault of its bytes (Fault::to_bytes). */
function ofBytes(bytes) {
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

/** Of what the host predicts. */
export function ofHost({ trace, report }) {
  const states = [];
  trace.forEach(({ state }, tick) => {
    if (state !== (states.at(-1)?.state ?? 'idle')) states.push({ tick, state });
  });
  const latched = report.faults.map(({ kind, tick }) => `${kind} ${tick}`);
  const incidents = report.incidents.map(({ kind, axis, size_deg: sizeDeg, phase_deg: phaseDeg, tick }) => ({
    kind,
    axis: axis ?? undefined,
    sizeDeg,
    phaseDeg,
    tick,
    latched: latched.includes(`${kind} ${tick}`),
  }));
  return { states, incidents };
}
