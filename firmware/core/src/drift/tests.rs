//! The monitor against cranks whose errors are known.

use super::*;
use crate::settings::{DriftSettings, MachineSettings, Platform};

const TICK_CYCLES: u32 = 62_500;

fn machine() -> MachineSettings {
    MachineSettings {
        crank_radius_m: 0.02,
        lambda: 0.3,
        load_kg: 10.0,
        platform: Platform::Above,
        gravity_mps2: 9.80665,
        mount_radius_m: 0.25,
    }
}

fn monitor<const N: usize>(tilt_mrad: f64, warp_deg: f64, common_deg: f64) -> DriftMonitor<N> {
    let settings = DriftSettings {
        tilt_limit_mrad: tilt_mrad,
        warp_limit_deg: warp_deg,
        common_limit_deg: common_deg,
        reading_deg: 0.25,
        lag_s: 0.0,
    };
    DriftMonitor::new(
        DriftLimits::new(&settings, &machine()),
        [Some(Turns::ZERO); N],
        TICK_CYCLES,
    )
}

/// Turns cranks that lag or lead by `errors` (turns) at `speed` (turns a tick) for `ticks`; the first
/// fault, with the tick.
fn turn<const N: usize>(
    monitor: &mut DriftMonitor<N>,
    errors: [f64; N],
    speed: f64,
    ticks: u32,
    dead: Option<usize>,
) -> Option<(u32, Fault)> {
    for tick in 0..ticks {
        // The end is the next tick's start to the last bit, or a passage could fall between the two.
        let (start, end) = (f64::from(tick) * speed, f64::from(tick + 1) * speed);
        let commanded = TickPhase {
            start: Phase::from_turns(Turns::wrapping_from_num(start)),
            turns: Turns::from_num(speed),
        };
        let pulses = core::array::from_fn(|i| {
            let (from, to) = (start + errors[i], end + errors[i]);
            let passes = to.floor() > from.floor() && dead != Some(i);
            passes.then(|| IndexPulse {
                cycle: ((to.floor() - from) / speed * f64::from(TICK_CYCLES)) as i32,
            })
        });
        if let Err(fault) = monitor.observe(&pulses, &[commanded; N].each_ref()) {
            return Some((tick, fault));
        }
    }
    None
}

/// Were the interpolation inside the tick wrong, drift would follow the speed, a tick's worth of it.
#[test]
fn drift_is_measured_to_a_cycle_at_any_speed() {
    for speed in [0.0005, 0.013, 0.1, 0.4] {
        let mut monitor = monitor::<4>(100.0, 90.0, 180.0);
        let errors = [0.01, -0.02, 0.003, 0.0];
        let ticks = (3.0 / speed) as u32;
        assert_eq!(turn(&mut monitor, errors, speed, ticks, None), None);
        assert!(monitor.is_aligned());
        for (got, want) in monitor.drift().iter().zip(errors) {
            let error = got.to_num::<f64>() - want;
            // The pulse's own cycle, rounded down, and the interpolation's 24 bits.
            let bound = speed / f64::from(TICK_CYCLES) + speed * (-24.0_f64).exp2() + 1e-11;
            assert!(error.abs() < bound, "{error:e} at {speed} turns a tick");
        }
    }
}

/// A tilt limit in mrad is met at the amplitude that geometry gives, neither before nor after.
#[test]
fn tilt_trips_at_its_limit() {
    // mode 1 of one axis in three that is off by e is 2/3 e; max s(α) at λ = 0.3 by fine search.
    let most_way = (0..100_000)
        .map(|i| {
            let alpha = f64::from(i) * core::f64::consts::PI / 100_000.0;
            let (sin, cos) = alpha.sin_cos();
            sin + 0.3 * sin * cos / (1.0 - 0.09 * sin * sin).sqrt()
        })
        .fold(0.0, f64::max);
    let limit_mrad = 3.0;
    let amplitude = limit_mrad * 1e-3 * 0.25 / 0.02 / most_way / core::f64::consts::TAU;
    for (part, trips) in [(0.99, false), (1.01, true)] {
        let mut monitor = monitor::<3>(limit_mrad, 90.0, 180.0);
        let error = -1.5 * amplitude * part;
        let fault = turn(&mut monitor, [0.0, 0.0, error], 0.01, 300, None);
        assert_eq!(fault.is_some(), trips, "at {part} of the limit");
        if let Some((tick, fault)) = fault {
            assert_eq!((fault.kind, fault.axis), (FaultKind::Tilt, Some(2)));
            assert!(
                tick <= 102,
                "a turn and two ticks after the first pulse that shows it"
            );
        }
    }
}

#[test]
fn warp_and_common_lag_have_limits_of_their_own() {
    let bent = [0.02, -0.02, 0.02, -0.02]; // no tilt, no mean
    let fault = turn(&mut monitor::<4>(3.0, 5.0, 15.0), bent, 0.01, 300, None);
    assert_eq!(fault.map(|(_, fault)| fault.kind), Some(FaultKind::Warp));
    let late = [-0.05; 4];
    let fault = turn(&mut monitor::<4>(3.0, 5.0, 15.0), late, 0.01, 300, None);
    assert_eq!(
        fault.map(|(_, fault)| fault.kind),
        Some(FaultKind::CommonLag)
    );
    assert_eq!(
        turn(&mut monitor::<4>(3.0, 5.0, 19.0), late, 0.01, 300, None),
        None
    );
}

/// All lag alike, and pulses of one turn fall into two ticks: comparing new with old would show a tilt
/// that never was.
#[test]
fn a_lag_in_common_is_not_taken_for_tilt() {
    let mut monitor = monitor::<4>(0.05, 0.05, 180.0);
    for lag in 0..50 {
        // Each turn a little later, so that the pulses wander across the ticks' borders.
        let lag = -0.0037 * f64::from(lag);
        assert_eq!(
            turn(
                &mut monitor,
                [lag, lag - 1e-6, lag + 1e-6, lag],
                0.01,
                250,
                None
            ),
            None
        );
    }
}

#[test]
fn a_sensor_that_stays_silent_is_missed_within_its_turn() {
    let mut monitor = monitor::<4>(3.0, 5.0, 15.0);
    let (tick, fault) = turn(&mut monitor, [0.0; 4], 0.01, 1000, Some(3)).expect("a fault");
    assert_eq!((fault.kind, fault.axis), (FaultKind::IndexMissing, Some(3)));
    assert!(tick <= 107, "found after {tick} ticks of 0.01 turn");
    assert!(!monitor.is_aligned());
}

/// A pulse that is confirmed a tick later belongs to the speed of its own tick. Were it reckoned from the
/// later one's, 2000 rev/s² would make 0.018° of 50 µs. One cycle at 200 rev/s is 0.0006°.
#[test]
fn a_pulse_of_the_tick_before_is_measured_as_well() {
    let tick_s = f64::from(TICK_CYCLES) / f64::from(crate::settings::CLOCK_HZ);
    let error = [0.01, -0.02, 0.003, 0.0];
    for (hz_per_s, back_s) in [(2000.0, 50e-6), (-2000.0, 50e-6), (2000.0, 2e-6)] {
        let mut monitor = monitor::<4>(100.0, 90.0, 180.0);
        let back = (back_s * f64::from(crate::settings::CLOCK_HZ)) as u32;
        // Speed is constant within a tick, by definition; the phase at the border is near the index.
        let before = (200.0 - hz_per_s * tick_s) * tick_s;
        let now = 200.0 * tick_s;
        let pulse_at = 1.0 - before * f64::from(back) / f64::from(TICK_CYCLES);
        for (sensor, error) in monitor.sensors.iter_mut().zip(error) {
            sensor.index = Some(Turns::from_num(pulse_at - 1.0 + error));
        }
        let tick = |start: f64, turns: f64| TickPhase {
            start: Phase::from_turns(Turns::from_num(start)),
            turns: Turns::from_num(turns),
        };
        let pulse = Some(IndexPulse {
            cycle: -(back as i32),
        });
        monitor
            .observe(&[None; 4], &[tick(1.0 - before, before); 4].each_ref())
            .unwrap();
        monitor
            .observe(&[pulse; 4], &[tick(1.0, now); 4].each_ref())
            .unwrap();
        for (got, want) in monitor.drift().iter().zip(error) {
            let off_deg = (got.to_num::<f64>() - want) * 360.0;
            assert!(off_deg.abs() < 0.0006, "{off_deg}° at {hz_per_s} rev/s²");
        }
    }
}

/// After missed deadlines nobody knows the tick before: a pulse in it shows that its sensor is alive, and
/// no more.
#[test]
fn a_pulse_of_a_tick_that_is_not_known_is_not_measured() {
    let mut monitor = monitor::<2>(100.0, 90.0, 180.0);
    let still = [TickPhase::default(); 2];
    monitor.observe(&[None; 2], &still.each_ref()).unwrap();
    monitor.disregard(&[None; 2]);
    let pulse = Some(IndexPulse { cycle: -1 });
    monitor.observe(&[pulse; 2], &still.each_ref()).unwrap();
    assert!(!monitor.is_aligned());
    monitor.observe(&[pulse; 2], &still.each_ref()).unwrap();
    assert!(monitor.is_aligned());
}

/// A sensor that bounces at every other passage, at 0.4 turns a tick: three widths or one until a pulse is
/// confirmed, the width a quarter of a tick. A pulse that waits is not a missing one.
#[test]
fn pulses_that_wait_to_be_confirmed_are_not_missed() {
    let mut monitor = monitor::<2>(100.0, 90.0, 1.0);
    let tick_cycles = f64::from(TICK_CYCLES);
    let turns = 0.3987; // so that passages fall anywhere in a tick
    let mut waiting = None;
    for tick in 0..1000 {
        let (start, end) = (f64::from(tick) * turns, f64::from(tick + 1) * turns);
        let mut told = None;
        if end.floor() > start.floor() {
            let widths = if end.floor() % 2.0 == 0.0 { 3.0 } else { 1.0 };
            let cycle = (end.floor() - start) / turns * tick_cycles;
            if cycle + widths * 0.25 * tick_cycles <= tick_cycles {
                told = Some(cycle);
            } else {
                waiting = Some(cycle);
            }
        } else {
            told = waiting.take().map(|cycle| cycle - tick_cycles);
        }
        let pulse = told.map(|cycle| IndexPulse {
            cycle: cycle as i32,
        });
        let phase = TickPhase {
            start: Phase::from_turns(Turns::wrapping_from_num(start)),
            turns: Turns::from_num(turns),
        };
        assert_eq!(
            monitor.observe(&[pulse; 2], &[phase; 2].each_ref()),
            Ok(()),
            "tick {tick}"
        );
    }
    assert!(monitor.is_aligned());
}
