"""The index program: time stamps of level changes on six lines are compared with the true times.

A word is the levels above a count of 26 bits. The n-th look at the lines has the count -n. A look takes 7 cycles, and
14 after a change; it samples 4 cycles after its beginning. So a stamp says in which 7 (or 14) cycles a line changed.
"""

import random
from dataclasses import replace

from machine import SEEN_AFTER, Difference, StateMachine
from pioemu.shift_register import ShiftRegister

LINES = 6
COUNT_BITS = 26
COUNT = (1 << COUNT_BITS) - 1
LOOK = 7
SAMPLED_AFTER = 4
# pioemu's FIFO; the hardware's is joined and has 8. The DMA channel empties it at once.
FIFO = 4


def check(machine, quick=False):
    """Feeds changes to the machine; gives a sentence with what was compared. `quick` is less of it."""
    numbers = random.Random(8)
    far = list(at_random(numbers, 60 if quick else 320, lambda: numbers.randrange(30, 400)))
    near = list(at_random(numbers, 100, lambda: numbers.choice((1, 2, 5, 7, 8, 13, 14, 15, 20, 40))))
    wrap = list(at_random(numbers, 30, lambda: numbers.randrange(30, 200)))
    every_phase = [(100 + 113 * turn, turn + 1) for turn in range(2 * LOOK)]
    compared, worst = 0, {LOOK: 0, 2 * LOOK: 0}
    for name, given, looks_before in (
        ("changes far apart", far, 0),
        ("changes at every phase of a look", every_phase, 0),
        ("changes near each other", near, 0),
        ("changes while the count wraps", wrap, COUNT - 300),
    ):
        reports = run(machine, given, given[-1][0] + 100, looks_before)
        compared += compare(name, given, reports, looks_before, worst)
    compared += check_full_fifo(machine)
    text = f"{compared} stamps compared, worst difference {worst[LOOK]} cycles from the middle of {LOOK}"
    return f"{text}, and just after a change {worst[2 * LOOK]} from the middle of {2 * LOOK}"


def at_random(numbers, count, gap):
    """Changes at random: cycle, and the levels of all lines from its end on."""
    cycle, levels = 20, 0
    for _ in range(count):
        cycle += gap()
        levels ^= numbers.randrange(1, 1 << LINES)
        yield cycle, levels


def run(machine, given, end, looks_before=0, emptied=lambda cycle: True):
    """What the machine reports: count of the look, and levels. It has made `looks_before` looks."""
    at = iter(given)
    now, coming = 0, next(at)

    def inputs(cycle):
        nonlocal now, coming
        while coming and coming[0] <= cycle:
            now, coming = coming[1], next(at, None)
        # What is on other pins is not the machine's.
        return now | 0xA5A5_A500

    player = StateMachine(machine, inputs)
    if looks_before:
        count = ShiftRegister(-looks_before & 0xFFFF_FFFF, 0)
        player.state = replace(player.state, output_shift_register=count)
    reports = []
    for cycle, state in player.run(end):
        if emptied(cycle):
            while state.receive_fifo:
                value = state.receive_fifo.popleft()
                reports.append((-value & COUNT, value >> COUNT_BITS))
    return reports


def sampled(look, looks_before=0):
    """The cycle in which the look samples the lines."""
    return LOOK * ((look - looks_before - 1) & COUNT) + SAMPLED_AFTER


def compare(name, given, reports, looks_before, worst):
    """Compares reports with what was given: gives how many, and updates the worst differences by window."""
    cycles = [cycle for cycle, _ in given]
    last, levels, compared = None, 0, 0
    reported = set()
    for look, seen in reports:
        sample = sampled(look, looks_before)
        # The look before is 7 cycles earlier; if it reported a change, 14.
        window = 2 * LOOK if last is not None and sample - last == 2 * LOOK else LOOK
        # A change at the end of cycle k is seen from k + 3 on.
        newest = sample - SEEN_AFTER
        true = max(((cycle, level) for cycle, level in given if cycle <= newest), default=(0, 0))[1]
        if seen != true or seen == levels:
            raise Difference(f"{name}, look {look}: levels {seen:06b} after {levels:06b}; they were {true:06b}")
        inside = [number for number, cycle in enumerate(cycles) if newest - window < cycle <= newest]
        if not inside:
            raise Difference(f"{name}, look {look}: no line changed in the {window} cycles before {newest}")
        reported.update(inside)
        middle = newest - window // 2
        worst[window] = max(worst[window], *(abs(cycles[number] - middle) for number in inside))
        last, levels, compared = sample, seen, compared + 1
    for number, (cycle, _) in enumerate(given):
        alone = all(
            abs(cycle - other) > 2 * LOOK for other in cycles[max(0, number - 1) : number + 2] if other != cycle
        )
        if alone and number not in reported:
            raise Difference(f"{name}: the change in cycle {cycle} was not reported")
    return compared


def check_full_fifo(machine):
    """A full FIFO loses changes, and not the clock: those after it have true stamps. Gives the stamps compared."""
    given = [(100 * turn, turn % 2) for turn in range(1, 13)]
    full_until = 850
    reports = run(machine, given, 1400, emptied=lambda cycle: cycle >= full_until)
    expected = given[:FIFO] + [change for change in given if change[0] > full_until]
    if len(reports) != len(expected):
        raise Difference(f"a full FIFO: {len(reports)} reports instead of {len(expected)}")
    for (look, seen), (cycle, levels) in zip(reports, expected):
        newest = sampled(look) - SEEN_AFTER
        if seen != levels or not newest - LOOK < cycle <= newest:
            raise Difference(
                f"a full FIFO: levels {seen:06b} up to cycle {newest}; they were {levels:06b} from {cycle} on"
            )
    return len(expected)
