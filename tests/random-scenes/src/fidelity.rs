//! `fidelity`, `[questions]` and `[method]`.

use cophase_scene::file::{Axes, Fidelity, Method, MethodName, Questions};

use crate::basis::{Basis, Kind, Kinds};
use crate::source::Source;

/// Model level, and whether the motors have torque.
pub fn level(source: &mut Source, kind: Kind, kinds: Kinds, has_links: bool) -> (Fidelity, bool) {
    if kinds.has_questions {
        return (Fidelity::Auto, true);
    }
    let level = match kind {
        Kind::Screws => source.one_of(&[Fidelity::Auto, Fidelity::Kinematic]),
        Kind::Shafts if has_links => {
            source.one_of(&[Fidelity::Auto, Fidelity::Kinematic, Fidelity::Elastic])
        }
        Kind::Shafts => source.one_of(&[Fidelity::Auto, Fidelity::Kinematic]),
        Kind::Cranks => source.one_of(&[
            Fidelity::Auto,
            Fidelity::Auto,
            Fidelity::Kinematic,
            Fidelity::QuasiStatic,
            Fidelity::Rigid,
            Fidelity::Phased,
            Fidelity::Phased,
            Fidelity::Elastic,
        ]),
    };
    let may_have = level == Fidelity::Auto && source.percent(70) || source.percent(30);
    let has_torque = !matches!(level, Fidelity::Auto | Fidelity::Kinematic) || may_have;
    (level, has_torque && kind == Kind::Cranks)
}

/// Questions, if the level is left open and can be chosen for them.
pub fn questions(
    source: &mut Source,
    basis: &Basis,
    has_links: bool,
    has_frame: bool,
) -> Questions {
    let can_answer = match basis.kind {
        Kind::Cranks => basis.has_torque,
        Kind::Shafts => has_links,
        Kind::Screws => false,
    };
    let is_requested = basis.kinds.has_questions || source.percent(60);
    if basis.fidelity != Fidelity::Auto || !can_answer || !is_requested {
        return Questions::default();
    }
    let mut tolerance = |percent: u32, usual: (f64, f64)| {
        source.maybe(percent, |source| source.usual(usual, (1e-9, 1e6)))
    };
    let percent = (0.05, 20.0);
    if basis.kind == Kind::Shafts {
        return Questions {
            amax_percent: tolerance(100, percent),
            ..Questions::default()
        };
    }
    Questions {
        lag_deg: tolerance(40, (0.01, 5.0)),
        spread_deg: tolerance(30, (0.01, 5.0)),
        tilt_mrad: tolerance(30, (0.01, 5.0)),
        amax_percent: tolerance(40, percent),
        torque_percent: tolerance(30, percent),
        ground_percent: tolerance(50, percent).filter(|_| has_frame),
        slips: source.maybe(30, |source| source.percent(80)),
    }
}

/// A method. In most scenes it is left to the automatic choice.
pub fn method(source: &mut Source, basis: &Basis, axes: &Axes) -> Method {
    let is_integrated = basis.fidelity.moves_by_torque() || basis.fidelity == Fidelity::Auto;
    if !is_integrated || source.percent(60) {
        return Method::default();
    }
    let has_integral = axes.servo.is_some_and(|servo| servo.integral_s.is_some());
    // Explicit Euler makes hundreds of steps a tick with little damping.
    let of_positions = [
        MethodName::ExplicitEuler,
        MethodName::SymplecticEuler,
        MethodName::SymplecticEuler,
        MethodName::VelocityVerlet,
        MethodName::VelocityVerlet,
    ];
    let of_all = [
        MethodName::Auto,
        MethodName::Rk4,
        MethodName::ImplicitMidpoint,
        MethodName::Sdirk4,
    ];
    let name = match basis.kind {
        Kind::Shafts if source.percent(30) => MethodName::Exact,
        Kind::Cranks if !has_integral && source.percent(30) => source.one_of(&of_positions),
        _ => source.one_of(&of_all),
    };
    // Steps that the scene sets itself are stable at once only where few are needed.
    let steps_per_tick = source.maybe(30, |source| source.usual((4.0, 40.0), (1.0, 200.0)) as u32);
    Method {
        name,
        steps_per_tick,
    }
}
