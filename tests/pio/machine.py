"""One state machine of the firmware, executed by rp2040-pio-emulator (`pioemu`).

Pins are renumbered: the machine's IN base is pin 0, because pioemu has no IN base. Three things that pioemu does not
have are added outside of it: optional side-set, IRQ instructions, and a FIFO that a DMA channel fills. A program that
needs anything else that pioemu lacks is refused.

A clock value is a cycle of 8 ns. An output that an instruction of cycle k changes, changes at the end of cycle k. An
input that changes at the end of cycle k is detected by instructions from cycle k + 3 on, through two flip-flops.
"""

import copy
from collections import deque
from dataclasses import replace

import pioemu
import pioemu.emulation
import pioemu.instructions.pull
import pioemu.instructions.push
import pioemu.primitive_operations
from firmware import CLKDIV, EXECCTRL, PINCTRL, SHIFTCTRL

DETECTED_AFTER = 3
FIFO, JOINED_FIFO = 4, 8
NO_DIVIDER = 0x0001_0000

# The three highest bits of an instruction.
JMP, WAIT, MOV, IRQ = 0, 1, 5, 6
Y_DECREMENT = 4


class Unsupported(Exception):
    """The program or its configuration needs what neither pioemu nor this file has."""


def replaced(state, **changes):
    """`dataclasses.replace` for a state, without the checks that take most of pioemu's time."""
    new = object.__new__(type(state))
    new.__dict__.update(state.__dict__, **changes)
    return new


def accelerate(on):
    """Has pioemu use `replaced`, or the function that it was written with."""
    for module in (
        pioemu.emulation,
        pioemu.instructions.pull,
        pioemu.instructions.push,
        pioemu.primitive_operations,
    ):
        module.replace = replaced if on else replace


class Difference(Exception):
    """A program does something else than it is documented to do."""


class StateMachine:
    """A state machine with its program, as the firmware set it up.

    `inputs` gives the levels of all pins at the end of a cycle, by renumbered pin. `words` are pairs: the cycle from
    which on the DMA channel has a word, and the word. `skips` passes over most iterations of a loop that only waits;
    without it pioemu executes every instruction.
    """

    def __init__(self, machine, inputs=None, words=(), skips=True):
        self.machine = machine
        self.inputs = inputs
        self.words = deque(words)
        self.skips = skips
        self.code = [machine.memory.get(slot, 0) for slot in range(32)]
        self.side_count = machine.bits(PINCTRL, 31, 29)
        self.side_optional = machine.bits(EXECCTRL, 30, 30)
        self.state = self.first_state()
        self.options = self.configuration()
        self.depth = JOINED_FIFO if machine.bits(SHIFTCTRL, 30, 30) else FIFO
        self.flag = False  # IRQ flag 0
        self.waits_for_flag = False
        self.side_level = 0
        self.last_slot = None

    def copy(self):
        """Another machine in the same state; the words are not copied."""
        return copy.copy(self)

    def pin(self, number):
        """The renumbered pin of a GPIO."""
        return (number - self.machine.bits(PINCTRL, 19, 15)) % 32

    def configuration(self):
        """The machine's configuration in pioemu's terms."""
        bits = self.machine.bits
        target, top = bits(EXECCTRL, 11, 7), bits(EXECCTRL, 16, 12)
        refused = {
            "a clock divider": self.machine.registers[CLKDIV] != NO_DIVIDER,
            "side-set of pin directions": bits(EXECCTRL, 29, 29),
            "inline OUT enable or sticky output": bits(EXECCTRL, 18, 17),
            "autopush or autopull": bits(SHIFTCTRL, 17, 16),
            "side-set of other than one optional pin": self.side_count != 2 * self.side_optional,
            "a wrap at instruction 0": top == 0,
        }
        for slot in self.slots():
            refused.update({f"{what} in slot {slot}": is_so for what, is_so in self.refused(self.code[slot]).items()})
        for what, is_so in refused.items():
            if is_so:
                raise Unsupported(f"machine {self.machine}: {what}")
        return {
            "shift_osr_right": bool(bits(SHIFTCTRL, 19, 19)),
            "shift_isr_right": bool(bits(SHIFTCTRL, 18, 18)),
            "out_base": self.pin(bits(PINCTRL, 4, 0)),
            "out_count": bits(PINCTRL, 25, 20),
            "set_base": self.pin(bits(PINCTRL, 9, 5)),
            "set_count": bits(PINCTRL, 28, 26),
            "side_set_base": self.pin(bits(PINCTRL, 14, 10)),
            "side_set_count": self.side_count,
            "jmp_pin": self.pin(bits(EXECCTRL, 28, 24)),
            "wrap_target": target,
            "wrap_top": top,
        }

    def slots(self):
        """The slots of the machine's program: those that it can reach from where it starts."""
        bits = self.machine.bits
        found, coming = set(), [self.state.program_counter]
        while coming:
            slot = coming.pop()
            if slot in found:
                continue
            found.add(slot)
            opcode = self.code[slot]
            if opcode >> 13 == JMP:
                coming.append(opcode & 31)
            if opcode & 0xE0E0:  # any instruction but a jump that is always taken
                coming.append(bits(EXECCTRL, 11, 7) if slot == bits(EXECCTRL, 16, 12) else slot + 1)
        return sorted(found)

    def refused(self, opcode):
        """Parts of an instruction that pioemu executes differently from the hardware."""
        operation, low = opcode >> 13, opcode & 0xFF
        one_pin = self.machine.bits(PINCTRL, 25, 20) == 1 and self.pin(self.machine.bits(PINCTRL, 4, 0)) == 0
        return {
            "WAIT for other than an IN pin": operation == WAIT and low >> 5 & 3 != 1,
            "MOV that reverses bits": operation == MOV and low >> 3 & 3 == 2,
            "MOV of STATUS": operation == MOV and low & 7 == 5,
            "IRQ of another kind than 'set flag 0'": operation == IRQ and low & ~0x20 != 0,
            # pioemu writes all pins from 0 on; only pin 0 is checked.
            "MOV to other pins than the first IN pin": operation == MOV and low >> 5 == 0 and not one_pin,
        }

    def first_state(self):
        """The state after the instructions that the processor forced."""
        state = pioemu.State()
        for forced in self.machine.forced:
            mapping = {"set_base": self.pin(forced.pinctrl >> 5 & 31), "set_count": forced.pinctrl >> 26 & 7}
            start = replace(state, program_counter=0)
            _, after = next(pioemu.emulate([forced.instruction], stop_when=never, initial_state=start, **mapping))
            jumps = forced.instruction >> 13 == JMP
            counter = after.program_counter if jumps else state.program_counter
            state = replace(after, clock=0, program_counter=counter)
        return state

    def run(self, until):
        """Executes instructions up to cycle `until`; yields the cycle of each and the state after it."""

        def stops(opcode, state):
            return state.clock >= until or opcode >> 13 == IRQ or self.only_waits(opcode, state)

        def levels(state: pioemu.State) -> int:
            return self.inputs(state.clock - DETECTED_AFTER)

        options = {**self.options, "stop_when": stops, "input_source": levels if self.inputs else None}
        while self.state.clock < until:
            opcode = self.code[self.state.program_counter]
            if opcode >> 13 == IRQ:
                yield self.state.clock, self.interrupt(opcode)
            elif self.only_waits(opcode, self.state):
                skipped = min(self.state.y_register - 2, until - self.state.clock)
                y = self.state.y_register - skipped
                self.state = replace(self.state, y_register=y, clock=self.state.clock + skipped)
            else:
                self.refill()
                for before, after in pioemu.emulate(self.code, initial_state=self.state, **options):
                    self.state = after
                    self.last_slot = before.program_counter
                    self.take_side_set()
                    self.refill()
                    yield before.clock, after

    def only_waits(self, opcode, state):
        """True in the middle of a loop of one `jmp y--` without delay: neither in its first pass nor in its last five."""
        delay = opcode >> 8 & (1 << 5 - self.side_count) - 1
        here = JMP << 13 | Y_DECREMENT << 5 | state.program_counter
        is_loop = opcode & 0xE0FF == here and delay == 0
        return self.skips and is_loop and self.last_slot == state.program_counter and state.y_register > 4

    def take_side_set(self):
        """Takes the optional side-set's level. pioemu writes level and enable bit to two pins at each instruction."""
        if self.side_optional:
            pins = self.state.pin_values >> self.options["side_set_base"]
            if pins & 2:
                self.side_level = pins & 1

    def refill(self):
        """Moves words into the FIFO, as the DMA channel does."""
        fifo = self.state.transmit_fifo
        while self.words and self.words[0][0] <= self.state.clock and len(fifo) < self.depth:
            fifo.append(self.words.popleft()[1])

    def interrupt(self, opcode):
        """Executes a cycle of an IRQ instruction: raises the flag; with `wait`, waits until it is cleared."""
        if not self.waits_for_flag:
            self.flag = True
            self.waits_for_flag = opcode & 0x20 != 0
        else:
            self.waits_for_flag = self.flag
        counter = self.state.program_counter
        if not self.waits_for_flag:
            at_top = counter == self.options["wrap_top"]
            counter = self.options["wrap_target"] if at_top else counter + 1
        self.state = replace(self.state, clock=self.state.clock + 1, program_counter=counter)
        return self.state


def never(*_):
    """Stops at no instruction."""
    return False
