//! Figures of a crusher's run: its speed over a turn, the rock's work, and stalling.

use std::f64::consts::TAU;

use super::Crusher;
use crate::dynamics::plant::{Figure, Record, Tick};

/// Speeds within one turn of the shaft, rad/s.
#[derive(Clone, Copy, Debug)]
struct Turn {
    slowest: f64,
    fastest: f64,
    began_s: f64,
    /// True if rock was fed during the whole turn, at a constant commanded speed.
    is_crushing: bool,
}

/// Time and angle at which the shaft was stopped.
#[derive(Clone, Copy, Debug)]
struct Stall {
    t_s: f64,
    turn_deg: f64,
    /// True if rock was fed then.
    in_rock: bool,
}

impl Stall {
    /// Time and angle, in words.
    fn place(&self) -> String {
        format!("{:.3} s, at {:.1}° of its turn", self.t_s, self.turn_deg)
    }
}

/// Figures of a run.
#[derive(Clone, Debug)]
pub struct CrusherRecord {
    crusher: Crusher,
    /// Number of the shaft's current turn, and the speeds within it.
    turn: Option<(f64, Turn)>,
    /// Slowest, fastest and mean speed of the last complete turn with rock.
    crushing: Option<[f64; 3]>,
    /// True once rock was fed.
    was_fed: bool,
    /// Largest commanded speed, rad/s.
    top_rad_s: f64,
    /// True if the shaft has exceeded half of its commanded speed since its last commanded stop.
    turned: bool,
    stall: Option<Stall>,
}

/// Fraction of the largest commanded speed below which the shaft counts as stopping on command.
const STANDING: f64 = 0.1;

impl CrusherRecord {
    pub(super) fn new(crusher: &Crusher) -> Self {
        Self {
            crusher: crusher.clone(),
            turn: None,
            crushing: None,
            was_fed: false,
            top_rad_s: 0.0,
            turned: false,
            stall: None,
        }
    }

    fn speeds(&mut self, tick: &Tick<'_>, phi_rad: f64, omega: f64) {
        let number = (phi_rad / TAU).floor();
        // The turn began within this tick.
        let began_s = tick.t_s - (phi_rad - number * TAU) / omega.max(f64::MIN_POSITIVE);
        let is_crushing =
            tick.acceleration_rad_s2 == 0.0 && self.crusher.fed_rad.contains(&phi_rad);
        match &mut self.turn {
            Some((current, turn)) if *current == number => {
                turn.slowest = turn.slowest.min(omega);
                turn.fastest = turn.fastest.max(omega);
                turn.is_crushing &= is_crushing;
            }
            other => {
                if let Some((_, turn)) = other.filter(|(_, turn)| turn.is_crushing) {
                    let mean = TAU / (began_s - turn.began_s);
                    self.crushing = Some([turn.slowest, turn.fastest, mean]);
                }
                let turn = Turn {
                    slowest: omega,
                    fastest: omega,
                    began_s,
                    is_crushing,
                };
                *other = Some((number, turn));
            }
        }
    }

    fn stalls(&mut self, tick: &Tick<'_>, phi_rad: f64, omega: f64) {
        let commanded = tick.omega_rad_s;
        self.top_rad_s = self.top_rad_s.max(commanded);
        // At the end of a commanded stop every shaft comes to rest, which is not a stall.
        if !tick.drives_enabled || commanded < STANDING * self.top_rad_s {
            self.turned = false;
        } else if omega > 0.5 * commanded {
            self.turned = true;
        } else if self.turned && omega <= 0.0 && self.stall.is_none() {
            self.stall = Some(Stall {
                t_s: tick.t_s,
                turn_deg: phi_rad.rem_euclid(TAU).to_degrees(),
                in_rock: self.crusher.fed_rad.contains(&phi_rad),
            });
        }
    }

    /// Mean torque of the rock over a turn, N·m.
    fn mean_nm(&self) -> f64 {
        self.crusher.work_j() / TAU
    }
}

impl Record for CrusherRecord {
    fn tick(&mut self, tick: &Tick<'_>) {
        self.was_fed |= self.crusher.fed_rad.contains(&(tick.turns[0] * TAU));
        let Some(state) = tick.state else {
            return;
        };
        let (phi_rad, omega) = (state.q[0], state.v[0]);
        self.speeds(tick, phi_rad, omega);
        self.stalls(tick, phi_rad, omega);
    }

    fn figures(&self) -> Vec<Figure> {
        let speed = |i: usize| self.crushing.map(|speeds| speeds[i]);
        let irregularity = self
            .crushing
            .map(|[slowest, fastest, mean]| (fastest - slowest) / mean);
        let sentence = match (self.crushing, irregularity) {
            (Some([slowest, fastest, mean]), Some(irregularity)) => format!(
                "In the last whole turn with rock the shaft turned at {slowest:.3} to {fastest:.3} rad/s, {mean:.3} on average: an irregularity of {irregularity:.4}."
            ),
            _ => String::new(),
        };
        let figure = |key, value, sentence| Figure {
            key,
            value,
            sentence,
        };
        vec![
            figure("speed_slowest_rad_s", speed(0), sentence),
            figure("speed_fastest_rad_s", speed(1), String::new()),
            figure("speed_mean_rad_s", speed(2), String::new()),
            figure("irregularity", irregularity, String::new()),
            figure(
                "rock_work_j",
                Some(self.crusher.work_j()),
                format!(
                    "The rock takes {:.0} J a turn, {:.0} N·m on average, and {:.0} N·m at its peak.",
                    self.crusher.work_j(),
                    self.mean_nm(),
                    self.crusher.rock_nm()
                ),
            ),
            figure(
                "rock_torque_nm",
                Some(self.crusher.rock_nm()),
                String::new(),
            ),
            figure(
                "stalled_s",
                self.stall.map(|stall| stall.t_s),
                match self.stall {
                    Some(stall) if stall.in_rock => {
                        format!("The rock stopped the shaft at {}.", stall.place())
                    }
                    Some(stall) => {
                        format!("The shaft was stopped at {}, without rock.", stall.place())
                    }
                    None if self.was_fed => "The rock did not stop the shaft.".to_owned(),
                    None => "No rock was fed.".to_owned(),
                },
            ),
            figure(
                "stalled_deg",
                self.stall.map(|stall| stall.turn_deg),
                String::new(),
            ),
        ]
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let mean_nm = self.mean_nm();
        let is_weak = |motor_nm: &f64| self.was_fed && *motor_nm < mean_nm;
        let weak = self.crusher.motor_nm.filter(is_weak);
        if let Some(motor_nm) = weak {
            warnings.push(format!(
                "The rock takes {mean_nm:.0} N·m on average, and the motor has at most {motor_nm:.0}: no flywheel carries the shaft through that."
            ));
        }
        if let Some(stall) = self.stall {
            let cause = if stall.in_rock {
                "flywheel and motor do not break this rock at this speed"
            } else {
                "no rock was fed there, so look at the motor's torque, the ramps and the injected faults"
            };
            warnings.push(format!(
                "The crusher stalled at {}: {cause}.",
                stall.place()
            ));
        }
        warnings
    }
}
