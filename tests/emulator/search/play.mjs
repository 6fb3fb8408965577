// Plays one scene of the search on the firmware, and measures each tick.
//
// The cranks follow the steps (bench/cranks.mjs), so nothing is predicted, and the machine may be stopped at any time. From
// moments before the pulses of all axes are confirmed, the run continues in several *branches*: each stops the machine, or changes
// something else, in one of the ticks around.

import { Snapshot } from '../board/snapshot.mjs';
import { CYCLES_PER_US } from '../board/clock.mjs';
import { TIMER_IRQ_1 } from '../board/usage.mjs';
import { Cranks } from '../bench/cranks.mjs';
import { PROGRAM, requests } from '../bench/frames.mjs';
import { LinkHost } from '../bench/link-host.mjs';
import { log } from '../bench/log.mjs';
import { CYCLES_PER_S, Machine } from '../bench/machine.mjs';
import { inverted, ALARM, STOP } from '../bench/pins.mjs';
import { NAMES, Parts, PLAN } from './parts.mjs';

/** Channels of a stream: all of firmware/link/src/sample.rs. */
const ALL_CHANNELS = (1 << 11) - 1;

/** Bytes that wait for the board while the link is saturated, and how often the host looks, ns. */
const BUSY_BYTES = 4096;
const BUSY_NS = 250_000;

const READY_S = 1;

/** Homing that proves the wiring is not awaited for longer. */
const MAX_HOMING_S = 0.8;

const SLIP_NS = 500_000;

/** An interrupt begins this many cycles before the first ones at most, relative to its deadline: what it interrupts decides. */
const SOONER = 50;

/** Ticks for which a branch runs, and the time of a stop. */
const BRANCH_TICKS = 14;
const STOP_S = 0.03;

/** Moments from which a scene branches, up to so long apart; and for how long the pulses of all axes are awaited there. */
const MOMENTS = 2;
const MOMENTS_S = 0.03;
const PULSES_S = 0.04;

/** Share of the scenes whose parts are also measured in homing. */
const WHOLE_SHARE = 0.15;

/** Share of the scenes with USB in which a program is loaded. */
const LOAD_SHARE = 0.3;

/** Cranks that slip on their shafts, and note when their index pulses begin. */
class SlippingCranks extends Cranks {
  constructor(board, toml, slips) {
    super(board, toml);
    this.slips = slips;
    this.owed = slips.map(() => 0);
    this.pulses = [];
    this.isSlipping = false;
    this.slip = this.slip.bind(this);
  }

  begin() {
    this.isSlipping = true;
    this.board.clock.later(SLIP_NS, this.slip);
  }

  slip() {
    if (!this.isSlipping) return;
    this.slips.forEach((perSecond, axis) => {
      this.owed[axis] += (perSecond * SLIP_NS) / 1e9;
      const forward = this.owed[axis] > 0;
      for (; Math.abs(this.owed[axis]) >= 1; this.owed[axis] -= forward ? 1 : -1) this.turn(this.cranks[axis], forward, this.board.cycle + 1);
    });
    this.board.clock.later(SLIP_NS, this.slip);
  }

  turn(crank, forward, cycle) {
    const was = crank.beyondFlag;
    super.turn(crank, forward, cycle);
    if (crank.hasIndex && forward && crank.beyondFlag < was) this.pulses.push(cycle);
  }

  /** Steps that a crank has made. */
  steps(axis) {
    return this.cranks[axis].at - this.cranks[axis].start;
  }
}

/** A host that keeps both directions of the link full. */
class BusyHost extends LinkHost {
  constructor(machine, transport, override) {
    super(machine, transport);
    this.override = override;
    this.isOn = false;
    this.refill = this.refill.bind(this);
  }

  /** Opens the line, without waiting for a reply: the search is for ticks, also where the link has little time. */
  open() {
    this.until(() => this.link.ready, READY_S, 'the line is not there');
    this.link.open();
    this.link.send([0]);
    this.send(requests.identify());
  }

  saturate() {
    this.send(requests.takeControl());
    this.send(requests.stream(ALL_CHANNELS, 1));
    this.send(requests.streamStatus(10));
    this.isOn = true;
    this.block = requests.write(0, Buffer.alloc(384, 0xa5));
    this.refill();
  }

  refill() {
    if (!this.isOn) return;
    if (this.override !== null) this.send(requests.override(this.override));
    this.override = this.override === null ? null : 1300 - this.override;
    while (this.link.pending < BUSY_BYTES) this.send(this.block);
    this.machine.board.clock.later(BUSY_NS, this.refill);
  }
}

/** Measures ticks: the longest one, and the longest of each part. `bound` in cycles. */
class Meter {
  constructor(bound) {
    this.bound = bound;
    this.worst = { cycles: 0 };
    this.above = [];
    this.parts = new Float64Array(NAMES.length);
    this.plan = 0;
    this.late = 0;
    this.preempted = 0;
  }

  take(machine, parts, began, what) {
    const { board, tick } = machine;
    parts.finish();
    const calls = new Map(parts.calls.map((call) => [call.entry, call]));
    for (const { entry, own, end } of board.usage.calls.get(TIMER_IRQ_1).splice(0)) {
      const from = began + Math.floor((entry - began + SOONER) / tick) * tick;
      const cycles = end - from;
      const late = entry - from;
      this.late = Math.max(this.late, late);
      this.preempted = Math.max(this.preempted, end - entry - own);
      const call = calls.get(entry);
      call?.cycles.forEach((spent, part) => {
        this.parts[part] = Math.max(this.parts[part], spent);
      });
      const found = { cycles, number: Math.round((from - began) / tick), what, parts: call?.cycles, plans: call?.plans };
      if (call?.plans) this.plan = Math.max(this.plan, call.cycles[PLAN] / call.plans);
      if (cycles > this.worst.cycles) this.worst = found;
      if (cycles > this.bound) this.above.push(found);
    }
    parts.forget();
  }
}

/** Plays a scene with its settings file; gives its Meter, with `missed`: what the log says of deadlines, and `branches`. */
export function play({ toml, transport, slips, override }, settings, bound, next) {
  const tickHz = toml.control.tick_hz;
  const machine = new Machine({ axes: toml.axes.count, tickHz, settings, inverted: inverted(toml.wiring) });
  const { board } = machine;
  const meter = new Meter(bound);
  const parts = new Parts(board.elf.functions);
  machine.boot();
  const host = transport === null ? null : new BusyHost(machine, transport, override);
  host?.open();
  board.usage.calls.get(TIMER_IRQ_1).splice(0);
  // Homing takes most of the time, and counting by parts doubles that.
  const isWhole = next() < WHOLE_SHARE;
  if (isWhole) board.profile = parts;
  if (transport === 'usb' && next() < LOAD_SHARE) {
    const program = host.readFile(PROGRAM);
    host.ask(requests.takeControl());
    host.writeFile(PROGRAM, program);
  }
  host?.saturate();
  const began = machine.start();
  const cranks = new SlippingCranks(board, toml, slips);
  const state = { machine, cranks, host };
  meter.branches = 0;
  toRun(machine, cranks, toml);
  cranks.begin();
  meter.take(machine, parts, began, 'homing');
  board.profile = parts;
  for (let moment = 0; moment < MOMENTS; moment += 1) {
    machine.run(moment * MOMENTS_S * next());
    meter.take(machine, parts, began, 'run');
    branch(state, meter, parts, began, toml, next);
  }
  // Missed deadlines of branches would be in their own log.
  meter.missed = missedOf(board);
  machine.set(STOP, 1);
  machine.run(STOP_S);
  meter.take(machine, parts, began, 'a stop at any time');
  machine.run(0.005);
  meter.missed = Math.max(meter.missed, missedOf(board));
  return meter;
}

/** Runs until the machine turns faster than in homing. */
function toRun(machine, cranks, toml) {
  const { limits, control, axes, axis } = toml;
  const [motor, crank] = axis[0].gear ?? [1, 1];
  const perTurn = ((axis[0].steps_per_turn ?? axes.steps_per_turn) * motor) / crank;
  const window = 0.01;
  for (let seconds = 0; seconds < MAX_HOMING_S; seconds += window) {
    const before = cranks.steps(0);
    machine.run(window);
    const speed = (cranks.steps(0) - before) / window / perTurn;
    if (speed > 1.3 * limits.homing_speed_hz && axis[0].cam === undefined && axis[0].ratio === undefined) return;
    if ((axis[0].cam !== undefined || axis[0].ratio !== undefined) && seconds > control.settle_s + 0.4) return;
  }
}

/** Continues from here several times, with a stop or an alarm in the ticks around that in which most pulses are confirmed. */
function branch(state, meter, parts, began, toml, next) {
  const { machine, cranks } = state;
  const { board, tick } = machine;
  board.profile = null;
  cranks.pulses = [];
  const snapshot = new Snapshot(state);
  const from = board.cycle;
  const width = (toml.index?.width_us ?? 2) * CYCLES_PER_US;
  board.profile = parts;
  const haveCome = () => cranks.pulses.length >= machine.axes;
  board.run({ cycles: PULSES_S * CYCLES_PER_S, until: haveCome, every: 4 * tick });
  meter.take(machine, parts, began, 'run');
  // A pulse is confirmed at the first deadline at which its level has lasted for the width.
  const counts = new Map();
  for (const cycle of cranks.pulses) {
    const number = Math.ceil((cycle + width - began) / tick);
    counts.set(number, (counts.get(number) ?? 0) + 1);
  }
  const [first, second] = [...counts].sort(([, a], [, b]) => b - a).map(([number]) => number);
  const target = first ?? Math.ceil((from - began) / tick) + 20;
  const tries = [
    { offset: 0, how: 'stop' },
    { offset: 1, how: 'stop' },
    { offset: 1 + Math.floor(next() * 7), how: 'stop' },
    { offset: Math.floor(next() * 3) - 1, how: 'alarm' },
    { offset: Math.floor(next() * 12), how: 'both' },
    { offset: 0, how: 'stop', at: second },
    ...(state.host === null ? [] : [{ offset: 0, how: 'host' }]),
  ];
  for (const { offset, how, at = target } of tries) {
    board.profile = null;
    snapshot.restore();
    board.profile = parts;
    // An input is read at a deadline, with every level since the one before.
    const cycle = began + (at + offset) * tick - Math.round(tick / 2);
    if (cycle <= board.cycle) continue;
    if (how === 'host') state.host.send(requests.stop(Math.floor(next() * 2)));
    if (how === 'stop' || how === 'both') machine.set(STOP, 1, cycle);
    if (how === 'alarm' || how === 'both') machine.set(ALARM[Math.floor(next() * machine.axes)], 1, cycle);
    board.run({ untilCycle: cycle + BRANCH_TICKS * tick });
    meter.take(machine, parts, began, `${how}, ${offset} ticks after the pulses`);
    meter.branches += 1;
  }
  board.profile = null;
  snapshot.restore();
  board.profile = parts;
}

/** Deadlines missed, as the log counts them. */
function missedOf(board) {
  const counts = log(board).map((line) => line.match(/(\d+) deadlines missed in all/)).filter(Boolean);
  return counts.length === 0 ? 0 : Number(counts[counts.length - 1][1]);
}
