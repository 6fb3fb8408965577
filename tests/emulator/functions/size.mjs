// Flash that a function takes: its own code, all that it calls, and the tables that these point to.
//
// Some tables have no symbol (constants that were never given an address in the source). Such a block begins where a
// constant points and ends where the next block begins: at a symbol, or at the target of any other constant.

const FLASH = 0x10000000;
const END = FLASH + 0x200000;

/** Sizes of what can be reached in an ELF. */
export class Sizes {
  constructor(elf) {
    this.segments = elf.segments;
    this.symbols = elf.symbols.filter((s) => s.address >= FLASH && s.address < END);
    const edges = new Set(this.symbols.flatMap((s) => [s.address, s.address + s.size]));
    for (const { address, bytes } of elf.segments) {
      edges.add(address + bytes.length);
      for (const target of constants(bytes, address)) edges.add(target);
    }
    this.edges = [...edges].sort((a, b) => a - b);
  }

  /** Bytes that can be reached from the function `name` by calls, jumps, and addresses among its constants. */
  reachable(name) {
    const visited = new Set();
    // A function does not need the message of a panic.
    const panic = this.symbols.find((s) => s.name.includes('panic_fmt'));
    if (panic) visited.add(panic.address);
    let sum = 0;
    const visit = (block) => {
      // Equal functions may share one body: an address counts once.
      if (block === undefined || visited.has(block.address)) return;
      visited.add(block.address);
      sum += block.size;
      if (block.kind !== 'function') return;
      const code = this.bytes(block);
      for (const target of [...branches(code, block.address), ...constants(code, block.address)]) {
        visit(this.holder(target));
      }
    };
    visit(this.symbols.find((s) => s.name === name));
    return sum;
  }

  holder(address) {
    const symbol = this.symbols.find((s) => s.address <= address && address < s.address + s.size);
    if (symbol !== undefined) return symbol;
    const loaded = this.segments.some((s) => s.address <= address && address < s.address + s.bytes.length);
    if (!loaded) return undefined;
    return { kind: 'object', address, size: this.edges.find((edge) => edge > address) - address };
  }

  bytes({ address, size }) {
    const segment = this.segments.find((s) => s.address <= address && address + size <= s.address + s.bytes.length);
    return segment.bytes.subarray(address - segment.address, address - segment.address + size);
  }
}

/** Aligned words that are addresses in flash. */
function* constants(bytes, address) {
  for (let at = -address & 3; at + 4 <= bytes.length; at += 4) {
    const word = bytes.readUInt32LE(at);
    if (word >= FLASH && word < END) yield word & ~1;
  }
}

/** Targets of BL, and of B out of the function. */
function* branches(code, address) {
  for (let at = 0; at + 2 <= code.length; at += 2) {
    const first = code.readUInt16LE(at);
    const second = at + 4 <= code.length ? code.readUInt16LE(at + 2) : 0;
    if (first >> 11 === 0b11110 && (second & 0xd000) === 0xd000) {
      const sign = (first >> 10) & 1;
      const i1 = 1 ^ sign ^ ((second >> 13) & 1);
      const i2 = 1 ^ sign ^ ((second >> 11) & 1);
      const high = (sign ? -1 << 24 : 0) | (i1 << 23) | (i2 << 22);
      yield address + at + 4 + (high | ((first & 0x3ff) << 12) | ((second & 0x7ff) << 1));
    } else if (first >> 11 === 0b11100) {
      const target = address + at + 4 + (((first & 0x7ff) << 21) >> 20);
      if (target < address || target >= address + code.length) yield target;
    }
  }
}
