"""Step words, by their documentation: firmware/motion/src/pulse/run.rs. Nothing of the firmware is used here.

Bits 0 to 12 are the number of edges; 0 is a pause. Bits 13 to 30 are cycles - 8: between edges, or of the pause. Bit 31
is DIR, which only a pause takes up, 8 cycles after it begins.
"""

LEAST = 8
MOST = LEAST + (1 << 18) - 1
MOST_EDGES = (1 << 13) - 1
DIR_DELAY = 8

STEP, DIR = "STEP", "DIR"


def word(edges, cycles, forward):
    """The word of `edges` edges, `cycles` apart, or without edges of a pause."""
    assert 0 <= edges <= MOST_EDGES and LEAST <= cycles <= MOST, (edges, cycles)
    return edges | cycles - LEAST << 13 | forward << 31


def play(timed, begins, step=0, forward=0):
    """Changes of the lines while words are played: (cycle, line, level) of each, and the cycle at the end.

    `timed` are pairs of the cycle from which on a word is available, and the word. A word that the machine waits for
    begins `begins` cycles after it is available.
    """
    changes, at = [], timed[0][0] + begins
    for there, value in timed:
        edges, cycles, direction = value & MOST_EDGES, (value >> 13 & 0x3FFFF) + LEAST, value >> 31
        at = max(at, there + begins)
        if edges == 0 and direction != forward:
            forward = direction
            changes.append((at + DIR_DELAY, DIR, forward))
        for _ in range(edges):
            at += cycles
            step ^= 1
            changes.append((at, STEP, step))
        at += cycles if edges == 0 else 0
    return changes, at


class Encoder:
    """Makes words of given changes of the lines, in order."""

    def __init__(self, at, forward):
        self.at = at
        self.forward = forward
        self.runs = []

    def words(self):
        """The words."""
        return [word(*run) for run in self.runs]

    def pause_until(self, cycle):
        """Appends pauses up to a cycle."""
        while cycle > self.at:
            left = cycle - self.at
            cycles = left if left <= MOST else min(MOST, left - LEAST)
            self.runs.append((0, cycles, self.forward))
            self.at += cycles

    def edge(self, cycle):
        """Appends an edge of STEP, to the run before it if that has the same period."""
        while cycle - self.at > MOST:
            self.pause_until(self.at + MOST - LEAST)
        period = cycle - self.at
        edges, before, _ = self.runs[-1] if self.runs else (0, 0, 0)
        if 0 < edges < MOST_EDGES and before == period:
            self.runs[-1] = (edges + 1, period, self.forward)
        else:
            self.runs.append((1, period, self.forward))
        self.at = cycle

    def turn(self, cycle, forward):
        """Appends a change of DIR."""
        self.pause_until(cycle - DIR_DELAY)
        self.forward = forward
        self.pause_until(cycle)
