//! A designed platform as a scene.
//!
//! The scene has what the design computes: crank radius, λ, load, number of motors, and the motor torque with the safety factor. What
//! the design leaves open is assumed, and each such line is marked.

use core::f64::consts::TAU;

use cophase_scene::units::STANDARD_GRAVITY_MPS2;

use super::motor::MotorChoice;
use super::steps::Design;
use super::warning::Warning;
use crate::design::scene::{aligned, comment, number};
use host_sim::mechanism::Mechanism;

/// Ratio of the speed limit to the design's frequency, and the greatest limit that scenes accept, rev/s.
const MARGIN: f64 = 1.05;
const FASTEST_HZ: f64 = 200.0;
/// Limits of acceleration and jerk for one rev/s of the design's frequency. They give full speed in about two seconds.
const ACCELERATION_PER_HZ: f64 = 0.6;
const JERK_PER_HZ: f64 = 3.0;
/// Least mount radius, m, and its least ratio to the crank radius, because cranks need room beside each other.
const MOUNT_M: f64 = 0.2;
const MOUNT_PER_CRANK: f64 = 4.0;
/// Speed ripple of an assumed servo under the design's torque, as a fraction of its speed. Bandwidth of its velocity loop, rad/s, and
/// its position gain, 1/s.
const RIPPLE: f64 = 0.01;
const BANDWIDTH_RAD_S: f64 = 400.0 * TAU;
const POSITION_GAIN_PER_S: f64 = 100.0;

impl Design {
    /// The scene, as TOML text. It has steppers if steppers can reach the speed and power, else servo drives that take STEP and DIR.
    pub fn scene(&self, motor: &MotorChoice) -> String {
        let text = [
            self.heading(motor),
            self.machine(),
            self.limits(),
            self.motors(motor),
            self.program(),
        ];
        aligned(&text.concat())
    }

    /// Returns true if the design exceeds the speed or power of steppers.
    fn needs_servos(&self, motor: &MotorChoice) -> bool {
        let is_about_steppers = |warning: &Warning| {
            matches!(
                warning,
                Warning::StepperSpeed { .. } | Warning::StepperPower { .. }
            )
        };
        self.warnings(motor).iter().any(is_about_steppers)
    }

    fn heading(&self, motor: &MotorChoice) -> String {
        let required = &self.requirement;
        let mut command = format!(
            "# cophase design --load-kg {} --amax-g {} --freq-hz {} --lambda {} --motors {} --safety {} --gravity {}",
            required.load_kg,
            required.amax_g,
            required.freq_hz,
            required.lambda,
            required.motors,
            required.safety,
            required.gravity_mps2,
        );
        let usual = MotorChoice::default();
        if motor.gear != usual.gear {
            let gear = motor.gear;
            command += &format!(" --gear {}:{}", gear.motor_turns, gear.crank_turns);
        }
        if motor.steps_per_turn != usual.steps_per_turn {
            command += &format!(" --steps-per-turn {}", motor.steps_per_turn);
        }
        if let Some(kgm2) = motor.rotor_inertia_kgm2 {
            command += &format!(" --rotor-inertia-kgm2 {kgm2}");
        }
        command += " --scene\n";
        let warnings = self.warnings(motor);
        let warnings: String = warnings
            .iter()
            .map(|warning| comment(&format!("! {warning}")))
            .collect();
        let fidelity = if self.needs_servos(motor) {
            "fidelity = \"phased\" # each crank its own rotor, moved by torque\n"
        } else {
            "fidelity = \"quasi-static\" # required against pull-out torque; other levels need rotor_inertia_kgm2 and damping_nms\n"
        };
        format!(
            "{}{command}{}{warnings}name = \"design\"\ndescription = \"{} motors, {} kg, {} g at {} Hz\"\n{fidelity}",
            comment("A vibration platform, made by"),
            comment(
                "Lines marked \"assumed\" are no part of the design: put your machine's values there."
            ),
            required.motors,
            required.load_kg,
            required.amax_g,
            required.freq_hz,
        )
    }

    fn machine(&self) -> String {
        let required = &self.requirement;
        let radius_m = self.mechanism.crank_radius_m();
        // Rounded up, so that amax is reached at the frequency or just below it.
        let radius_mm = (radius_m * 1e9).ceil() / 1e6;
        let mount_m = MOUNT_M.max(MOUNT_PER_CRANK * radius_m);
        let mount_mm = (mount_m * 1e2).ceil() * 1e1;
        format!(
            "\n[machine]\n\
             crank_radius_mm = {radius_mm}  # amax / (ω² (1 + λ))\n\
             lambda = {}\n\
             load_kg = {}  # add the mass of the platform\n\
             platform = \"below\"          # the sign of gravity in the design's torque\n\
             gravity_mps2 = {}\n\
             mount_radius_mm = {mount_mm}        # assumed\n",
            required.lambda, required.load_kg, required.gravity_mps2,
        )
    }

    fn speed_limit_hz(&self) -> f64 {
        let freq_hz = self.requirement.freq_hz;
        // Above the range of scenes, the limit is the design's own frequency, which the check then refuses.
        (MARGIN * freq_hz).min(FASTEST_HZ.max(freq_hz))
    }

    fn limits(&self) -> String {
        let freq_hz = self.requirement.freq_hz;
        let limit_hz = self.speed_limit_hz();
        let margin = 100.0 * (limit_hz / freq_hz - 1.0);
        format!(
            "\n[limits]\n\
             speed_hz = {}              # {margin:.1} % above the design's frequency\n\
             acceleration_hz_per_s = {}  # assumed\n\
             jerk_hz_per_s2 = {}         # assumed\n",
            number(limit_hz),
            number(ACCELERATION_PER_HZ * freq_hz),
            number(JERK_PER_HZ * freq_hz),
        )
    }

    fn motors(&self, motor: &MotorChoice) -> String {
        let required = &self.requirement;
        let usual = MotorChoice::default();
        let torque = number(motor.torque_nm(self));
        let ratio = motor.gear.ratio();
        let assumed = |is_assumed: bool| if is_assumed { "       # assumed" } else { "" };
        let mut common = format!(
            "\n[axes]\ncount = {}\nsteps_per_turn = {}{}\n",
            required.motors,
            motor.steps_per_turn,
            assumed(motor.steps_per_turn == usual.steps_per_turn),
        );
        if motor.gear != usual.gear {
            common += &format!(
                "gear = [{}, {}]             # turns of the motor, turns of the crank\n",
                motor.gear.motor_turns, motor.gear.crank_turns
            );
        }
        if self.needs_servos(motor) {
            // At the motor, torque is divided by the gear's ratio, and speed is multiplied.
            let velocity_gain_nms =
                self.motor_torque_nm() / (RIPPLE * self.speed_rad_s() * ratio * ratio);
            let inertia = motor.rotor_inertia_kgm2.map_or_else(
                || digits(velocity_gain_nms / BANDWIDTH_RAD_S) + "  # assumed",
                number,
            );
            let gain = digits(velocity_gain_nms);
            format!(
                "{common}drive = \"pulse-servo\"       # steppers end below this speed or power\n\
                 rotor_inertia_kgm2 = {inertia}\n\
                 \n[axes.servo]\n\
                 limit_nm = {torque}         # the design's torque with safety {}\n\
                 position_gain_per_s = {POSITION_GAIN_PER_S}     # assumed\n\
                 velocity_gain_nms = {gain}      # assumed\n",
                required.safety
            )
        } else {
            let limit_hz = number(self.speed_limit_hz() * ratio);
            let inertia = motor.rotor_inertia_kgm2;
            let inertia = inertia.map_or_else(String::new, |kgm2| {
                format!("rotor_inertia_kgm2 = {}\n", number(kgm2))
            });
            format!(
                "{common}drive = \"stepper\"\n{inertia}\
                 # [speed_hz, torque_nm]: the design's torque with safety {}; put your motor's curve there\n\
                 pull_out = [[0, {torque}], [{limit_hz}, {torque}]]\n",
                required.safety
            )
        }
    }

    fn program(&self) -> String {
        let amax_g = self.requirement.amax_mps2() / STANDARD_GRAVITY_MPS2;
        let segment = |amax_g: f64, hold_s: u32, note: &str| {
            format!(
                "\n[[program]]\namax_g = {}{note}\nramp_s = 3\nhold_s = {hold_s}\n",
                number(amax_g)
            )
        };
        let at = format!("  # at {} rev/s", self.requirement.freq_hz);
        segment(0.25 * amax_g, 2, "  # at half the speed") + &segment(amax_g, 6, &at)
    }
}

/// An assumed number with two digits.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.1e}").parse().unwrap_or(value);
    number(rounded)
}
