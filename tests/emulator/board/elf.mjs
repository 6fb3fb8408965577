// Minimal reader of 32-bit little-endian ELF files: the loaded segments, and the symbols.

const PT_LOAD = 1;
const SHT_SYMTAB = 2;

const text = (bytes, at) => {
  let end = at;
  while (bytes[end] !== 0) end += 1;
  return new TextDecoder().decode(bytes.subarray(at, end));
};

/**
 * Reads an ELF file.
 * Gives `entry`; `segments`: [{ physical, virtual, bytes, memorySize }] with a size; `symbols`: Map from name to
 * { name, address, size, type } (type: 1 object, 2 function; the lowest address bit of functions is cleared);
 * `functions`: those of type function with a size, by address. Throws when the file is not such an ELF.
 */
export function readElf(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const u16 = (at) => view.getUint16(at, true);
  const u32 = (at) => view.getUint32(at, true);
  if (bytes.length < 52 || view.getUint32(0) !== 0x7f454c46 || bytes[4] !== 1 || bytes[5] !== 1) {
    throw new Error('not a 32-bit little-endian ELF file');
  }

  const segments = [];
  for (let i = 0; i < u16(44); i += 1) {
    const at = u32(28) + i * u16(42);
    const [offset, virtual, physical, size, memorySize] = [4, 8, 12, 16, 20].map((d) => u32(at + d));
    if (u32(at) === PT_LOAD && size > 0) {
      segments.push({ physical, virtual, memorySize, bytes: bytes.subarray(offset, offset + size) });
    }
  }

  const sections = [];
  for (let i = 0; i < u16(48); i += 1) {
    const at = u32(32) + i * u16(46);
    sections.push({ type: u32(at + 4), offset: u32(at + 16), size: u32(at + 20), link: u32(at + 24) });
  }
  const symbols = new Map();
  for (const table of sections.filter((s) => s.type === SHT_SYMTAB)) {
    const names = sections[table.link].offset;
    for (let at = table.offset; at < table.offset + table.size; at += 16) {
      const name = text(bytes, names + u32(at));
      const type = bytes[at + 12] & 0xf;
      const address = type === 2 ? (u32(at + 4) & ~1) >>> 0 : u32(at + 4);
      if (name !== '' && !name.startsWith('$')) symbols.set(name, { name, address, size: u32(at + 8), type });
    }
  }
  const functions = [...symbols.values()].filter((s) => s.type === 2 && s.size > 0);
  functions.sort((a, b) => a.address - b.address);
  return { entry: u32(24), segments, symbols, functions };
}

export const FLASH_BASE = 0x1000_0000;
export const FLASH_SIZE = 2 * 1024 * 1024;

/** Loads the firmware's segments into a flash array, like a programmer. The rest keeps its content. */
export function loadInto(flash, elf) {
  for (const { physical, bytes } of elf.segments) {
    const offset = physical - FLASH_BASE;
    if (offset >= 0 && offset + bytes.length <= flash.length) flash.set(bytes, offset);
  }
}
