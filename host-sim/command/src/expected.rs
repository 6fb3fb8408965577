//! Expected duration of a run, which is printed before a long run.
//!
//! Two first pieces of the run, of different lengths, are timed. The duration of a tick follows from their difference, which does not
//! contain the time to set the run up. Most scenes are short. For those, only the first few ticks are timed.
//!
//! A run that ends early, by a fault, takes less time. A run with a slip is run twice, for its edges ([`super::run`]).

use std::io::{self, Write};
use std::time::Instant;

use cophase_files::trace::{Every, Format, Recorder, ScopeData, ScopeFrame, Window};
use cophase_scene::SceneError;
use host_sim::checked::Checked;
use host_sim::fidelity::{Answers, sample_run};
use host_sim::sim::{Observer, expected_ticks, simulate_first};

/// Longest duration for which nothing is printed, s: of the run, and of a sample run. The choice of a model level makes a few of these.
const LONG_S: f64 = 3.0;
const LONG_SAMPLE_S: f64 = 1.0;

/// Number of ticks in the first timed piece, and the factor to the next piece, until the duration of a tick is measured.
const FIRST_TICKS: u64 = 16;
const MORE: u64 = 4;

/// Difference between the durations of two pieces at which the timing ends, s. It is large compared with differences in the time to
/// set the run up, and with the resolution of the clock.
const TIMED_S: f64 = 0.05;

/// Largest ratio of the duration of a tick in motion to that of a tick at rest. The first ticks are at rest.
const MOVING: f64 = 4.0;

/// Prints that a model level is chosen, if that takes long. It states no time: how many sample runs the choice needs is not known before.
///
/// # Errors
/// The scene cannot be run.
pub(super) fn before_choice(checked: &Checked, err: &mut impl Write) -> Result<(), SceneError> {
    let Some(sample) = sample_run(checked)? else {
        return Ok(());
    };
    let time = |ticks| time_s(ticks, &sample, Answers::default());
    let run_s = expected_s(expected_ticks(&sample)?, LONG_SAMPLE_S, time)?;
    if run_s.is_some_and(|run_s| run_s > LONG_SAMPLE_S) {
        say(
            err,
            "choosing the model level, by sample runs of the scene on several levels",
        );
    }
    Ok(())
}

/// Prints the expected duration of the run, if it is long.
///
/// # Errors
/// As of [`before_choice`].
pub(super) fn before_run(checked: &Checked, err: &mut impl Write) -> Result<(), SceneError> {
    let time = |ticks| time_s(ticks, checked, recorder(checked));
    let run_s = expected_s(expected_ticks(checked)?, LONG_S, time)?;
    if let Some(about) = run_s.and_then(about) {
        say(err, &format!("this takes about {about}"));
    }
    Ok(())
}

fn say(err: &mut impl Write, what: &str) {
    // The run continues if the message cannot be written.
    let _ = writeln!(err, "cophase: {what}");
}

/// Returns a time as text, to two digits; `None` if it is short.
fn about(seconds: f64) -> Option<String> {
    (seconds > LONG_S).then(|| match seconds {
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 99.5 * 60.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.0} h", s / 3600.0),
    })
}

/// Measures the duration of the first ticks of a run, s.
fn time_s(ticks: u64, checked: &Checked, mut observer: impl Observer) -> Result<f64, SceneError> {
    let began = Instant::now();
    simulate_first(ticks, checked, &mut observer, |_, _| {})?;
    Ok(began.elapsed().as_secs_f64())
}

/// Returns the expected duration of `ticks`, s; `None` if it is certainly less than `long_s`. `time` measures the first ticks.
fn expected_s(
    ticks: u64,
    long_s: f64,
    mut time: impl FnMut(u64) -> Result<f64, SceneError>,
) -> Result<Option<f64>, SceneError> {
    let (mut timed, mut took_s) = (FIRST_TICKS, time(FIRST_TICKS)?);
    while timed < ticks {
        // This includes the time to set the run up, so it is an upper estimate.
        if took_s * ticks as f64 / (timed as f64) < long_s / MOVING {
            return Ok(None);
        }
        let (more, more_s) = (timed * MORE, time(timed * MORE)?);
        if more_s - took_s > TIMED_S && more < ticks {
            return Ok(Some(
                (more_s - took_s) / (more - timed) as f64 * ticks as f64,
            ));
        }
        (timed, took_s) = (more, more_s);
    }
    Ok(Some(took_s)) // all ticks were timed
}

/// Creates an observer like that of a run, because the observer takes part of the time. It keeps nothing.
fn recorder(checked: &Checked) -> impl Observer {
    let scope = ScopeData::new(checked.scene.axes.count, ScopeFrame::for_scene(checked));
    // It accepts all bytes like `io::sink()`, and has positions like a file.
    let files = [Format::Csv, Format::Vcd].map(|format| (format, io::empty()));
    let recorder = Recorder::new(
        checked,
        files,
        None,
        Every::Fitting,
        Window::FirstMotion,
        scope,
    );
    (recorder.ok(), Answers::default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use cophase_scene::load;

    /// If this fails, the time to set the run up counts for every tick, or no message announces a run of minutes.
    #[test]
    fn the_run_time_is_extrapolated_from_two_pieces() {
        let expected = |set_up_s: f64, tick_s: f64, ticks: u64| {
            let mut timed = 0;
            let time = |first: u64| {
                timed += first.min(ticks);
                Ok(set_up_s + tick_s * first.min(ticks) as f64)
            };
            (expected_s(ticks, LONG_S, time).unwrap(), timed)
        };
        let is_near = |found: Option<f64>, right_s: f64| {
            found.is_some_and(|found_s| (found_s / right_s - 1.0).abs() < 1e-6)
        };
        let (long_s, timed) = expected(0.2, 1e-3, 100_000);
        assert!(is_near(long_s, 100.0) && timed < 400, "{long_s:?}");
        let (long_s, _) = expected(1e-4, 1e-6, 1_000_000_000);
        assert!(is_near(long_s, 1000.0), "{long_s:?}");
        // In a short run, only the first few ticks are timed.
        assert_eq!(expected(1e-4, 1e-6, 100_000), (None, FIRST_TICKS));
        // A long time to set the run up does not make its ticks long.
        let (short_s, _) = expected(0.5, 1e-6, 100_000);
        assert_eq!(short_s.and_then(about), None, "{short_s:?}");
    }

    #[test]
    fn only_long_run_times_are_stated() {
        assert_eq!(about(2.9), None);
        for (seconds, words) in [
            (3.4, "3 s"),
            (61.0, "61 s"),
            (240.0, "4 min"),
            (7200.0, "2 h"),
        ] {
            assert_eq!(about(seconds).as_deref(), Some(words));
        }
    }

    fn scene(program: &str) -> Checked {
        let text = format!(
            "name = \"long\"\n[machine]\ncrank_radius_mm = 10\nlambda = 0.25\nload_kg = 20\n\
             [questions]\nlag_deg = 0.01\n\
             [limits]\nspeed_hz = 10\nacceleration_hz_per_s = 20\njerk_hz_per_s2 = 200\n\
             [axes]\ncount = 3\ndrive = \"servo\"\nsteps_per_turn = 3200\nrotor_inertia_kgm2 = 1e-3\n\
             servo = {{ position_gain_per_s = 60, velocity_gain_nms = 2.0 }}\n\
             [[program]]\namax_g = 3\n{program}\n"
        );
        Checked::new(load::parse(&text).unwrap()).unwrap()
    }

    /// If this fails, a run of hours begins without a message, or a message announces a run that ends at once. No machine runs days of
    /// simulated time in seconds. No machine needs three seconds for one simulated second.
    #[test]
    fn long_runs_are_announced() {
        let said = |program: &str| {
            let (checked, mut choice, mut run) = (scene(program), Vec::new(), Vec::new());
            before_choice(&checked, &mut choice).unwrap();
            before_run(&checked, &mut run).unwrap();
            [choice, run].map(|said| String::from_utf8(said).unwrap())
        };
        assert_eq!(said("ramp_s = 0.2\nhold_s = 0.2"), ["", ""]);
        let [choice, run] = said("ramp_s = 0.2\nhold_s = 1e6");
        assert_eq!(choice, "", "a sample cuts holds");
        assert!(run.starts_with("cophase: this takes about "), "{run}");
        let [choice, run] = said("ramp_s = 1e5\nhold_s = 1");
        let start = "cophase: choosing the model level";
        assert!(choice.starts_with(start), "{choice}");
        assert!(!run.is_empty());
    }
}
