//! The page of a run. The pages that are drawn here stay in `tmp/` of the target folder for inspection.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use cophase_files::trace::{Row, ScopeData, ScopeFrame};
use host_sim::machines::Shown;

use super::{GRAVITY_MPS2, TICK_S, axes, mixing};

fn frame(title: &str, subtitle: &str) -> ScopeFrame {
    ScopeFrame {
        title: title.into(),
        subtitle: subtitle.into(),
        bands_hz: vec![(24.0, 28.0)],
        gravity_mps2: GRAVITY_MPS2,
        tilt_limit_mrad: Some(2.0),
        phase_error_limit_deg: Some(5.4),
        shown: Shown::Tilt,
    }
}

/// Stores a page for inspection, and checks that it is an SVG page.
fn keep(name: &str, svg: &str) {
    fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join(name), svg).unwrap();
    assert!(svg.starts_with("<svg"), "{name}");
    assert!(svg.trim_end().ends_with("</svg>"), "{name}");
    for bad in ["NaN", "inf\"", "inf "] {
        assert!(!svg.contains(bad), "{name} has a coordinate `{bad}`");
    }
}

#[test]
fn a_mixing_run_gives_a_page() {
    let subtitle = "200 kg, 20-60-40-100 g; quasi-static; done";
    let mut scope = ScopeData::new(3, frame("Mixing, three axes", subtitle));
    mixing(&[], |row| scope.push(row));
    for t_s in [16.0, 27.0, 36.5, 53.0] {
        scope.mark(t_s, "band crossed");
    }
    let svg = scope.render();
    keep("scope-mixing.svg", &svg);
    for text in [
        "Mixing, three axes",
        subtitle,
        "amax, g",
        "speed, Hz",
        "phase error, deg",
        "tilt, mrad",
        "time since power-up, s",
        "band crossed",
        "parked",
    ] {
        assert!(svg.contains(text), "no `{text}` on the page");
    }
    let bytes = svg.len();
    assert!(bytes < 700_000, "{bytes} bytes do not open at ease");
}

#[test]
fn a_fault_is_shown_on_the_page() {
    let subtitle = "axis 2 loses 7.2° three times; fault at 41.65 s";
    let mut scope = ScopeData::new(3, frame("Lost steps", subtitle));
    let slips = [38.0, 40.2, 41.6];
    mixing(&slips, |row| scope.push(row));
    for t_s in slips {
        scope.mark(t_s, "axis 2: steps lost");
    }
    scope.mark(41.65, "fault: lost steps, axis 2");
    let svg = scope.render();
    keep("scope-fault.svg", &svg);
    for text in ["fault: lost steps, axis 2", "limit ±5.4", "peak 21.6"] {
        assert!(svg.contains(text), "no `{text}` on the page");
    }
}

/// If this fails, the axis that is drawn last hides those with the same phase error, and a correction appears to have no effect.
#[test]
fn axes_that_coincide_are_visible_and_a_correction_is_explained() {
    let page = |is_corrected: bool, apart_deg: f64| {
        let mut scope = ScopeData::new(4, frame("coincide", ""));
        for tick in 0..5000_u32 {
            let t_s = f64::from(tick) * TICK_S;
            let mut axes = axes(4);
            for (i, axis) in axes.iter_mut().enumerate() {
                let is_apart = i == 2 && t_s > 1.0;
                axis.phase_error_deg = (4.0 * t_s).sin() + if is_apart { apart_deg } else { 0.0 };
            }
            scope.push(&Row {
                t_s,
                state: "run",
                axes,
                ..Row::default()
            });
        }
        if is_corrected {
            scope.corrected();
        }
        scope.render()
    };
    let svg = page(true, 3.0);
    keep("scope-coincide.svg", &svg);
    for entry in [
        "axis 0, peak 1.0",
        "axis 1, as axis 0<",
        "axis 2, peak 4.0",
        "axis 3, as axis 0<",
    ] {
        assert!(svg.contains(entry), "{entry}");
    }
    // The widest line is at the back, and the others are within it.
    let first = |width: &str| svg.find(&format!("stroke-width=\"{width}\""));
    let [five, three] = [first("5.5").unwrap(), first("3.5").unwrap()];
    assert!(five < three, "{five}, {three}");
    // Axes that are less than a pixel apart coincide.
    assert!(page(true, 0.1).contains("axis 2, peak"));
    assert!(page(true, 0.01).contains("axis 2, as axis 0"));

    let note = "the phase error stays";
    assert!(svg.contains(note));
    assert!(!page(false, 3.0).contains(note));
}

#[test]
fn the_same_run_gives_the_same_page() {
    let page = || {
        let mut scope = ScopeData::new(6, frame("same", "bytes"));
        for tick in 0..5000_u32 {
            scope.push(&Row {
                t_s: f64::from(tick) * TICK_S,
                state: "run",
                axes: axes(6),
                ..Row::default()
            });
        }
        scope.render()
    };
    // The page is drawn twice in one process. Global counters of a library would make a difference.
    assert_eq!(page(), page());
    keep("scope-six.svg", &page());
}

/// If this fails, the page shows the commanded amplitude as the actual one, or twice the amplitude of a level that is over.
#[test]
fn three_amplitudes_are_drawn_by_their_names() {
    let page = |shown: Shown| {
        let frame = ScopeFrame {
            shown,
            ..frame("amplitudes", "")
        };
        let mut scope = ScopeData::new(1, frame);
        for tick in 0..8000_u32 {
            let t_s = f64::from(tick) * TICK_S;
            let phase_turns = 10.0 * t_s;
            scope.push(&Row {
                t_s,
                state: "run",
                amax_requested_mps2: 36.0 * GRAVITY_MPS2,
                amax_commanded_mps2: 35.0 * GRAVITY_MPS2,
                amax_actual_mps2: 32.25 * GRAVITY_MPS2,
                omega_rad_s: 10.0 * TAU,
                phase_turns,
                axes: axes(1),
                ..Row::default()
            });
        }
        scope.render()
    };
    let platform = page(Shown::Tilt);
    keep("scope-amplitudes.svg", &platform);
    for entry in [
        "requested, peak 36.0",
        "commanded, peak 35.0",
        "actual, peak 32.2",
    ] {
        assert!(platform.contains(entry), "{entry}");
    }
    assert!(
        !page(Shown::Acceleration("pushers")).contains("actual"),
        "pushers have a panel of their own"
    );
    assert!(
        page(Shown::Displacement("jaw")).contains("jaw, mm"),
        "a machine of its own kind has no tilt"
    );
}

#[test]
fn runs_with_hardly_any_data_give_pages() {
    keep(
        "scope-none.svg",
        &ScopeData::new(2, ScopeFrame::default()).render(),
    );

    let mut one = ScopeData::new(2, frame("One row", "at rest"));
    one.push(&Row {
        state: "idle",
        axes: axes(2),
        ..Row::default()
    });
    keep("scope-one.svg", &one.render());

    let mut wild = ScopeData::new(
        2,
        ScopeFrame {
            title: "<&\u{1}>".into(),
            bands_hz: vec![(f64::NAN, 3.0), (5.0, 4.0), (0.1, 1e9)],
            gravity_mps2: f64::NAN,
            tilt_limit_mrad: Some(f64::NAN),
            phase_error_limit_deg: Some(f64::INFINITY),
            ..ScopeFrame::default()
        },
    );
    for t_s in [0.0, 0.1, f64::NAN, 0.1, 0.3] {
        wild.push(&Row {
            t_s,
            state: "run",
            amax_requested_mps2: f64::NAN,
            amax_commanded_mps2: f64::INFINITY,
            omega_rad_s: if t_s == 0.1 { f64::NAN } else { 1.0 },
            ..Row::default()
        });
    }
    wild.mark(f64::NAN, "never");
    wild.mark(1e300, "late");
    keep("scope-wild.svg", &wild.render());
}

/// If this fails, a machine without sensors has an empty panel, or a long legend ends beyond the edge of the page.
#[test]
fn a_page_has_only_panels_with_data_and_room_for_its_legends() {
    let page = |is_overdue: bool, band_hz: (f64, f64)| {
        let frame = ScopeFrame {
            bands_hz: vec![band_hz],
            ..frame("fitting", "")
        };
        let mut scope = ScopeData::new(1, frame);
        for tick in 0..100 {
            let mut axes = axes(1);
            axes[0].is_overdue = is_overdue;
            scope.push(&Row {
                t_s: f64::from(tick) * TICK_S,
                state: "run",
                axes,
                ..Row::default()
            });
        }
        scope.render()
    };
    let short = page(false, (5.0, 6.0));
    assert!(short.contains("phase error, deg") && short.contains("width=\"1200\""));
    assert!(!page(true, (5.0, 6.0)).contains("phase error"));
    let long = page(false, (1000.125, 1000.375));
    assert!(long.contains("avoid 1000.125–1000.375 (above)"));
    let width = long.split("width=\"").nth(1).unwrap();
    let width: f64 = width.split('"').next().unwrap().parse().unwrap();
    // 31 letters of at least 6 px, from 1053 px on.
    assert!(width > 1053.0 + 31.0 * 6.0, "{width} px");
}
