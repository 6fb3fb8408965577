"""Two scenes solved from the documentation alone, and `cophase run` compared with the solution.

    python3 tests/peers/from_docs.py                # both scenes, with target/release/cophase
    python3 tests/peers/from_docs.py --self-test    # a constant of the model is off by 1 %: that must be noticed

`documented.py` has the equations of docs/model.md and solves them for the commands in `trace.csv`. This file compares cranks, platform,
report and program. Exit status: 0 all within their limits, 1 not, with a sentence for each.
"""

import argparse
import copy
import json
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import numpy as np

from documented import DRIVES_ON, STANDARD_GRAVITY, Machine, Trace, outputs, solve

HERE = Path(__file__).resolve().parent
SCENES = ["servos", "steppers"]
RUNNING = ("run", "stop")
ANGLE_LIMIT_DEG = 1e-4
VALUE_LIMIT = 1e-4  # of values in the report, relative
HOLD_LIMIT = 1e-6  # of the speed of a hold, relative
REQUESTED_LIMIT_MPS2 = 1e-4  # of amax requested: a unit of its last place


class Table:
    """Deviations beside their limits."""

    def __init__(self, name):
        self.name, self.exceeded = name, []
        print(f"\n{name:34}{'solved':>14}{'cophase':>14}{'deviation':>11}{'limit':>9}")

    def line(self, what, deviation, limit, solved="", reported=""):
        number = "{:.8g}".format
        solved, reported = (x if isinstance(x, str) else number(x) for x in (solved, reported))
        print(f"{what:34}{solved:>14}{reported:>14}{deviation:>11.1e}{limit:>9.1e}")
        if not deviation <= limit:
            self.exceeded.append(f"{self.name}: {what} deviates by {deviation:.2e}, the limit is {limit:.1e}")

    def value(self, what, solved, reported):
        solved, reported = float(solved), float(reported)
        deviation = abs(solved - reported) / abs(reported) if reported else abs(solved)
        self.line(what, deviation, VALUE_LIMIT, solved, reported)


def compare(machine, scene, trace, report, name):
    """Compares everything. Returns sentences about what exceeds its limit."""
    inside, ends = [], []
    for row, (command, t_s, states) in enumerate(solve(machine, trace, name)):
        found = outputs(machine, command, t_s, states)
        ends.append({key: values[-1] for key, values in found.items()})
        if trace.state[row] in RUNNING:
            inside.append({key: np.abs(values[:-1]).max() for key, values in found.items()})
    end = {key: np.array([tick[key] for tick in ends]) for key in ends[0]}
    table = Table(name)
    for axis in range(machine.n):
        table.line(f"actual_turns_{axis} (°)", np.abs(end["actual_deg"] - trace.actual_deg)[:, axis].max(), ANGLE_LIMIT_DEG)
    height = machine.radius * (1 + machine.ratio) * np.radians(ANGLE_LIMIT_DEG)  # of a corner, by the limit of its crank
    tilt, accel = 2e3 * height / machine.mount, np.abs(trace.platform["accel_mps2"]).max()
    limits = {"tilt_x_mrad": tilt, "tilt_y_mrad": tilt, "warp_deg": 2 * ANGLE_LIMIT_DEG, "z_m": height, "accel_mps2": VALUE_LIMIT * accel}
    for column, limit in limits.items():
        table.line(column, np.abs(end[column] - trace.platform[column]).max(), limit)

    on, run = np.isin(trace.state, DRIVES_ON), trace.state == "run"
    table.value("phase_spread_worst_deg", end["spread_deg"][on].max(), report["phase_spread_worst_deg"])
    table.value("phase_spread_rms_deg", np.sqrt(np.mean(end["spread_deg"][run] ** 2)), report["phase_spread_rms_deg"])
    table.value("tilt_worst_mrad", end["tilt_mrad"][on].max(), report["tilt_worst_mrad"])
    table.value("warp_worst_deg", end["warp_deg"][on].max(), report["warp_worst_deg"])
    table.value("accel_worst_mps2", np.abs(end["accel_mps2"][run]).max(), report["accel_worst_mps2"])
    for axis, entry in enumerate(report["axes"]):
        table.value(f"axes[{axis}].torque_worst_nm", end["torque_nm"][:, axis].max(), entry["torque_worst_nm"])
    answers = {"amax_percent": "accel_mps2", "torque_percent": "torque_nm"}
    for output in report["fidelity"]["outputs"]:
        key = output["output"]
        if key == "slips":
            off = np.degrees(machine.start) + 360 * trace.turns - end["actual_deg"]
            slipped = np.any(np.round(off * machine.cycles / 360) != 0, axis=0)
            table.value("fidelity slips", slipped.sum(), output["value"])
        else:
            table.value(f"fidelity {key}", max(tick[answers.get(key, key)] for tick in inside), output["value"])
    check_command(table, machine, scene, trace)
    return table.exceeded


def requested(program, t_s):
    """amax that a program without blocks requests at a time since its start."""
    level = 0.0
    for entry in program:
        ramp_s, hold_s, target = entry.get("ramp_s", 0), entry.get("hold_s", 0), entry["amax_g"] * STANDARD_GRAVITY
        if t_s < ramp_s:
            x = t_s / ramp_s
            return level + (target - level) * (x if entry.get("shape") == "linear" else x**3 * (10 - 15 * x + 6 * x * x))
        if t_s < ramp_s + hold_s:
            return target
        level, t_s = target, t_s - ramp_s - hold_s
    return level


def check_command(table, machine, scene, trace):
    """Compares the command with the program: amax requested, speed at the end of each hold, the parking phase."""
    program, run = scene["program"], np.flatnonzero(trace.state == "run")
    amax = [requested(program, (row - run[0] + 1) * machine.tick_s) for row in run]
    table.line("amax_requested_mps2", np.abs(amax - trace.requested[run]).max(), REQUESTED_LIMIT_MPS2)
    end_s = 0.0
    for entry in program:
        end_s += entry.get("ramp_s", 0) + entry.get("hold_s", 0)
        if "hold_s" in entry:
            omega = np.sqrt(entry["amax_g"] * STANDARD_GRAVITY / (machine.radius * (1 + machine.ratio)))
            held = trace.omega[run[0] + round(end_s / machine.tick_s) - 2]
            table.line(f"omega_rad_s, hold of {entry['amax_g']} g", abs(omega / held - 1), HOLD_LIMIT, omega, held)
    parked = scene["control"].get("park_deg", 180) / 360
    table.line("phase when parked (turns)", np.abs(trace.turns[-1] % 1 - parked).max(), 1e-9, parked, trace.turns[-1, 0] % 1)


def simulate(cophase, path, folder):
    try:
        done = subprocess.run([cophase, "run", path, "--out", folder, "--every", "1", "--quiet"])
    except OSError as error:
        sys.exit(f"{cophase}: {error.strerror}; `cargo sim run` builds the default, --cophase names another")
    if done.returncode != 0:
        sys.exit(f"{path}: cophase run ended with status {done.returncode}")
    report = json.loads((folder / "report.json").read_text())
    level = report["fidelity"]["model_level"]
    if level != "phased":
        sys.exit(f"{path}: fidelity \"auto\" chose {level}; only the phased level is solved here")
    return report


def perturbed(scene):
    """Scenes with one constant 1 % off, by what it is."""
    for what, table, key in [
        ("friction of axis 1", ["axis", 0], "friction_nm"),
        ("load", ["machine"], "load_kg"),
        ("inertia of the rotors", ["axes"], "rotor_inertia_kgm2"),
    ]:
        other = copy.deepcopy(scene)
        place = other
        for name in table:
            place = place[name]
        place[key] *= 1.01
        yield what, other


def self_test(scene, trace, name):
    """Returns sentences about perturbations that no crank's angle shows."""
    unnoticed = []
    for what, other in perturbed(scene):
        machine = Machine(other)
        for row, (command, t_s, states) in enumerate(solve(machine, trace, f"{name}, {what} 1 % off")):
            deviation = np.abs(outputs(machine, command, t_s, states)["actual_deg"][-1] - trace.actual_deg[row]).max()
            if deviation > ANGLE_LIMIT_DEG:
                print(f"{name}: {what} 1 % off is noticed at {trace.t_s[row]:.3f} s, by {deviation:.1e}°")
                break
        else:
            unnoticed.append(f"{name}: {what} 1 % off stays within {ANGLE_LIMIT_DEG}°")
    return unnoticed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=SCENES, metavar="SCENE", help=f"of {', '.join(SCENES)} [default: all]")
    parser.add_argument("--cophase", default=HERE.parents[1] / "target/release/cophase", help="the program [default: %(default)s]")
    parser.add_argument("--self-test", action="store_true", help="solve with constants 1 %% off; fail where that goes unnoticed")
    arguments = parser.parse_args()
    wrong = []
    for name in arguments.scenes:
        path = HERE / f"{name}.toml"
        if not path.exists():
            parser.error(f"no scene {name}; there are {', '.join(SCENES)}")
        scene = tomllib.loads(path.read_text())
        with tempfile.TemporaryDirectory() as folder:
            report = simulate(arguments.cophase, path, Path(folder))
            machine = Machine(scene)
            trace = Trace(Path(folder) / "trace.csv", machine)
        wrong += self_test(scene, trace, name) if arguments.self_test else compare(machine, scene, trace, report, name)
    for sentence in wrong:
        print(f"error: {sentence}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
