"""PIO programs and their configuration, read out of the linked firmware by running its start-up code.

The firmware writes instruction words and configuration registers at start-up. Unicorn, a processor emulator, runs it
from its reset vector until it pends the interrupt of its control loop. This file records what is written to the two
PIO blocks. So the check gets what the hardware gets, relocated words and register values, and no second copy.

Only the processor is emulated. A peripheral register reads as what was last written to it. Code that polls a register
for a status bit gets changing values until it continues. Register layout: RP2040 datasheet, sections 2.1.2, 2.4, 3.7.
"""

import struct
from dataclasses import dataclass, field
from pathlib import Path

import unicorn
from unicorn import arm_const as arm

FLASH = 0x1000_0000
FLASH_BYTES = 2 << 20
RAM = 0x2000_0000
RAM_BYTES = 264 << 10
VECTORS = FLASH + 0x100

ROM_BYTES = 16 << 10
ROM_ANY, ROM_LOOKUP, ROM_COPY = 0x100, 0x104, 0x110

PIO_BLOCKS = (0x5020_0000, 0x5030_0000)
INSTR_MEM = 0x48
MACHINES = 0xC8
MACHINE_BYTES = 0x18
CLKDIV, EXECCTRL, SHIFTCTRL, ADDR, INSTR, PINCTRL = range(0, MACHINE_BYTES, 4)
RESET_VALUES = {CLKDIV: 0x0001_0000, EXECCTRL: 0x0001_F000, SHIFTCTRL: 0x000C_0000, PINCTRL: 0x1400_0000}

TIMER = 0x4005_4000
TIMER_COUNTS = (TIMER + 0x08, TIMER + 0x0C, TIMER + 0x24, TIMER + 0x28)
SIO = 0xD000_0000
SPINLOCKS = range(SIO + 0x100, SIO + 0x180, 4)
NVIC_ISPR = 0xE000_E200

# Flash interface; peripherals; single-cycle IO; the core's own. Start and length.
PERIPHERALS = 0x4000_0000
REGISTERS = ((0x1400_0000, 0x500_0000), (PERIPHERALS, 0x2000_0000), (SIO, 0x1000), (0xE000_0000, 0x10_0000))

MOST_INSTRUCTIONS = 200_000_000
# Reads of one register, with no other access between, after which the code counts as polling it.
PATIENCE = 8


class FirmwareError(Exception):
    """The firmware cannot be read, or did not reach the end of its start-up."""


@dataclass(frozen=True)
class Forced:
    """An instruction that the processor made a machine execute, and the pin mapping at that time."""

    instruction: int
    pinctrl: int


@dataclass
class Machine:
    """Registers and instruction memory that the firmware wrote for one state machine."""

    block: int
    number: int
    registers: dict = field(default_factory=lambda: dict(RESET_VALUES))
    forced: list = field(default_factory=list)
    # The instruction memory of its block, by slot.
    memory: dict = field(default_factory=dict)

    def bits(self, register, high, low):
        """The bits `high` to `low` of a register."""
        return self.registers[register] >> low & (1 << high - low + 1) - 1


def segments(elf):
    """Loadable segments of an ELF file: pairs of load address and bytes."""
    if elf[:6] != b"\x7fELF\x01\x01":
        raise FirmwareError("not a 32-bit little-endian ELF file")
    (table,) = struct.unpack_from("<I", elf, 28)
    size, count = struct.unpack_from("<HH", elf, 42)
    for entry in range(table, table + size * count, size):
        kind, offset, _, address, length = struct.unpack_from("<5I", elf, entry)
        if kind == 1 and length:
            yield address, elf[offset : offset + length]


class Board:
    """A processor, its memory, and registers that remember."""

    def __init__(self, elf):
        self.machines = [[Machine(block, number) for number in range(4)] for block in (0, 1)]
        self.uc = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
        self.uc.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M0)
        self.registers = {}
        self.polled = (None, 0)
        self.now_us = 0
        self.started = False
        self.uc.mem_map(0, ROM_BYTES)
        self.uc.mem_map(FLASH, FLASH_BYTES)
        self.uc.mem_map(RAM, (RAM_BYTES + 0xFFF) & ~0xFFF)
        self.uc.mem_write(0, self.rom())
        self.uc.mem_write(FLASH, b"\xff" * FLASH_BYTES)
        for address, data in segments(elf):
            self.uc.mem_write(address, data)
        for base, size in REGISTERS:
            self.uc.mmio_map(base, size, self.read, base, self.write, base)

    @staticmethod
    def rom():
        """A boot ROM whose functions return at once: flash cannot be written.

        The start-up copies the second boot stage to RAM and calls it after a write: 'C4' copies a return.
        """
        rom = bytearray(ROM_BYTES)
        struct.pack_into("<3H", rom, 0x14, 0x200, 0x200, ROM_LOOKUP | 1)
        # ldr r2, code; cmp r1, r2; ldr r0, any; bne; ldr r0, copy; bx lr
        struct.pack_into("<6H", rom, ROM_LOOKUP, 0x4A05, 0x4291, 0x4805, 0xD100, 0x4805, 0x4770)
        # ldr r3, return; strh r3, [r0]; bx lr
        struct.pack_into("<3H", rom, ROM_COPY, 0x4B05, 0x8003, 0x4770)
        struct.pack_into("<H", rom, ROM_ANY, 0x4770)
        code = int.from_bytes(b"C4", "little")
        struct.pack_into("<4I", rom, ROM_COPY + 12, code, ROM_ANY | 1, ROM_COPY | 1, 0x4770)
        return bytes(rom)

    def read(self, uc, offset, size, base):
        """Gives the processor a register's value."""
        address = base + offset
        if address in TIMER_COUNTS:
            self.now_us += 1
            return 0 if address in TIMER_COUNTS[::2] else self.now_us
        if address in SPINLOCKS:
            return 1
        word = self.registers.get(address & ~3, 0)
        self.polled = (address, self.polled[1] + 1 if self.polled[0] == address else 1)
        tries = self.polled[1] - PATIENCE
        if tries > 0:
            word = (0xFFFF_FFFF, 0, *(1 << bit for bit in range(32)))[tries % 34]
        return word >> 8 * (address & 3) & (1 << 8 * size) - 1

    def write(self, uc, offset, size, value, base):
        """Takes the processor's value for a register."""
        address = base + offset
        self.polled = (None, 0)
        if address == NVIC_ISPR:
            self.started = True
            uc.emu_stop()
        if base == PERIPHERALS:
            # Peripherals have aliases that change bits: 1 is exclusive or, 2 sets, 3 clears.
            alias, address = address >> 12 & 3, address & ~0x3000
            before = self.registers.get(address, 0)
            value = (value, before ^ value, before | value, before & ~value)[alias]
        self.registers[address] = value & 0xFFFF_FFFF
        for block, start in enumerate(PIO_BLOCKS):
            if start <= address < start + 0x144:
                self.write_pio(block, address - start, self.registers[address])

    def write_pio(self, block, offset, value):
        """Records a write to a PIO block."""
        machines = self.machines[block]
        if INSTR_MEM <= offset < MACHINES:
            for machine in machines:
                machine.memory[(offset - INSTR_MEM) // 4] = value & 0xFFFF
        elif MACHINES <= offset < MACHINES + 4 * MACHINE_BYTES:
            number, register = divmod(offset - MACHINES, MACHINE_BYTES)
            machine = machines[number]
            if register == INSTR:
                machine.forced.append(Forced(value & 0xFFFF, machine.registers[PINCTRL]))
            else:
                machine.registers[register] = value


def read_firmware(path):
    """The machines that the firmware at `path` (an ELF file) sets up, in the order of blocks and numbers.

    Raises FirmwareError if the start-up does not reach the control loop.
    """
    board = Board(Path(path).read_bytes())
    stack, reset = struct.unpack("<II", board.uc.mem_read(VECTORS, 8))
    board.uc.reg_write(arm.UC_ARM_REG_SP, stack)
    try:
        board.uc.emu_start(reset | 1, 0xFFFF_FFFE, count=MOST_INSTRUCTIONS)
    except unicorn.UcError as error:
        at = board.uc.reg_read(arm.UC_ARM_REG_PC)
        raise FirmwareError(f"the start-up failed at {at:#x}: {error}") from error
    if not board.started:
        at = board.uc.reg_read(arm.UC_ARM_REG_PC)
        raise FirmwareError(f"the start-up did not reach the control loop; it was at {at:#x}")
    return [machine for machines in board.machines for machine in machines if machine.forced]
