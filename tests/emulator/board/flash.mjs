// The flash chip behind the ROM's functions: erasing, programming, and a power failure in the middle of either.
//
// NOR flash: erasing a sector sets all its bits; programming only clears bits. A call outside the ROM's contract
// (unaligned ranges, ranges beyond the chip) throws. On hardware it would corrupt something without an error.

export const SECTOR_BYTES = 4096;
export const PAGE_BYTES = 256;

export class Flash {
  constructor(array) {
    this.array = array;
  }

  check(name, address, length, unit) {
    if (address % unit !== 0 || length % unit !== 0 || length === 0) {
      throw new Error(
        `${name} of 0x${length.toString(16)} bytes at 0x${address.toString(16)}: not in units of ${unit}`,
      );
    }
    if (address + length > this.array.length) throw new Error(`${name} beyond the end of the flash`);
  }

  /** Erases; with `survived` bytes only, the next byte is left with some of its bits erased and the rest as it was. */
  erase(address, length, survived = length) {
    this.check('erase', address, length, SECTOR_BYTES);
    this.array.fill(0xff, address, address + survived);
    if (survived < length) this.array[address + survived] |= 0x55;
  }

  /** Programs; with `survived` bytes only, the next byte has some of its bits programmed. */
  program(address, data, survived = data.length) {
    this.check('program', address, data.length, PAGE_BYTES);
    for (let i = 0; i < survived; i += 1) this.array[address + i] &= data[i];
    if (survived < data.length) this.array[address + survived] &= data[survived] | 0x55;
  }
}
