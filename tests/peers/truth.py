"""The exact equations of the platform, integrated by SciPy's DOP853: what both sides are judged by.

Written for this comparison alone, from geometry: whole rotations of the platform (a slide, then hinges about x and y),
rods at their true slant, each crank in the vertical plane through the platform's axis. Two kinds of rod:
- `rigid`: constraints, solved with the accelerations (index 1); for up to three cranks, whose rods always fit;
- `elastic`: springs and dampers along the rods; for any number.

Coordinates: N crank angles (rad, 0 upright), heave over the crank axes (m), two tilts (rad); then their speeds.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

UP = np.array([0.0, 0.0, 1.0])


def turned_rad(machine, t_s):
    """Angle by which a field has turned. Its speed rises as 3u^2 - 2u^3, and is constant then."""
    omega = 2 * np.pi * machine["speed_hz"]
    ramp_s = machine["ramp_s"]
    u = min(t_s / ramp_s, 1.0)
    return omega * (ramp_s * u**3 * (1 - 0.5 * u) + max(t_s - ramp_s, 0.0))


def ticks(machine):
    return round((machine["ramp_s"] + machine["hold_s"]) / machine["tick_s"])


def fields(machine, tick):
    """Angle at a tick's beginning and speed through it, before each axis's offset."""
    tick_s = machine["tick_s"]
    begin, end = turned_rad(machine, tick * tick_s), turned_rad(machine, (tick + 1) * tick_s)
    return begin, (end - begin) / tick_s


class Platform:
    def __init__(self, machine, axes, rods):
        self.machine, self.n, self.rods = machine, axes, rods
        around = 2 * np.pi * np.arange(axes) / axes
        self.radial = np.stack([np.cos(around), np.sin(around), np.zeros(axes)], axis=1)
        self.mounts = machine["mount_radius_m"] * self.radial
        self.torque, self.friction = (np.array(machine[key][:axes]) for key in ("torque_nm", "friction_nm"))
        self.offset = np.radians(machine["offset_deg"][:axes])
        tilt = machine["tilt_inertia_kgm2"]
        self.tilt, self.spin = tilt, 2 * tilt  # a disc about its axis

    def rods_and_slopes(self, q):
        """Rods d (pin to corner), their derivatives by crank, heave and tilts, and the rotations behind the last."""
        radius, n = self.machine["crank_radius_m"], self.n
        sin, cos = np.sin(q[:n])[:, None], np.cos(q[:n])[:, None]
        (sx, sy), (cx, cy) = np.sin(q[n + 1 :]), np.cos(q[n + 1 :])
        about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
        by_x = np.array([[0, 0, 0], [0, -sx, -cx], [0, cx, -sx]])
        about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
        by_y = np.array([[-sy, 0, cy], [0, 0, 0], [-cy, 0, -sy]])
        pins = self.mounts + radius * (sin * self.radial + cos * UP)
        d = q[n] * UP + self.mounts @ (about_x @ about_y).T - pins
        by_crank = -radius * (cos * self.radial - sin * UP)
        by_tilt = self.mounts @ (by_x @ about_y).T, self.mounts @ (about_x @ by_y).T
        turning = pins - self.mounts, (about_x, by_x, about_y, by_y)
        return d, by_crank, by_tilt, turning

    def slopes(self, d, by_crank, by_tilt):
        """Row i: derivative of half the square of rod i's length by all coordinates."""
        rows = np.zeros((self.n, self.n + 3))
        rows[np.arange(self.n), np.arange(self.n)] = np.sum(d * by_crank, axis=1)
        rows[:, self.n] = d[:, 2]
        rows[:, self.n + 1] = np.sum(d * by_tilt[0], axis=1)
        rows[:, self.n + 2] = np.sum(d * by_tilt[1], axis=1)
        return rows

    def rates(self, t_s, y, field_rad, field_rad_s):
        n, machine = self.n, self.machine
        q, v = y[: n + 3], y[n + 3 :]
        alpha, omega, (tilt_x, tilt_y) = q[:n], v[:n], v[n + 1 :]
        ahead = machine["cycles_per_turn"] * (field_rad + field_rad_s * t_s + self.offset - alpha)
        force = np.empty(n + 3)
        force[:n] = self.torque * np.sin(ahead) + machine["damping_nms"] * (field_rad_s - omega)
        force[:n] -= self.friction * np.tanh(omega / machine["friction_speed_rad_s"])
        force[n] = -machine["load_kg"] * machine["gravity_mps2"]
        sin, cos = np.sin(q[n + 2]), np.cos(q[n + 2])
        slope = 2 * (self.spin - self.tilt) * sin * cos
        force[n + 1] = -slope * tilt_x * tilt_y
        force[n + 2] = 0.5 * slope * tilt_x**2
        mass = np.full(n + 3, machine["rotor_inertia_kgm2"])
        mass[n] = machine["load_kg"]
        mass[n + 1], mass[n + 2] = self.tilt * cos**2 + self.spin * sin**2, self.tilt
        d, by_crank, by_tilt, turning = self.rods_and_slopes(q)
        rows = self.slopes(d, by_crank, by_tilt)
        if self.rods == "elastic":
            length = np.sqrt(np.sum(d * d, axis=1))
            rate = rows @ v / length
            push = -machine["rod_n_per_m"] * (length - machine["rod_length_m"]) - machine["rod_ns_per_m"] * rate
            return np.concatenate([v, (force + (push / length) @ rows) / mass])
        pins, (about_x, by_x, about_y, by_y) = turning
        d_rate = by_crank * omega[:, None] + v[n] * UP + by_tilt[0] * tilt_x + by_tilt[1] * tilt_y
        twice_x, twice_y = -np.diag([0, 1, 1]) @ about_x, -about_y @ np.diag([1, 0, 1])
        turn = twice_x @ about_y * tilt_x**2 + 2 * by_x @ by_y * tilt_x * tilt_y + about_x @ twice_y * tilt_y**2
        swing = self.mounts @ turn.T + pins * omega[:, None] ** 2
        convective = np.sum(d_rate**2, axis=1) + np.sum(d * swing, axis=1)
        free = force / mass
        held = np.linalg.solve((rows / mass) @ rows.T, -convective - rows @ free)
        return np.concatenate([v, free + held @ rows / mass])

    def start(self):
        """At rest: cranks at their fields, the platform where its rods, or springs under its weight, hold it."""
        n, machine = self.n, self.machine
        alpha = self.offset
        guess = np.array([machine["crank_radius_m"] + machine["rod_length_m"], 0.0, 0.0])

        def unbalanced(plane):
            d, by_crank, by_tilt, _ = self.rods_and_slopes(np.concatenate([alpha, plane]))
            length = np.sqrt(np.sum(d * d, axis=1))
            if self.rods == "rigid":
                return (length - machine["rod_length_m"]) * 1e3
            push = -machine["rod_n_per_m"] * (length - machine["rod_length_m"])
            net = (push / length) @ self.slopes(d, by_crank, by_tilt)[:, n:]
            return (net - [machine["load_kg"] * machine["gravity_mps2"], 0, 0]) / 1e2

        plane = root(unbalanced, guess, tol=1e-15).x
        return np.concatenate([alpha, plane, np.zeros(n + 3)])

    def solve(self, tolerance, method="DOP853"):
        """Angles and platform at every sample, one row each, and how far the rods are from their length at the end."""
        machine, y = self.machine, self.start()
        tick_s, rows, step_s = machine["tick_s"], [], None
        for tick in range(ticks(machine)):
            # One tick at a time: the field's speed jumps between ticks, and no step may extend over a
            # jump.
            part = solve_ivp(
                self.rates, (0.0, tick_s), y, method, rtol=tolerance, atol=tolerance,
                args=fields(machine, tick), first_step=step_s,
            )
            assert part.success, part.message
            y, step_s = part.y[:, -1], np.max(np.diff(part.t))
            if (tick + 1) % machine["ticks_per_sample"] == 0:
                rows.append(y[: self.n + 3])
        d = self.rods_and_slopes(y[: self.n + 3])[0]
        drift = np.max(np.abs(np.sqrt(np.sum(d * d, axis=1)) - machine["rod_length_m"]))
        return np.array(rows), drift
