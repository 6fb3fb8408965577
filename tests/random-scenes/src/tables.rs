//! All tables of a scene, in the order in which they depend on each other.

use cophase_scene::file::Scene;

use crate::basis::{Basis, Kind, Kinds};
use crate::source::Source;
use crate::{axes, cam, control, events, faults, fidelity, machine, plain, program};

/// Draws a scene, and the file of its cam table if it has one.
pub(crate) fn scene_and_table(
    source: &mut Source,
    kinds: Kinds,
    seed: u64,
) -> (Scene, Option<String>) {
    let kind = match source.below(if kinds.has_questions { 9 } else { 10 }) {
        0..8 => Kind::Cranks,
        8 => Kind::Shafts,
        _ => Kind::Screws,
    };
    let tick_hz = control::tick_hz(source);
    let (machine, shaft) = match kind {
        Kind::Cranks => (Some(machine::machine(source, tick_hz)), None),
        Kind::Shafts | Kind::Screws => (None, Some(cam::shaft(source, kind, kinds, tick_hz))),
    };
    let mechanism = machine
        .as_ref()
        .map_or_else(|| cam::mechanism(shaft.as_ref()), machine::mechanism);
    let has_links = shaft
        .as_ref()
        .is_some_and(|shaft| shaft.masses_kg.is_some());
    let (fidelity, has_torque) = fidelity::level(source, kind, kinds, has_links);
    let drive = axes::drive(source, kind, fidelity);
    let speed_hz = control::speed_hz(source, &mechanism, tick_hz);
    let ramp_s = control::ramp_s(source, tick_hz);
    let mut basis = Basis {
        kinds,
        kind,
        fidelity,
        count: source.one_of(&[2, 3, 3, 3, 4, 4, 5, 6]),
        drive,
        other_drive: axes::other_drive(source, drive),
        has_encoder: source.percent(40),
        has_torque,
        tick_hz,
        load_kg: machine.as_ref().map_or(0.0, |machine| machine.load_kg),
        mechanism,
        speed_hz,
        homing_hz: control::homing_hz(source, speed_hz),
        ramp_s,
        ratio: axes::ratio(source, kind),
        gear: axes::gear(source),
        program_s: 0.0,
        begins_s: 0.0,
    };
    let control = control::control(source, tick_hz);
    let program = program::program(source, &basis);
    basis.program_s = program::length_s(&program);
    basis.begins_s = control.settle_s + 2.0 / basis.homing_hz;
    let (cam_table, table) = cam::tables(source, &basis, shaft.as_ref());
    let limits = control::limits(source, &basis);
    let pulse = control::pulse(source, tick_hz);
    let axes = axes::axes(source, &basis, &pulse, &limits, &cam_table, table.is_some());
    let axis = axes::apart(source, &basis, &axes, &cam_table);
    let frame = machine
        .as_ref()
        .and_then(|machine| machine::frame(source, machine, fidelity));
    let machine = machine.map(|machine| machine::rods(source, &basis, &axes, machine));
    let noise = faults::noise(source, &basis);
    let fault = faults::faults(source, &basis, &axes, &axis);
    let questions = fidelity::questions(source, &basis, has_links, frame.is_some());
    let method = fidelity::method(source, &basis, &axes);
    let events = events::events(source, &basis);
    let scene = Scene {
        name: format!("random-{seed}"),
        description: String::new(),
        fidelity,
        questions,
        method,
        frame,
        control,
        index: control::index(source, tick_hz),
        drift: control::drift(source, &basis, &axes),
        correction: control::correction(source, &basis, &axes),
        limits,
        pulse,
        cam: shaft,
        cam_table,
        machine,
        axes,
        axis,
        noise,
        wiring: control::wiring(source),
        link: control::link(source),
        program,
        command: events.commands,
        input: events.inputs,
        fault,
        late: events.late,
        scope: events.scope,
        ..plain::scene()
    };
    (scene, table)
}
