//! Conversion of a scene into the core's settings: units, and the values of `[axes]` and `[[axis]]` for each
//! axis.

use cophase_core::axes::{CamSettings, MAX_CAMS};
use cophase_core::program::{CAPACITY, EntrySettings};
use cophase_core::settings::{
    AxisSettings, BandSettings, CorrectionSettings, LimitSettings, MAX_BANDS, MachineSettings,
    Settings, short_name,
};
use cophase_link::board::{Board, Rp2040};
use cophase_scene::file::{Limits, Scene};

use super::cam_table;

/// Returns the core's settings of a scene, with its converted mechanism. Axes, bands and program entries beyond the
/// capacity are left out; an earlier check refuses them.
pub(super) fn settings(
    scene: &Scene,
    machine: MachineSettings,
    correction: CorrectionSettings,
    cams: heapless::Vec<CamSettings, MAX_CAMS>,
    program: impl IntoIterator<Item = EntrySettings>,
) -> Settings {
    let numbers = 0..scene.axes.count;
    Settings {
        name: short_name(&scene.name),
        tick_hz: scene.control.tick_hz,
        clock_hz: Rp2040::CLOCK_HZ, // The board that scenes are simulated for.
        machine,
        limits: limits(&scene.limits),
        pulse: scene.pulse,
        index: scene.index,
        axes: numbers.clone().map(|i| axis(scene, i)).collect(),
        cams,
        trims_turns: numbers
            .map(|i| scene.resolved(i).own.trim_deg / 360.0)
            .collect(),
        drift: scene.drift,
        correction,
        park_turns: scene.control.park_deg / 360.0,
        settle_s: scene.control.settle_s,
        has_brake: scene.axes.brake,
        wiring: scene.wiring.settings(),
        host_loss: scene.link.settings(),
        program: program.into_iter().take(CAPACITY).collect(),
    }
}

/// Returns the limits of the master shaft.
pub(super) fn limits(limits: &Limits) -> LimitSettings {
    let bands = limits.band.iter().take(MAX_BANDS);
    LimitSettings {
        speed_hz: limits.speed_hz,
        acceleration_hz_per_s: limits.acceleration_hz_per_s,
        jerk_hz_per_s2: limits.jerk_hz_per_s2,
        stop_acceleration_hz_per_s: limits
            .stop_acceleration_hz_per_s
            .unwrap_or(limits.acceleration_hz_per_s),
        stop_jerk_hz_per_s2: limits.stop_jerk_hz_per_s2.unwrap_or(limits.jerk_hz_per_s2),
        homing_speed_hz: limits.homing_speed_hz,
        bands: bands
            .map(|band| BandSettings {
                from_hz: band.from_hz,
                to_hz: band.to_hz,
            })
            .collect(),
    }
}

/// Returns the settings of an axis.
fn axis(scene: &Scene, number: usize) -> AxisSettings {
    let common = &scene.axes;
    let axis = scene.resolved(number);
    let drive = axis.drive.kind();
    AxisSettings {
        drive,
        steps_per_turn: axis.steps_per_turn,
        gear: axis.gear,
        reversed: axis.own.reversed,
        follower: cam_table::follower(scene, &axis),
        offset_turns: axis.offset_deg / 360.0,
        index_turns: axis.index_deg.map(|index_deg| index_deg / 360.0),
        index_width_turns: common.index_width_deg / 360.0,
        index_delay_s: common.index_delay_us * 1e-6,
        encoder: common.encoder,
        cycle_steps: if drive.is_open_loop() {
            cycle_steps(axis.steps_per_turn, common.full_steps_per_turn)
        } else {
            0
        },
        trim_limit_turns: common.trim_limit_deg / 360.0,
        trim_rate_hz: common.trim_rate_deg_per_s / 360.0,
        rotor_inertia_kgm2: common.rotor_inertia_kgm2,
    }
}

/// Returns the steps of an electrical cycle, four full steps, for a stepper with `steps_per_turn`.
pub(crate) fn cycle_steps(steps_per_turn: u32, full_steps_per_turn: u32) -> u32 {
    (4 * u64::from(steps_per_turn) / u64::from(full_steps_per_turn.max(1))).max(1) as u32
}
