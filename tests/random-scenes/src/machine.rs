//! `[machine]` and `[frame]`.

use std::f64::consts::TAU;

use cophase_scene::file::MechanismName;
use cophase_scene::file::{Axes, Fidelity, Foundation, Frame, Machine, Platform, Rods};
use host_sim::mechanism::{AnyMechanism, Configured, Mechanism};

use crate::basis::Basis;
use crate::source::{Source, at_most};

/// Crank, coupler and ground of crank-rockers, relative to their rockers: those of the source, a short crank, and one that comes close to
/// jamming.
const LINKAGES: [[f64; 3]; 3] = [
    [0.48521, 1.54021, 1.92792],
    [0.15, 1.0, 1.35],
    [0.42, 1.5, 2.0],
];

/// Cranks under a platform.
pub fn machine(source: &mut Source, tick_hz: u32) -> Machine {
    let mechanism = source.one_of(&[
        MechanismName::SliderCrank,
        MechanismName::SliderCrank,
        MechanismName::SliderCrank,
        MechanismName::ScotchYoke,
        MechanismName::CrankRocker,
    ]);
    let has_rod = mechanism == MechanismName::SliderCrank;
    let has_radius = mechanism != MechanismName::CrankRocker;
    let [crank, coupler, ground] = source
        .one_of(&LINKAGES)
        .map(|ratio| (!has_radius).then_some(ratio));
    let crank_radius_mm = source.usual((2.0, 100.0), (0.1, 500.0));
    let lambda = source.number(0.1, 0.6);
    let by_length = source.percent(30);
    let load_kg = source.usual((0.1, 50.0), (0.001, 50.0));
    let mount_radius_mm = source.usual((100.0, 1000.0), (10.0, 5000.0));
    let disc_kgm2 = load_kg * (mount_radius_mm * 1e-3).powi(2) / 4.0;
    let rods = source.one_of(&[Rods::QuasiStatic, Rods::QuasiStatic, Rods::Elastic]);
    // An oscillation on the rods is as slow as some ticks allow, except in a few scenes.
    let (min, max) = (source.log_between(0.01, 0.3), source.log_between(0.3, 3.0));
    let stiffness = |ticks: f64| load_kg * (ticks * f64::from(tick_hz)).powi(2) * 1e-6;
    let mut machine = crate::plain::scene().machine.expect("it has one");
    machine.mechanism = mechanism;
    machine.crank_radius_mm = has_radius.then_some(crank_radius_mm);
    machine.lambda = (has_rod && !by_length).then_some(lambda);
    machine.rod_length_mm =
        (has_rod && by_length).then_some(crank_radius_mm / lambda.clamp(0.11, 0.59));
    machine.screw_lead_mm = (!has_radius).then_some((TAU * crank_radius_mm).clamp(0.63, 3000.0));
    machine.crank_ratio = crank;
    machine.coupler_ratio = coupler;
    machine.ground_ratio = ground;
    machine.load_kg = load_kg;
    machine.platform = source.one_of(&[Platform::Above, Platform::Below]);
    machine.gravity_mps2 = source.or_default(9.80665, 0.0, 20.0);
    machine.mount_radius_mm = mount_radius_mm;
    machine.tilt_inertia_kgm2 = source.maybe(40, |source| {
        source.usual((0.3 * disc_kgm2, 3.0 * disc_kgm2), (1e-6, 1000.0))
    });
    machine.rod_n_per_um = source.usual((stiffness(min), stiffness(max)), (0.01, 10_000.0));
    machine.rods = rods;
    machine.rod_zeta = source.or_default(0.02, 0.0, 2.0);
    machine.allow_commanded_tilt = source.percent(50);
    machine
}

/// Mechanism of a machine.
///
/// # Panics
/// Never: a machine that was drawn has the keys of its mechanism.
pub fn mechanism(machine: &Machine) -> AnyMechanism {
    let settings = AnyMechanism::settings(machine).expect("the keys of its mechanism");
    let radius_m = AnyMechanism::radius_m(machine).expect("the keys of its mechanism");
    AnyMechanism::from_settings(&settings, radius_m)
}

/// The machine with its rods. Half of the scenes where nothing bends the rods have the default. Most others have rods on which the rotors
/// swing slowly.
pub fn rods(source: &mut Source, basis: &Basis, axes: &Axes, machine: Machine) -> Machine {
    if basis.count <= 3 && machine.rods == Rods::QuasiStatic && source.percent(50) {
        return Machine {
            rod_n_per_um: 50.0,
            ..machine
        };
    }
    if axes.rotor_inertia_kgm2 == 0.0 || source.percent(5) {
        return machine;
    }
    let lever_m = basis.mechanism.crank_radius_m() * basis.mechanism.max_s();
    let fastest_rad_s = source.log_between(0.1, 1.0) * f64::from(basis.tick_hz);
    let max = axes.rotor_inertia_kgm2 * (fastest_rad_s / lever_m).powi(2) * 1e-6;
    Machine {
        rod_n_per_um: at_most(machine.rod_n_per_um.min(max)).max(0.01),
        ..machine
    }
}

/// Frame and foundation. They are present wherever the level needs them, and in some other scenes.
pub fn frame(source: &mut Source, machine: &Machine, fidelity: Fidelity) -> Option<Frame> {
    if fidelity != Fidelity::Elastic && !source.percent(20) {
        return None;
    }
    let load_kg = machine.load_kg;
    let radius_m = machine.mount_radius_mm * 1e-3;
    let inertia = |source: &mut Source, mass_kg: f64| {
        source.maybe(30, |source| {
            let disc_kgm2 = mass_kg * radius_m * radius_m / 4.0;
            source.usual((0.3 * disc_kgm2, 3.0 * disc_kgm2), (1e-6, 1e7))
        })
    };
    let spring = |source: &mut Source, mass_kg: f64, (low_hz, high_hz): (f64, f64)| {
        let n_per_mm = |hz: f64| mass_kg * (TAU * hz).powi(2) * 1e-3;
        source.usual((n_per_mm(low_hz), n_per_mm(high_hz)), (1e-3, 1e9))
    };
    let mass_kg = source.usual((load_kg, 30.0 * load_kg), (0.01, 1e6));
    Some(Frame {
        mass_kg,
        tilt_inertia_kgm2: inertia(source, mass_kg),
        suspension_n_per_mm: spring(source, mass_kg + load_kg, (0.5, 30.0)),
        suspension_zeta: source.or_default(0.05, 0.0, 2.0),
        foundation: source.maybe(40, |source| {
            let block_kg = source.usual((mass_kg, 30.0 * mass_kg), (0.01, 1e6));
            Foundation {
                mass_kg: block_kg,
                tilt_inertia_kgm2: inertia(source, block_kg),
                ground_n_per_mm: spring(source, mass_kg + block_kg, (5.0, 100.0)),
                ground_zeta: source.or_default(0.1, 0.0, 2.0),
            }
        }),
    })
}
