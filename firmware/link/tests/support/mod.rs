//! Settings for encoding, and two slots in a flash whose power can be cut.

pub mod device;
pub mod line;
pub mod nor;
pub mod slots;

use cophase_core::axes::{CamSettings, FollowerSettings, MAX_CAM_POINTS, MAX_CAMS};
use cophase_core::mechanism::{CrankRockerSettings, MechanismSettings, SliderCrankSettings};
use cophase_core::program::{CAPACITY, EntrySettings, SegmentSettings, Shape};
use cophase_core::settings::Settings;
use cophase_core::settings::{
    AxisSettings, BandSettings, CorrectionSettings, Drift, DriveKind, HostLossSettings,
    IndexSettings, LimitSettings, MAX_BANDS, MachineSettings, NAME_BYTES, Platform,
    PlatformSettings, PulseSettings, Transmission, WiringSettings, short_name,
};
use cophase_core::units::MAX_AXES;
use cophase_link::board::{Board, Rp2040};

/// Valid settings, with `entries` in their program.
pub fn settings(axes: usize, bands: usize, entries: usize) -> Settings {
    Settings {
        index: IndexSettings { width_us: 2.0 },
        name: short_name("bench"),
        tick_hz: 2000,
        clock_hz: Rp2040::CLOCK_HZ,
        machine: MachineSettings::Platform(PlatformSettings {
            crank_radius_m: 0.02,
            mechanism: MechanismSettings::SliderCrank(SliderCrankSettings { lambda: 0.3 }),
            load_kg: 5.0,
            platform: Platform::Above,
            gravity_mps2: 9.80665,
            mount_radius_m: 0.25,
            allow_commanded_tilt: false,
        }),
        limits: LimitSettings {
            speed_hz: 20.0,
            acceleration_hz_per_s: 20.0,
            jerk_hz_per_s2: 200.0,
            stop_acceleration_hz_per_s: 40.0,
            stop_jerk_hz_per_s2: 400.0,
            homing_speed_hz: 1.0,
            bands: (0..bands)
                .map(|i| BandSettings {
                    from_hz: 3.0 + i as f64,
                    to_hz: 3.5 + i as f64,
                })
                .collect(),
        },
        pulse: PulseSettings {
            width_ns: 400.0,
            dir_setup_ns: 500.0,
            dir_hold_ns: 500.0,
        },
        axes: (0..axes)
            .map(|i| AxisSettings {
                drive: [DriveKind::Stepper, DriveKind::Servo][i % 2],
                reversed: i % 2 == 1,
                offset_turns: 0.1,
                index_turns: Some(-0.25),
                cycle_steps: 0,
                rotor_inertia_kgm2: 1e-4,
                ..AxisSettings::DEFAULT
            })
            .collect(),
        cams: Default::default(),
        trims_turns: (0..axes).map(|i| 1e-3 * i as f64).collect(),
        drift: Drift::DEFAULT,
        correction: CorrectionSettings::NONE,
        park_turns: 0.5,
        settle_s: 0.1,
        has_brake: false,
        wiring: WiringSettings::DEFAULT,
        host_loss: HostLossSettings::NONE,
        program: (0..entries)
            .map(|i| {
                EntrySettings::Segment(SegmentSettings {
                    amax_mps2: 10.0 + i as f64,
                    ramp_s: 1.0,
                    hold_s: 1.0 / 3.0,
                    shape: Shape::Smooth,
                })
            })
            .collect(),
    }
}

/// Settings with the longest encoding: full lists, and the greatest numbers of variable length.
pub fn longest() -> Settings {
    let mut longest = settings(MAX_AXES, MAX_BANDS, CAPACITY);
    longest.name = short_name(&"x".repeat(NAME_BYTES));
    longest.tick_hz = u32::MAX;
    longest.cams = core::iter::repeat_n(
        CamSettings {
            net_turns: i32::MIN,
            max_speed_hz: CamSettings::USUAL_MAX_SPEED_HZ,
            max_acceleration_hz_per_s: CamSettings::USUAL_MAX_ACCELERATION_HZ_PER_S,
            points_turns: [0.25; MAX_CAM_POINTS].into_iter().collect(),
        },
        MAX_CAMS,
    )
    .collect();
    if let MachineSettings::Platform(platform) = &mut longest.machine {
        // The mechanism with the most numbers.
        platform.mechanism = MechanismSettings::CrankRocker(CrankRockerSettings {
            crank: 0.45,
            coupler: 1.54,
            ground: 1.93,
        });
    }
    for axis in &mut longest.axes {
        axis.steps_per_turn = u32::MAX;
        axis.cycle_steps = u32::MAX;
        axis.gear = Transmission {
            motor_turns: u32::MAX,
            crank_turns: u32::MAX,
        };
        axis.follower = FollowerSettings::gear((u32::MAX, u32::MAX));
    }
    longest
}

/// Makes a controller of settings, and returns its error text.
pub fn check(settings: &Settings) -> Result<(), String> {
    settings
        .controller()
        .map(drop)
        .map_err(|error| error.to_string())
}
