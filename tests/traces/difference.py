"""Differences between a present run and a stored one, and whether rules.toml allows them."""

import math

from series import digest, sample_indices


class Difference:
    """One series that is not what it was, or one exception that is not needed."""

    def __init__(self, name, text, exception=None, largest=math.inf, count=math.inf):
        self.name = name
        self.text = text
        self.exception = exception
        self.is_allowed = (
            exception is not None
            and largest <= exception["at_most"]
            and count <= exception.get("count_at_most", 0)
        )

    def __str__(self):
        if self.exception is None:
            return f"{self.name}: {self.text}"
        verdict = "allowed" if self.is_allowed else f"beyond the exception's {self.exception['at_most']:g}"
        return f"{self.name}: {self.text}; {verdict}: {self.exception['reason']}"

    @classmethod
    def find(cls, rules, scene, stored, present, full=None):
        """All differences of a scene: `stored` digests by old name, `present` series by new name, and the `full` old series
        by old name where they are at hand."""
        old, names = rules.as_of_old(present)
        found, used = [], []
        for name in stored:
            if name not in old:
                found.append(cls(name, "is no longer there"))
                continue
            if digest(old[name])[:2] == stored[name][:2]:
                continue
            exception = rules.exception(scene, names[name])
            used.append(exception)
            difference = differing(names[name], exception, stored[name], old[name], full and full[name], old["t_s"])
            found.append(difference)
        found += [cls(names[name], "is new, and not in the list of new columns") for name in old if name not in stored]
        for exception in rules.exceptions:
            if exception["scene"] == scene and exception not in used:
                found.append(cls(exception["column"], f"has an exception but does not differ: {exception['reason']}"))
        return found


def differing(name, exception, stored, present, full, times):
    """A series that differs: where first, and by how much at most; at the samples if the full series is not at hand."""
    length, _, samples = stored
    if full:
        pairs = [(i, was, present[i]) for i, was in enumerate(full[: len(present)])]
        scope = "all values"
    else:
        pairs = [(i, was, present[i]) for i, was in zip(sample_indices(length), samples) if i < len(present)]
        scope = f"{len(pairs)} samples"
    count = abs(len(present) - length)
    parts = [f"{len(present)} values, were {length}"] if count else []
    first = next(((i, was, now) for i, was, now in pairs if was != now), None)
    largest = max((distance(was, now) for _, was, now in pairs), default=0.0)
    if first:
        row, was, now = first
        when = f" at {times[row]} s" if len(present) == len(times) else ""
        parts.append(f"value {row}{when} is {now}, was {was}; largest difference {largest:g} in {scope}")
    elif not count:
        parts.append(f"differs, but not at the {scope}; --against DIR shows where")
    return Difference(name, "; ".join(parts), exception, largest, count)


def distance(was, now):
    """Difference of two values: infinite between texts that are not the same number."""
    if was == now:
        return 0.0
    try:
        gap = abs(float(was) - float(now))
    except ValueError:
        return math.inf
    return math.inf if math.isnan(gap) else gap
