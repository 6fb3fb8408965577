// The cache between processor and flash: 16 KiB, two ways of 1,024 lines of 8 bytes (RP2040 datasheet, 2.6.3). A hit
// costs nothing here. A miss costs the time to fetch a line from the flash chip. So does each access past the cache, at 0x13000000.
//
// Not documented, and assumed: the least recently used of the two ways is replaced. Not modelled: DMA from the flash,
// and the other two aliases of the window; the firmware uses neither.

const SETS = 1024;
const LINE_BITS = 3;
const EMPTY = -1;

/**
 * Cycles that a line takes: in quad mode with continuous read, which the second-stage boot block sets up, 8 clocks of
 * address and mode, 4 of waiting and 16 of data, each two cycles of the processor long.
 */
export const MISS_CYCLES = 56;

export class XipCache {
  constructor(missCycles = MISS_CYCLES) {
    this.missCycles = missCycles;
    /** The lines in both ways of each set, the most recently used first. */
    this.lines = new Int32Array(2 * SETS);
    this.misses = 0;
    this.flush();
  }

  /** Empties the cache. */
  flush() {
    this.lines.fill(EMPTY);
    this.last = EMPTY;
  }

  /** Wait of an access to `address`, an offset into the flash, in cycles. */
  wait(address) {
    const line = address >>> LINE_BITS;
    if (line === this.last) return 0;
    this.last = line;
    const { lines } = this;
    const set = (line & (SETS - 1)) << 1;
    if (lines[set] === line) return 0;
    const hit = lines[set + 1] === line;
    lines[set + 1] = lines[set];
    lines[set] = line;
    if (hit) return 0;
    this.misses += 1;
    return this.missCycles;
  }
}
