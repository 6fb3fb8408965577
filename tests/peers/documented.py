"""The phased level as docs/model.md states it: constants of a scene, equations, outputs, and a solution by SciPy's DOP853.

Dry friction sticks and
slides by events. Nothing here is from the simulation's code. Commands come from the columns of `trace.csv`. Known are slider-cranks with three or more
steppers, or servos, and quasi-static rods. Names of quantities are those of docs/model.md where it has one.
"""

import csv
import itertools
import sys
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

TOLERANCE = 1e-8  # of the solution, relative to what changes within a tick
DRIVES_ON = ("homing", "run", "stop", "parked")
STANDARD_GRAVITY = 9.80665
TURN = 2 * np.pi


class Machine:
    """Constants of a scene in SI units, and the equations of the phased level. Arrays end with the axes; samples come before."""

    def __init__(self, scene):
        machine, axes, servo = scene["machine"], scene["axes"], scene["axes"].get("servo", {})
        self.n = n = axes["count"]
        self.drive = axes["drive"]
        own = {axis["number"]: axis for axis in scene.get("axis", [])}

        def each(key, default):
            return np.array([own.get(i, {}).get(key, axes.get(key, default)) for i in range(n)], float)

        self.radius, self.ratio = machine["crank_radius_mm"] * 1e-3, machine["lambda"]
        self.up = -1.0 if machine.get("platform") == "below" else 1.0
        self.load, self.gravity = machine["load_kg"], machine.get("gravity_mps2", STANDARD_GRAVITY)
        self.mount = mount = machine.get("mount_radius_mm", 250) * 1e-3
        self.rotor, self.friction = axes["rotor_inertia_kgm2"], each("friction_nm", 0)
        self.start = np.radians(each("start_deg", 0))
        self.rod = machine.get("rod_n_per_um", 50) * 1e6 if n > 3 else 0.0
        tilt = machine.get("tilt_inertia_kgm2", self.load * mount**2 / 4)
        self.mobility = np.diag([1 / self.load, 1 / tilt, 1 / tilt])
        around = TURN * np.arange(n) / n
        self.corners = np.stack([np.ones(n), mount * np.cos(around), mount * np.sin(around)], axis=1)  # rows H
        self.shares = np.stack([np.ones(n), 2 * np.cos(around) / mount, 2 * np.sin(around) / mount], axis=1) / n  # rows S

        self.tick_s, self.steps = 1 / scene["control"]["tick_hz"], scene["method"]["steps_per_tick"]
        self.cycles, self.damping = axes.get("full_steps_per_turn", 200) / 4, axes.get("damping_nms", 0)
        self.pull_out = np.array(axes.get("pull_out", [[0, 0]]), float).T
        self.pull_out_scale = each("pull_out_scale", 1)
        self.position_gain, self.velocity_gain = servo.get("position_gain_per_s"), servo.get("velocity_gain_nms")
        self.speed_share, self.integral_s = servo.get("velocity_feed_forward", 1), servo.get("integral_s")
        self.limit = servo.get("limit_nm", np.inf)

    def crank(self, angle):
        """s and h: the slider's slope by the crank's angle, and that slope's own, over the crank radius."""
        sin, cos, ratio = np.sin(angle), np.cos(angle), self.ratio
        below = 1 - (ratio * sin) ** 2
        return sin + ratio * sin * cos / np.sqrt(below), cos + ratio * (1 - 2 * sin**2 + ratio**2 * sin**4) / below**1.5

    def heights(self, angle):
        rod = self.radius / self.ratio
        return self.up * (self.radius * np.cos(angle) + np.sqrt(rod**2 - (self.radius * np.sin(angle)) ** 2))

    def warp(self, corners):
        return corners - corners @ self.shares @ self.corners.T

    def feed_forward(self, turns, omega, omega_before):
        """Torque that the controller sends with the setpoint for the end of a tick."""
        slope, bend = self.crank(TURN * turns)
        gain = (omega - omega_before) / self.tick_s
        platform = self.radius * (bend * omega**2 + slope * gain) - self.up * self.gravity
        return self.load / self.n * self.radius * slope * platform + self.rotor * gain

    def motors(self, ahead, omega, integral, command):
        """Torques, and the rates of the integrals. `ahead` is the crank's angle minus the field's."""
        rate = np.zeros_like(omega)
        if not command.on:
            return rate, rate
        if self.drive == "stepper":
            most = self.pull_out_scale * np.interp(np.abs(omega) / TURN, *self.pull_out, right=0)
            return most * np.sin(-self.cycles * ahead) + self.damping * (command.speed - omega), rate
        target_speed = self.speed_share * command.speed - self.position_gain * ahead
        torque = self.velocity_gain * (target_speed - omega) + integral + command.torque
        torque = np.clip(torque, -self.limit, self.limit)
        return torque, (torque - command.torque - integral) / self.integral_s if self.integral_s else rate

    def accelerations(self, t_s, ahead, omega, integral, command, slides):
        """Those of the cranks and of the platform; with them the motors' torques, the rates of the integrals, and the friction.
        `slides` is 1, −1, or 0 for a crank that sticks."""
        angle = command.begin + command.speed * t_s + ahead
        slope, bend = self.crank(angle)
        lever, bend = -self.up * self.radius * slope, -self.up * self.radius * bend
        torque, rate = self.motors(ahead, omega, integral, command)
        free = torque - self.friction * slides
        if self.rod:
            free = free - self.rod * self.warp(self.heights(angle)) * lever
        reach = self.shares * lever[..., None]  # rows G
        back = np.swapaxes(reach, -1, -2)
        turning = (bend * omega**2) @ self.shares
        yields = np.where(slides == 0, 0.0, 1 / self.rotor)
        driven = (back @ (yields * free)[..., None])[..., 0] + turning
        driven[..., 0] += self.gravity
        force = np.linalg.solve(self.mobility + (back * yields[..., None, :]) @ reach, driven[..., None])
        net = free - (reach @ force)[..., 0]
        friction = -np.where(slides == 0, net, self.friction * slides)
        cranks = yields * net
        return cranks, (back @ cranks[..., None])[..., 0] + turning, torque, rate, friction

    def rates(self, t_s, y, command, slides):
        ahead, omega, integral = y.reshape(3, self.n)
        cranks, _, _, rate, _ = self.accelerations(t_s, ahead, omega, integral, command, slides)
        return np.concatenate([omega - command.speed, cranks, rate])

    def slides(self, t_s, y, command):
        """Direction of each crank, 0 where it sticks. Of all that cranks at rest may do, one obeys the law of friction."""
        ahead, omega, integral = y.reshape(3, self.n)
        choices = [(np.sign(speed),) if speed else (0.0, 1.0, -1.0) for speed in omega]
        best, least = None, np.inf
        for choice in map(np.array, itertools.product(*choices)):
            cranks, *_, friction = self.accelerations(t_s, ahead, omega, integral, command, choice)
            rests = omega == 0
            beyond = np.where(choice == 0, np.abs(friction) - self.friction, -cranks * choice * self.rotor)
            wrong = np.max(np.where(rests, beyond, -np.inf))
            if wrong < least:
                best, least = choice, wrong
            if least <= 0:
                break
        return best

    def changes(self, slides):
        """An event for each crank: its speed reverses, or it needs more friction than it has to stick."""

        def change(i):
            def distance(t_s, y, command, slides):
                ahead, omega, integral = y.reshape(3, self.n)
                if slides[i]:
                    return omega[i] * slides[i]
                *_, friction = self.accelerations(t_s, ahead, omega, integral, command, slides)
                return self.friction[i] - abs(friction[i])

            distance.terminal, distance.direction = True, -1
            return distance

        return [change(i) for i in range(self.n)]


@dataclass
class Command:
    """A tick's field at its beginning (rad), its speed (rad/s), the feed-forward torque (N·m), the phase in turns at both ends."""

    begin: np.ndarray
    speed: np.ndarray
    torque: np.ndarray
    turns: np.ndarray
    on: bool


class Trace:
    def __init__(self, path, machine):
        rows = list(csv.DictReader(path.open()))

        def column(name):
            return np.array([float(row[name]) for row in rows])

        def axes(name):
            return np.stack([column(f"{name}_{i}") for i in range(machine.n)], axis=1)

        self.state = np.array([row["state"] for row in rows])
        self.t_s, self.omega, self.requested = column("t_s"), column("omega_rad_s"), column("amax_requested_mps2")
        self.turns, self.actual_deg = axes("command_turns"), 360 * axes("actual_turns")
        self.platform = {name: column(name) for name in ("tilt_x_mrad", "tilt_y_mrad", "warp_deg", "z_m", "accel_mps2")}

    def commands(self, machine):
        """A command for each row. All stand before the first row. Drives switch a tick before the state is in its row."""
        turns, omega = np.concatenate([self.turns[:1], self.turns]), np.concatenate([[0.0], self.omega])
        on = np.isin(np.append(self.state[1:], self.state[-1]), DRIVES_ON)
        for row in range(len(on)):
            ends = turns[row : row + 2]
            begin, end = TURN * ends + machine.start
            torque = machine.feed_forward(ends[1], omega[row + 1], omega[row]) if machine.drive == "servo" else 0.0
            yield Command(begin, (end - begin) / machine.tick_s, torque, ends, on[row])


def solve(machine, trace, name):
    """Yields each tick's command, and the states before each step of the simulation's method and at the end: (steps + 1, 3, N)."""
    moments = np.linspace(0, machine.tick_s, machine.steps + 1)
    y, stands = np.zeros(3 * machine.n), True
    for row, command in enumerate(trace.commands(machine)):
        if row % 1000 == 0:
            print(f"{name}: {trace.t_s[row]:.1f} of {trace.t_s[-1]:.1f} s solved", file=sys.stderr, flush=True)
        stands = stands and not command.on
        states = np.zeros((len(moments), 3 * machine.n))
        if not stands:
            if not command.on:
                y[2 * machine.n :] = 0
            states, y = tick(machine, command, moments, y, f"{name}, {trace.t_s[row]} s")
        yield command, moments[:, None], states.reshape(-1, 3, machine.n)


def tick(machine, command, moments, y, where):
    """The states at the moments of a tick, and the last of them. It is solved from one change of friction to the next."""
    n, from_s, known = machine.n, 0.0, [y.copy()]
    for _ in range(100):
        slides = machine.slides(from_s, y, command)
        left = moments[moments > from_s]
        part = solve_ivp(
            machine.rates,
            (from_s, machine.tick_s),
            y,
            "DOP853",
            left,
            args=(command, slides),
            events=machine.changes(slides),
            rtol=TOLERANCE,
            atol=TOLERANCE / 100,
        )
        if not part.success:
            sys.exit(f"{where}: no solution: {part.message}")
        known.extend(part.y.T if len(part.t) else [])
        if part.status == 0:
            return np.array(known), known[-1].copy()
        i = next(i for i, at in enumerate(part.t_events) if len(at))
        from_s, y = part.t_events[i][0], part.y_events[i][0].copy()
        if slides[i]:
            y[n + i] = 0.0
        else:
            # The root is where it still sticks; a moment later it slides.
            y[n + i] = -np.sign(friction_of(machine, from_s, y, command, slides)[i]) * 1e-12
    sys.exit(f"{where}: friction changes without end")


def friction_of(machine, t_s, y, command, slides):
    *_, friction = machine.accelerations(t_s, *y.reshape(3, machine.n), command, slides)
    return friction


def outputs(machine, command, t_s, states):
    """All outputs at each moment of a tick, by name."""
    ahead, omega, integral = states[:, 0], states[:, 1], states[:, 2]
    angle = command.begin + command.speed * t_s + ahead
    turns = command.turns[0] + (command.turns[1] - command.turns[0]) * t_s / machine.tick_s
    error = np.degrees(angle) - 360 * turns
    plane = machine.heights(angle) @ machine.shares
    slides = np.array([machine.slides(t, state.ravel(), command) for t, state in zip(t_s[:, 0], states)])
    _, accel, torque, *_ = machine.accelerations(t_s, ahead, omega, integral, command, slides)
    return {
        "actual_deg": np.degrees(angle),
        "tilt_x_mrad": 1e3 * plane[:, 1],
        "tilt_y_mrad": 1e3 * plane[:, 2],
        "tilt_mrad": 1e3 * np.hypot(plane[:, 1], plane[:, 2]),
        "warp_deg": np.abs(machine.warp(error)).max(axis=1) if machine.n > 3 else np.zeros(len(error)),
        "z_m": plane[:, 0],
        "accel_mps2": accel[:, 0],
        "lag_deg": np.abs(error).max(axis=1),
        "spread_deg": np.ptp(error, axis=1),
        "torque_nm": np.abs(torque),
    }
