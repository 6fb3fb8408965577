// Cycles of a tick by its parts: the functions of which the bound on a tick consists.
//
// A *part* is a function with all that it calls, except what is a part itself. So the parts of a tick add up to its cycles. Names are
// those of the linked functions.

import { CallProfile } from '../board/profile.mjs';

/** A part's name, and how its symbol is recognised. */
const PARTS = [
  ['inputs', /control\.\.Board.*Io.*4read17/],
  ['program', /Controller12load_program17/],
  ['commands', /Controller.*6adjust17/],
  ['readings', /DriftMonitor.*7observe17/],
  ['hold', /Controller.*10check_hold17/],
  ['homing', /Controller.*14advance_homing17/],
  ['correction', /Controller.*7correct17/],
  ['judgement', /Controller.*(5judge|22highest_priority_fault)17|events15select_reaction17|tick12harder_fault17/],
  ['observation', /Controller.*7observe17/],
  ['state', /Controller.*(5enter|7refusal|7publish)17/],
  ['level', /Controller.*4play17/],
  ['shaft', /Shaft7advance17/],
  ['plan', /Controller.*9plan_axis17/],
  ['followers', /Controller.*17advance_followers17/],
  ['offset', /Controller.*14advance_offset17|PhaseOffsets(10begin_slot|9move_axis)17/],
  ['groups', /Controller.*7regroup17/],
  ['drive', /Controller.*5drive17/],
  ['report', /Controller.*6report17/],
  ['note', /NoteQueue4note17/],
  ['hand-over', /control\.\.Board.*Io.*5write17/],
  ['tick', /Controller.*4tick17/],
];
const REST = 'loop';

export const NAMES = [...PARTS.map(([name]) => name), REST];
export const PLAN = NAMES.indexOf('plan');

/** Per tick: the cycles of each part, and the number of plans. */
export class Parts extends CallProfile {
  constructor(functions) {
    super(functions);
    /** Part of each function; none if it belongs to its caller's. */
    this.own = functions.map(({ name }) => PARTS.findIndex(([, symbol]) => symbol.test(name)));
    this.of = new Map();
    this.cycles = new Float64Array(NAMES.length);
    this.plans = 0;
  }

  count(node, pc, spent) {
    let part = this.of.get(node);
    if (part === undefined) {
      part = this.partOf(node);
      this.of.set(node, part);
    }
    this.cycles[part] += spent;
  }

  partOf(node) {
    for (let at = node; at > 0; at = this.nodes[at].parent) {
      const { fn } = this.nodes[at];
      if (fn >= 0 && this.own[fn] >= 0) return this.own[fn];
    }
    return NAMES.length - 1;
  }

  child(parent, site, fn) {
    if (fn >= 0 && this.own[fn] === PLAN) this.plans += 1;
    return super.child(parent, site, fn);
  }

  finish() {
    if (this.current === null) return;
    this.calls.push({ entry: this.current.call.entry, cycles: this.cycles, plans: this.plans });
    this.cycles = new Float64Array(NAMES.length);
    this.plans = 0;
    this.current = null;
  }

  /** Forgets the call that is under way: the board goes back to another moment. */
  forget() {
    this.finish();
    this.calls = [];
  }
}
