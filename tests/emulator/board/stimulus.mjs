// Inputs of the pins from outside: a schedule of levels at exact cycles.
//
// A pin that is not in the schedule, or that it has released, is a broken wire: its pulls determine its level.

const RELEASED = -1;

export class Stimulus {
  constructor() {
    /** Sorted by cycle, those of one cycle in the order in which they were requested; done up to `position`. */
    this.plan = [];
    this.position = 0;
    this.now = 0;
    this.onSchedule = () => {};
  }

  /** Cycle of the next change, or Infinity. */
  get next() {
    return this.position < this.plan.length ? this.plan[this.position].cycle : Infinity;
  }

  /** Sets `pin` to `level` (0, 1 or null to release it) at `cycle`. */
  at(cycle, pin, level) {
    if (!Number.isInteger(cycle) || cycle < this.now) throw new Error(`cycle ${cycle} is over already or not whole`);
    if (!Number.isInteger(pin) || pin < 0 || pin > 29) throw new Error(`there is no pin ${pin}`);
    const entry = { cycle, pin, level: level === null ? RELEASED : Number(Boolean(level)) };
    let low = this.position;
    let high = this.plan.length;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if (this.plan[middle].cycle <= cycle) low = middle + 1;
      else high = middle;
    }
    if (low === this.plan.length) this.plan.push(entry);
    else this.plan.splice(low, 0, entry);
    this.onSchedule(cycle);
    return this;
  }

  release(cycle, pin) {
    return this.at(cycle, pin, null);
  }

  /** From `cycle` on, `level` for `length` cycles, then the other. */
  pulse(cycle, pin, length, level = 1) {
    return this.at(cycle, pin, level).at(cycle + length, pin, 1 - level);
  }

  /** `count` pulses, one every `period` cycles. */
  burst(cycle, pin, { count, period, length = Math.floor(period / 2), level = 1 }) {
    if (length <= 0 || length >= period) throw new Error('a pulse of a burst must be shorter than its period');
    for (let i = 0; i < count; i += 1) this.pulse(cycle + i * period, pin, length, level);
    return this;
  }

  /** Carries out the changes that are due up to `cycle` on `outside` (see pads.mjs). Gives whether there were any. */
  apply(cycle, outside) {
    let any = false;
    this.now = cycle + 1;
    while (this.next <= cycle) {
      const { pin, level } = this.plan[this.position];
      const bit = 1 << pin;
      if (level === RELEASED) outside.enable &= ~bit;
      else outside.enable |= bit;
      outside.levels = level === 1 ? outside.levels | bit : outside.levels & ~bit;
      this.position += 1;
      any = true;
    }
    if (this.position > 4096) {
      this.plan.splice(0, this.position);
      this.position = 0;
    }
    return any;
  }
}
