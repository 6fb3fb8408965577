// The processor's own registers: NVIC pending bits, ICSR, AIRCR and SysTick, corrected in rp2040js's PPB.
//
// In rp2040js software cannot pend a hardware interrupt correctly: it stays pending, or cannot be cleared.
// rp2040js has no system reset, and reloads SysTick wrongly after a write to its current value.

const SYST_CSR = 0x010;
const SYST_RVR = 0x014;
const SYST_CVR = 0x018;
const NVIC_ISPR = 0x200;
const NVIC_ICPR = 0x280;
const ICSR = 0xd04;
const AIRCR = 0xd0c;
const SCR = 0xd10;
const SHPR2 = 0xd1c;
const SHPR3 = 0xd20;

const SYSRESETREQ = 1 << 2;
const AIRCR_KEY = 0x05fa;

/** Counts down by one a cycle of the processor, reloads, and pends its exception when it reaches zero. */
class SysTick {
  constructor(rp2040) {
    this.clock = rp2040.clock;
    this.rp2040 = rp2040;
    this.control = 0;
    this.reload = 0;
    this.counted = false;
    /** While running: the cycle in which the counter was, or would have been, zero. While stopped: its value. */
    this.zeroAt = 0;
    this.frozen = 0;
    this.alarm = this.clock.createAlarm(() => this.zero());
  }

  get running() {
    return (this.control & 1) !== 0;
  }

  get value() {
    if (!this.running) return this.frozen;
    const elapsed = this.clock.cycle - this.zeroAt;
    return elapsed <= 0 ? -elapsed : this.reload - ((elapsed - 1) % (this.reload + 1));
  }

  start(value) {
    this.zeroAt = this.clock.cycle + value;
    this.alarm.cancel();
    if (value > 0) this.alarm.at(this.zeroAt);
    else if (this.reload > 0) this.alarm.at(this.zeroAt + this.reload + 1);
  }

  zero() {
    this.zeroAt = this.clock.cycle;
    this.counted = true;
    if (this.control & 2) {
      this.rp2040.core.pendingSystick = true;
      this.rp2040.core.interruptsUpdated = true;
    }
    if (this.reload > 0) this.alarm.at(this.zeroAt + this.reload + 1);
  }

  read(offset) {
    if (offset === SYST_RVR) return this.reload;
    if (offset === SYST_CVR) return this.value;
    const result = this.control | (this.counted ? 1 << 16 : 0);
    this.counted = false;
    return result;
  }

  write(offset, value) {
    if (offset === SYST_RVR) {
      this.reload = value & 0xff_ffff;
    } else if (offset === SYST_CVR) {
      this.counted = false;
      this.frozen = 0;
      if (this.running) this.start(0);
    } else {
      const now = this.value;
      const was = this.running;
      this.control = value & 7;
      if (this.running && !was) this.start(now);
      if (!this.running && was) {
        this.frozen = now;
        this.alarm.cancel();
      }
    }
  }
}

/** Corrects the PPB of `rp2040`; `onSystemReset` is called when software requests a reset. */
export function fixPpb(rp2040, onSystemReset) {
  const { ppb } = rp2040;
  ppb.systickAlarm.enable = false;
  const systick = new SysTick(rp2040);
  ppb.systick = systick;
  const stockRead = ppb.readUint32.bind(ppb);
  const stockWrite = ppb.writeUint32.bind(ppb);

  ppb.readUint32 = (offset) => {
    const { core } = rp2040;
    if (offset >= SYST_CSR && offset <= SYST_CVR) return systick.read(offset);
    if (offset === AIRCR) return 0xfa05_0000;
    if (offset === SCR) return 0;
    if (offset !== ICSR) return stockRead(offset);
    const isr = (core.pendingInterrupts & core.enabledInterrupts) !== 0;
    return (
      (core.pendingNMI ? 1 << 31 : 0) |
      (core.pendingPendSV ? 1 << 28 : 0) |
      (core.pendingSystick ? 1 << 26 : 0) |
      (isr ? 1 << 22 : 0) |
      (core.nextException(4) << 12) |
      core.IPSR
    );
  };

  ppb.writeUint32 = (offset, value) => {
    const { core } = rp2040;
    if (offset >= SYST_CSR && offset <= SYST_CVR) return systick.write(offset, value);
    if (offset === NVIC_ISPR) return core.setPending(value);
    if (offset === NVIC_ICPR) return core.clearPending(value);
    if (offset === AIRCR) {
      if (value >>> 16 === AIRCR_KEY && value & SYSRESETREQ) onSystemReset();
      return undefined;
    }
    if (offset === SCR && (value & 0x16) === 0) return undefined;
    if (offset === SHPR2 || offset === SHPR3) core.interruptsUpdated = true;
    return stockWrite(offset, value);
  };
}
