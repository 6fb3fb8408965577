//! Pushers of all axes in a run.
//!
//! On the *kinematic* model level a pusher is at the position that its law gives. On the *elastic* level a chain of three masses
//! connects cam and pusher ([`Chain`]), and is integrated. On both levels the cam is where its drive has turned it, and turns
//! evenly within a tick. The force of the pusher does not turn the shaft. With *screws* there is no cam: the axes follow cam tables.

use cophase_core::units::MAX_AXES;
use cophase_methods::problems::{Cam, Chain};
use cophase_methods::{Scheme, StepError};
use cophase_scene::SceneError;
use cophase_scene::file::Fidelity;

use super::CamShafts;
use super::chain::Elastic;
use super::screw::Screws;
use crate::machines::follower::{Follower, PartMotion, Peaks, RunStart, ShaftTick};
use crate::pose::Pose;

/// Samples per tick where nothing is integrated.
const SAMPLES: u32 = 16;

/// Motion of a cam in a tick.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Turned {
    /// Turns since power-up, before the tick.
    pub from: f64,
    /// Turns since power-up, after the tick.
    pub to: f64,
    /// Commanded speed at the end of the tick, rad/s.
    pub omega_rad_s: f64,
    /// Commanded acceleration, rad/s².
    pub acceleration_rad_s2: f64,
}

/// Greatest values of a pusher, under their names in `report.json`.
#[derive(Clone, Copy, Debug)]
pub(super) struct PusherPeaks {
    /// Deviation from its law, mm.
    pub off_law_worst_mm: f64,
    /// Acceleration, m/s².
    pub pusher_accel_worst_mps2: f64,
    /// Acceleration of the mass next to the cam, m/s²; for a pusher without a cam, that of its law.
    pub cam_side_accel_worst_mps2: f64,
    /// Deviation of its acceleration from that of its law, m/s².
    pub off_law_accel_worst_mps2: f64,
}

impl From<PusherPeaks> for Peaks {
    fn from(peaks: PusherPeaks) -> Self {
        Self::new([
            ("off_law_worst_mm", peaks.off_law_worst_mm),
            ("pusher_accel_worst_mps2", peaks.pusher_accel_worst_mps2),
            ("cam_side_accel_worst_mps2", peaks.cam_side_accel_worst_mps2),
            ("off_law_accel_worst_mps2", peaks.off_law_accel_worst_mps2),
        ])
    }
}

/// Cause of a pusher's motion.
#[derive(Clone, Debug)]
enum MovedBy {
    /// The law of its cam.
    Law,
    /// A cam, through masses and springs.
    Chain(Box<Elastic>),
    /// A screw.
    Screw(Screws),
}

/// Pushers of all axes.
#[derive(Clone, Debug)]
pub(super) struct Pushers {
    cam: Cam,
    moved_by: MovedBy,
    pushers: [PartMotion; MAX_AXES],
    peaks: [Peaks; MAX_AXES],
    /// Last motion of each cam.
    turned: [Turned; MAX_AXES],
    /// Mean acceleration of the pushers at each sample within the tick, m/s².
    within_mps2: Vec<f64>,
    axes: usize,
    tick_s: f64,
}

impl Pushers {
    /// Creates pushers at rest.
    ///
    /// # Errors
    /// Fails if the method that the scene sets is unstable at its step, or does not suit the pushers.
    pub fn new(shafts: &CamShafts, start: &RunStart<'_>) -> Result<Self, SceneError> {
        let &CamShafts { cam, links, .. } = shafts;
        let lift_m = |turns: f64| cam.at_angle(turns * std::f64::consts::TAU).displacement;
        let mut pushers = [PartMotion::default(); MAX_AXES];
        for (pusher, turns) in pushers.iter_mut().zip(start.turns) {
            pusher.place_m = match shafts.screw_lead_m {
                Some(lead_m) => lead_m * turns,
                None => lift_m(*turns),
            };
        }
        let moved_by = match (shafts.screw_lead_m, links, start.level) {
            (Some(lead_m), _, _) => {
                MovedBy::Screw(Screws::new(lead_m, start.shifts_turns.iter().copied()))
            }
            (None, Some((links, shaft)), Fidelity::Elastic) => {
                let chain = Chain::with_links(cam, shaft, &links);
                let mut elastic = Elastic::new(chain, start.tick_s, start.chosen)
                    .map_err(|problem| SceneError::for_key("method", problem))?;
                for (state, pusher) in elastic.states.iter_mut().zip(&pushers) {
                    state[..3].fill(pusher.place_m); // no spring is strained
                }
                MovedBy::Chain(Box::new(elastic))
            }
            _ => MovedBy::Law,
        };
        let mut turned = [Turned::default(); MAX_AXES];
        for (turned, turns) in turned.iter_mut().zip(start.turns) {
            turned.to = *turns;
        }
        Ok(Self {
            cam,
            moved_by,
            pushers,
            turned,
            peaks: [Peaks::default(); MAX_AXES],
            within_mps2: Vec::new(),
            axes: start.turns.len(),
            tick_s: start.tick_s,
        })
    }

    /// Plays a tick in which the cams have turned.
    fn follow(&mut self) {
        let samples = self.chain().map_or(SAMPLES, |elastic| elastic.steps);
        self.within_mps2.clear();
        self.within_mps2.resize(samples as usize, 0.0);
        let share = 1.0 / self.axes as f64;
        let axes = self.pushers[..self.axes].iter_mut().zip(&mut self.peaks);
        for (axis, ((pusher, peaks), turned)) in axes.zip(&self.turned).enumerate() {
            *peaks = Peaks::default();
            let mut observe = |at: u32, pusher: &PartMotion| {
                self.within_mps2[at as usize] += share * pusher.accel_mps2;
            };
            match &mut self.moved_by {
                MovedBy::Chain(elastic) if elastic.broken.is_none() => {
                    match elastic.play(axis, turned, self.tick_s, &mut observe) {
                        Ok(played) => (*pusher, *peaks) = played,
                        Err(error) => elastic.broken = Some(error),
                    }
                }
                MovedBy::Chain(_) => {}
                MovedBy::Law | MovedBy::Screw(_) => {
                    (*pusher, *peaks) = by_law(&self.cam, turned, self.tick_s, &mut observe);
                }
            }
        }
    }

    fn mean(&self, of: fn(&PartMotion) -> f64) -> f64 {
        self.parts().iter().map(of).sum::<f64>() / self.axes as f64
    }

    fn chain(&self) -> Option<&Elastic> {
        match &self.moved_by {
            MovedBy::Chain(elastic) => Some(elastic),
            MovedBy::Law | MovedBy::Screw(_) => None,
        }
    }
}

impl Follower for Pushers {
    fn play(&mut self, tick: &ShaftTick<'_>) {
        if let MovedBy::Screw(screws) = &mut self.moved_by {
            let axes = self.axes;
            screws.play(
                &self.cam,
                self.tick_s,
                tick,
                (&mut self.pushers[..axes], &mut self.peaks[..axes]),
            );
            self.within_mps2 = vec![self.mean(|pusher| pusher.accel_mps2)];
            return;
        }
        let on = f64::from(u8::from(tick.drives_enabled));
        for (turned, cam) in self.turned.iter_mut().zip(tick.axes) {
            *turned = Turned {
                from: turned.to,
                to: cam.turns(),
                omega_rad_s: tick.omega_rad_s * cam.ratio() * on,
                acceleration_rad_s2: tick.acceleration_rad_s2 * cam.ratio() * on,
            };
        }
        self.follow();
    }

    /// The mean of the pushers, which does not tilt.
    fn pose(&self, _: &[f64], _: f64, _: f64) -> Pose {
        Pose {
            z_m: self.mean(|pusher| pusher.place_m),
            accel_mps2: self.mean(|pusher| pusher.accel_mps2),
            ..Pose::default()
        }
    }

    fn within_mps2(&self) -> &[f64] {
        &self.within_mps2
    }

    fn parts(&self) -> &[PartMotion] {
        &self.pushers[..self.axes]
    }

    fn peaks(&self) -> &[Peaks] {
        &self.peaks[..self.axes]
    }

    fn method(&self) -> Option<(Scheme, u32)> {
        let elastic = self.chain()?;
        Some((elastic.scheme, elastic.steps))
    }

    fn broken(&self) -> Option<StepError> {
        self.chain()?.broken
    }
}

/// Plays a tick of a pusher that its law moves. `observe` receives it at each sample.
fn by_law(
    cam: &Cam,
    turned: &Turned,
    tick_s: f64,
    mut observe: impl FnMut(u32, &PartMotion),
) -> (PartMotion, Peaks) {
    let (mut pusher, mut peaks) = (PartMotion::default(), Peaks::default());
    for sample in 1..=SAMPLES {
        let part = f64::from(sample) / f64::from(SAMPLES);
        let angle_rad = (turned.from + (turned.to - turned.from) * part) * std::f64::consts::TAU;
        let omega = turned.omega_rad_s - turned.acceleration_rad_s2 * tick_s * (1.0 - part);
        let law = cam.at_angle(angle_rad);
        pusher = PartMotion {
            place_m: law.displacement,
            accel_mps2: law.acceleration * omega * omega
                + law.velocity * turned.acceleration_rad_s2,
        };
        observe(sample - 1, &pusher);
        peaks = peaks.or(PusherPeaks {
            off_law_worst_mm: 0.0,
            pusher_accel_worst_mps2: pusher.accel_mps2.abs(),
            cam_side_accel_worst_mps2: pusher.accel_mps2.abs(),
            off_law_accel_worst_mps2: 0.0,
        }
        .into());
    }
    (pusher, peaks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_methods::problems::{Law, Shaft};

    /// If this fails, a scene whose equations diverge ends in meaningless numbers. The simulator refuses an unstable step
    /// beforehand, so the test sets the step directly: 100 us for RK4, whose limit here is 81 us.
    #[test]
    fn divergence_stops_the_pushers_and_is_reported() {
        let chain = Chain::wrapper(Cam::wrapper(Law::ModifiedSine), Shaft::DampedToCam);
        let (tick_s, steps) = (5e-4, 5);
        let elastic = Elastic {
            method: Scheme::Rk4
                .prepare(&chain, tick_s / f64::from(steps))
                .unwrap(),
            chain,
            scheme: Scheme::Rk4,
            steps,
            states: [[0.0; 6]; MAX_AXES],
            broken: None,
        };
        let mut pushers = Pushers {
            cam: Cam::wrapper(Law::ModifiedSine),
            moved_by: MovedBy::Chain(Box::new(elastic)),
            pushers: [PartMotion::default(); MAX_AXES],
            peaks: [Peaks::default(); MAX_AXES],
            turned: [Turned::default(); MAX_AXES],
            within_mps2: Vec::new(),
            axes: 2,
            tick_s,
        };
        for tick in 0..2000 {
            let turns = f64::from(tick) * 7.5 * tick_s;
            let turned = Turned {
                from: turns,
                to: turns + 7.5 * tick_s,
                omega_rad_s: 47.1,
                acceleration_rad_s2: 0.0,
            };
            pushers.turned[..2].fill(turned);
            pushers.follow();
        }
        assert!(matches!(
            pushers.broken(),
            Some(StepError::NotFinite { .. })
        ));
        assert!(pushers.mean(|pusher| pusher.place_m).is_finite());
    }
}
