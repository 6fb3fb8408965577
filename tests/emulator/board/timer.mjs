// Alarms of the 64-bit microsecond timer, corrected. rp2040js counts from the middle of a microsecond and drops the
// rest. So an alarm may come up to a microsecond before its time, and the firmware has to arm it again and again.
//
// Convention: the timer's microseconds begin with the reset. On hardware they begin when the firmware starts the tick,
// and have no fixed relation to the system clock.

import { CYCLES_PER_US } from './clock.mjs';

const ALARM0 = 0x10;
const ALARM3 = 0x1c;

export function fixTimer(rp2040) {
  const timer = rp2040.peripherals[0x40054];
  const { clock } = rp2040;
  const stock = timer.writeUint32.bind(timer);
  timer.writeUint32 = (offset, value) => {
    if (offset < ALARM0 || offset > ALARM3) {
      stock(offset, value);
      return;
    }
    const alarm = timer.alarms[(offset - ALARM0) / 4];
    const now = Math.floor((clock.cycle - clock.origin) / CYCLES_PER_US);
    const wait = (value - now) >>> 0;
    alarm.armed = true;
    alarm.targetMicros = value;
    // A value equal to the present one matches at once. A past one matches only after the low word has wrapped.
    alarm.clockAlarm.at(wait === 0 ? clock.cycle : clock.origin + (now + wait) * CYCLES_PER_US);
  };
}
