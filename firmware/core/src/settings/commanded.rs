//! Effect of commanded phases alone on a platform.
//!
//! Cranks under one platform turn in phase. An offset or a trim of its own sets a crank ahead of the others in every turn. The platform then
//! tilts and warps although every crank is where it is commanded to be, and the monitor, which compares cranks with their commands, sees
//! nothing. So such settings are refused, unless they say that they mean it ([`PlatformSettings::allow_commanded_tilt`]). Cranks whose turns
//! have other steps, or that lead by a part of a step, are also apart by what their commands are rounded to whole steps.
//!
//! *Tilt* is the slope of the plane closest to the N corners, at the worst phase of the turn. Corner i stands at θ = 2π i/N on a circle of
//! radius ρ, and is R Z(α + δᵢ) high: δᵢ is the lead of its crank, and Z the integral of the mechanism's slope over the crank angle. With
//! heights zᵢ the slope is |2/N Σ zᵢ (cos θ, sin θ)| / ρ. *Warp* is the largest distance of a lead from the plane closest to all leads.

use super::slots::slot_turns;
use super::{AxisSettings, PlatformSettings, Settings};
use crate::mechanism::{AnyMechanism, Mechanism};
use crate::problem::{Problem, SettingsError};
use crate::units::{MAX_AXES, PerAxis, Turns};
use core::f64::consts::TAU;

/// Angles of a turn at which the tilt is computed. The board computes it too, without an FPU, so they are few: heights between them follow
/// from slope and curvature at both ends, and the largest tilt from a parabola through three of them.
const ANGLES: u32 = 128;

/// Distance of two of them, 2³² to the turn.
const STEP: i64 = (1 << 32) / ANGLES as i64;

/// Greatest part of a limit by which rounding may exceed it.
const ROUNDING: f64 = 1e-4;

/// Stages of the trims on their way at which tilt and warp are computed, besides the first, if cranks have offsets, too. A trim is up to
/// 36°, so a crank is within 2.25° of a stage.
const STAGES: u32 = 8;

/// Slots by which cranks that move apart, one after the other, tilt and warp at most beyond the straight way. In both, the lead of N cranks
/// counts with factors whose magnitudes add up to √2 at most.
const SLOTS: f64 = core::f64::consts::SQRT_2;

impl Settings {
    /// Largest tilt over a turn of a platform whose cranks are where offsets and trims command them to be, mrad, also while the trims are on
    /// their way. Zero without a platform. The error is below 1e-4 of the tilt of one crank that is half a turn ahead. The settings must
    /// have been checked.
    #[cold]
    pub fn commanded_tilt_mrad(&self) -> f64 {
        let Some(platform) = self.machine.platform() else {
            return 0.0;
        };
        let by_steps =
            SLOTS * self.rounding_turns() * self.machine.tilt_mrad_per_turn(self.tick_hz);
        self.max_tilt_mrad(platform, &PerAxis::default()) + by_steps
    }

    /// Checks that commanded phases alone keep a platform within its limits, and that its cranks make the master's own turns.
    #[cold]
    pub(super) fn check_commanded(&self) -> Result<(), SettingsError> {
        let Some(platform) = self.machine.platform() else {
            return Ok(());
        };
        for (i, axis) in self.axes.iter().enumerate() {
            if let Some(key) = axis.follower.key_of_own_turns() {
                return Err(SettingsError::new(key, Problem::NotInPhase).on_entry(i));
            }
        }
        let Some((problem, axis)) = self.commanded_problem(platform, &PerAxis::default()) else {
            return Ok(());
        };
        let are_trimmed = self.trims_turns.iter().any(|turns| *turns != 0.0);
        let key = if self.are_offset() {
            "axes.offset_deg"
        } else if are_trimmed {
            "axes.trim_deg"
        } else {
            "axes.steps_per_turn"
        };
        Err(SettingsError::new(key, problem).on_entry(axis))
    }

    /// Returns true if a platform stays within its limits when its cranks are also moved apart by `levels`, turns. It does if it may be
    /// tilted by commands.
    #[cold]
    pub(crate) fn allows_apart(&self, levels: &PerAxis<Turns>) -> bool {
        let levels = levels.map(Turns::to_num::<f64>);
        self.machine
            .platform()
            .is_none_or(|platform| self.commanded_problem(platform, &levels).is_none())
    }

    /// Limit that commanded phases exceed, and the axis that is farthest off, with cranks that are also moved apart by `levels`, turns.
    #[cold]
    fn commanded_problem(
        &self,
        platform: &PlatformSettings,
        levels: &PerAxis<f64>,
    ) -> Option<(Problem, usize)> {
        if platform.allow_commanded_tilt {
            return None;
        }
        let stages = self.stages(levels).map(|leads| leads.warp_deg());
        let (warp_deg, axis) = stages
            .reduce(|farthest, stage| {
                if stage.0 > farthest.0 {
                    stage
                } else {
                    farthest
                }
            })
            .unwrap_or_default();
        // While cranks move apart, each waits for its slot.
        let moves = |turns: &f64| *turns != 0.0;
        let slot = if self.trims_turns.iter().any(moves) || levels.iter().any(moves) {
            slot_turns(self)
        } else {
            0.0
        };
        let ahead = SLOTS * (slot + self.rounding_turns());
        let warp_deg = if self.axes.len() > 3 {
            warp_deg + 360.0 * ahead
        } else {
            warp_deg
        };
        let tilt_mrad = self.max_tilt_mrad(platform, levels)
            + ahead * self.machine.tilt_mrad_per_turn(self.tick_hz);
        let limit_mrad = self.drift.tilt_limit_mrad;
        let limit_deg = self.drift.warp_limit_deg;
        let problem = if tilt_mrad > limit_mrad * (1.0 + ROUNDING) {
            Problem::CommandedTilt {
                tilt_mrad,
                limit_mrad,
            }
        } else if warp_deg > limit_deg * (1.0 + ROUNDING) {
            Problem::CommandedWarp {
                warp_deg,
                limit_deg,
            }
        } else {
            return None;
        };
        Some((problem, axis))
    }

    #[cold]
    fn max_tilt_mrad(&self, platform: &PlatformSettings, levels: &PerAxis<f64>) -> f64 {
        let mechanism = self.mechanism();
        self.stages(levels)
            .filter(|leads| !leads.are_equal()) // The usual case needs no integrals.
            .map(|leads| leads.tilt_mrad(platform, mechanism))
            .fold(0.0, f64::max)
    }

    /// Half the distance by which whole steps set cranks apart, turns: commands of the same phase make their steps at different times, if a
    /// turn has other steps on one axis, or if a crank leads by a part of a step.
    #[cold]
    fn rounding_turns(&self) -> f64 {
        let steps = |axis: &AxisSettings| axis.steps_per_crank_turn();
        let are_alike = self.axes.windows(2).all(|pair| {
            let steps_ahead =
                (pair[1].offset_turns - pair[0].offset_turns) * steps(&pair[0]).to_f64();
            steps(&pair[0]) == steps(&pair[1])
                && (steps_ahead - libm::round(steps_ahead)).abs() < ROUNDING
        });
        let max = self.axes.iter().map(|axis| steps(axis).turns_of(1.0));
        if are_alike {
            0.0
        } else {
            0.5 * max.fold(0.0, f64::max)
        }
    }

    #[cold]
    fn are_offset(&self) -> bool {
        self.axes
            .windows(2)
            .any(|pair| pair[0].offset_turns != pair[1].offset_turns)
    }

    /// Commanded leads while the trims move in, all at the same part of their way at a time. Without offsets, the last stage is the worst.
    #[cold]
    fn stages(&self, levels: &PerAxis<f64>) -> impl Iterator<Item = Leads> {
        let trims = &self.trims_turns;
        let are_trimmed = trims.windows(2).any(|pair| pair[0] != pair[1]);
        let first = if are_trimmed && self.are_offset() {
            0
        } else {
            STAGES
        };
        (first..=STAGES).map(move |stage| {
            let part = f64::from(stage) / f64::from(STAGES);
            Leads::new(self.axes.len(), |i| {
                let offset = self.axes.get(i).map_or(0.0, |axis| axis.offset_turns);
                let level = levels.get(i).copied().unwrap_or(0.0);
                offset + part * trims.get(i).copied().unwrap_or(0.0) + level
            })
        })
    }
}

/// Commanded lead of each crank over crank 0, turns, from −½ to ½.
struct Leads {
    turns: PerAxis<f64>,
    count: usize,
}

impl Leads {
    #[cold]
    fn new(count: usize, lead: impl Fn(usize) -> f64) -> Self {
        let first = lead(0);
        Self {
            turns: core::array::from_fn(|i| {
                let ahead = lead(i) - first;
                ahead - libm::round(ahead)
            }),
            count: count.min(MAX_AXES),
        }
    }

    #[cold]
    fn of_cranks(&self) -> impl Iterator<Item = f64> {
        self.turns.iter().take(self.count).copied()
    }

    #[cold]
    fn are_equal(&self) -> bool {
        self.of_cranks().all(|lead| lead == 0.0)
    }

    /// Cosine and sine of each crank's place on the mount circle. Two cranks tilt the platform in one direction only.
    #[cold]
    fn places(&self) -> PerAxis<(f64, f64)> {
        core::array::from_fn(|i| {
            let theta = TAU * i as f64 / self.count.max(1) as f64;
            let sine = if self.count == 2 {
                0.0
            } else {
                libm::sin(theta)
            };
            (libm::cos(theta), sine)
        })
    }

    /// Slopes of the plane closest to a value at each crank, per mount radius.
    #[cold]
    fn slopes(
        &self,
        places: &PerAxis<(f64, f64)>,
        values: impl Iterator<Item = f64>,
    ) -> (f64, f64) {
        let part = if self.count == 2 { 1.0 } else { 2.0 } / self.count as f64;
        let each = values.zip(places).take(self.count);
        let (x, y) = each.fold((0.0, 0.0), |(x, y), (value, (cosine, sine))| {
            (x + value * cosine, y + value * sine)
        });
        (part * x, part * y)
    }

    /// Largest distance of a lead from the plane of all, degrees, and its axis. Three cranks are always in a plane.
    #[cold]
    fn warp_deg(&self) -> (f64, usize) {
        let mean = self.of_cranks().sum::<f64>() / self.count.max(1) as f64;
        let places = self.places();
        let (x, y) = self.slopes(&places, self.of_cranks());
        let flat = self.count <= 3;
        let mut farthest = (0.0, 0);
        for (i, (lead, (cosine, sine))) in self.of_cranks().zip(places).enumerate() {
            let plane = if flat { 0.0 } else { x * cosine + y * sine };
            let off = (lead - mean - plane).abs();
            if off > farthest.0 {
                farthest = (off, i);
            }
        }
        let (off, axis) = farthest;
        (if flat { 0.0 } else { off * 360.0 }, axis)
    }

    /// Largest tilt of a platform over a turn, mrad.
    #[cold]
    fn tilt_mrad(&self, platform: &PlatformSettings, mechanism: AnyMechanism) -> f64 {
        let places = self.places();
        let mut corners = self.turns.map(|lead| Corner::ahead(mechanism, lead));
        let mut max = 0.0_f64;
        let [mut first, mut second] = [0.0; 2];
        // Three squared tilts in a row have each angle of a turn in their middle.
        for k in 0..ANGLES + 2 {
            let heights = corners.iter().map(|corner| corner.height);
            let (x, y) = self.slopes(&places, heights);
            let third = x * x + y * y;
            if k >= 2 && second >= first && second >= third {
                let bend = 2.0 * second - first - third;
                let rise = if bend > 0.0 {
                    (first - third) * (first - third) / (8.0 * bend)
                } else {
                    0.0
                };
                max = max.max(second + rise);
            }
            (first, second) = (second, third);
            for corner in corners.iter_mut().take(self.count) {
                corner.turn(mechanism, STEP);
            }
        }
        1e3 * libm::sqrt(max) * platform.crank_radius_m / platform.mount_radius_m
    }
}

/// Corner of a platform on its crank.
struct Corner {
    /// Angle of the crank, 2³² to the turn.
    angle: u32,
    /// Height over that at angle 0, per crank radius.
    height: f64,
    /// Slope and curvature of the mechanism at this angle.
    slope: f64,
    curvature: f64,
}

impl Corner {
    /// Corner on a crank that is at most half a turn ahead of the master at phase 0, or behind.
    #[cold]
    fn ahead(mechanism: AnyMechanism, turns: f64) -> Self {
        let mut corner = Self {
            angle: 0,
            height: 0.0,
            slope: 0.0,
            curvature: 0.0,
        };
        corner.turn(mechanism, 0);
        let mut rest = (turns * 4_294_967_296.0) as i64;
        while rest != 0 {
            let by = rest.clamp(-STEP, STEP);
            corner.turn(mechanism, by);
            rest -= by;
        }
        corner
    }

    /// Turns the crank by an angle, 2³² to the turn. The height is the integral of the cubic that has slope and curvature of both ends
    /// (Hermite).
    #[cold]
    fn turn(&mut self, mechanism: AnyMechanism, by: i64) {
        self.angle = self.angle.wrapping_add(by as u32);
        let now = mechanism.kinematics(self.angle);
        let [slope, curvature] =
            [now.slope, now.curvature].map(|value| f64::from(value) / f64::from(1 << 30));
        let angle = by as f64 * (TAU / 4_294_967_296.0);
        self.height +=
            angle * (0.5 * (self.slope + slope) + angle / 12.0 * (self.curvature - curvature));
        (self.slope, self.curvature) = (slope, curvature);
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample::{platform, settings};
    use super::super::{FollowerSettings, MachineSettings, ShaftSettings};
    use super::*;
    use crate::axes::{CamSettings, CamTableSettings};
    use proptest::prelude::*;
    use std::string::{String, ToString};

    fn refused(settings: &Settings) -> Option<String> {
        settings.check().err().map(|error| error.to_string())
    }

    fn with_offsets(offsets_deg: &[f64]) -> Settings {
        let mut settings = settings(offsets_deg.len());
        for (axis, offset_deg) in settings.axes.iter_mut().zip(offsets_deg) {
            axis.offset_turns = offset_deg / 360.0;
        }
        settings
    }

    /// If this fails, a machine is set up whose platform tilts far beyond its limit in every turn, without a fault.
    #[test]
    fn cranks_that_are_commanded_apart_are_refused() {
        for offsets_deg in [
            &[0.0, 72.0, 144.0, -144.0, -72.0][..],
            &[0.0, 120.0, -120.0],
            &[0.0, 180.0],
            &[0.0, 0.0, 0.0, 6.0],
        ] {
            let mut apart = with_offsets(offsets_deg);
            let said = refused(&apart).expect("they tilt the platform");
            assert!(said.starts_with("axes.offset_deg (number "), "{said}");
            assert!(said.contains("tilt the platform by up to"), "{said}");
            platform(&mut apart).allow_commanded_tilt = true;
            assert_eq!(refused(&apart), None);
            apart.machine = MachineSettings::Shafts(ShaftSettings { length_m: 0.02 });
            assert_eq!(refused(&apart), None, "shafts tilt nothing");
        }
        let mut trimmed = settings(3);
        trimmed.trims_turns = heapless::Vec::from_array([0.0, 0.0, 0.0138]);
        let said = refused(&trimmed).expect("it tilts the platform");
        assert!(said.starts_with("axes.trim_deg (number 2)"), "{said}");
    }

    /// If this fails, four cranks of which opposite ones lead bend rods and platform, although nothing tilts.
    #[test]
    fn cranks_that_are_commanded_off_a_plane_are_refused() {
        let said = refused(&with_offsets(&[4.0, -4.0, 4.0, -4.0])).expect("a warp");
        assert!(said.contains("4.08° off the plane"), "{said}");
        assert_eq!(refused(&with_offsets(&[2.9, -2.9, 2.9, -2.9])), None);
    }

    /// If this fails, a platform is accepted that tilts until its trims have moved in.
    #[test]
    fn trims_that_undo_offsets_are_refused_too() {
        let mut undone = with_offsets(&[0.0, 0.0, 5.0]);
        undone.trims_turns = heapless::Vec::from_array([0.0, 0.0, -5.0 / 360.0]);
        let said = refused(&undone).expect("it tilts before the trim is there");
        assert!(said.starts_with("axes.offset_deg (number 2)"), "{said}");
    }

    /// If this fails, a platform is accepted that tilts beyond its limit when the proof of the wiring tilts it further.
    #[test]
    fn the_proof_of_the_wiring_has_the_rest_of_the_limit() {
        let proving = |offset_deg: f64| {
            let mut proving = with_offsets(&[0.0, 0.0, offset_deg]);
            proving.correction.prove_wiring = true;
            proving.controller().err().map(|error| error.to_string())
        };
        assert_eq!(proving(0.0), None);
        let said = proving(2.9).expect("it tilts by 2.8 mrad and more");
        assert!(said.starts_with("correction.prove_wiring: "), "{said}");
    }

    /// If this fails, a platform is accepted that tilts in each turn as one crank makes coarser steps than the others.
    #[test]
    fn cranks_with_coarser_steps_are_refused() {
        let mut coarse = settings(3);
        coarse.axes[1].steps_per_turn = 40;
        let said = refused(&coarse).expect("a step of 9 degrees");
        assert!(said.starts_with("axes.steps_per_turn"), "{said}");
        coarse.axes[1].steps_per_turn = 20_000;
        assert_eq!(refused(&coarse), None);
    }

    /// If this fails, machines in phase are refused, or trims that level a platform.
    #[test]
    fn cranks_in_phase_are_accepted() {
        for count in 1..=MAX_AXES {
            for offset_deg in [0.0, 17.0, 180.0] {
                assert_eq!(
                    refused(&with_offsets(&[offset_deg; MAX_AXES][..count])),
                    None
                );
            }
        }
        // Half a turn ahead is half a turn behind.
        assert_eq!(refused(&with_offsets(&[180.0, -180.0, 180.0])), None);
        assert_eq!(refused(&with_offsets(&[0.0, 1.0, -1.0])), None);
    }

    /// If this fails, one crank of a platform turns otherwise than the rest, and the platform accelerates otherwise than the program says.
    #[test]
    fn cranks_with_turns_of_their_own_are_refused() {
        for (numbers, is_direct) in [
            ((1, 1), true),
            ((3, 3), true),
            ((36, 20), false),
            ((1, 2), false),
        ] {
            let mut geared = settings(3);
            geared.axes[1].follower = FollowerSettings::gear(numbers);
            let said = refused(&geared);
            assert_eq!(said.is_none(), is_direct, "{said:?}");
            if let Some(said) = said {
                assert!(said.starts_with("axes.ratio (number 1): "), "{said}");
                assert!(said.contains("gear = [motor turns, crank turns]"), "{said}");
                platform(&mut geared).allow_commanded_tilt = true;
                assert!(
                    refused(&geared).is_some(),
                    "its amplitude is wrong all the same"
                );
            }
        }
        let mut on_cam = settings(2);
        on_cam.cams = core::iter::once(CamSettings {
            net_turns: 1,
            max_speed_hz: CamSettings::USUAL_MAX_SPEED_HZ,
            max_acceleration_hz_per_s: CamSettings::USUAL_MAX_ACCELERATION_HZ_PER_S,
            points_turns: [0.0, 0.25, 0.5, 0.75].into_iter().collect(),
        })
        .collect();
        on_cam.axes[1].follower = FollowerSettings::CamTable(CamTableSettings {
            table: 0,
            shift_turns: 0.0,
        });
        assert!(
            refused(&on_cam)
                .expect("a table")
                .starts_with("axes.cam (number 1)")
        );
    }

    proptest! {
        /// The tilt by the positions of slider-cranks, at a thousand angles. If this fails, a tilt is computed wrongly.
        #[test]
        fn tilt_agrees_with_the_heights_of_slider_cranks(
            leads in prop::collection::vec(-0.5..0.5_f64, 2..=MAX_AXES),
            lambda in 0.1..0.6_f64,
        ) {
            let mut settings = with_offsets(&[0.0; MAX_AXES][..leads.len()]);
            for (axis, lead) in settings.axes.iter_mut().zip(&leads) {
                axis.offset_turns = *lead;
            }
            let own = platform(&mut settings);
            own.mechanism = crate::mechanism::MechanismSettings::SliderCrank(
                crate::mechanism::SliderCrankSettings { lambda },
            );
            let (radius, mount) = (own.crank_radius_m, own.mount_radius_m);
            let own = *own;
            let actual = Leads::new(leads.len(), |i| leads.get(i).copied().unwrap_or(0.0))
                .tilt_mrad(&own, settings.mechanism());
            let mut max = 0.0_f64;
            for angle in 0..1000 {
                let (mut x, mut y) = (0.0, 0.0);
                for (i, lead) in leads.iter().enumerate() {
                    let alpha = TAU * (f64::from(angle) / 1000.0 + lead);
                    let height = radius * alpha.cos()
                        + ((radius / lambda).powi(2) - (radius * alpha.sin()).powi(2)).sqrt();
                    let theta = TAU * i as f64 / leads.len() as f64;
                    x += height * theta.cos();
                    y += height * theta.sin();
                }
                let part = if leads.len() == 2 { 0.5 } else { 2.0 / leads.len() as f64 };
                if leads.len() == 2 { y = 0.0; }
                max = max.max(part * x.hypot(y) / mount * 1e3);
            }
            prop_assert!((actual - max).abs() < 1e-4 * (80.0 + max), "{actual} {max}");
        }
    }
}
