"""The index program: time stamps of level changes on six lines are compared with the true times.

A word is the levels above a count of 26 bits. The n-th poll of the lines has the count -n. A poll takes 7 cycles, and
14 after a change; it samples 4 cycles after its beginning. So a stamp says in which 7 (or 14) cycles a line changed.
"""

import random
from dataclasses import replace

from machine import DETECTED_AFTER, Difference, StateMachine
from pioemu.shift_register import ShiftRegister

LINES = 6
COUNT_BITS = 26
COUNT = (1 << COUNT_BITS) - 1
POLL = 7
SAMPLED_AFTER = 4
# pioemu's FIFO; the hardware's is joined and has 8. The DMA channel empties it at once.
FIFO = 4


def check(machine, quick=False):
    """Feeds changes to the machine; gives a sentence with what was compared. `quick` is less of it."""
    numbers = random.Random(8)
    far = list(at_random(numbers, 60 if quick else 320, lambda: numbers.randrange(30, 400)))
    near = list(at_random(numbers, 100, lambda: numbers.choice((1, 2, 5, 7, 8, 13, 14, 15, 20, 40))))
    wrap = list(at_random(numbers, 30, lambda: numbers.randrange(30, 200)))
    every_phase = [(100 + 113 * turn, turn + 1) for turn in range(2 * POLL)]
    compared, worst = 0, {POLL: 0, 2 * POLL: 0}
    for name, given, polls_before in (
        ("changes far apart", far, 0),
        ("changes at every phase of a poll", every_phase, 0),
        ("changes near each other", near, 0),
        ("changes while the count wraps", wrap, COUNT - 300),
    ):
        reports = run(machine, given, given[-1][0] + 100, polls_before)
        compared += compare(name, given, reports, polls_before, worst)
    compared += check_full_fifo(machine)
    text = f"{compared} stamps compared, worst difference {worst[POLL]} cycles from the middle of {POLL}"
    return f"{text}, and just after a change {worst[2 * POLL]} from the middle of {2 * POLL}"


def at_random(numbers, count, gap):
    """Changes at random: cycle, and the levels of all lines from its end on."""
    cycle, levels = 20, 0
    for _ in range(count):
        cycle += gap()
        levels ^= numbers.randrange(1, 1 << LINES)
        yield cycle, levels


def run(machine, given, end, polls_before=0, emptied=lambda cycle: True):
    """Report of the machine: count of the poll, and levels. It has made `polls_before` polls before."""
    at = iter(given)
    now, coming = 0, next(at)

    def inputs(cycle):
        nonlocal now, coming
        while coming and coming[0] <= cycle:
            now, coming = coming[1], next(at, None)
        # The machine must ignore the levels of other pins.
        return now | 0xA5A5_A500

    player = StateMachine(machine, inputs)
    if polls_before:
        count = ShiftRegister(-polls_before & 0xFFFF_FFFF, 0)
        player.state = replace(player.state, output_shift_register=count)
    reports = []
    for cycle, state in player.run(end):
        if emptied(cycle):
            while state.receive_fifo:
                value = state.receive_fifo.popleft()
                reports.append((-value & COUNT, value >> COUNT_BITS))
    return reports


def sampled(poll, polls_before=0):
    """The cycle in which the poll samples the lines."""
    return POLL * ((poll - polls_before - 1) & COUNT) + SAMPLED_AFTER


def compare(name, given, reports, polls_before, worst):
    """Compares reports with what was given: gives how many, and updates the worst differences by window."""
    cycles = [cycle for cycle, _ in given]
    last, levels, compared = None, 0, 0
    reported = set()
    for poll, now in reports:
        sample = sampled(poll, polls_before)
        # The poll before is 7 cycles earlier; if it reported a change, 14.
        window = 2 * POLL if last is not None and sample - last == 2 * POLL else POLL
        # A change at the end of cycle k is visible from k + 3 on.
        newest = sample - DETECTED_AFTER
        true = max(((cycle, level) for cycle, level in given if cycle <= newest), default=(0, 0))[1]
        if now != true or now == levels:
            raise Difference(f"{name}, poll {poll}: levels {now:06b} after {levels:06b}; they were {true:06b}")
        inside = [number for number, cycle in enumerate(cycles) if newest - window < cycle <= newest]
        if not inside:
            raise Difference(f"{name}, poll {poll}: no line changed in the {window} cycles before {newest}")
        reported.update(inside)
        middle = newest - window // 2
        worst[window] = max(worst[window], *(abs(cycles[number] - middle) for number in inside))
        last, levels, compared = sample, now, compared + 1
    for number, (cycle, _) in enumerate(given):
        alone = all(
            abs(cycle - other) > 2 * POLL for other in cycles[max(0, number - 1) : number + 2] if other != cycle
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
    for (poll, now), (cycle, levels) in zip(reports, expected):
        newest = sampled(poll) - DETECTED_AFTER
        if now != levels or not newest - POLL < cycle <= newest:
            raise Difference(
                f"a full FIFO: levels {now:06b} up to cycle {newest}; they were {levels:06b} from {cycle} on"
            )
    return len(expected)
