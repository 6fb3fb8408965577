// The pads: the driver of each of the 30 pins, the resulting level, and the level inside the chip.
//
// Words:
// - *stamp*: the cycle at whose end a level changes. An instruction of a state machine in cycle k, a store whose last
//   cycle is k, a stimulus at k: all change levels with stamp k;
// - *outside*: the levels that the bench drives. An undriven pin follows its pulls; with none, or both, it keeps its
//   level;
// - *synchroniser*: two flip-flops between pad and inside: a level of stamp k is visible inside in cycle k + 3 and
//   later (k + 1 where INPUT_SYNC_BYPASS is set). Interrupts of IO_BANK0 are raised with the stamp itself.
//
// A *contention* is a pin that the chip and the outside drive to different levels. It is noted, and the chip wins.

const PIN_COUNT = 30;
const PIN_MASK = 0x3fff_ffff;
const PAD_RESET = 0x56;
const EDGE_HIGH = 8;
const EDGE_LOW = 4;
const LEVEL_HIGH = 2;
const LEVEL_LOW = 1;
const SYNC_CYCLES = 3;

/** Levels that the bench drives, on all pins. They are kept over the chip's resets. */
export class Outside {
  enable = 0;
  levels = 0;
}

export class Pads {
  /** `onChange(stamp, changed, levels)` is called at every change of levels; `onContention(pins)` at a contention;
   * `onConfigure()` before functions, overrides or pulls change. */
  constructor(rp2040, outside, levels, { onChange, onConfigure, onContention, stampNow }) {
    Object.assign(this, { rp2040, outside, onChange, onConfigure, onContention, stampNow });
    this.levels = levels;
    this.contended = 0;
    /** The last changes, newest last: stamps and the levels from then on. */
    this.stamps = [-Infinity];
    this.history = [levels];
    for (const pin of rp2040.gpio) {
      pin.padValue = PAD_RESET;
      pin.checkForUpdates = () => this.update(this.stampNow());
      pin.refreshInput = () => {};
    }
    for (const peripheral of [rp2040.peripherals[0x40014], rp2040.peripherals[0x4001c]]) {
      const stock = peripheral.writeUint32.bind(peripheral);
      peripheral.writeUint32 = (offset, value) => {
        this.onConfigure();
        stock(offset, value);
        this.refresh();
        this.update(this.stampNow());
      };
    }
    Object.defineProperty(rp2040, 'gpioValues', { get: () => this.inputs(rp2040.clock.cycle) });
    this.refresh();
    for (const pin of rp2040.gpio) this.feed(pin, (levels >>> pin.index) & 1, false);
  }

  /** Reads function selects, overrides and pulls again. */
  refresh() {
    const all = (test) => {
      let mask = 0;
      for (const pin of this.rp2040.gpio) if (test(pin)) mask |= 1 << pin.index;
      return mask;
    };
    this.ofPwm = all((p) => p.functionSelect === 4);
    this.ofSio = all((p) => p.functionSelect === 5);
    this.ofPio0 = all((p) => p.functionSelect === 6);
    this.ofPio1 = all((p) => p.functionSelect === 7);
    this.outInvert = all((p) => p.outputOverride === 1);
    this.outKeep = all((p) => p.outputOverride < 2);
    this.outHigh = all((p) => p.outputOverride === 3);
    this.enableInvert = all((p) => p.outputEnableOverride === 1);
    this.enableKeep = all((p) => p.outputEnableOverride < 2 && !p.outputDisable);
    this.enableHigh = all((p) => p.outputEnableOverride === 3 && !p.outputDisable);
    this.inInvert = all((p) => p.inputOverride === 1);
    this.inKeep = all((p) => p.inputOverride < 2);
    this.inHigh = all((p) => p.inputOverride === 3);
    this.inEnable = all((p) => p.inputEnable);
    this.pullUp = all((p) => p.pullupEnabled && !p.pulldownEnabled);
    this.pullDown = all((p) => p.pulldownEnabled && !p.pullupEnabled);
  }

  /** Computes the levels again; changes get this stamp. */
  update(stamp) {
    const { rp2040, outside } = this;
    const pio0 = rp2040.pio[0];
    const pio1 = rp2040.pio[1];
    const out =
      ((((pio0.pinValues & this.ofPio0) |
        (pio1.pinValues & this.ofPio1) |
        (rp2040.sio.gpioValue & this.ofSio) |
        (rp2040.pwm.gpioValue & this.ofPwm)) ^
        this.outInvert) &
        this.outKeep) |
      this.outHigh;
    const enable =
      ((((pio0.pinDirections & this.ofPio0) |
        (pio1.pinDirections & this.ofPio1) |
        (rp2040.sio.gpioOutputEnable & this.ofSio) |
        (rp2040.pwm.gpioDirection & this.ofPwm)) ^
        this.enableInvert) &
        this.enableKeep) |
      this.enableHigh;
    const contended = enable & outside.enable & (out ^ outside.levels) & PIN_MASK;
    if (contended & ~this.contended) this.onContention(contended & ~this.contended);
    this.contended = contended;

    const undriven = ((this.levels & ~this.pullDown) | this.pullUp) & ~outside.enable;
    const levels = ((out & enable) | (~enable & ((outside.levels & outside.enable) | undriven))) & PIN_MASK;
    const changed = levels ^ this.levels;
    if (changed === 0) return;
    this.levels = levels;
    const last = this.stamps.length - 1;
    if (this.stamps[last] === stamp) {
      this.history[last] = levels;
    } else {
      this.stamps.push(stamp);
      this.history.push(levels);
      if (this.stamps.length > 64) {
        this.stamps.splice(0, 48);
        this.history.splice(0, 48);
      }
    }
    for (let rest = changed; rest !== 0; rest &= rest - 1) {
      const index = 31 - Math.clz32(rest & -rest);
      this.feed(rp2040.gpio[index], (levels >>> index) & 1, true);
    }
    this.onChange(stamp, changed, levels);
  }

  /** Passes its level to a pin of rp2040js: for interrupts, and for PWM that counts it. */
  feed(pin, level, edge) {
    const watched = pin.irqEnableMask !== 0;
    const before = watched && pin.irqValue;
    pin.rawInputValue = level === 1;
    const high = level === 1 && pin.inputEnable;
    pin.irqStatus &= ~(LEVEL_HIGH | LEVEL_LOW);
    pin.irqStatus |= high ? LEVEL_HIGH : LEVEL_LOW;
    if (edge) pin.irqStatus |= high ? EDGE_HIGH : EDGE_LOW;
    if (watched && pin.irqValue !== before) this.rp2040.updateIOInterrupt();
    if (edge && pin.functionSelect === 4) this.rp2040.pwm.gpioOnInput(pin.index);
  }

  /** Levels on the inside in `cycle`; `bypass`: mask of pins without synchroniser. */
  inputs(cycle, bypass = 0) {
    let sampled = this.levelsBefore(cycle - SYNC_CYCLES);
    if (bypass !== 0) sampled = (sampled & ~bypass) | (this.levelsBefore(cycle - 1) & bypass);
    return this.inside(sampled);
  }

  /** Applies input enables and overrides to levels. */
  inside(levels) {
    return (((levels & this.inEnable) ^ this.inInvert) & this.inKeep) | this.inHigh;
  }

  /** True if in `cycle` the inside has other levels on `pins` than the present ones, with or without synchroniser. */
  moving(cycle, pins) {
    const { levels } = this;
    const sampled = (this.levelsBefore(cycle - SYNC_CYCLES) ^ levels) | (this.levelsBefore(cycle - 1) ^ levels);
    return (sampled & pins) !== 0;
  }

  /** True if a level changed with a stamp after `stamp`. */
  changedSince(stamp) {
    return this.stamps[this.stamps.length - 1] > stamp;
  }

  /** Levels after all changes with stamps up to `stamp`. */
  levelsBefore(stamp) {
    let at = this.stamps.length - 1;
    while (at > 0 && this.stamps[at] > stamp) at -= 1;
    return this.history[at];
  }
}

export { PIN_COUNT, SYNC_CYCLES };
