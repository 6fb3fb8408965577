// A PIO block in cycles: four machines, their registers and their shared state. Registers that depend on time are
// corrected here. The rest stay rp2040js's.
//
// Convention: machines of one cycle read flags and pins as they were at its start. Their own changes are visible in
// the next. Machines are executed in order, so that the highest-numbered wins a pin that two write in one cycle
// (datasheet 3.5.6).

import { RPPIO } from 'rp2040js';
import { Machine } from './pio-machine.mjs';
import { FDEBUG, FLAG, INPUT, NONE, TX } from './pio-operations.mjs';

const REG = {
  ctrl: 0x000,
  fdebug: 0x008,
  irq: 0x030,
  irqForce: 0x034,
  bypass: 0x038,
  memory: 0x048,
  machines: 0x0c8,
};
const MACHINE_BYTES = 0x18;
const MACHINES_END = REG.machines + 4 * MACHINE_BYTES;
const MACHINE_REG = { clkdiv: 0x00, execctrl: 0x04, shiftctrl: 0x08, addr: 0x0c, instr: 0x10, pinctrl: 0x14 };
const PIN_MASK = 0x3fff_ffff;

/** `value` on `count` pins from `base`, going on at pin 0 after pin 31, in place of those bits of `old`. */
function placed(old, value, base, count) {
  const field = count >= 32 ? 0xffff_ffff : (1 << count) - 1;
  const turn = (bits) => (base === 0 ? bits : (bits << base) | (bits >>> (32 - base)));
  const mask = turn(field);
  return ((old & ~mask) | (turn(value & field) & mask)) & PIN_MASK;
}

export class Block extends RPPIO {
  /** `host`: the board. It gives the present stamp, and is notified of new due cycles. */
  constructor(rp2040, index, host) {
    super(rp2040, `PIO${index}`, 7 + 2 * index, index);
    this.host = host;
    this.fastForward = host.fastForward;
    /** IRQ flags as the machines of the present cycle see them. */
    this.flags = 0;
    this.cycle = -1;
    this.sampled = 0;
    this.sampledIn = -1;
    this.pinsTouched = false;
    /** A flag was raised or cleared in the present cycle, also if that changed nothing. */
    this.flagsTouched = false;
    this.machines = [0, 1, 2, 3].map((i) => new Machine(this, i));
  }

  stampNow() {
    return this.host.stamp;
  }

  onDue(cycle) {
    this.host.onDue(cycle);
  }

  /** rp2040js would run the machines from a timer of the operating system. */
  run() {}

  get due() {
    const { machines } = this;
    return Math.min(machines[0].due, machines[1].due, machines[2].due, machines[3].due);
  }

  /** Executes the instructions that are due in `cycle`. Gives whether pins were written. */
  execute(cycle) {
    this.begin(cycle);
    for (let i = 0; i < 4; i += 1) {
      const machine = this.machines[i];
      if (machine.due <= cycle) machine.execute(cycle);
    }
    return this.end(cycle);
  }

  /** Plain stepping: tries every stalled instruction again in every cycle. */
  poll(cycle) {
    for (const machine of this.machines) {
      if (machine.stall !== NONE && (machine.enabled || machine.forced >= 0)) machine.retry(machine.stall, cycle);
    }
  }

  begin(cycle) {
    this.cycle = cycle;
    this.flags = this.irq;
    this.pinsTouched = false;
    this.flagsTouched = false;
  }

  end(cycle) {
    if (this.flagsTouched) {
      this.flags = this.irq;
      this.flagsChanged(cycle + 1);
    }
    return this.pinsTouched;
  }

  // ---- pins ----

  /** Input pins as the machines read them in the present cycle. */
  get inputs() {
    if (this.sampledIn !== this.cycle) {
      this.sampled = this.host.pads.inputs(this.cycle, this.inputSyncBypass);
      this.sampledIn = this.cycle;
    }
    return this.sampled;
  }

  /** Inputs as the machines read them once no level moves. */
  steadyInputs() {
    const { pads } = this.host;
    return pads.inside(pads.levels);
  }

  /** True if `pins` are read with other levels in `cycle` than they will be once nothing moves. */
  inputsMoving(cycle, pins) {
    return this.host.pads.moving(cycle, pins);
  }

  /** Sets the inputs that a machine that runs ahead reads in `cycle`. */
  fixInputs(cycle, levels) {
    this.cycle = cycle;
    this.sampledIn = cycle;
    this.sampled = levels;
  }

  /** True if changes of pins are under way that have not reached the machines in `cycle`. */
  inputsUnsettled(cycle) {
    return this.host.pads.changedSince(cycle - 3);
  }

  inputsChanged(stamp, changed) {
    for (const machine of this.machines) {
      if (machine.stall === INPUT) machine.retry(INPUT, stamp + 1);
      else if (machine.saved.ahead && machine.pinsRead & changed) machine.settle(stamp + 1);
    }
  }

  setPins(value, base, count) {
    this.pinValues = placed(this.pinValues, value, base, count);
    this.pinsTouched = true;
  }

  setDirections(value, base, count) {
    this.pinDirections = placed(this.pinDirections, value, base, count);
    this.pinsTouched = true;
  }

  // ---- flags ----

  raiseFlag(flag) {
    this.irq |= 1 << flag;
    this.flagsTouched = true;
    this.checkInterrupts();
  }

  clearFlag(flag) {
    this.irq &= ~(1 << flag);
    this.flagsTouched = true;
    this.checkInterrupts();
  }

  flagsChanged(cycle) {
    for (const machine of this.machines) machine.retry(FLAG, cycle);
  }

  // ---- registers ----

  readUint32(offset) {
    if (offset < REG.machines || offset >= MACHINES_END) return super.readUint32(offset);
    const machine = this.machines[Math.floor((offset - REG.machines) / MACHINE_BYTES)];
    switch ((offset - REG.machines) % MACHINE_BYTES) {
      case MACHINE_REG.clkdiv:
        return machine.clkdiv;
      case MACHINE_REG.execctrl:
        return machine.execctrl >>> 0;
      case MACHINE_REG.shiftctrl:
        return machine.shiftctrl >>> 0;
      case MACHINE_REG.addr:
        machine.settle(this.rp2040.clock.cycle);
        return machine.pc;
      case MACHINE_REG.instr:
        machine.settle(this.rp2040.clock.cycle);
        return machine.forced >= 0 ? machine.forced : this.instructions[machine.pc];
      default:
        return machine.pinctrl >>> 0;
    }
  }

  writeUint32(offset, value) {
    const now = this.host.stamp + 1;
    if (offset >= REG.memory && offset < REG.machines) {
      this.settle(now);
      super.writeUint32(offset, value);
    } else if (offset >= REG.machines && offset < MACHINES_END) {
      this.settle(now);
      const machine = this.machines[Math.floor((offset - REG.machines) / MACHINE_BYTES)];
      this.writeMachine(machine, (offset - REG.machines) % MACHINE_BYTES, value >>> 0, now);
    } else if (offset === REG.bypass) {
      this.settle(now);
      super.writeUint32(offset, value);
    } else if (offset === REG.ctrl) {
      this.control(value, now);
    } else if (offset === REG.fdebug) {
      this.fdebug &= ~this.rawWriteValue;
      for (const machine of this.machines) if (machine.stall === TX) machine.flagDebug(FDEBUG.txStall);
    } else if (offset === REG.irq || offset === REG.irqForce) {
      if (offset === REG.irq) this.irq &= ~this.rawWriteValue;
      else this.irq |= value & 0xff;
      this.checkInterrupts();
      this.flagsChanged(now);
    } else {
      super.writeUint32(offset, value);
    }
  }

  /** CTRL: restarts, then enables; machines enabled by one write execute their first instruction in one cycle. */
  control(value, now) {
    this.machines.forEach((machine, i) => {
      if (value & (0x10 << i)) machine.restart(now);
      if (value & (0x100 << i)) machine.phase = now;
      machine.enable((value & (1 << i)) !== 0, now);
    });
  }

  writeMachine(machine, register, value, now) {
    switch (register) {
      case MACHINE_REG.clkdiv:
        machine.clkdiv = value;
        break;
      case MACHINE_REG.execctrl:
        machine.execctrl = (value & 0x7fff_ffff) | (machine.execctrl & 0x8000_0000);
        break;
      case MACHINE_REG.shiftctrl: {
        const rejoin = ((machine.shiftctrl ^ value) & 0xc000_0000) !== 0;
        machine.shiftctrl = value;
        if (rejoin) machine.join();
        break;
      }
      case MACHINE_REG.pinctrl:
        machine.pinctrl = value;
        break;
      case MACHINE_REG.instr:
        machine.force(value & 0xffff, now);
        if (this.pinsTouched) this.host.pads.update(now - 1);
        return;
      default:
        return;
    }
    machine.decode();
    if (machine.enabled) machine.refuseUnmodelled();
  }

  /** Ends the running ahead of machines, because the instructions that they are to execute may change. */
  settle(now) {
    for (const machine of this.machines) machine.settle(now);
  }

  /** Interrupt sources of the FIFOs: TX not full, RX not empty. */
  get intRaw() {
    let raw = (this.irq & 0xf) << 8;
    this.machines.forEach((machine, i) => {
      if (!machine.txFIFO.full) raw |= 0x10 << i;
      if (!machine.rxFIFO.empty) raw |= 1 << i;
    });
    return raw;
  }
}
