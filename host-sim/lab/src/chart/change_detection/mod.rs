//! Detection of small steps and slow drifts from one reading a turn: the monitor's two rules beside CUSUM, GLR and the range of readings.
//!
//! All rules are compared at the same rate of false alarms. Lengths are in tolerances r, the largest error of a reading that the monitor
//! assumes.
//!
//! - [`noise`]: errors of readings; [`rules`]: the rules;
//! - [`false_alarms`]: rates of false alarms; [`measure`]: delays, and loads that cause no alarm.

mod false_alarms;
mod measure;
mod noise;
mod rules;

use std::cmp::Ordering;
use std::fmt::Write;

use false_alarms::{Effort, rate, threshold};
use measure::{Change, LOADS, RAMPS, delay, tolerated_load};
use noise::Noise;
use rules::Rule;

use super::axis::Axis;
use super::ink::{Ink, Stroke};
use super::picture::{Level, Line, Panel, Picture, render};
use super::{ChartError, Drawn, Progress, Size};

/// Turns of an axis in a year of 365.25 days at 60 rev/s.
const TURNS_A_YEAR: f64 = 60.0 * 365.25 * 86_400.0;
/// Rate of false alarms a year at which the sentence compares.
const COMPARED: f64 = 1.0;
/// Changes that have panels, one row each.
const SHOWN: [Change; 3] = [
    Change::Step(0.5),
    Change::Drift(1e-2),
    Change::Drift(COMPARED_DRIFT),
];
/// Drift of the last row and of the sentence, tolerances a turn.
const COMPARED_DRIFT: f64 = 1e-3;

/// Rule with its threshold, and what is measured of it.
struct Measured {
    noise: Noise,
    rule: Rule,
    threshold: f64,
    /// The thresholds of the monitor.
    is_present: bool,
    false_alarms_a_year: f64,
    /// Mean turns of each change in [`Change::ALL`].
    delays: Vec<Option<f64>>,
    /// Largest loads that cause no alarm, one for each of [`RAMPS`].
    loads: Vec<f64>,
}

impl Measured {
    fn turns(&self, of: Change) -> Option<f64> {
        let index = Change::ALL.iter().position(|&change| change == of)?;
        self.delays[index]
    }
}

/// Makes the chart.
pub fn draw(size: Size, progress: Progress) -> Result<Drawn, ChartError> {
    let (rates, runs, times, effort): (&[f64], _, _, _) = match size {
        Size::Small => (
            &[COMPARED, 1e6],
            8,
            2,
            Effort {
                states: 60,
                clumps: 20,
            },
        ),
        Size::Full => (
            &[1e-2, COMPARED, 1e2, 1e4, 1e6],
            200,
            4,
            Effort {
                states: 150,
                clumps: 400,
            },
        ),
    };
    let mut all = Vec::new();
    let of = (Noise::ALL.len() * Rule::ALL.len()) as u64;
    for noise in Noise::ALL {
        for rule in Rule::ALL {
            progress(all.len() as u64, of);
            for (threshold, false_alarms_a_year) in settings(rule, noise, rates, effort) {
                let delays = Change::ALL
                    .iter()
                    .map(|&change| delay(rule, threshold, noise, change, runs));
                let loads = RAMPS
                    .iter()
                    .map(|&ramp| tolerated_load(rule, threshold, noise, ramp, times));
                all.push(Measured {
                    noise,
                    rule,
                    threshold,
                    is_present: rule.present() == Some(threshold),
                    false_alarms_a_year,
                    delays: delays.collect(),
                    loads: loads.collect(),
                });
            }
        }
    }
    progress(of, of);
    let says = says(&all);
    let svg = render(Picture {
        title: "Change detection: delay against false alarms".to_owned(),
        says: says.clone(),
        columns: Noise::ALL.len(),
        chosen_is: "the monitor",
        panels: panels(&all),
    });
    Ok(Drawn::one(csv(&all), svg, says))
}

/// Returns the thresholds of a rule and their rates of false alarms a year: at `rates`, of the monitor, and without false alarms.
fn settings(rule: Rule, noise: Noise, rates: &[f64], effort: Effort) -> Vec<(f64, f64)> {
    let a_year = |a_turn: f64| a_turn * TURNS_A_YEAR;
    let mut found: Vec<_> = rates
        .iter()
        .filter_map(|&rate| {
            let threshold = threshold(rule, rate / TURNS_A_YEAR, noise, effort)?;
            Some((threshold, rate))
        })
        .collect();
    let present = rule.present();
    let certain = rule
        .without_false_alarms()
        .filter(|certain| present != Some(*certain));
    for threshold in present.into_iter().chain(certain) {
        let rate = rate(rule, threshold, noise, effort).unwrap_or(0.0);
        found.push((threshold, a_year(rate)));
    }
    found
}

fn csv(all: &[Measured]) -> String {
    let mut csv =
        "noise,rule,numbers,threshold,present,false_alarms_a_year,change,size,turns\n".to_owned();
    for of in all {
        let Measured {
            noise,
            rule,
            threshold,
            is_present,
            false_alarms_a_year,
            ..
        } = of;
        let head = format!(
            "{},{},{},{threshold:.4},{is_present},{false_alarms_a_year:.2e}",
            noise.name(),
            rule.name(),
            rule.numbers()
        );
        for (change, delay) in Change::ALL.iter().zip(&of.delays) {
            let (kind, size) = change.kind_and_size();
            let delay = delay.map_or_else(|| "none".to_owned(), |delay| format!("{delay:.1}"));
            // Writing to a string does not fail.
            let _ = writeln!(csv, "{head},{kind},{size},{delay}");
        }
        for (ramp, load) in RAMPS.iter().zip(&of.loads) {
            let _ = writeln!(csv, "{head},load,{load},{ramp}");
        }
    }
    csv
}

fn style(rule: Rule) -> (Ink, Stroke) {
    match rule {
        Rule::Gate => (Ink::Black, Stroke::Solid),
        Rule::Windows => (Ink::Blue, Stroke::Solid),
        Rule::Range => (Ink::Green, Stroke::Solid),
        Rule::Cusum { k } if k < 1.0 => (Ink::Vermilion, Stroke::Solid),
        Rule::Cusum { k } if k < 2.0 => (Ink::Orange, Stroke::Solid),
        Rule::Cusum { .. } => (Ink::Yellow, Stroke::Solid),
        Rule::GlrStep => (Ink::Purple, Stroke::Dashed),
        Rule::GlrSlope => (Ink::Sky, Stroke::Dashed),
    }
}

fn panels(all: &[Measured]) -> Vec<Panel> {
    let mut panels = Vec::new();
    for change in SHOWN {
        for noise in Noise::ALL {
            panels.push(panel(all, change, noise));
        }
    }
    panels.extend(Noise::ALL.map(|noise| trade(all, noise)));
    panels
}

/// Delay of a drift against the largest load that causes no alarm as it comes and goes slowly.
fn trade(all: &[Measured], noise: Noise) -> Panel {
    const MAX: f64 = LOADS.0;
    let mut lines = vec![Line {
        stroke: Stroke::Dotted,
        marked: false,
        ..Line::new(
            "load / drift",
            Ink::Grey,
            vec![(0.0, 0.0), (MAX, MAX / COMPARED_DRIFT)],
        )
    }];
    for rule in Rule::ALL {
        for is_present in [false, true] {
            let points = all
                .iter()
                .filter(|of| of.noise == noise && of.rule == rule && of.is_present == is_present)
                .filter_map(|of| Some((of.loads[1], of.turns(Change::Drift(COMPARED_DRIFT))?)))
                .collect::<Vec<_>>();
            if points.is_empty() {
                continue;
            }
            lines.push(Line {
                stroke: Stroke::None,
                chosen: is_present,
                ..Line::new(rule.name(), style(rule).0, points)
            });
        }
    }
    Panel {
        title: format!(
            "drift of {COMPARED_DRIFT} r a turn, errors {}",
            noise.name()
        ),
        x: Axis::linear("largest slow load without an alarm, r", 0.0, MAX),
        y: Axis::linear("mean turns to the alarm", 0.0, MAX / COMPARED_DRIFT),
        lines,
        levels: Vec::new(),
    }
}

fn panel(all: &[Measured], change: Change, noise: Noise) -> Panel {
    const YEARLY: (f64, f64) = (5e-4, 2e6);
    let turns = |of: &Measured| of.turns(change);
    let (mut lines, mut undetected) = (Vec::new(), Vec::new());
    for rule in Rule::ALL {
        let (ink, stroke) = style(rule);
        let of_rule = || {
            all.iter()
                .filter(move |of| of.noise == noise && of.rule == rule)
        };
        let is_curve = |of: &&Measured| of.false_alarms_a_year > YEARLY.0;
        let mut points: Vec<_> = of_rule()
            .filter(is_curve)
            .filter_map(|of| Some((of.false_alarms_a_year, turns(of)?)))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        lines.push(Line {
            stroke,
            ..Line::new(rule.name(), ink, points)
        });
        // A rate that is below the axis is drawn across it.
        for of in of_rule().filter(|of| !is_curve(of)) {
            match turns(of) {
                Some(turns) => lines.push(Line {
                    stroke: if of.is_present {
                        Stroke::Solid
                    } else {
                        Stroke::Dotted
                    },
                    marked: false,
                    chosen: of.is_present,
                    ..Line::new(rule.name(), ink, vec![(YEARLY.0, turns), (YEARLY.1, turns)])
                }),
                None if of.is_present => undetected.push(rule.name()),
                None => {}
            }
        }
    }
    let level = Level::at_y(
        0.6,
        format!("not detected by the monitor's {}", undetected.join(" and ")),
    );
    Panel {
        title: format!("{}, errors {}", change.title(), noise.name()),
        x: Axis::log(
            "false alarms of an axis a year, at 60 rev/s",
            YEARLY.0,
            YEARLY.1,
        ),
        y: Axis::log("mean turns to the alarm", 0.5, 10_000.0),
        lines,
        levels: if undetected.is_empty() {
            Vec::new()
        } else {
            vec![level]
        },
    }
}

/// The comparison at one false alarm a year, with independent normal errors.
fn says(all: &[Measured]) -> String {
    let noise = Noise::ALL[1];
    // The monitor's threshold, or the one with most false alarms that are few enough.
    let of_rule = |rule| {
        let allowed = |of: &&Measured| of.is_present || of.false_alarms_a_year <= COMPARED;
        all.iter()
            .filter(move |of| of.noise == noise && of.rule == rule)
            .filter(allowed)
            .max_by(|a, b| {
                let rank = |of: &Measured| (of.is_present, of.false_alarms_a_year);
                rank(a).partial_cmp(&rank(b)).unwrap_or(Ordering::Equal)
            })
    };
    let entries: Vec<_> = Rule::ALL
        .into_iter()
        .filter_map(of_rule)
        .filter_map(|of| {
            let turns = of.turns(Change::Drift(COMPARED_DRIFT))?;
            Some(format!("{} {turns:.0} ({} r)", of.rule.name(), of.loads[1]))
        })
        .collect();
    format!(
        "Turns to the alarm at a drift of {COMPARED_DRIFT:e} r a turn, and in brackets the largest load that comes and goes slowly without \
         an alarm, with independent normal errors: {}. Gate and windows are the monitor's; the others have at most {COMPARED} false alarm a \
         year.",
        entries.join(", ")
    )
}
