// One RP2040 after a reset: rp2040js's object with every correction of this folder in it.
//
// A reset builds a new one. The board passes on the state that survives (RAM, flash, watchdog scratch, the pins that the
// bench drives). So the rest of the old state cannot remain.

import { BasePeripheral, RP2040 } from 'rp2040js';
import { BenchCore } from './core.mjs';
import { fixDivider } from './divider.mjs';
import { fixDma } from './dma.mjs';
import { Fault } from './core-memory.mjs';
import { Pads } from './pads.mjs';
import { Block } from './pio-block.mjs';
import { Pl011 } from './pl011.mjs';
import { fixPpb } from './ppb.mjs';
import { fixTimer } from './timer.mjs';
import { UsbDevice } from './usb-device.mjs';

/** The firmware's vector table, where the second-stage boot block hands over. */
export const VECTOR_TABLE = 0x1000_0100;

/** Registers that only store the written value. */
class Registers extends BasePeripheral {
  constructor(rp2040, name, initial) {
    super(rp2040, name);
    this.values = new Map(Object.entries(initial).map(([offset, value]) => [Number(offset), value]));
  }

  readUint32(offset) {
    return this.values.get(offset) ?? 0;
  }

  writeUint32(offset, value) {
    this.values.set(offset, value);
  }
}

/** Messages of rp2040js in cases where the bus answers with an error, or the core with a fault. */
const UNMAPPED = /invalid memory address|undefined address|is not implemented yet/;
const XIP_STAT = 0x08;
/** Streaming FIFO empty, flush done. */
const XIP_READY = 0b011;
const ROSC_STATUS = 0x18;
const ROSC_RANDOMBIT = 0x1c;
const CHIP_RESET_HAD_POR = 1 << 8;

/** The boot ROM starts the processor: stack pointer and entry from the firmware's vector table. */
export function startCore(core) {
  core.VTOR = VECTOR_TABLE;
  const [stack, entry] = [core.readUint32(VECTOR_TABLE), core.readUint32(VECTOR_TABLE + 4)];
  core.SP = stack;
  core.PC = (entry & ~1) >>> 0;
  core.minSP = stack;
  core.initialSP = stack;
}

/**
 * Builds the chip. `board`: the object that the corrected parts call back; `kept`: { clock, sram, flash, rom, outside,
 * levels, scratch, reason }. The processor is not started.
 */
export function buildChip(board, { clock, sram, flash, rom, outside, levels, scratch, reason }) {
  const chip = new RP2040(clock);
  chip.logger = {
    debug() {},
    info() {},
    warn: (name, text) => {
      if (UNMAPPED.test(text)) throw new Fault(text);
      board.warn(name, text);
    },
    error: (name, text) => board.warn(name, text),
  };
  chip.sram = sram;
  chip.sramView = new DataView(sram.buffer, sram.byteOffset, sram.length);
  chip.flash = flash;
  chip.flash16 = new Uint16Array(flash.buffer, flash.byteOffset, flash.length >> 1);
  chip.flashView = new DataView(flash.buffer, flash.byteOffset, flash.length);
  chip.bootrom.set(rom);
  chip.core = new BenchCore(chip, board);
  chip.onBreak = () => {
    throw new Fault('breakpoint');
  };

  const { peripherals } = chip;
  peripherals[0x14000] = new Registers(chip, 'XIP_CTRL', { [XIP_STAT]: XIP_READY });
  fixSsi(chip);
  peripherals[0x40018] = new Registers(chip, 'IO_QSPI', {});
  peripherals[0x40060] = new Registers(chip, 'ROSC', { [ROSC_STATUS]: 0x8000_1000, [ROSC_RANDOMBIT]: 1 });
  peripherals[0x40064] = new Registers(chip, 'VREG_AND_CHIP_RESET', { 0: 0xb1, 4: 0x91, 8: CHIP_RESET_HAD_POR });
  chip.pio = [0, 1].map((index) => {
    const block = new Block(chip, index, board);
    peripherals[index === 0 ? 0x50200 : 0x50300] = block;
    return block;
  });
  chip.uart = [0, 1].map((index) => {
    const uart = new Pl011(chip, index, board.serial[index]);
    peripherals[index === 0 ? 0x40034 : 0x40038] = uart;
    return uart;
  });
  chip.usbCtrl = new UsbDevice(chip, board.usb);
  peripherals[0x50110] = chip.usbCtrl;
  fixDma(chip);
  fixPpb(chip, () => board.requestReset('system'));
  fixTimer(chip);
  fixDivider(chip);

  const watchdog = peripherals[0x40058];
  watchdog.scratchData = scratch;
  watchdog.reason = reason;
  watchdog.onWatchdogTrigger = () => board.requestReset('watchdog');
  chip.watchdog = watchdog;
  chip.psm = peripherals[0x40010];

  chip.pads = new Pads(chip, outside, levels, {
    stampNow: () => board.stamp,
    onConfigure: () => chip.pio.forEach((block) => block.settle(board.stamp + 1)),
    onChange: (stamp, changed, now) => board.pinsChanged(stamp, changed, now),
    onContention: (pins) => board.note('contention', `pins ${pinList(pins)} are driven from both sides`),
  });
  return chip;
}

function pinList(mask) {
  return [...Array(30).keys()].filter((pin) => (mask >>> pin) & 1).join(', ');
}

/** Unique number of the flash chip. */
export const FLASH_ID = [0xe6, 0x61, 0x41, 0x04, 0x03, 0x2b, 0x59, 0x2a];

/**
 * What rp2040js leaves out: the second-stage boot block, copied to RAM, brings XIP back: it enables the SSI in a mode that reads memory. And the flash chip
 * has a unique number.
 */
function fixSsi(chip) {
  const SSIENR = 0x08;
  const DR0 = 0x60;
  const TMOD_EEPROM_READ = 3;
  const READ_UNIQUE_ID = 0x4b;
  const DUMMY_BYTES = 4;
  let answer = [];
  const ssi = chip.peripherals[0x18000];
  const stock = ssi.writeUint32.bind(ssi);
  const stockRead = ssi.readUint32.bind(ssi);
  ssi.readUint32 = (offset) => (offset === DR0 && answer.length > 0 ? answer.shift() : stockRead(offset));
  ssi.writeUint32 = (offset, value) => {
    stock(offset, value);
    if (offset === DR0 && (value & 0xff) === READ_UNIQUE_ID) answer = [...new Array(DUMMY_BYTES).fill(0), ...FLASH_ID];
    if (offset === SSIENR && value & 1 && ((ssi.crtlr0 >>> 8) & 3) === TMOD_EEPROM_READ) chip.core.xipOff = false;
  };
}
