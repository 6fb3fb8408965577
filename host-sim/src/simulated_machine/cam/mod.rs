//! Cam shafts, each with its own follower, instead of cranks under a platform.
//!
//! A scene with *screws* has no cam: its axes follow cam tables ([`screw`]).
//!
//! On the *kinematic* model level a pusher is at the position that its law gives. On the *elastic* level a chain of three masses
//! connects cam and pusher ([`Chain`]), and is integrated. On both levels the cam is where its drive has turned it, and turns
//! evenly within a tick. The force of the follower does not turn the shaft.

mod elastic;
mod pusher;
mod screw;

pub use pusher::{Peaks, Pusher, Turned};

use cophase_core::units::MAX_AXES;
use cophase_methods::problems::{Cam, Chain};
use cophase_methods::{Scheme, StepError};
use cophase_scene::SceneError;
use cophase_scene::file::Fidelity;

use crate::checked::Checked;
use elastic::Elastic;
use screw::Screws;

/// Samples per tick where nothing is integrated.
const SAMPLES: u32 = 16;
/// Followers of all axes.
#[derive(Clone, Debug)]
pub struct Followers {
    cam: Cam,
    elastic: Option<Elastic>,
    screws: Option<Screws>,
    pushers: [Pusher; MAX_AXES],
    peaks: [Peaks; MAX_AXES],
    /// Mean acceleration of the pushers at each sample within the tick, m/s².
    within_mps2: Vec<f64>,
    axes: usize,
    tick_s: f64,
}

impl Followers {
    /// Creates the followers of a scene, at rest on cams that stand `turns` from phase 0; none if the scene has cranks.
    ///
    /// # Errors
    /// Fails if the method that the scene sets is unstable at its step, or does not suit the followers.
    pub fn new(checked: &Checked, turns: &[f64]) -> Result<Option<Self>, SceneError> {
        let Some(follower) = checked.machine.follower() else {
            return Ok(None);
        };
        let tick_s = 1.0 / f64::from(checked.scene.control.tick_hz);
        let mut pushers = [Pusher::default(); MAX_AXES];
        let screws = follower.screw_lead_m.map(|lead_m| {
            Screws::new(
                lead_m,
                checked
                    .settings
                    .axes
                    .iter()
                    .map(|axis| axis.follower.shift_turns()),
            )
        });
        for (pusher, turns) in pushers.iter_mut().zip(turns) {
            pusher.place_m = match &screws {
                Some(screws) => screws.place_m(*turns),
                None => {
                    follower
                        .cam
                        .at_angle(turns * std::f64::consts::TAU)
                        .displacement
                }
            };
        }
        let elastic = match (checked.fidelity, &follower.links) {
            (Fidelity::Elastic, Some((links, shaft))) => {
                let chain = Chain::of(follower.cam, *shaft, links);
                let mut elastic = Elastic::new(chain, tick_s, checked.chosen())
                    .map_err(|problem| SceneError::at("method", problem))?;
                for (state, pusher) in elastic.states.iter_mut().zip(&pushers) {
                    state[..3].fill(pusher.place_m); // no spring is strained
                }
                Some(elastic)
            }
            _ => None,
        };
        Ok(Some(Self {
            cam: follower.cam,
            elastic,
            screws,
            pushers,
            peaks: [Peaks::default(); MAX_AXES],
            within_mps2: Vec::new(),
            axes: turns.len(),
            tick_s,
        }))
    }

    /// Integration method and its steps per tick; none if nothing is integrated.
    pub fn method(&self) -> Option<(Scheme, u32)> {
        let elastic = self.elastic.as_ref()?;
        Some((elastic.scheme, elastic.steps))
    }

    /// Reason why the followers could not be advanced further, if there is one.
    pub fn broken(&self) -> Option<StepError> {
        self.elastic.as_ref()?.broken
    }

    /// Motion of each follower at the end of the tick.
    pub fn pushers(&self) -> &[Pusher] {
        &self.pushers[..self.axes]
    }

    /// Peak values of each follower in the tick.
    pub fn peaks(&self) -> &[Peaks] {
        &self.peaks[..self.axes]
    }

    /// Mean acceleration of the pushers at each sample within the last tick, m/s², the end of the tick included.
    pub fn within_mps2(&self) -> &[f64] {
        &self.within_mps2
    }

    /// Mean motion of the pushers.
    pub fn mean(&self) -> Pusher {
        let mean =
            |of: fn(&Pusher) -> f64| self.pushers().iter().map(of).sum::<f64>() / self.axes as f64;
        Pusher {
            place_m: mean(|pusher| pusher.place_m),
            accel_mps2: mean(|pusher| pusher.accel_mps2),
        }
    }

    /// Plays a tick in which the master travels `master_turns`. `command_turns` are the commanded positions of the axes at its end.
    pub fn play(&mut self, turned: &[Turned], master_turns: f64, command_turns: &[f64]) {
        if let Some(screws) = &mut self.screws {
            let mut turns = [0.0; MAX_AXES];
            for (turns, turned) in turns.iter_mut().zip(turned) {
                *turns = turned.to;
            }
            let (turns, pushers) = (&turns[..self.axes], &mut self.pushers[..self.axes]);
            let outcome = (pushers, &mut self.peaks[..self.axes]);
            screws.play(
                &self.cam,
                self.tick_s,
                master_turns,
                turns,
                command_turns,
                outcome,
            );
            self.within_mps2 = vec![self.mean().accel_mps2];
            return;
        }
        let samples = self
            .elastic
            .as_ref()
            .map_or(SAMPLES, |elastic| elastic.steps);
        self.within_mps2.clear();
        self.within_mps2.resize(samples as usize, 0.0);
        let share = 1.0 / self.axes as f64;
        let axes = self.pushers.iter_mut().zip(&mut self.peaks).enumerate();
        for ((axis, (pusher, peaks)), turned) in axes.zip(turned) {
            *peaks = Peaks::default();
            let mut observe = |at: u32, pusher: &Pusher| {
                self.within_mps2[at as usize] += share * pusher.accel_mps2;
            };
            match &mut self.elastic {
                None => (*pusher, *peaks) = by_law(&self.cam, turned, self.tick_s, &mut observe),
                Some(elastic) if elastic.broken.is_none() => {
                    match elastic.play(axis, turned, self.tick_s, &mut observe) {
                        Ok(played) => (*pusher, *peaks) = played,
                        Err(error) => elastic.broken = Some(error),
                    }
                }
                Some(_) => {}
            }
        }
    }
}

/// Plays a tick of a pusher that its law moves. `observe` receives it at each sample.
fn by_law(
    cam: &Cam,
    turned: &Turned,
    tick_s: f64,
    mut observe: impl FnMut(u32, &Pusher),
) -> (Pusher, Peaks) {
    let (mut pusher, mut peaks) = (Pusher::default(), Peaks::default());
    for sample in 1..=SAMPLES {
        let part = f64::from(sample) / f64::from(SAMPLES);
        let angle_rad = (turned.from + (turned.to - turned.from) * part) * std::f64::consts::TAU;
        let omega = turned.omega_rad_s - turned.acceleration_rad_s2 * tick_s * (1.0 - part);
        let law = cam.at_angle(angle_rad);
        pusher = Pusher {
            place_m: law.displacement,
            accel_mps2: law.acceleration * omega * omega
                + law.velocity * turned.acceleration_rad_s2,
        };
        observe(sample - 1, &pusher);
        peaks = peaks.or(Peaks {
            off_m: 0.0,
            pusher_mps2: pusher.accel_mps2.abs(),
            cam_side_mps2: pusher.accel_mps2.abs(),
            off_mps2: 0.0,
        });
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
    fn divergence_stops_the_followers_and_is_reported() {
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
        let mut followers = Followers {
            cam: Cam::wrapper(Law::ModifiedSine),
            elastic: Some(elastic),
            screws: None,
            pushers: [Pusher::default(); MAX_AXES],
            peaks: [Peaks::default(); MAX_AXES],
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
            followers.play(&[turned; 2], 0.0, &[]);
        }
        assert!(matches!(
            followers.broken(),
            Some(StepError::NotFinite { .. })
        ));
        assert!(followers.mean().place_m.is_finite());
    }
}
