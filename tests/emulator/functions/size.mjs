// Flash that a function takes: its own code, all that it calls, and the tables that these point to.

const FLASH = 0x10000000;

/** Bytes of the symbols that can be reached from `name` by calls, jumps, and addresses among its constants. */
export function reachableBytes(elf, name) {
  const bytesAt = (address, size) => {
    const segment = elf.segments.find((s) => s.address <= address && address + size <= s.address + s.bytes.length);
    return segment?.bytes.subarray(address - segment.address, address - segment.address + size);
  };
  const holder = (address) => elf.symbols.find((s) => s.address <= address && address < s.address + s.size);
  const seen = new Set();
  const visit = (symbol) => {
    // Equal functions may share one body: count an address once.
    if (symbol === undefined || seen.has(symbol.address)) return;
    seen.add(symbol.address);
    sum += symbol.size;
    if (symbol.kind !== 'function') return;
    const code = bytesAt(symbol.address, symbol.size);
    for (const target of targets(code, symbol.address)) visit(holder(target));
  };
  let sum = 0;
  // A panic's message is no part of what a function needs.
  seen.add(elf.symbols.find((s) => s.name.includes('panic_fmt'))?.address);
  visit(elf.symbols.find((s) => s.name === name));
  return sum;
}

/** Where code points: BL, B out of the function, and words in flash's range. */
function* targets(code, address) {
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
      const jump = ((first & 0x7ff) << 21) >> 20;
      const target = address + at + 4 + jump;
      if (target < address || target >= address + code.length) yield target;
    }
    if ((address + at) % 4 === 0 && at + 4 <= code.length) {
      const constant = code.readUInt32LE(at);
      if (constant >= FLASH && constant < FLASH + 0x200000) yield constant;
    }
  }
}
