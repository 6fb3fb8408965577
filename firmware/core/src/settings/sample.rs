//! Settings of a typical machine, which tests modify.

use super::*;
use crate::mechanism::{MechanismSettings, SliderCrankSettings};
use crate::program::{SegmentSettings, Shape};

/// A segment that lasts 3 s in total.
pub(crate) const LEVEL: SegmentSettings = SegmentSettings {
    amax_mps2: 100.0,
    ramp_s: 1.0,
    hold_s: 2.0,
    shape: Shape::Smooth,
};

/// A machine of `axes` steppers with index sensors, 2 kHz, whose program plays [`LEVEL`] three times.
pub(crate) fn settings(axes: usize) -> Settings {
    Settings {
        name: short_name("bench"),
        tick_hz: 2000,
        clock_hz: 125_000_000,
        machine: MachineSettings::Platform(PlatformSettings {
            crank_radius_m: 0.02,
            mechanism: MechanismSettings::SliderCrank(SliderCrankSettings { lambda: 0.3 }),
            load_kg: 10.0,
            platform: Platform::Above,
            gravity_mps2: 9.80665,
            mount_radius_m: 0.25,
            allow_commanded_tilt: false,
        }),
        limits: LimitSettings {
            speed_hz: 20.0,
            acceleration_hz_per_s: 20.0,
            jerk_hz_per_s2: 200.0,
            stop_acceleration_hz_per_s: 20.0,
            stop_jerk_hz_per_s2: 200.0,
            homing_speed_hz: 1.0,
            bands: heapless::Vec::new(),
        },
        pulse: PulseSettings::DEFAULT,
        index: IndexSettings::DEFAULT,
        axes: core::iter::repeat_n(AxisSettings::DEFAULT, axes).collect(),
        cams: heapless::Vec::new(),
        trims_turns: heapless::Vec::new(),
        drift: Drift::DEFAULT,
        correction: CorrectionSettings::NONE,
        park_turns: 0.5,
        settle_s: 0.1,
        has_brake: false,
        wiring: WiringSettings::DEFAULT,
        host_loss: HostLossSettings::NONE,
        program: heapless::Vec::from_array([
            EntrySettings::Segment(LEVEL),
            EntrySettings::Repeat { first: 0, times: 3 },
        ]),
    }
}

/// Platform of settings that have one.
pub(crate) fn platform(settings: &mut Settings) -> &mut PlatformSettings {
    match &mut settings.machine {
        MachineSettings::Platform(platform) => platform,
        MachineSettings::Shafts(_) => panic!("these settings have shafts"),
    }
}
