"""The step program: every change of STEP and DIR is compared with its documented cycle.

The expectation has two sources. For a scene it is the edges that `cophase run` predicts (steps.vcd); words are made of
them by `step_words.Encoder`. For words at random and at the limits it is `step_words.play`. Both were written from the
documentation of a word.
"""

import random
import tomllib

from machine import Difference, StateMachine, accelerate
from step_words import DIR, DIR_DELAY, LEAST, MOST, MOST_EDGES, STEP, Encoder, play, word
from vcd import read_vcd

CLOCK_HZ = 125_000_000
DEFAULT_TICK_HZ = 2000

# A word's time begins where the one before ends: STEP changes 2 cycles before the next word is pulled. A machine that
# waits pulls a word in the cycle in which it becomes available.
BEGINS = -2

# Edges may be off by this number of cycles.
TOLERANCE = 0


def check(machines, scene, vcd, quick=False):
    """Plays words on the first machine, and the scene on those of all axes; gives a sentence with what was compared.

    `quick` leaves out the scene.
    """
    found = [check_words(machines[0], timed) for timed in at_the_limits()]
    if not quick:
        found.append(check_without_shortcuts(machines[0]))
        with open(scene, "rb") as file:
            settings = tomllib.load(file)
        tick = CLOCK_HZ // settings.get("control", {}).get("tick_hz", DEFAULT_TICK_HZ)
        predicted = read_vcd(vcd)
        for axis, machine in machines.items():
            timed, expected = of_axis(predicted, tick, axis % settings["axes"]["count"])
            if play(timed, BEGINS)[0] != expected:
                raise Difference(f"axis {axis}: the words that were made of the scene do not mean its edges")
            found.append(check_words(machine, timed, f"axis {axis}: "))
    compared, worst = sum(count for count, _ in found), max(off for _, off in found)
    return f"{compared} edges of STEP and DIR compared on {len(machines)} machines, worst difference {worst} cycles"


def check_words(machine, timed, what="", skips=True):
    """Compares what the machine makes of words with what they mean; gives how many changes, and the worst difference."""
    expected, end = play(timed, BEGINS)
    found = changes(machine, timed, end, skips)
    worst = 0
    for number, (cycle, *change) in enumerate(expected):
        other, *to = next(found, (end, "nothing"))
        worst = max(worst, abs(other - cycle))
        if to != change or worst > TOLERANCE:
            raise Difference(f"{what}change {number}: {to} in cycle {other} instead of {change} in cycle {cycle}")
    for cycle, *change in found:
        raise Difference(f"{what}{change} in cycle {cycle}, after all that was to change")
    return len(expected), worst


def of_axis(predicted, tick, axis):
    """The words of an axis in a scene, tick by tick, and the changes that are predicted for it."""
    first, wires = predicted
    lines = [(cycle, STEP, level) for cycle, level in wires[f"step_{axis}"]]
    lines += [(cycle, DIR, level) for cycle, level in wires[f"dir_{axis}"]]
    lines.sort()
    # The last tick before the motion is a pause, which gives DIR its first level.
    start = (lines[0][0] // tick - 1) * tick
    forward = first[f"dir_{axis}"]
    encoder = Encoder(start, forward)
    for cycle, line, level in lines:
        while cycle > encoder.at - encoder.at % tick + tick:
            encoder.pause_until(encoder.at - encoder.at % tick + tick)
        if line == STEP:
            encoder.edge(cycle)
        else:
            encoder.turn(cycle, level)
    encoder.pause_until(encoder.at - encoder.at % tick + tick)
    begins = BEGINS - start
    expected = [(BEGINS + DIR_DELAY, DIR, 1)] if forward else []
    expected += [(begins + cycle, line, level) for cycle, line, level in lines]
    return [(0, value) for value in encoder.words()], expected


def at_the_limits():
    """Words at random, of the least and of the greatest fields, and words that come late."""
    numbers = random.Random(20130412)
    yield [(0, word(*run)) for run in at_random(numbers, 400, 300)]
    yield [(0, word(*run)) for run in ((0, LEAST, 1), (0, LEAST, 0), (1, LEAST, 0), (0, MOST, 1), (0, LEAST, 0))]
    yield [(0, word(*run)) for run in ((1, MOST, 0), (2, MOST - 1, 1), (0, MOST, 0), (0, MOST - 1, 1), (3, LEAST, 0))]
    yield [(0, word(*run)) for run in ((MOST_EDGES, LEAST, 0), (0, LEAST, 1), (5, LEAST + 1, 1), (1, LEAST, 1))]
    late, there = [], 0
    for run in at_random(numbers, 100, 300):
        there += numbers.choice((0, 0, 100, 2000, 9000))
        late.append((there, word(*run)))
    yield late


def at_random(numbers, count, longest):
    """Runs and pauses at random: edges, cycles, DIR."""
    for _ in range(count):
        edges = numbers.choice((0, 0, 1, 1, 2, 3, numbers.randrange(1, 24)))
        cycles = numbers.choice((LEAST, LEAST + 1, LEAST + 2, numbers.randrange(LEAST, longest)))
        yield edges, cycles, numbers.randrange(2)


def check_without_shortcuts(machine):
    """Plays words with every instruction executed by pioemu as it is; gives what `check_words` does."""
    accelerate(False)
    found = check_words(machine, [(0, word(*run)) for run in at_random(random.Random(1), 120, 90)], skips=False)
    accelerate(True)
    return found


def changes(machine, timed, end, skips):
    """Changes of the machine's lines up to the end of its words, and a while longer."""
    player = StateMachine(machine, words=timed, skips=skips)
    step, forward = player.state.pin_values & 1, player.side_level
    for cycle, state in player.run(end + 40):
        if player.side_level != forward:
            forward = player.side_level
            yield cycle, DIR, forward
        if state.pin_values & 1 != step:
            step ^= 1
            yield cycle, STEP, step
