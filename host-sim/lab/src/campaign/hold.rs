//! Tilt after a stop, while the drives hold.
//!
//! The enable line decides whether the drives hold. The state that the controller reports does not.

use cophase_scene::file::{FaultAt, FaultName, Scene};
use host_sim::sim::Moment;

use super::bound;
use super::geometry::Geometry;

/// Largest growth of the tilt since a stop, and the time from which it counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hold {
    has_moved: bool,
    /// Tilt in the first tick in which all commands stand, mrad.
    at_rest_mrad: Option<f64>,
    /// Beginning of the first such tick, s since power-up.
    pub rest_s: Option<f64>,
    /// Largest increase of the tilt since that tick, mrad. None if the drives never held after a stop.
    pub growth_mrad: Option<f64>,
    /// Largest tilt since the fault with the drives on and outside a hold, mrad. The first tick of a hold counts.
    pub before_mrad: f64,
}

impl Hold {
    /// Takes in one tick since the fault. `stands` is true if no axis was commanded to move in it.
    pub fn tick(&mut self, moment: &Moment<'_>, stands: bool) {
        self.take(
            moment.drives_enabled,
            stands,
            moment.start_ns as f64 * 1e-9,
            |max_mrad| moment.raise_tilt(max_mrad),
            || moment.tilt_mrad().unwrap_or(0.0),
        );
    }

    /// Takes in one tick. `raise` raises a largest tilt to the present one if that is larger. In most ticks it need not compute the tilt.
    fn take(
        &mut self,
        enabled: bool,
        stands: bool,
        t_s: f64,
        raise: impl Fn(&mut f64),
        tilt_mrad: impl Fn() -> f64,
    ) {
        if !enabled || !stands {
            self.has_moved = enabled;
            self.at_rest_mrad = None;
        }
        if !enabled {
            return;
        }
        if self.at_rest_mrad.is_none() {
            raise(&mut self.before_mrad);
        }
        if !stands || !self.has_moved {
            return;
        }
        let tilt_mrad = tilt_mrad();
        let at_rest_mrad = *self.at_rest_mrad.get_or_insert(tilt_mrad);
        self.rest_s.get_or_insert(t_s);
        let growth_mrad = (tilt_mrad - at_rest_mrad).max(self.growth_mrad.unwrap_or(0.0));
        self.growth_mrad = Some(growth_mrad);
    }
}

/// Largest growth of the tilt that is allowed, mrad. It is the tilt of one crank that is off by the sum of three parts: two steps, the
/// angle by which its rotor may settle in its field where torque moves it, and the travel that the fault causes at rest, from `rest_s` on.
pub fn allowed_mrad(scene: &Scene, geometry: &Geometry, rest_s: f64) -> f64 {
    let steps_turns = 2.0 / scene.resolved(0).steps_per_crank_turn();
    let settling_turns = bound::torque_turns(scene);
    let fault_turns = scene
        .fault
        .first()
        .map_or(0.0, |fault| at_rest_turns(scene, geometry, fault, rest_s));
    geometry.worst_tilt_mrad(steps_turns + settling_turns + fault_turns)
}

/// Travel by which a fault moves a crank whose command stands still, turns. It is at most half a turn, the largest possible error of a
/// crank.
fn at_rest_turns(scene: &Scene, geometry: &Geometry, fault: &FaultAt, rest_s: f64) -> f64 {
    let left_s = fault
        .for_s
        .map(|for_s| (fault.at_s + for_s - rest_s).max(0.0));
    let axis = fault.axis.unwrap_or_default();
    let (rate_hz, until_off_turns) = match fault.kind {
        FaultName::Slip => (
            fault.rate_deg_per_s.unwrap_or_default() / 360.0,
            f64::INFINITY,
        ),
        FaultName::Runaway => (
            fault.speed_hz.unwrap_or_default(),
            runaway_turns(scene, Some(geometry), false),
        ),
        // A stuck stepper that is released at rest goes to the nearest pole of its field. That is half an electrical cycle, or two full
        // steps, at most.
        FaultName::Stuck if scene.resolved(axis).drive.kind().is_open_loop() => {
            let is_let_go = left_s.is_some_and(|left_s| left_s > 0.0);
            let motor_turns = scene.resolved(axis).gear.ratio();
            let pole_turns = 2.0 / f64::from(scene.axes.full_steps_per_turn) / motor_turns;
            return if is_let_go { pole_turns } else { 0.0 };
        }
        _ => return 0.0,
    };
    let turns = left_s.map_or(f64::INFINITY, |left_s| rate_hz.abs() * left_s);
    turns.min(until_off_turns).min(0.5)
}

/// Travel at rest after which the drive of an axis that moves by itself must be off, turns. It ends three ticks after the sensor shows the
/// motion. An encoder shows it once this crank alone takes the platform beyond a limit. The crank may come from the other side, so twice
/// that travel is allowed. An index shows it as the crank passes its flag, within one turn. A rotor that swings at its flag makes pulses as
/// well, so from there another turn is allowed.
pub fn runaway_turns(scene: &Scene, geometry: Option<&Geometry>, rests_at_flag: bool) -> f64 {
    let shown_turns = if scene.axes.encoder {
        2.0 * geometry.map_or(0.25, Geometry::single_limit_turns)
    } else {
        1.0 + f64::from(u8::from(rests_at_flag))
    };
    let ticks = super::DETECTION_TICKS as f64;
    let speeds = scene.fault.iter().filter_map(|fault| fault.speed_hz);
    let speed_hz = speeds.fold(0.0, |max: f64, speed| max.max(speed.abs()));
    shown_turns + ticks * speed_hz / f64::from(scene.control.tick_hz)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_scene::library;

    /// If this fails, growth counts while the machine moves or the drives are off, and every stop fails. Or it counts from the smallest
    /// tilt, or not at all, and a crank that slips away after the stop passes.
    #[test]
    fn tilt_growth_counts_from_rest_while_drives_hold() {
        let mut hold = Hold::default();
        let take = |hold: &mut Hold, enabled, stands, t_s, tilt_mrad: f64| {
            let raise = |max_mrad: &mut f64| *max_mrad = max_mrad.max(tilt_mrad);
            hold.take(enabled, stands, t_s, raise, || tilt_mrad);
        };
        // The machine stood still before the fault's stop, so no hold has begun.
        take(&mut hold, true, true, 0.0, 9.0);
        assert_eq!(hold.growth_mrad, None);
        take(&mut hold, true, false, 0.1, 5.0);
        take(&mut hold, true, true, 0.2, 1.0);
        take(&mut hold, true, true, 0.3, 0.5);
        assert_eq!((hold.growth_mrad, hold.rest_s), (Some(0.0), Some(0.2)));
        take(&mut hold, true, true, 0.4, 1.25);
        assert_eq!(hold.growth_mrad, Some(0.25));
        assert_eq!(hold.before_mrad, 9.0);
        take(&mut hold, false, true, 0.5, 8.0);
        take(&mut hold, false, true, 0.6, 8.0);
        assert_eq!(hold.growth_mrad, Some(0.25));
    }

    /// If this fails, the tilt during a hold is compared with a wrong allowance. A slip that continues at rest is travel of the fault, up
    /// to its end.
    #[test]
    fn a_fault_moves_a_crank_at_rest_until_it_is_over() {
        let slip = FaultAt {
            rate_deg_per_s: Some(-36.0),
            for_s: Some(0.5),
            ..FaultAt::new(1.0, FaultName::Slip)
        };
        let scene = library::find("default").unwrap().scene();
        let geometry = Geometry::new(&scene).unwrap();
        let turns = |fault: &FaultAt, rest_s| at_rest_turns(&scene, &geometry, fault, rest_s);
        assert!((turns(&slip, 1.2) - 0.03).abs() < 1e-12);
        assert_eq!(turns(&slip, 1.6), 0.0);
        let mut stuck = FaultAt::new(1.0, FaultName::Stuck);
        assert_eq!(turns(&stuck, 1.2), 0.0);
        stuck.for_s = Some(0.5);
        assert!(scene.resolved(0).drive.kind().is_open_loop());
        assert!((turns(&stuck, 1.2) - 3.6 / 360.0).abs() < 1e-12);
        assert_eq!(turns(&stuck, 1.6), 0.0);
    }

    /// If this fails, a runaway with an encoder is allowed half a turn, and a loop that ignores encoders during a hold passes. Or a runaway
    /// with an index alone is not allowed a turn, and no loop can pass. Three ticks of 0.5 ms at 6 rev/s are 0.009 turn.
    #[test]
    fn the_runaway_allowance_at_rest_depends_on_the_sensor() {
        let mut scene = library::find("default").unwrap().scene();
        scene.axes.count = 5;
        scene.control.tick_hz = 2000;
        let runaway = FaultAt {
            speed_hz: Some(-6.0),
            ..FaultAt::new(1.0, FaultName::Runaway)
        };
        scene.fault = vec![runaway];
        let geometry = Geometry::new(&scene).unwrap();
        let turns = |scene: &Scene, at_flag| runaway_turns(scene, Some(&geometry), at_flag);
        scene.axes.encoder = false;
        assert!((turns(&scene, false) - 1.009).abs() < 1e-12);
        assert!((turns(&scene, true) - 2.009).abs() < 1e-12);
        assert_eq!(at_rest_turns(&scene, &geometry, &runaway, 2.0), 0.5);
        scene.axes.encoder = true;
        let expected = 2.0 * geometry.single_limit_turns() + 0.009;
        assert!((turns(&scene, true) - expected).abs() < 1e-12);
        assert_eq!(at_rest_turns(&scene, &geometry, &runaway, 2.0), expected);
    }
}
