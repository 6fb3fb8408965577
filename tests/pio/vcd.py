"""Reads the edges that `cophase run` predicts: steps.vcd, one-bit wires, nanoseconds."""

CYCLE_NS = 8


def read_vcd(path):
    """First levels by wire, and all changes by wire: pairs of cycle and level."""
    names, first, changes, now = {}, {}, {}, 0
    with open(path, encoding="utf-8") as lines:
        for line in lines:
            if line.startswith("$var wire 1 "):
                _, _, _, key, name, _ = line.split()
                names[key] = name
                changes[name] = []
            elif line[0] == "#":
                now, rest = divmod(int(line[1:]), CYCLE_NS)
                if rest:
                    raise ValueError(f"{path}: {line.strip()} ns is no whole cycle")
            elif line[0] in "01":
                name, level = names[line[1:].strip()], int(line[0])
                if name not in first:
                    first[name] = level
                elif (changes[name][-1][1] if changes[name] else first[name]) != level:
                    changes[name].append((now, level))
    return first, changes
