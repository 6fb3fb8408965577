"""The platform as MuJoCo has it, given its best chance, and the manoeuvre played on it.

- Cranks are bodies that turn about their own centre of mass, with the rotor's inertia: nothing added.
- Rods are spatial tendons from pin to corner, which have no mass: rigid ones a constraint on the tendon's length (one row a
  rod, where two `connect`s would take five), springs the tendon's own stiffness and damping.
- The platform is one body with a slide and two hinges: the same freedoms and no more.
- Motors and the loop over steps are C (`stepper.c`), so that no Python runs while the clock does.
"""

import ctypes
import os
import subprocess
import tempfile
from pathlib import Path

import mujoco
import numpy as np

from truth import ticks

MOST = 6
HERE = Path(__file__).parent


class Machine(ctypes.Structure):
    _fields_ = [
        *((name, ctypes.c_double) for name in (
            "cycles_per_turn", "damping_nms", "friction_speed_rad_s", "speed_rad_s", "ramp_s", "tick_s")),
        *((name, ctypes.c_double * MOST) for name in ("torque_nm", "friction_nm", "offset_rad")),
        *((name, ctypes.c_int) for name in ("axes", "ticks", "ticks_per_sample")),
    ]


def compiled():
    """stepper.c as a library, linked to the very libmujoco that Python has loaded."""
    package = Path(mujoco.__file__).parent
    library = next(package.glob("libmujoco.so*"))
    out = Path(tempfile.mkdtemp()) / "stepper.so"
    subprocess.run(
        [os.environ.get("CC", "cc"), "-O3", "-march=native", "-shared", "-fPIC", f"-I{package / 'include'}",
         str(HERE / "stepper.c"), str(library), f"-Wl,-rpath,{package}", "-lm", "-o", str(out)],
        check=True,
    )
    stepper = ctypes.CDLL(str(out))
    stepper.play.restype = ctypes.c_double
    stepper.play.argtypes = [
        ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p,
    ]
    return stepper


def mjcf(machine, axes, rods, integrator, step_s, stiffness_s):
    """`stiffness_s` is the time constant of the constraints that rigid rods are."""
    radius, length, mount = (machine[key] for key in ("crank_radius_m", "rod_length_m", "mount_radius_m"))
    rotor, tilt = machine["rotor_inertia_kgm2"], machine["tilt_inertia_kgm2"]
    cranks, corners, tendons, constraints = "", "", "", ""
    for i in range(axes):
        around = 2 * np.pi * i / axes
        cos, sin = np.cos(around), np.sin(around)
        place = f"{mount * cos:.17g} {mount * sin:.17g}"
        cranks += f"""
    <body name="crank{i}" pos="{place} 0">
      <joint type="hinge" axis="{-sin:.17g} {cos:.17g} 0" damping="{machine['damping_nms']}"/>
      <inertial pos="0 0 0" mass="1" diaginertia="{rotor} {rotor} {rotor}"/>
      <site name="pin{i}" pos="0 0 {radius}"/>
    </body>"""
        corners += f'<site name="corner{i}" pos="{place} 0"/>'
        spring = ""
        if rods == "elastic":
            spring = f'springlength="{length}" stiffness="{machine["rod_n_per_m"]}" damping="{machine["rod_ns_per_m"]}"'
        tendons += f'<spatial name="rod{i}" {spring}><site site="pin{i}"/><site site="corner{i}"/></spatial>'
        # Impedance as near to 1 as MuJoCo allows, over the whole range.
        if rods == "rigid":
            constraints += (
                f'<tendon tendon1="rod{i}" solref="{stiffness_s} 1" solimp="0.9999 0.9999 0.001 0.5 2"/>'
            )
    return f"""<mujoco>
  <compiler angle="radian"/>
  <option timestep="{step_s!r}" gravity="0 0 {-machine['gravity_mps2']}" integrator="{integrator}"
          solver="Newton" tolerance="1e-12" iterations="{100 if integrator == 'discrete' else 2}" jacobian="dense">
    <flag contact="disable" frictionloss="disable" limit="disable" clampctrl="disable" refsafe="disable"
          sensor="disable" midphase="disable" island="disable" autoreset="disable"
          {'' if rods == 'rigid' or integrator == 'discrete' else 'constraint="disable"'}/>
  </option>
  <worldbody>{cranks}
    <body name="platform" pos="0 0 {radius + length!r}">
      <joint type="slide" axis="0 0 1"/><joint type="hinge" axis="1 0 0"/><joint type="hinge" axis="0 1 0"/>
      <inertial pos="0 0 0" mass="{machine['load_kg']}" diaginertia="{tilt} {tilt} {2 * tilt}"/>
      {corners}
    </body>
  </worldbody>
  <tendon>{tendons}</tendon>
  {f'<equality>{constraints}</equality>' if constraints else ''}
</mujoco>"""


class Peer:
    def __init__(self, machine, axes, rods, start):
        self.machine, self.axes, self.rods, self.start = machine, axes, rods, start
        self.stepper = compiled()
        self.numbers = Machine(
            speed_rad_s=2 * np.pi * machine["speed_hz"], axes=axes,
            **{key: machine[key] for key in ("cycles_per_turn", "damping_nms", "friction_speed_rad_s", "ramp_s")},
        )
        for i in range(axes):
            self.numbers.torque_nm[i] = machine["torque_nm"][i]
            self.numbers.friction_nm[i] = machine["friction_nm"][i]
            self.numbers.offset_rad[i] = np.radians(machine["offset_deg"][i])

    def play(self, integrator, steps_per_tick, stiffness_steps, repeats=1):
        """Least CPU time of the repeats, s, and coordinates at every sample; none if it went off its command.

        Below one step a tick (1/2, 1/4), drives are commanded as much less often. `stiffness_steps` is the constraints' time
        constant in steps."""
        step_s = self.machine["tick_s"] / steps_per_tick
        ticks_a_step = max(1, round(1 / steps_per_tick))
        numbers = self.numbers
        numbers.tick_s = self.machine["tick_s"] * ticks_a_step
        numbers.ticks = ticks(self.machine) // ticks_a_step
        numbers.ticks_per_sample = self.machine["ticks_per_sample"] // ticks_a_step
        text = mjcf(self.machine, self.axes, self.rods, integrator, step_s, stiffness_steps * step_s)
        model = mujoco.MjModel.from_xml_string(text)
        samples = np.empty((ticks(self.machine) // self.machine["ticks_per_sample"], model.nq))
        best_s = np.inf
        for _ in range(repeats):
            data = mujoco.MjData(model)
            data.qpos[:] = self.start[: model.nq]
            data.qpos[self.axes] -= self.machine["crank_radius_m"] + self.machine["rod_length_m"]
            took_s = self.stepper.play(
                ctypes.byref(numbers), model._address, data._address, max(1, round(steps_per_tick)),
                samples.ctypes.data,
            )
            if took_s < 0:
                return None
            best_s = min(best_s, took_s)
        samples[:, self.axes] += self.machine["crank_radius_m"] + self.machine["rod_length_m"]
        return best_s, samples
