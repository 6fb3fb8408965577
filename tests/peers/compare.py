"""Cophase's phased model level beside MuJoCo on the same platform: error against time, on one core, in one run.

    python tests/peers/compare.py            # all of it: writes docs/peer-mujoco.csv and .svg, prints the tables
    python tests/peers/compare.py --keep target/peers   # keeps reference solutions there for the next time

Both sides play the same second (`machine.json`) and are judged by the same solution (`truth.py`). Runs of the two take
turns, and of each the least CPU time of all rounds counts: the machine may be busy with other things. README.md says what each side solves.
"""

import argparse
import csv
import hashlib
import json
import resource
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from peer import Peer
from truth import Platform

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
MACHINE = HERE / "machine.json"

CASES = [(3, "rigid"), (4, "elastic")]
LEVELS_RAD = [1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6, 2e-6, 1e-6]

# MuJoCo: integrator, and the time constant of rigid rods in steps. Each is the shortest stable one, or a little above.
PEERS = [("Euler", 1.3), ("implicitfast", 1.3), ("discrete", 1e-3), ("RK4", 0.5), ("RK4", 0.6), ("RK4", 0.8), ("RK4", 1.0)]

OURS = ["symplectic Euler", "velocity Verlet", "RK4", "implicit midpoint", "SDIRK4"]
# Steps a tick. Below one, drives are commanded less often by that factor, on both sides.
STEPS = [1 / 4, 1 / 2, 1, 2, 4, 8, 16]


@dataclass
class Run:
    """One method at one step."""

    side: str
    method: str
    steps_per_tick: float
    stiffness_steps: float = 0.0
    seconds: float = np.inf
    error_rad: float = np.nan
    tilt_mrad: float = np.nan
    refused: str = ""
    curve: str = field(init=False)

    def __post_init__(self):
        self.curve = self.method if self.side == "cophase" else f"{self.method} {self.stiffness_steps:g}"


def cophase(machine, axes, run, repeats):
    """CPU time and samples of the phased model level; the tilt is that of the plane closest to the corners' heights. The time is the
    whole process's, its start included."""
    command = [built(), MACHINE, str(axes), run.method, str(run.steps_per_tick), str(repeats)]
    before_s = spent_by_children_s()
    said = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    seconds = (spent_by_children_s() - before_s) / repeats
    if "error" in said:
        run.refused = said["error"]
        return None
    alpha = np.array(said["alpha_rad"]).reshape(-1, axes)
    radius, length = machine["crank_radius_m"], machine["rod_length_m"]
    heights = radius * np.cos(alpha) + np.sqrt(length**2 - (radius * np.sin(alpha)) ** 2)
    around = 2 * np.pi * np.arange(axes) / axes
    share = 2 / axes / machine["mount_radius_m"]
    tilts = share * np.stack([heights @ np.sin(around), -heights @ np.cos(around)], axis=1)
    return seconds, np.concatenate([alpha, heights.mean(axis=1, keepdims=True), tilts], axis=1)


def spent_by_children_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def built():
    """The runner, built once."""
    if not hasattr(built, "path"):
        command = ["cargo", "build", "--release", "--quiet", "--package", "host-sim", "--example", "peer",
                   "--message-format", "json"]
        lines = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.splitlines()
        made = [json.loads(line).get("executable") for line in lines]
        built.path = next(path for path in made if path and Path(path).stem.startswith("peer"))
    return built.path


def judge(run, played, truth, axes):
    if played is None:
        return
    seconds, samples = played
    run.seconds = min(run.seconds, seconds)
    off = np.abs(samples - truth)
    run.error_rad, run.tilt_mrad = off[:, :axes].max(), 1e3 * off[:, axes + 1 :].max()


def reference(machine, axes, rods, keep):
    """The solution, how far a looser one is from it (rad), and how far rods are from their length at its end (m)."""
    name = hashlib.sha256(MACHINE.read_bytes() + (HERE / "truth.py").read_bytes()).hexdigest()[:16]
    kept = keep / f"{name}-{axes}-{rods}.npz" if keep else None
    if kept and kept.exists():
        return tuple(np.load(kept).values())
    platform = Platform(machine, axes, rods)
    truth, drift = platform.solve(1e-11)
    uncertainty = np.abs(platform.solve(1e-9)[0] - truth)[:, :axes].max()
    if kept:
        keep.mkdir(parents=True, exist_ok=True)
        np.savez(kept, truth=truth, uncertainty=uncertainty, drift=drift)
    return truth, uncertainty, drift


def play(machine, axes, rods, truth, rounds):
    runs = [Run("cophase", method, steps) for method in OURS for steps in STEPS]
    # Springs have no constraints to set, so each integrator runs once.
    peers = PEERS if rods == "rigid" else dict(PEERS).items()
    runs += [Run("MuJoCo", name, steps, stiffness if rods == "rigid" else 0.0) for name, stiffness in peers for steps in STEPS]
    peer = Peer(machine, axes, rods, Platform(machine, axes, rods).start())
    for _ in range(rounds):
        for run in runs:
            if run.side == "cophase":
                # Enough repeats to make the start of the process a small part of the time.
                repeats = max(1, int(0.15 / run.seconds)) if np.isfinite(run.seconds) else 5
                judge(run, cophase(machine, axes, run, repeats), truth, axes)
            else:
                judge(run, peer.play(run.method, run.steps_per_tick, run.stiffness_steps), truth, axes)
    return runs


def seconds_at(runs, side, level):
    """Least time in which a side is within an error, over its methods, on straight lines between log error and log
    time; and the method. Infinite if it does not get there.

    A step counts only if all shorter ones of the method are within the error, too: what is better for once is luck."""
    best = (np.inf, "")
    for curve in dict.fromkeys(run.curve for run in runs if run.side == side):
        mine = [run for run in runs if run.side == side and run.curve == curve and np.isfinite(run.error_rad)]
        mine.sort(key=lambda run: run.steps_per_tick)
        within = len(mine)
        while within > 0 and mine[within - 1].error_rad <= level:
            within -= 1
        if within == len(mine):
            continue
        fine = mine[within]
        at = fine.seconds
        if within > 0:
            coarse = mine[within - 1]
            part = np.log(coarse.error_rad / level) / np.log(coarse.error_rad / fine.error_rad)
            at = coarse.seconds * (fine.seconds / coarse.seconds) ** part
        best = min(best, (at, curve))
    return best


def table(runs):
    print("| error, rad | cophase, ms | by | MuJoCo, ms | by | ratio |\n| --- | --- | --- | --- | --- | --- |")
    for level in LEVELS_RAD:
        (ours, our_method), (theirs, their_method) = (seconds_at(runs, side, level) for side in ("cophase", "MuJoCo"))
        cell = lambda seconds, method: f"{1e3 * seconds:.2f} | {method}" if np.isfinite(seconds) else "not reached | "
        ratio = f"{theirs / ours:.1f}" if np.isfinite(ours) and np.isfinite(theirs) else ""
        print(f"| {level:.0e} | {cell(ours, our_method)} | {cell(theirs, their_method)} | {ratio} |")


def write(results):
    with open(ROOT / "docs/peer-mujoco.csv", "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["axes", "rods", "side", "method", "steps_per_tick", "rod_time_constant_steps", "cpu_ms",
                      "angle_error_rad", "tilt_error_mrad"])
        for (axes, rods), runs in results.items():
            for run in runs:
                if np.isfinite(run.error_rad):
                    out.writerow([axes, rods, run.side, run.method, run.steps_per_tick, run.stiffness_steps or "",
                                  f"{1e3 * run.seconds:.3f}", f"{run.error_rad:.3e}", f"{run.tilt_mrad:.3e}"])


def picture(results):
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    matplotlib.rcParams.update({"svg.hashsalt": "cophase", "font.size": 10, "svg.fonttype": "none"})
    figure, panels = plt.subplots(1, len(results), figsize=(11, 4.6), sharey=True)
    # Only one of the time constants of RK4 is drawn, to keep the picture clear.
    marks = dict(zip(["symplectic Euler", "velocity Verlet", "RK4", "implicit midpoint", "SDIRK4", "Euler",
                      "implicitfast", "discrete"], "v^so*v>D"))
    for panel, ((axes, rods), runs) in zip(panels, results.items()):
        for side, colour in (("cophase", "tab:blue"), ("MuJoCo", "tab:red")):
            for curve in dict.fromkeys(run.curve for run in runs if run.side == side):
                mine = [run for run in runs if run.side == side and run.curve == curve and run.error_rad < 0.1]
                if side == "MuJoCo" and curve.startswith("RK4") and not curve.endswith(("0.6", " 0")):
                    continue
                if mine:
                    name = f"{side}, {mine[0].method}"
                    panel.loglog([1e3 * run.seconds for run in mine], [run.error_rad for run in mine],
                                 marks[mine[0].method] + "-", color=colour, label=name, markersize=5, linewidth=1)
        panel.set_title(f"{axes} cranks, rods {'rigid' if rods == 'rigid' else 'elastic'}")
        panel.set_xlabel("CPU time for one simulated second, ms")
        panel.grid(True, which="major", alpha=0.4)
    panels[0].set_ylabel("largest error of a crank angle, rad")
    panels[-1].legend(fontsize=8, loc="center left", bbox_to_anchor=(1.01, 0.5))
    figure.tight_layout()
    figure.savefig(ROOT / "docs/peer-mujoco.svg", metadata={"Date": None})


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--rounds", type=int, default=3)
    arguments.add_argument("--keep", type=Path, help="a folder to keep reference solutions in")
    arguments = arguments.parse_args()
    machine, results = json.loads(MACHINE.read_text()), {}
    for axes, rods in CASES:
        truth, uncertainty, drift = reference(machine, axes, rods, arguments.keep)
        print(f"\n{axes} cranks, rods {rods}. Reference: 1e-9 and 1e-11 differ by {uncertainty:.1e} rad", end="")
        print(f"; rods keep their length to {drift:.1e} m" if rods == "rigid" else "")
        results[axes, rods] = runs = play(machine, axes, rods, truth, arguments.rounds)
        for run in runs:
            if run.refused:
                print(f"cophase, {run.method}, {run.steps_per_tick} a tick: {run.refused}")
        table(runs)
    write(results)
    picture(results)


if __name__ == "__main__":
    main()
