// Account of the processor's cycles: asleep, and by exception; and the depth of its stack.
//
// Words: *own* cycles of an exception are those from its entry (stacking included) to its return, less those of
// exceptions that preempted it. Thread mode is number 0; interrupt n is exception 16 + n (TIMER_IRQ_1 is 1 + 16 = 17).

export const TIMER_IRQ_1 = 17;
export const DMA_IRQ_1 = 28;

export class Usage {
  /** `now()` gives the present cycle. Calls of the exceptions in `watched` are listed one by one. */
  constructor(now, watched = [TIMER_IRQ_1]) {
    this.now = now;
    this.watched = new Set(watched);
    this.asleep = 0;
    this.own = new Float64Array(64);
    this.entries = new Float64Array(64);
    /** For each watched exception: [{ entry, own, end }], in cycles; `own` as above, `end` the cycle of its return. */
    this.calls = new Map(watched.map((number) => [number, []]));
    this.restart();
  }

  /** After a reset: nothing is under way. */
  restart() {
    this.stack = [{ number: 0, entry: this.now(), own: 0 }];
    this.mark = this.now();
    this.sleeping = false;
  }

  /** The call that is under way: { number, entry, own }. */
  get current() {
    return this.stack[this.stack.length - 1];
  }

  /** Books the cycles since the last event. */
  settle() {
    const now = this.now();
    const spent = now - this.mark;
    this.mark = now;
    if (this.sleeping) {
      this.asleep += spent;
      return;
    }
    const top = this.stack[this.stack.length - 1];
    top.own += spent;
    this.own[top.number] += spent;
  }

  sleep(on) {
    this.settle();
    this.sleeping = on;
  }

  enter(number) {
    this.settle();
    this.sleeping = false;
    this.entries[number] += 1;
    this.stack.push({ number, entry: this.mark, own: 0 });
  }

  /** The return is under way. The cycles of the returning instruction are booked to the code that it returns to. */
  leave(number) {
    this.settle();
    if (this.stack.length < 2 || this.stack[this.stack.length - 1].number !== number) return;
    const call = this.stack.pop();
    if (this.watched.has(number)) this.calls.get(number).push({ entry: call.entry, own: call.own, end: this.mark });
  }

  /** The sums up to now: { cycles, asleep, awake, own: Map of exception number to cycles }. */
  sums() {
    this.settle();
    const own = new Map();
    let awake = 0;
    this.own.forEach((cycles, number) => {
      if (cycles > 0 || this.entries[number] > 0) own.set(number, { cycles, entries: this.entries[number] });
      awake += cycles;
    });
    return { cycles: awake + this.asleep, asleep: this.asleep, awake, own };
  }
}
