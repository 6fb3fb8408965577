"""Check of the comparison itself: what was changed is found, in the series where it was changed, and nowhere else."""

import copy
import pathlib
import tempfile

import series
from difference import Difference
from rules import Rules

RULES = {
    "columns": {"drift_deg_{i}": "phase_error_deg_{i}"},
    "states": {"align": "homing"},
    "new": {"columns": ["state_code"]},
}
ROWS = 100
CSV = "t_s,state,steps_0,drift_deg_0\n" + "".join(
    f"{k * 0.0005:.4f},{'align' if k < 40 else 'run'},{3 * k},{k * 0.00123:.5f}\n" for k in range(ROWS)
)
VCD = (
    "$timescale 1 ns $end\n$var wire 1 ! step_0 $end\n$var wire 1 \" dir_0 $end\n$enddefinitions $end\n"
    "#500\n$dumpvars\n0!\n1\"\n$end\n" + "".join(f"#{1000 + 250 * k}\n{(k + 1) % 2}!\n" for k in range(60)) + "#20000\n"
)


def run():
    """Runs all checks; 0 if they pass."""
    old = read(CSV, VCD)
    stored = {name: series.digest(one) for name, one in old.items()}

    def names(csv, vcd, status="0", exceptions=(), full=None):
        """Names of the series that differ and are not allowed to."""
        rules = Rules({**RULES, "exception": list(exceptions)})
        found = Difference.find(rules, "scene", stored, read(csv, vcd, status), full)
        return [difference.name for difference in found if not difference.is_allowed]

    present = CSV.replace("drift_deg_0", "phase_error_deg_0").replace("align", "homing")
    present = "\n".join(line + (",state_code" if k == 0 else ",2") for k, line in enumerate(present.splitlines())) + "\n"
    assert names(present, VCD) == [], "renamed and extended, but equal"
    assert names(present, VCD.replace(" ! ", " % ").replace("0!", "0%").replace("1!", "1%")) == [], "another identifier code"

    # One digit, in a row that is not among the samples.
    digit = swap(present, "0.05043,", "0.05044,")
    assert 41 not in series.sample_indices(ROWS)
    assert names(digit, VCD) == ["phase_error_deg_0"]
    assert names(swap(present, "homing,117,", "homing,118,"), VCD) == ["steps_0"]
    assert names(swap(present, "0.0195,homing", "0.0195,run"), VCD) == ["state"]
    assert names(present, swap(VCD, "#1250\n", "#1251\n")) == ["wire step_0"]
    assert names(present, swap(VCD, "1\"", "0\"")) == ["wire levels"], "a level at an unchanged time"
    assert names(present, swap(VCD, "#20000\n", "#20001\n")) == ["wire window"]
    assert names(present, VCD, status="1") == ["exit status"]
    shorter = "\n".join(present.splitlines()[:-1]) + "\n"
    assert set(names(shorter, VCD)) == {"t_s", "state", "steps_0", "phase_error_deg_0"}, "a row less"
    assert names(present.replace("steps_0", "counts_0"), VCD) == ["steps_0", "counts_0"], "gone, and new"

    # Exceptions allow only the stated amount, and only for columns that differ.
    allowed = {"scene": "scene", "column": "phase_error_deg_*", "at_most": 2e-5, "reason": "a test"}
    assert names(digit, VCD, exceptions=[allowed]) == []
    assert names(digit, VCD, exceptions=[allowed], full=old) == []
    assert names(digit, VCD, exceptions=[{**allowed, "scene": "other"}]) == ["phase_error_deg_0"]
    assert names(present, VCD, exceptions=[allowed]) == ["phase_error_deg_*"], "an exception without a difference"
    sampled = swap(present, "0.12177,", "0.1219,")  # the last row is a sample
    assert names(sampled, VCD, exceptions=[allowed]) == ["phase_error_deg_0"]
    larger = swap(present, "0.05043,", "0.05143,")
    assert names(larger, VCD, exceptions=[allowed], full=old) == ["phase_error_deg_0"]
    of_all = {**allowed, "column": "*", "at_most": 1e9}
    assert len(names(shorter, VCD, exceptions=[of_all])) == 4, "a row less is not covered by a bound of values"
    assert names(shorter, VCD, exceptions=[{**of_all, "count_at_most": 1}]) == []
    for key in allowed:
        partial = copy.copy(allowed)
        del partial[key]
        try:
            Rules({"exception": [partial]})
        except ValueError:
            continue
        raise AssertionError(f"an exception without `{key}` was accepted")
    print("self-test passed: every change was found where it was made")
    return 0


def read(csv, vcd, status="0"):
    """Series of files with these contents."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in (("trace.csv", csv), ("steps.vcd", vcd), ("exit-status", status)):
            pathlib.Path(folder, name).write_text(text)
        return series.read(folder)


def swap(text, was, now):
    """Replaces what is there exactly once."""
    assert text.count(was) == 1, f"{was!r} is there {text.count(was)} times"
    return text.replace(was, now)
