"""Series of one run of a scene, and digests of them.

A *series* is a list of texts with a name: a column of trace.csv (name as in the header), the times at which a wire of steps.vcd
changes (`wire step_0`, ns), the levels of all wires at first, the window of that file, or the exit status.

A *digest* of a series is its length, a SHA-256 of all its values, and a few samples. Equal digests mean equal series. The
samples bound how far an intended difference goes, where the full series of the other side is not at hand.
"""

import hashlib
import pathlib

SAMPLES = 16


def digest(values):
    """The stored form of a series: [length, SHA-256, samples]."""
    hashed = hashlib.sha256("\n".join(values).encode()).hexdigest()
    return [len(values), hashed, [values[i] for i in sample_indices(len(values))]]


def sample_indices(count):
    """Positions of the samples: evenly spaced, first and last included."""
    if count <= SAMPLES:
        return list(range(count))
    return [(count - 1) * k // (SAMPLES - 1) for k in range(SAMPLES)]


def read(folder):
    """All series of a folder that `cophase run` wrote, by name."""
    folder = pathlib.Path(folder)
    series = columns(folder / "trace.csv")
    series.update(wires(folder / "steps.vcd"))
    series["exit status"] = [(folder / "exit-status").read_text().strip()]
    return series


def columns(path):
    """Columns of a trace. No field of it is quoted. The digests are of numbers without `.0`."""
    with open(path, encoding="utf-8", newline="") as file:
        names = file.readline().rstrip("\r\n").split(",")
        rows = [line.rstrip("\r\n").split(",") for line in file]
    for number, row in enumerate(rows):
        if len(row) != len(names):
            raise ValueError(f"{path}: row {number} has {len(row)} fields, the header {len(names)}")
    if len(set(names)) != len(names):
        raise ValueError(f"{path}: two columns have the same name")
    by_column = zip(*rows) if rows else ([] for _ in names)
    return {name: [value.removesuffix(".0") for value in values] for name, values in zip(names, by_column)}


def wires(path):
    """Times at which each wire changes, whatever its identifier code; the levels at first; and the window: first and last
    time in the file."""
    names, times, first, last = {}, {}, {}, {}
    window = []
    with open(path, encoding="ascii") as file:
        for line in file:
            if line.startswith("$var"):
                _, _, _, code, name, _ = line.split()
                names[code] = name
                times[code] = []
            elif line.startswith("$enddefinitions"):
                break
        for line in file:
            kind = line[0]
            if kind == "#":
                window = [window[0] if window else line[1:].rstrip(), line[1:].rstrip()]
            elif kind in "01":
                code = line[1:].rstrip()
                if last.get(code) == kind:
                    raise ValueError(f"{path}: {names[code]} changes to the level that it has, at {window[1]} ns")
                last[code] = kind
                first.setdefault(code, kind)
                times[code].append(window[1])
            elif kind != "$":
                raise ValueError(f"{path}: {line.rstrip()} is not understood")
    found = {f"wire {name}": times[code] for code, name in names.items()}
    found["wire levels"] = [f"{name} {first.get(code)}" for code, name in names.items()]
    found["wire window"] = window
    return found
