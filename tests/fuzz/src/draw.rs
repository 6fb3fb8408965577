//! Machines and programs: any that settings accept, fast enough for the short cases.

use cophase_core::axes::{CamSettings, CamTableSettings, FollowerSettings};
use cophase_core::controller::Controller;
use cophase_core::mechanism::{
    Mechanism, MechanismSettings, ScotchYokeSettings, SliderCrankSettings,
};
use cophase_core::program::{EntrySettings, SegmentSettings, Shape};
use cophase_core::settings::{
    AxisSettings, BandSettings, CorrectionSettings, Drift, DriveKind, HostLossSettings,
    IndexSettings, LimitSettings, MachineSettings, Platform, PlatformSettings, PulseSettings,
    Settings, ShaftSettings, Transmission, WiringSettings,
};

use cophase_core::units::Turns;

use crate::Script;

/// The usual follower, sometimes a gear of another ratio, or the cam table at any shift.
fn follower(script: &mut Script<'_>) -> FollowerSettings {
    if !script.one_in(16) {
        return FollowerSettings::DIRECT;
    }
    let byte = script.byte();
    match byte % 4 {
        3 => FollowerSettings::CamTable(CamTableSettings {
            table: 0,
            shift_turns: f64::from(byte) / 256.0,
        }),
        more => FollowerSettings::gear((1 + u32::from(more), 2)),
    }
}

/// A turn in which the axis is at times faster than the master, and at times slower. It may have an index.
fn cam() -> CamSettings {
    let point = |i: u32| {
        let turn = f64::from(i) / 32.0;
        turn + 0.1 * (core::f64::consts::TAU * turn).sin()
    };
    CamSettings {
        net_turns: 1,
        max_speed_hz: CamSettings::USUAL_MAX_SPEED_HZ,
        max_acceleration_hz_per_s: CamSettings::USUAL_MAX_ACCELERATION_HZ_PER_S,
        points_turns: (0..32).map(point).collect(),
    }
}

/// Settings. A few of them are refused, which the caller must handle.
pub fn settings(count: usize, script: &mut Script<'_>) -> Settings {
    let tick_hz = [2000, 1000, 500, 2000, 5000, 10_000, 2000, 1000][script.below(8)];
    let speed_hz = script.between(4.0, 60.0);
    let acceleration_hz_per_s = script.between(20.0, 4000.0);
    let jerk_hz_per_s2 = acceleration_hz_per_s * script.between(10.0, 1000.0);
    let harder = if script.one_in(2) {
        1.0
    } else {
        script.between(1.0, 20.0)
    };
    let homing_speed_hz = script.between(2.0, 10.0).min(speed_hz);
    let banded = script.one_in(3) && 0.3 * speed_hz > homing_speed_hz;
    let band = banded.then_some(BandSettings {
        from_hz: 0.4 * speed_hz,
        to_hz: 0.6 * speed_hz,
    });
    let servos = script.byte();
    let kind = script.byte();
    let sensors = script.byte();
    let trim_limit_turns = script.between(1e-3, 0.1);
    let mut settings = Settings {
        name: heapless::String::new(),
        tick_hz,
        clock_hz: 125_000_000,
        machine: MachineSettings::Platform(PlatformSettings {
            crank_radius_m: 0.01,
            mechanism: if script.one_in(4) {
                MechanismSettings::ScotchYoke(ScotchYokeSettings {})
            } else {
                MechanismSettings::SliderCrank(SliderCrankSettings {
                    lambda: script.between(0.1, 0.6),
                })
            },
            load_kg: script.between(0.1, 20.0),
            platform: if script.one_in(2) {
                Platform::Above
            } else {
                Platform::Below
            },
            gravity_mps2: 9.80665,
            mount_radius_m: 0.25,
            allow_commanded_tilt: true,
        }),
        limits: LimitSettings {
            speed_hz,
            acceleration_hz_per_s,
            jerk_hz_per_s2,
            stop_acceleration_hz_per_s: acceleration_hz_per_s * harder,
            stop_jerk_hz_per_s2: jerk_hz_per_s2 * harder,
            homing_speed_hz,
            bands: band.into_iter().collect(),
        },
        pulse: PulseSettings {
            width_ns: 200.0,
            dir_setup_ns: 200.0,
            dir_hold_ns: 200.0,
        },
        index: IndexSettings { width_us: 2.0 },
        axes: (0..count)
            .map(|i| {
                let bit = |bits: u8| bits >> i & 1 == 1;
                let servo = match kind % 3 {
                    0 => false,
                    1 => true,
                    _ => bit(servos),
                };
                let steps_per_turn = if servo {
                    4096
                } else {
                    [800, 1600, 3200][script.below(3)]
                };
                AxisSettings {
                    drive: if servo {
                        DriveKind::Servo
                    } else {
                        DriveKind::Stepper
                    },
                    steps_per_turn,
                    gear: gear(script),
                    reversed: script.one_in(3),
                    follower: follower(script),
                    offset_turns: if script.one_in(4) {
                        script.between(0.01, 0.5)
                    } else {
                        0.0
                    },
                    // Every fourth machine lacks some index sensors.
                    index_turns: (!sensors.is_multiple_of(4) || bit(sensors >> 2)).then_some(0.125),
                    index_width_turns: 0.02,
                    index_delay_s: if script.one_in(4) { 1e-4 } else { 0.0 },
                    encoder: servo || script.one_in(3),
                    cycle_steps: if servo { 0 } else { steps_per_turn / 50 },
                    trim_limit_turns,
                    trim_rate_hz: script.between(0.01, 1.0),
                    rotor_inertia_kgm2: 1e-4,
                }
            })
            .collect(),
        cams: core::iter::once(cam()).collect(),
        trims_turns: heapless::Vec::new(),
        program: heapless::Vec::new(),
        drift: Drift {
            tilt_limit_mrad: script.between(0.1, 20.0),
            warp_limit_deg: script.between(1.0, 30.0),
            common_limit_deg: script.between(2.0, 90.0),
            reading_error_deg: script.between(0.05, 1.0),
            ..Drift::DEFAULT
        },
        correction: if script.one_in(3) {
            CorrectionSettings::NONE
        } else {
            CorrectionSettings {
                gain: if script.one_in(4) {
                    0.0
                } else {
                    script.between(0.05, 1.0)
                },
                prove_wiring: script.one_in(3),
                coupling: if script.one_in(2) {
                    script.between(0.01, 2.0)
                } else {
                    0.0
                },
                coupling_per_s: if script.one_in(2) {
                    script.between(0.1, 1000.0)
                } else {
                    0.0
                },
            }
        },
        park_turns: f64::from(script.byte()) / 256.0,
        has_brake: script.one_in(4),
        settle_s: if script.one_in(2) { 0.01 } else { 0.0 },
        wiring: WiringSettings::DEFAULT,
        host_loss: HostLossSettings::NONE,
    };
    let own_turns = |axis: &AxisSettings| axis.follower.key_of_own_turns().is_some();
    if settings.axes.iter().any(own_turns) {
        // Under a platform, each crank makes the master's own turns.
        settings.machine = MachineSettings::Shafts(ShaftSettings { length_m: 0.01 });
    }
    settings
}

/// The loop with a program of one to three levels.
pub fn controller(settings: &Settings, script: &mut Script<'_>) -> Option<Controller> {
    settings.check().ok()?;
    let mut settings = settings.clone();
    let top = Turns::from_num(settings.limits.speed_hz / f64::from(settings.tick_hz));
    let max = settings.mechanism().amax(top).to_num::<f64>();
    for _ in 0..=script.below(3) {
        let segment = SegmentSettings {
            amax_mps2: max * 0.98 * f64::from(script.byte()) / 255.0,
            ramp_s: f64::from(script.byte()) / 256.0,
            hold_s: f64::from(script.byte()) / 128.0,
            shape: if script.one_in(2) {
                Shape::Smooth
            } else {
                Shape::Linear
            },
        };
        settings
            .program
            .push(EntrySettings::Segment(segment))
            .ok()?;
    }
    settings.controller().ok()
}

/// Belt or gearbox of an axis, in most machines none.
fn gear(script: &mut Script<'_>) -> Transmission {
    if !script.one_in(4) {
        return Transmission::DIRECT;
    }
    let (motor_turns, crank_turns) = [(57, 11), (3, 1), (20, 36), (1000, 999)][script.below(4)];
    Transmission {
        motor_turns,
        crank_turns,
    }
}
