// Time in cycles. One cycle is 8 ns (125 MHz). The peripherals of rp2040js request times in nanoseconds and get
// exact ones.
//
// `cycle` is the board's own count and never goes back. `origin` is the cycle of the last reset, so that the chip's
// timer starts at zero after each. An alarm that is set from within an alarm fires one cycle later at the earliest,
// because nothing in the chip happens twice in one cycle.

export const CYCLES_PER_SECOND = 125_000_000;
export const CYCLES_PER_US = 125;
export const NANOS_PER_CYCLE = 8;

class Alarm {
  constructor(clock, callback) {
    this.clock = clock;
    this.callback = callback;
    this.cycle = 0;
    this.next = null;
    this.scheduled = false;
    /** True for an alarm of something outside the chip, which a reset of the chip does not cancel. */
    this.outside = false;
  }

  /** Fires `nanos` from now; a part of a cycle is rounded up. */
  schedule(nanos) {
    this.at(this.clock.cycle + Math.ceil(nanos / NANOS_PER_CYCLE));
  }

  /** Fires in this cycle. */
  at(cycle) {
    const { clock } = this;
    if (this.scheduled) clock.unlink(this);
    this.cycle = clock.firing ? Math.max(cycle, clock.cycle + 1) : cycle;
    clock.link(this);
  }

  cancel() {
    if (this.scheduled) this.clock.unlink(this);
  }
}

/** The clock that an RP2040 object is built on: rp2040js's SimulationClock, but in whole cycles. */
export class CycleClock {
  constructor(origin = 0) {
    this.origin = origin;
    this.cycle = origin;
    this.first = null;
    this.firing = false;
    /** Called with the cycle of each new alarm. */
    this.onSchedule = () => {};
  }

  get nanos() {
    return (this.cycle - this.origin) * NANOS_PER_CYCLE;
  }

  get micros() {
    return this.nanos / 1000;
  }

  createAlarm(callback) {
    return new Alarm(this, callback);
  }

  /** Calls `callback` once, `nanos` from now, even if the chip is reset meanwhile. Gives the alarm. */
  later(nanos, callback) {
    const alarm = this.createAlarm(callback);
    alarm.outside = true;
    alarm.schedule(nanos);
    return alarm;
  }

  /** Takes over the alarms of parts outside the chip from the clock before a reset. */
  inherit(former) {
    for (let alarm = former.first; alarm !== null; ) {
      const { next } = alarm;
      if (alarm.outside) {
        alarm.clock = this;
        this.link(alarm);
      }
      alarm = next;
    }
  }

  /** Cycle of the next alarm, or Infinity. */
  get next() {
    return this.first ? this.first.cycle : Infinity;
  }

  link(alarm) {
    let before = null;
    let after = this.first;
    while (after && after.cycle <= alarm.cycle) {
      before = after;
      after = after.next;
    }
    alarm.next = after;
    if (before) before.next = alarm;
    else this.first = alarm;
    alarm.scheduled = true;
    this.onSchedule(alarm.cycle);
  }

  unlink(alarm) {
    let before = null;
    let at = this.first;
    while (at && at !== alarm) {
      before = at;
      at = at.next;
    }
    if (at) {
      if (before) before.next = at.next;
      else this.first = at.next;
    }
    alarm.next = null;
    alarm.scheduled = false;
  }

  /** Fires every alarm due in the present cycle. */
  fire() {
    this.firing = true;
    while (this.first && this.first.cycle <= this.cycle) {
      const alarm = this.first;
      this.first = alarm.next;
      alarm.next = null;
      alarm.scheduled = false;
      alarm.callback();
    }
    this.firing = false;
  }
}
