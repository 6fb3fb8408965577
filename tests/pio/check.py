"""Checks the PIO programs of the firmware on rp2040-pio-emulator. See README.md beside this."""

import argparse
import copy
import sys

import guard
import index
import steps
from firmware import EXECCTRL, PINCTRL, FirmwareError, read_firmware
from machine import Difference, StateMachine, Unsupported, accelerate

# docs/wiring.md
STEP_PINS = (0, 2, 4, 6, 8, 23)
DIR_PINS = (1, 3, 5, 7, 9, 24)
INDEX_PINS = 10

DELAY_BITS = 5


def by_program(machines):
    """Sorts machines by the pins that they have: step machines by axis, the index machine, the guard."""
    axes, others = {}, {}
    for machine in machines:
        pins = machine.bits(PINCTRL, 4, 0), machine.bits(PINCTRL, 14, 10)
        if machine.bits(PINCTRL, 25, 20) and pins in zip(STEP_PINS, DIR_PINS):
            axes[STEP_PINS.index(pins[0])] = machine
        elif machine.bits(EXECCTRL, 28, 24) == guard.ENABLE:
            others["guard"] = machine
        elif machine.bits(PINCTRL, 19, 15) == INDEX_PINS:
            others["index"] = machine
        else:
            raise FirmwareError(
                f"machine {machine.block}.{machine.number} has pins that docs/wiring.md does not have"
            )
    if sorted(axes) != list(range(len(axes))) or len(axes) < 2 or len(others) != 2:
        raise FirmwareError(f"the firmware sets up step machines for the axes {sorted(axes)}, and {sorted(others)}")
    return {axis: axes[axis] for axis in sorted(axes)}, others["index"], others["guard"]


def check_all(axes, index_machine, guard_machine, files):
    """Runs all checks, prints a line for each; gives whether all passed."""
    passed = True
    for name, check in (
        ("steps", lambda: steps.check(axes, *files)),
        ("index", lambda: index.check(index_machine)),
        ("guard", lambda: guard.check(guard_machine)),
    ):
        try:
            print(f"{name}: {check()}", flush=True)
        except Difference as difference:
            print(f"{name}: DIFFERENT: {difference}", flush=True)
            passed = False
    return passed


def check_mutants(axes, index_machine, guard_machine, files):
    """Changes delays of instructions, one at a time; gives whether each change was found.

    The guard has tolerances: only the delays of its loop are changed, by enough to exceed them.
    """
    passed = True
    for name, machine, check, delays in (
        ("steps", axes[0], lambda mutant: steps.check({0: mutant}, *files, quick=True), None),
        ("index", index_machine, lambda mutant: index.check(mutant, quick=True), None),
        ("guard", guard_machine, lambda mutant: guard.check(mutant, quick=True), (10, 31)),
    ):
        player = StateMachine(machine)
        bits = DELAY_BITS - player.side_count
        found = []
        for slot in player.slots():
            opcode = player.code[slot]
            delay = opcode >> 8 & (1 << bits) - 1
            if delays and not delay:
                continue
            for other in delays or (delay + 1,):
                mutant = copy.copy(machine)
                mutant.memory = {**machine.memory, slot: opcode & ~(((1 << bits) - 1) << 8) | other << 8}
                found.append(is_found(check, mutant, f"{name}: delay {delay} of slot {slot} changed to {other}"))
        print(f"{name}: {sum(found)} of {len(found)} changed delays found", flush=True)
        passed = passed and found and all(found)
    return passed


def is_found(check, mutant, what):
    """True if a check fails, as it must."""
    try:
        check(mutant)
    except Difference:
        return True
    print(f"{what}: NOT FOUND", flush=True)
    return False


def main():
    """Runs the command; gives its exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("firmware", help="the firmware's ELF file")
    parser.add_argument("scene", help="the scene whose edges are compared")
    parser.add_argument("vcd", help="steps.vcd of that scene, from `cophase run --window all`")
    parser.add_argument(
        "--self-test", action="store_true", help="change delays of instructions; each change must be found"
    )
    arguments = parser.parse_args()
    accelerate(True)
    files = (arguments.scene, arguments.vcd)
    try:
        programs = by_program(read_firmware(arguments.firmware))
        checks = check_mutants if arguments.self_test else check_all
        return 0 if checks(*programs, files) else 1
    except (FirmwareError, Unsupported, OSError) as error:
        print(f"tests/pio: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
