// The SIO's divider (datasheet 2.3.1.5), in place of rp2040js's: whole quotients, its results for a division by
// zero, and its time.
//
// A write of an operand starts a division. Its result is valid eight cycles later. An earlier read gives an
// intermediate value on hardware, and throws here. The code of an interrupt reads DIRTY to find out whether it must
// save the state.

const UDIVIDEND = 0x60;
const UDIVISOR = 0x64;
const SDIVIDEND = 0x68;
const SDIVISOR = 0x6c;
const QUOTIENT = 0x70;
const REMAINDER = 0x74;
const CSR = 0x78;

export const DIVISION_CYCLES = 8;
const READY = 1;
const DIRTY = 2;

class Divider {
  constructor(clock) {
    this.clock = clock;
    this.dividend = 0;
    this.divisor = 0;
    this.quotient = 0;
    this.remainder = 0;
    this.dirty = 0;
    this.readyAt = -Infinity;
  }

  get ready() {
    return this.clock.cycle >= this.readyAt;
  }

  divide(signed) {
    const view = (value) => (signed ? value | 0 : value >>> 0);
    const [dividend, divisor] = [view(this.dividend), view(this.divisor)];
    // The quotient of a division by zero is all ones; signed it is minus one, or one for a negative dividend.
    const quotient = divisor === 0 ? (dividend < 0 ? 1 : -1) : Math.trunc(dividend / divisor);
    this.quotient = quotient >>> 0;
    this.remainder = (divisor === 0 ? dividend : dividend % divisor) >>> 0;
    this.dirty = DIRTY;
    this.readyAt = this.clock.cycle + DIVISION_CYCLES;
  }

  result(value) {
    if (!this.ready) throw new Error(`the divider was read ${this.readyAt - this.clock.cycle} cycles too early`);
    return value;
  }

  read(offset) {
    switch (offset) {
      case UDIVIDEND:
      case SDIVIDEND:
        return this.dividend;
      case UDIVISOR:
      case SDIVISOR:
        return this.divisor;
      case QUOTIENT:
        this.dirty = 0;
        return this.result(this.quotient);
      case REMAINDER:
        return this.result(this.remainder);
      default:
        return this.dirty | (this.ready ? READY : 0);
    }
  }

  write(offset, value) {
    const word = value >>> 0;
    switch (offset) {
      case UDIVIDEND:
      case SDIVIDEND:
        this.dividend = word;
        this.divide(offset === SDIVIDEND);
        break;
      case UDIVISOR:
      case SDIVISOR:
        this.divisor = word;
        this.divide(offset === SDIVISOR);
        break;
      case QUOTIENT:
      case REMAINDER:
        if (offset === QUOTIENT) this.quotient = word;
        else this.remainder = word;
        this.dirty = DIRTY;
        this.readyAt = this.clock.cycle;
        break;
      default:
    }
  }
}

export function fixDivider(rp2040) {
  const { sio, clock } = rp2040;
  const divider = new Divider(clock);
  sio.divider = divider;
  const stockRead = sio.readUint32.bind(sio);
  const stockWrite = sio.writeUint32.bind(sio);
  const isOurs = (offset) => offset >= UDIVIDEND && offset <= CSR;
  sio.readUint32 = (offset) => (isOurs(offset) ? divider.read(offset) : stockRead(offset));
  sio.writeUint32 = (offset, value) => (isOurs(offset) ? divider.write(offset, value) : stockWrite(offset, value));
}
