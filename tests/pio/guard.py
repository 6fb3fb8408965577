"""The guard program: how long a loss of the enable input may last, and when the drives are off.

A loss of ENABLE of up to 8 µs is noise and changes nothing. If it lasts 10 µs or more, DRIVE ENABLE is low within
10 µs of its beginning. Both must hold at every phase of the program's loops. DRIVE ENABLE stays low until the control
loop has cleared the flag and ENABLE has returned.
"""

from machine import Difference, StateMachine

CYCLES_PER_US = 125
NOISE = 8 * CYCLES_PER_US
LOSS = 10 * CYCLES_PER_US
# Two glitches with less than this between them are one: the input is read once in 36 cycles.
APART = 36
# Phases: longer than any path through the program that does not wait.
PHASES = 80
# Time at which the simulated control loop clears the flag.
CLEARED_AFTER = 60
# Time after the last change of the input: longer than all of its effects.
SETTLED = 200
# docs/wiring.md
DRIVE_ENABLE, ENABLE = 21, 26


class Bench:
    """A guard that lets the drives be on: the state from which each case begins."""

    def __init__(self, machine):
        self.intervals = []
        self.player = StateMachine(machine, self.inputs)
        self.drive = 1 << self.player.pin(DRIVE_ENABLE)
        self.enable = 1 << self.player.pin(ENABLE)
        if not self.player.state.pin_directions & self.drive:
            raise Difference("DRIVE ENABLE is no output")
        changes = self.changes(self.player, 400, clears=True)
        if [level for _, level in changes] != [1]:
            raise Difference(f"with enable from power-up, DRIVE ENABLE changes (cycle, level): {changes}")

    def inputs(self, cycle):
        """Levels of the pins: ENABLE is high in the intervals."""
        lost = any(begin <= cycle < end for begin, end in self.intervals)
        return self.enable if lost else 0

    def changes(self, player, until, clears):
        """Changes of DRIVE ENABLE, while the control loop clears the flag or does not."""
        level = player.state.pin_values & self.drive != 0
        raised, changes = None, []
        for cycle, state in player.run(until):
            now = state.pin_values & self.drive != 0
            if now != level:
                level = now
                changes.append((cycle, int(now)))
            raised = (cycle if raised is None else raised) if player.flag else None
            if clears and raised is not None and cycle - raised >= CLEARED_AFTER:
                player.flag = False
        return changes

    def case(self, intervals, until, clears=True):
        """Changes of DRIVE ENABLE when ENABLE is lost from the end of one cycle to the end of another, in each interval."""
        player = self.player.copy()
        player.inputs = self.inputs
        now = player.state.clock + 10
        self.intervals = [(now + begin, now + end) for begin, end in intervals]
        return [(cycle - now, level) for cycle, level in self.changes(player, now + until, clears)]


def check(machine, quick=False):
    """Plays glitches and losses at every phase, or `quick` at every seventh; gives a sentence with what was compared."""
    bench = Bench(machine)
    phases = range(1, PHASES, 7 if quick else 1)
    for length in (1, 17, 18, 19, 35, 36, 37, 500, NOISE - 1, NOISE):
        no_effect(bench, [(0, length)])
    cuts = [cut(bench, [(0, LOSS)], 0, 0)]
    early = []
    for first in (1, 19, 37):
        for low in phases:
            begin = first + low
            apart = low >= APART
            noise = NOISE if apart else NOISE - begin
            no_effect(bench, [(0, first), (begin, begin + noise)])
            after = cut(bench, [(0, first), (begin, begin + LOSS)], begin, begin if apart else 0)
            (cuts if apart else early).append(after)
    for low in phases:
        if low >= APART:
            no_effect(bench, [(0, NOISE), (NOISE + low, 2 * NOISE + low)])
        cut_again(bench, low)
    edges = 2 * len(cuts + early) + len(phases) + stays_cut(bench)
    text = f"{edges} edges of DRIVE ENABLE compared, worst cut {max(cuts + early)} cycles after a loss (at most {LOSS})"
    return f"{text}, earliest {min(cuts)}; {NOISE} cycles change nothing"


def no_effect(bench, intervals):
    """Raises a Difference if DRIVE ENABLE changes."""
    changes = bench.case(intervals, intervals[-1][1] + SETTLED)
    if changes:
        raise Difference(f"ENABLE lost in cycles {intervals}: DRIVE ENABLE changes (cycle, level): {changes}")


def cut(bench, intervals, begin, earliest):
    """Cycles from the beginning of a loss to the cut. The line must rise only after the loss."""
    changes = bench.case(intervals, intervals[-1][1] + SETTLED)
    if [level for _, level in changes] != [0, 1]:
        raise Difference(f"ENABLE lost in cycles {intervals}: DRIVE ENABLE changes (cycle, level): {changes}")
    (fell, _), (rose, _) = changes
    if not earliest <= fell <= begin + LOSS:
        raise Difference(f"ENABLE lost in cycles {intervals}: DRIVE ENABLE fell in cycle {fell}")
    if rose < intervals[-1][1]:
        raise Difference(f"ENABLE lost in cycles {intervals}: DRIVE ENABLE rose in cycle {rose}")
    return fell - begin


def cut_again(bench, low):
    """Raises a Difference if DRIVE ENABLE is high 10 µs after the beginning of a loss that follows another."""
    begin = LOSS + low
    changes = bench.case([(0, LOSS), (begin, begin + LOSS)], begin + LOSS + SETTLED)
    levels = [level for cycle, level in changes if cycle <= begin + LOSS]
    if changes[0][0] > LOSS or levels[-1] != 0 or len(changes) != len(levels) + 1:
        raise Difference(
            f"two losses, ENABLE present for {low} cycles between: DRIVE ENABLE changes (cycle, level): {changes}"
        )


def stays_cut(bench):
    """A cut lasts until the flag is cleared, and as long as the input is lost. Gives the edges compared."""
    changes = bench.case([(0, LOSS)], 2 * LOSS, clears=False)
    if [level for _, level in changes] != [0]:
        raise Difference(f"the flag not cleared: DRIVE ENABLE changes (cycle, level): {changes}")
    changes = bench.case([(0, 3 * LOSS)], 3 * LOSS + SETTLED)
    if [level for _, level in changes] != [0, 1] or changes[1][0] < 3 * LOSS:
        raise Difference(f"the flag cleared during a loss: DRIVE ENABLE changes (cycle, level): {changes}")
    return 3
