// The board: one RP2040 at 125 MHz, processor and both PIO blocks in lockstep, with everything on its pins recorded and driven to the
// cycle. README.md describes the model and the meaning of a cycle number.
//
// How time passes: `cycle` is the present cycle of the processor, which executes one instruction from there. Everything else (state
// machines, alarms of peripherals, stimuli) is an *event* with a cycle of its own. Events up to the present are carried out before the
// processor accesses a peripheral, and after each instruction (`catchUp`).

import { RomBench } from './bootrom.mjs';
import { buildChip, startCore } from './chip.mjs';
import { CycleClock } from './clock.mjs';
import { BenchCore } from './core.mjs';
import { Edges } from './edges.mjs';
import { FLASH_SIZE, loadInto, readElf } from './elf.mjs';
import { Outside } from './pads.mjs';
import { CallProfile } from './profile.mjs';
import { Rtt } from './rtt.mjs';
import { Stimulus } from './stimulus.mjs';
import { UartLine } from './uart-line.mjs';
import { Usage } from './usage.mjs';
import { UsbPort } from './usb-port.mjs';

const APB_READ_WAIT = 3;
const APB_WRITE_WAIT = 4;
const RAM_BYTES = 264 * 1024;
/** PSM: RESETS, SIO and processor 0. The register is zero after reset. With that value a watchdog resets nothing. */
const WDSEL_NEEDED = (1 << 3) | (1 << 14) | (1 << 15);
const POWER_UP_PATTERN = 0xa5;

export class Board {
  /**
   * `elf`: bytes of the firmware's ELF; its segments go into the flash. `flash`: the flash array (Uint8Array, kept and
   * changed in place) to use instead, or to load the firmware over. One of them is needed, except with `bare`.
   * `pins`: { name: GPIO number } to record. `watched`: exceptions whose calls are listed (default TIMER_IRQ_1).
   * `rtt`: true, false, or the cycles between two reads of the host (default: true where the ELF has an RTT block).
   * `fastForward`: false steps every cycle of everything. `profile`: true counts the loop's cycles by call path (profile.mjs).
   * `flashTimes`: see bootrom.mjs. `missCycles`: the cost of a miss of the flash's cache (xip-cache.mjs). `bare`: true builds the chip with
   * its processor asleep, for tests of peripherals.
   */
  constructor({
    elf,
    flash,
    pins = {},
    watched,
    rtt,
    fastForward = true,
    profile = false,
    flashTimes,
    missCycles = 0,
    bare = false,
  } = {}) {
    this.elf = elf && readElf(elf);
    this.flash = flash ?? new Uint8Array(FLASH_SIZE).fill(0xff);
    if (this.elf) loadInto(this.flash, this.elf);
    this.fastForward = fastForward;
    this.bare = bare;
    this.missCycles = missCycles;
    this.cycle = 0;
    this.done = 0;
    this.stamp = -1;
    this.nextEvent = Infinity;
    this.stopped = null;
    this.pendingReset = null;
    this.events = [];
    this.warnings = new Map();
    this.outside = new Outside();
    this.stimulus = new Stimulus();
    this.stimulus.onSchedule = (cycle) => this.onDue(cycle);
    this.usb = new UsbPort(this);
    this.serial = [0, 1].map((index) => new UartLine(this, index));
    this.edges = new Edges(pins);
    this.usage = new Usage(() => this.cycle, watched);
    this.profile = profile ? new CallProfile(this.elf.functions) : null;
    this.rom = new RomBench(this, flashTimes);
    const block = this.elf?.symbols.get('_SEGGER_RTT');
    this.rtt = block && rtt !== false ? new Rtt(this, block.address, typeof rtt === 'number' ? rtt : 0) : null;
    this.powerUp();
  }

  // ---- resets ----

  /** Switches the power on: the content of RAM is meaningless, the flash keeps its content. */
  powerUp() {
    this.sram = new Uint8Array(RAM_BYTES).fill(POWER_UP_PATTERN);
    this.powered = true;
    this.boot('power', new Uint32Array(8), 0, this.pads?.levels ?? 0);
  }

  /** Switches the power off, until `powerUp`: nothing runs, nothing drives a pin, and time goes on. */
  powerDown() {
    this.powered = false;
    this.boot('no power', new Uint32Array(8), 0, this.pads.levels);
  }

  boot(cause, scratch, reason, levels) {
    this.note('reset', cause);
    const former = this.clock;
    this.clock = new CycleClock(this.cycle);
    this.clock.onSchedule = (cycle) => this.onDue(cycle);
    if (former) this.clock.inherit(former);
    this.chip = buildChip(this, {
      clock: this.clock,
      sram: this.sram,
      flash: this.flash,
      rom: this.rom.image,
      outside: this.outside,
      levels,
      scratch,
      reason,
    });
    this.core = this.chip.core;
    this.pads = this.chip.pads;
    this.pio = this.chip.pio;
    this.pads.update(this.stamp);
    this.nextEvent = Math.min(this.stimulus.next, this.clock.next);
    this.usage.restart();
    this.rtt?.attach();
    if (this.bare || !this.powered) this.core.waiting = true;
    else startCore(this.core);
  }

  /** Requested by the watchdog or by software; carried out once the present instruction is over. */
  requestReset(cause) {
    this.pendingReset ??= cause;
  }

  performReset() {
    const cause = this.pendingReset;
    this.pendingReset = null;
    if (cause === 'watchdog') {
      if ((this.chip.psm.wdsel & WDSEL_NEEDED) !== WDSEL_NEEDED) {
        throw new Error('the watchdog bites, but PSM WDSEL does not select what it should reset');
      }
      const { scratchData, reason } = this.chip.watchdog;
      this.boot(cause, scratchData, reason, this.pads.levels);
      return;
    }
    // SYSRESETREQ resets the processor and its interrupt controller, and nothing else.
    this.note('reset', cause);
    const { lines } = this.core;
    this.core = new BenchCore(this.chip, this);
    this.chip.core = this.core;
    this.core.lines = lines;
    this.core.setPending(lines);
    this.usage.restart();
    this.rtt?.attach();
    startCore(this.core);
  }

  // ---- running ----

  /**
   * Runs for `cycles`, or to `untilCycle`, or until `until(board)` holds (checked every `every` cycles), whichever comes first. Gives
   * { reason, detail, cycle }. The reason is 'cycles', 'until', or the cause that stopped the board for good: 'lockup', 'power-cut'.
   */
  run({ cycles = Infinity, untilCycle = Infinity, until = null, every = 1000 } = {}) {
    const end = Math.min(this.cycle + cycles, untilCycle);
    if (end === Infinity && !until) throw new Error('run needs an end');
    if (until === null) {
      this.runTo(end);
    } else {
      while (!this.stopped && this.cycle < end) {
        if (until(this)) return { reason: 'until', cycle: this.cycle };
        this.runTo(Math.min(end, this.cycle + every));
      }
    }
    if (this.stopped) return this.stopped;
    return { reason: until?.(this) ? 'until' : 'cycles', cycle: this.cycle };
  }

  runTo(end) {
    while (this.cycle < end && this.stopped === null) {
      const { core } = this;
      if (core.waiting) {
        this.sleepTo(end);
      } else if (this.profile !== null) {
        const pc = (core.registers[15] & ~1) >>> 0;
        const spent = core.step();
        this.profile.book(pc, spent, this.usage.current, core);
        this.cycle += spent;
      } else {
        this.cycle += core.step();
      }
      if (this.nextEvent < this.cycle) this.catchUp(this.cycle);
      if (core.left !== 0) {
        this.usage.leave(core.left);
        core.left = 0;
      }
      if (this.pendingReset !== null) this.performReset();
    }
    if (this.stopped === null) this.catchUp(this.cycle);
  }

  /** The processor sleeps: time advances from event to event until the processor wakes up. */
  sleepTo(end) {
    const { core } = this;
    core.wake();
    if (!core.waiting) return;
    this.usage.sleep(true);
    while (core.waiting && this.cycle < end && this.pendingReset === null && this.stopped === null) {
      const event = this.fastForward ? this.nextEvent : this.cycle;
      this.cycle = Math.min(end, event + 1);
      this.catchUp(this.cycle);
      core.wake();
    }
    this.usage.sleep(false);
  }

  /** Carries out every event before `target`, in order; afterwards it is `target`. */
  catchUp(target) {
    while (this.nextEvent < target || (!this.fastForward && this.done < target)) {
      const cycle = this.fastForward ? this.nextEvent : this.done;
      if (!this.fastForward) this.done = cycle + 1;
      this.carryOut(cycle);
      if (this.pendingReset !== null) break;
    }
    if (target > this.clock.cycle) this.clock.cycle = target;
    this.stamp = target - 1;
  }

  /** One cycle's events: state machines first, then alarms, then stimuli. */
  carryOut(cycle) {
    const pio0 = this.pio[0];
    const pio1 = this.pio[1];
    this.stamp = cycle;
    this.clock.cycle = cycle;
    this.nextEvent = Infinity;
    if (!this.fastForward) for (const block of this.pio) block.poll(cycle);
    let touched = false;
    if (pio0.due <= cycle) touched = pio0.execute(cycle);
    if (pio1.due <= cycle && pio1.execute(cycle)) touched = true;
    if (touched) this.pads.update(cycle);
    if (this.clock.next <= cycle) this.clock.fire();
    if (this.stimulus.next <= cycle && this.stimulus.apply(cycle, this.outside)) this.pads.update(cycle);
    this.nextEvent = Math.min(pio0.due, pio1.due, this.clock.next, this.stimulus.next);
  }

  // ---- called by the parts ----

  onDue(cycle) {
    if (cycle < this.nextEvent) this.nextEvent = cycle;
  }

  /** A load gives the peripheral's value at the start of the load's last cycle. */
  beforeRead(address) {
    const last = this.cycle + waitOf(address, APB_READ_WAIT);
    this.catchUp(last);
    this.stamp = last;
  }

  /** A store takes effect at the end of its last cycle. */
  beforeWrite(address) {
    this.catchUp(this.cycle + waitOf(address, APB_WRITE_WAIT) + 1);
  }

  pinsChanged(stamp, changed) {
    this.edges.record(stamp, changed);
    for (const block of this.pio) block.inputsChanged(stamp, changed);
  }

  romCall(number, core) {
    return this.rom.call(number, core);
  }

  /** Ends the run for good. */
  stop(reason, detail) {
    this.stopped ??= { reason, detail, cycle: this.cycle };
    this.note(reason, detail);
  }

  note(kind, text) {
    this.events.push({ cycle: this.cycle, kind, text });
  }

  /** Counts a complaint of rp2040js that does not stop it. */
  warn(name, text) {
    const key = `${name}: ${text}`;
    this.warnings.set(key, (this.warnings.get(key) ?? 0) + 1);
  }

  // ---- for the bench ----

  /** The greatest depth of the stack below its initial position, in bytes. */
  get stackDepth() {
    return this.core.initialSP - this.core.minSP;
  }

  /** Reads or writes a register like a debugger: at the end of the present cycle, in no time. */
  peek(address) {
    this.catchUp(this.cycle);
    return this.chip.readUint32(address) >>> 0;
  }

  poke(address, value) {
    this.catchUp(this.cycle);
    this.chip.writeUint32(address, value);
  }

  /** Starts a new recording of edges here. */
  record(pins) {
    this.catchUp(this.cycle);
    this.edges = new Edges(pins, { cycle: this.cycle, levels: this.pads.levels });
    return this.edges;
  }
}

function waitOf(address, apbWait) {
  const region = address >>> 28;
  if (region === 0xd) return 0;
  return region === 4 ? apbWait : 1;
}
