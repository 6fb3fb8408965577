// The tick generator, and what it clocks: the 64-bit microsecond timer, corrected, and the watchdog.
//
// rp2040js counts from the middle of a microsecond and drops the rest. So an alarm may come up to a microsecond before its time, and the
// firmware has to arm it again and again. It has no tick generator: here WATCHDOG.TICK sets the rate of both, or stops them, and PAUSE
// stops the timer.
//
// Convention: the timer's microseconds begin with the reset. On hardware they begin when the firmware starts the tick,
// and have no fixed relation to the system clock.

import { CYCLES_PER_US } from './clock.mjs';

const TIMER = 0x40054;
const WATCHDOG = 0x40058;

const [TIMELR, ALARM0, ALARM3, TIMERAWH, TIMERAWL, PAUSE] = [0x0c, 0x10, 0x1c, 0x24, 0x28, 0x30];
const WORD = 2 ** 32;

const CTRL = 0x00;
const CTRL_ENABLE = 1 << 30;
const TICK = 0x2c;
const TICK_ENABLE = 1 << 9;
const TICK_RUNNING = 1 << 10;
const TICK_CYCLES = 0x1ff;

/** Cycles of the crystal in a microsecond. */
const CRYSTAL_CYCLES_PER_US = 12;
/** The watchdog counts down twice a tick (erratum E1). */
const WATCHDOG_HZ = 2_000_000;

/** Makes ticks from the crystal, as WATCHDOG.TICK says. */
export class TickGenerator {
  constructor(rp2040) {
    this.clock = rp2040.clock;
    this.watchdog = rp2040.peripherals[WATCHDOG];
    this.timer = rp2040.peripherals[TIMER];
    this.running = true;
    this.crystalCycles = CRYSTAL_CYCLES_PER_US;
    /** The crystal's frequency against that of the processor's clock; 1: as they should be. */
    this.rate = 1;
    this.paused = false;
    /** Time of the timer at the cycle `since`, from which on it has counted at the present rate. */
    this.micros = 0;
    this.since = this.clock.origin;
  }

  /** Cycles of the processor in a tick. */
  get cycles() {
    return (CYCLES_PER_US * this.crystalCycles) / CRYSTAL_CYCLES_PER_US / this.rate;
  }

  get counting() {
    return this.running && !this.paused;
  }

  /** Time of the timer, in ticks; the part of one that has begun counts. */
  get now() {
    return this.counting ? this.micros + (this.clock.cycle - this.since) / this.cycles : this.micros;
  }

  /** The cycle in which the timer reaches a time; Infinity if it stands. */
  cycleAt(micros) {
    return this.counting ? Math.ceil(this.since + (micros - this.micros) * this.cycles) : Infinity;
  }

  /** Changes `running`, `crystalCycles`, `rate` or `paused`. The timer goes on from its present time. */
  change(values) {
    this.micros = this.now;
    this.since = this.clock.cycle;
    Object.assign(this, values);
    this.watchdog.timer.frequency = (WATCHDOG_HZ * CYCLES_PER_US) / this.cycles;
    for (const alarm of this.timer.alarms) if (alarm.armed) this.arm(alarm);
  }

  /** A value equal to the present one matches at once. A past one matches only after the low word has wrapped. */
  arm(alarm) {
    const now = Math.floor(this.now);
    const wait = (alarm.targetMicros - now) >>> 0;
    const cycle = wait === 0 ? this.clock.cycle : this.cycleAt(now + wait);
    if (cycle === Infinity) alarm.clockAlarm.cancel();
    else alarm.clockAlarm.at(cycle);
  }
}

export function fixTimer(rp2040) {
  const ticks = new TickGenerator(rp2040);
  const { timer, watchdog } = ticks;
  rp2040.ticks = ticks;

  const readTimer = timer.readUint32.bind(timer);
  timer.readUint32 = (offset) => {
    switch (offset) {
      case TIMELR:
        timer.latchedTimeHigh = Math.floor(ticks.now / WORD);
        return Math.floor(ticks.now) >>> 0;
      case TIMERAWL:
        return Math.floor(ticks.now) >>> 0;
      case TIMERAWH:
        return Math.floor(ticks.now / WORD);
      case PAUSE:
        return Number(ticks.paused);
      default:
        return readTimer(offset);
    }
  };
  const writeTimer = timer.writeUint32.bind(timer);
  timer.writeUint32 = (offset, value) => {
    if (offset === PAUSE) {
      ticks.change({ paused: (value & 1) !== 0 });
    } else if (offset >= ALARM0 && offset <= ALARM3) {
      const alarm = timer.alarms[(offset - ALARM0) / 4];
      alarm.armed = true;
      alarm.targetMicros = value;
      ticks.arm(alarm);
    } else {
      writeTimer(offset, value);
    }
  };

  const readWatchdog = watchdog.readUint32.bind(watchdog);
  watchdog.readUint32 = (offset) => {
    if (offset === TICK) return (ticks.running ? TICK_RUNNING | TICK_ENABLE : 0) | ticks.crystalCycles;
    const value = readWatchdog(offset);
    // rp2040js gives the enable bit only while the watchdog counts.
    return offset === CTRL && watchdog.enable ? value | CTRL_ENABLE : value;
  };
  const writeWatchdog = watchdog.writeUint32.bind(watchdog);
  watchdog.writeUint32 = (offset, value) => {
    writeWatchdog(offset, value);
    if (offset !== TICK) return;
    const [running, crystalCycles] = [(value & TICK_ENABLE) !== 0, value & TICK_CYCLES];
    if (running && crystalCycles === 0) throw new Error('a tick of no cycles is not modelled');
    ticks.change({ running, crystalCycles });
  };
}
