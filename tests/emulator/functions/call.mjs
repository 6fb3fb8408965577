// Calls single functions of an ELF in the RP2040 emulator, and counts the cycles of each.
//
// rp2040js counts as Arm's table for the Cortex-M0+ does, with the RP2040's multiplier of one cycle, with two
// exceptions: PUSH with LR and POP with PC are each a cycle short, since it leaves LR and PC out of the number of
// registers. Both are added here. Not modelled: waiting for flash (a miss of the 16 KiB cache in front of it costs
// dozens of cycles) and contention on the bus.
import { readFileSync } from 'node:fs';
import { RP2040 } from 'rp2040js';

const FLASH = 0x10000000;
const STACK = 0x20040000;
const RETURN = 0x20041000; // nothing lies there: a function that reaches it has returned

/** Symbols and loadable bytes of a little-endian ELF of 32 bits. */
export function readElf(path) {
  const file = readFileSync(path);
  const word = (at) => file.readUInt32LE(at);
  const half = (at) => file.readUInt16LE(at);
  const segments = [];
  for (let i = 0; i < half(44); i++) {
    const at = word(28) + i * half(42);
    const [type, offset, address, , size] = [0, 4, 8, 12, 16].map((o) => word(at + o));
    if (type === 1 && size > 0) segments.push({ address, bytes: file.subarray(offset, offset + size) });
  }
  const section = (i) => {
    const at = word(32) + i * half(46);
    return { type: word(at + 4), offset: word(at + 16), size: word(at + 20), link: word(at + 24) };
  };
  const symbols = [];
  for (let i = 0; i < half(48); i++) {
    const table = section(i);
    if (table.type !== 2) continue;
    const names = section(table.link).offset;
    for (let at = table.offset; at < table.offset + table.size; at += 16) {
      const start = names + word(at);
      const name = file.toString('latin1', start, file.indexOf(0, start));
      const kind = ['', 'object', 'function'][file[at + 12] & 15] ?? '';
      if (kind !== '') symbols.push({ name, kind, address: word(at + 4) & ~1, size: word(at + 8) });
    }
  }
  return { segments, symbols };
}

/** A core with an ELF in its flash. */
export class Board {
  constructor(elf) {
    this.chip = new RP2040();
    for (const { address, bytes } of elf.segments) {
      if (address < FLASH || address >= 0x20000000) throw new Error('data in RAM would need start-up code');
      this.chip.flash.set(bytes, address - FLASH);
    }
    this.addresses = new Map(elf.symbols.filter((s) => s.kind === 'function').map((s) => [s.name, s.address]));
    this.panicked = this.address('panicked');
    this.emptyCycles = 0;
    this.emptyCycles = this.call('empty', [], 100).cycles;
  }

  address(name) {
    const address = this.addresses.get(name);
    if (address === undefined) throw new Error(`no function ${name} in the ELF`);
    return address;
  }

  /** r0 and r1 after the call and its cycles, net of an empty function's; or `failure`: 'hangs' or 'panics'. */
  call(name, words, limit) {
    const { core, flash16 } = this.chip;
    core.registers.fill(0, 0, 13);
    words.forEach((word, i) => (core.registers[i] = word));
    core.SP = STACK;
    core.LR = RETURN | 1;
    core.PC = this.address(name);
    core.cycles = 0;
    let uncounted = 0;
    while (core.PC !== RETURN) {
      if (core.cycles > limit) return { failure: 'hangs' };
      if (core.PC === this.panicked) return { failure: 'panics' };
      const top = flash16[(core.PC - FLASH) >> 1] >> 8;
      if (top === 0xb5 || top === 0xbd) uncounted += 1; // PUSH with LR, POP with PC
      core.executeInstruction();
    }
    return {
      r0: core.registers[0],
      r1: core.registers[1],
      cycles: core.cycles + uncounted - this.emptyCycles,
    };
  }
}
