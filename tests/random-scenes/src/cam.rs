//! `[cam]` and `[[cam_table]]`.

use cophase_core::axes::{MAX_CAM_POINTS, MIN_CAM_POINTS};
use cophase_core::mechanism::{MechanismSettings, ScotchYokeSettings};
use cophase_scene::file::{CamSegment, CamShaft, CamTable, Damper, LawName};
use host_sim::machines::cam::cam_of;
use host_sim::mechanism::{AnyMechanism, Configured};

use crate::basis::{Basis, Kind, Kinds};
use crate::random_scene::TABLE_FILE;
use crate::source::Source;

const LAWS: [LawName; 4] = [
    LawName::Cycloid,
    LawName::SkewedCycloid,
    LawName::ModifiedSine,
    LawName::ModifiedTrapezoid,
];

/// Limits of axes that follow tables: the greatest, as the step rate limits these axes more tightly.
const MAX_SPEED_HZ: f64 = 1e3;
const MAX_ACCELERATION_HZ_PER_S: f64 = 1e9;

/// A cam, with masses on springs in more than half of the scenes, and always in scenes with
/// questions.
pub fn shaft(source: &mut Source, kind: Kind, kinds: Kinds, tick_hz: u32) -> CamShaft {
    let is_on_screws = kind == Kind::Screws;
    let has_links = !is_on_screws && (kinds.has_questions || source.percent(60));
    let three = |source: &mut Source, usual: (f64, f64), range: (f64, f64)| {
        std::array::from_fn(|_| source.usual(usual, range))
    };
    let has_zeta = source.percent(50);
    // An oscillation makes some radians a tick at most, except in a few scenes.
    let max_n_per_mm = (10.0 * f64::from(tick_hz)).powi(2) * 1e-3;
    let mut shaft = CamShaft {
        law: source.one_of(&LAWS),
        rise_mm: 0.0,
        rise_deg: source.usual((60.0, 150.0), (5.0, 180.0)),
        dwell_deg: source.number(0.0, 60.0),
        return_deg: source.usual((60.0, 150.0), (5.0, 120.0)),
        screw_lead_mm: is_on_screws.then(|| source.usual((2.0, 50.0), (0.1, 1000.0))),
        masses_kg: has_links.then(|| three(source, (0.05, 5.0), (1e-4, 1000.0))),
        stiffness_n_per_mm: has_links
            .then(|| three(source, (0.01 * max_n_per_mm, max_n_per_mm), (0.1, 1e7))),
        dampers_ns_per_m: (has_links && !has_zeta).then(|| three(source, (1.0, 1e3), (0.0, 1e7))),
        zeta: (has_links && has_zeta).then(|| source.usual((0.01, 0.5), (0.0, 2.0))),
        damper: source.one_of(&[Damper::Cam, Damper::Ground]),
    };
    // The cam accelerates like a crank for which the loop is designed.
    let unit = CamShaft {
        rise_mm: 1.0,
        ..shaft.clone()
    };
    let peak_m = cam_of(&unit).peak_m();
    let (low_mm, high_mm) = (2e-4 / peak_m, 0.5 / peak_m);
    shaft.rise_mm = source.usual(
        (low_mm.max(1.0), high_mm.min(200.0)),
        (low_mm.max(0.1), high_mm.min(1000.0)),
    );
    shaft
}

/// The mechanism of the same greatest acceleration: amax = κ ω², as a Scotch yoke has with R = κ.
pub fn mechanism(shaft: Option<&CamShaft>) -> AnyMechanism {
    let yoke = MechanismSettings::ScotchYoke(ScotchYokeSettings {});
    AnyMechanism::from_settings(&yoke, shaft.map_or(0.0, |shaft| cam_of(shaft).peak_m()))
}

/// Cam tables, if axes follow them, and the file of one of them.
pub fn tables(
    source: &mut Source,
    basis: &Basis,
    shaft: Option<&CamShaft>,
) -> (Vec<CamTable>, Option<String>) {
    if basis.kind != Kind::Screws {
        return (Vec::new(), None);
    }
    if source.percent(30) {
        let (table, file) = from_file(source);
        return (vec![table], Some(file));
    }
    let mut tables = vec![from_segments(source, "lobe", shaft)];
    if source.percent(30) {
        tables.push(from_segments(source, "other", shaft));
    }
    (tables, None)
}

fn from_segments(source: &mut Source, name: &str, shaft: Option<&CamShaft>) -> CamTable {
    let net_turns = source.one_of(&[0, 0, 0, 1, -1, 3]);
    let turns = match shaft {
        // The stroke of the mechanical cam.
        Some(shaft) if source.percent(50) => {
            (shaft.rise_mm / shaft.screw_lead_mm.unwrap_or(1.0)).clamp(0.01, 20.0)
        }
        _ => source.log_between(0.01, 20.0),
    };
    let dwell_deg = source.between(1.0, 60.0);
    let rise_deg = source.between(60.0, 150.0);
    CamTable {
        name: name.to_owned(),
        net_turns,
        max_speed_hz: MAX_SPEED_HZ,
        max_acceleration_hz_per_s: MAX_ACCELERATION_HZ_PER_S,
        law: source.one_of(&LAWS),
        segment: vec![
            CamSegment {
                deg: rise_deg,
                turns,
            },
            CamSegment {
                deg: dwell_deg,
                turns: 0.0,
            },
            CamSegment {
                deg: 120.0,
                turns: f64::from(net_turns) - turns,
            },
        ],
        file: None,
        points_turns: Vec::new(),
    }
}

/// A table that rises by one turn everywhere. The wave on it is flat enough for that.
fn from_file(source: &mut Source) -> (CamTable, String) {
    let count = if source.percent(50) {
        source.one_of(&[MIN_CAM_POINTS, MAX_CAM_POINTS])
    } else {
        MIN_CAM_POINTS + source.below(MAX_CAM_POINTS - MIN_CAM_POINTS)
    };
    let wave = source.between(0.0, 0.1);
    let position = |i: usize| {
        let turn = i as f64 / count as f64;
        turn + wave * (std::f64::consts::TAU * turn).sin()
    };
    let points: Vec<f64> = (0..count).map(position).collect();
    let has_phase = source.percent(50);
    let rows = points.iter().enumerate().map(|(i, point)| {
        if has_phase {
            format!("{:.6},{point:.6}\n", i as f64 / count as f64)
        } else {
            format!("{point:.6}\n")
        }
    });
    let file: String = rows.collect();
    let table = CamTable {
        name: "waves".to_owned(),
        net_turns: 1,
        max_speed_hz: MAX_SPEED_HZ,
        max_acceleration_hz_per_s: MAX_ACCELERATION_HZ_PER_S,
        law: LawName::ModifiedSine,
        segment: Vec::new(),
        file: Some(TABLE_FILE.to_owned()),
        points_turns: points,
    };
    (table, file)
}

/// Upper estimate of the turns of an axis per turn of the master. It is 1 for an axis that follows
/// no table.
pub fn steepest(tables: &[CamTable]) -> f64 {
    // No law is steeper than 2, and a spline goes somewhat beyond.
    const LAW: f64 = 2.2;
    let of_segments = tables
        .iter()
        .flat_map(|table| &table.segment)
        .map(|segment| LAW * segment.turns.abs() * 360.0 / segment.deg);
    let of_points = tables.iter().map(|table| {
        let count = table.points_turns.len() as f64;
        let rises = table.points_turns.windows(2);
        1.5 * count
            * rises
                .map(|pair| (pair[1] - pair[0]).abs())
                .fold(0.0, f64::max)
    });
    of_segments.chain(of_points).fold(1.0, f64::max)
}
