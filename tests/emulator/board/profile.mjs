// Cycles of one exception by call path: the functions that spent them, and their callers.
//
// A *node* is one place in the call tree: a function, the node that called it, and the instruction that called. Calls are
// detected as they happen: BL and BLX call, and a branch to the return address with the caller's stack pointer returns. A jump
// into another function is a tail call: the callee is a child of the function that jumped, and returns with it. The cycles of
// entering and leaving the exception are at address 0 of the root.
//
// The sum of a call's cycles is `own` of usage.mjs: cycles of exceptions that preempt are not in it.

import { TIMER_IRQ_1 } from './usage.mjs';

/** The address that stands for entering the exception. */
export const ENTRY = 0;

/** An address within its memory. */
const OFFSET = 0xff_ffff;

const isCallRegister = (opcode) => (opcode & 0xff87) === 0x4780;
const isCall = (first, second) => first >>> 11 === 0b11110 && (second & 0xd000) === 0xd000;

export class CallProfile {
  /** `functions`: of the ELF, by address; `number`: the exception whose cycles are counted. */
  constructor(functions, number = TIMER_IRQ_1) {
    this.functions = functions;
    this.number = number;
    /** The call tree: [{ parent, site, fn }]; `fn` is a place in `functions`, or -1; `site` the calling instruction. */
    this.nodes = [{ parent: -1, site: ENTRY, fn: -1, children: new Map(), keys: new Map() }];
    /** The places at which cycles are counted: [{ node, pc }]. */
    this.keys = [];
    /** Complete calls of the exception: [{ entry, own, cycles, calls }], as pairs: a key and its cycles, a node and its times. */
    this.calls = [];
    /** Cycles of the call that is under way, by key, and which keys have any. */
    this.spent = new Uint32Array(1 << 16);
    this.touched = [];
    this.current = null;
    this.lastFn = -1;
  }

  /** Books one instruction at `pc` that took `spent` cycles; `call` is the exception's call that is under way, of usage.mjs. */
  book(pc, spent, call, core) {
    if (call.number !== this.number) return;
    if (call !== this.current?.call) {
      this.finish();
      this.current = { call, own: 0, calls: new Map() };
      this.frames = [{ node: 0, returnTo: -1, stack: -1 }];
      this.lastPc = ENTRY;
      this.count(0, ENTRY, spent);
      return;
    }
    const node = this.nodeAt(pc);
    this.count(node, pc, spent);
    this.follow(pc, node, core);
  }

  /** Ends the call that is under way: it is complete once the next begins, or the run is over. */
  finish() {
    if (this.current === null) return;
    const { call, own, calls } = this.current;
    const cycles = new Uint32Array(2 * this.touched.length);
    this.touched.forEach((key, i) => {
      cycles[2 * i] = key;
      cycles[2 * i + 1] = this.spent[key];
      this.spent[key] = 0;
    });
    this.calls.push({ entry: call.entry, own, cycles, calls: Uint32Array.from([...calls].flat()) });
    this.touched = [];
    this.current = null;
  }

  count(node, pc, spent) {
    const { keys } = this.nodes[node];
    let key = keys.get(pc);
    if (key === undefined) {
      key = this.keys.push({ node, pc }) - 1;
      keys.set(pc, key);
    }
    if (key >= this.spent.length) {
      const larger = new Uint32Array(2 * this.spent.length);
      larger.set(this.spent);
      this.spent = larger;
    }
    if (this.spent[key] === 0) this.touched.push(key);
    this.spent[key] += spent;
    this.current.own += spent;
  }

  /** The node of the instruction at `pc`, after a call or a tail call if its function is another. */
  nodeAt(pc) {
    const fn = this.functionAt(pc);
    const { frames } = this;
    const top = frames[frames.length - 1];
    if (top.node === -1) {
      top.node = this.child(frames[frames.length - 2].node, top.site, fn);
    } else if (this.nodes[top.node].fn !== fn) {
      // Back in a function that made a tail call, or a tail call of another.
      let back = frames.length - 1;
      const same = (frame) => frame.returnTo === top.returnTo && frame.stack === top.stack;
      while (back >= 0 && same(frames[back]) && this.nodes[frames[back].node].fn !== fn) back -= 1;
      if (back >= 0 && same(frames[back])) frames.length = back + 1;
      else frames.push({ ...top, node: this.child(top.node, this.lastPc, fn) });
    }
    this.lastPc = pc;
    return frames[frames.length - 1].node;
  }

  /** Updates the stack of calls after the instruction at `pc`. */
  follow(pc, node, core) {
    const next = (core.registers[15] & ~1) >>> 0;
    if (next === pc + 2) return;
    const first = halfAt(core, pc);
    if (isCallRegister(first)) {
      this.frames.push({ node: -1, site: pc, returnTo: pc + 2, stack: core.registers[13] });
      return;
    }
    if (isCall(first, halfAt(core, pc + 2))) {
      const own = this.functions[this.nodes[node].fn];
      // Inside of a long function BL is a jump.
      const isJump = own && next > own.address && next < own.address + own.size;
      if (!isJump) this.frames.push({ node: -1, site: pc, returnTo: pc + 4, stack: core.registers[13] });
      return;
    }
    const { returnTo, stack } = this.frames[this.frames.length - 1];
    if (next !== returnTo || core.registers[13] !== stack) return;
    while (this.frames[this.frames.length - 1].returnTo === returnTo && this.frames[this.frames.length - 1].stack === stack) this.frames.pop();
  }

  child(parent, site, fn) {
    const { children } = this.nodes[parent];
    const name = `${site} ${fn}`;
    let node = children.get(name);
    if (node === undefined) {
      node = this.nodes.push({ parent, site, fn, children: new Map(), keys: new Map() }) - 1;
      children.set(name, node);
    }
    const { calls } = this.current;
    calls.set(node, (calls.get(node) ?? 0) + 1);
    return node;
  }

  functionAt(pc) {
    const last = this.functions[this.lastFn];
    if (last && pc >= last.address && pc < last.address + last.size) return this.lastFn;
    this.lastFn = placeOf(this.functions, pc);
    return this.lastFn;
  }
}

/** A half-word of code, read like a debugger does: the read does not change the content of the flash's cache. */
function halfAt(core, address) {
  if (address >>> 28 === 2) return core.ram16[(address & OFFSET) >>> 1];
  return (address >>> 28 === 1 ? core.flash16 : core.rom16)[(address & OFFSET) >>> 1];
}

/** The place in `functions`, which are sorted by address, of the one around `pc`; -1 if there is none. */
export function placeOf(functions, pc) {
  let low = 0;
  let high = functions.length;
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (functions[middle].address <= pc) low = middle + 1;
    else high = middle;
  }
  const found = functions[low - 1];
  return found && pc < found.address + found.size ? low - 1 : -1;
}
