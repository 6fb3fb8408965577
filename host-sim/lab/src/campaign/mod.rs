//! A campaign: thousands of machines that are drawn, each with one thing that goes wrong, and each once more with nothing wrong.
//!
//! The *claim* that it tests, run by run:
//! 1. every fault that moves a crank beyond a limit (tilt or warp, as the true cranks have it) is detected within one turn of the
//!    master and N + 5 ticks, with N axes: the loop has found something of the axis that it befell, or of one that it moved ([`moved`]), or
//!    something that is of no axis, and stops or disables the machine for it, or has trimmed the crank back
//!    ([`judge::detection`]), and this is played by then;
//! 2. what is reported is the right name, by one table ([`names`]), and of the right axis: in 99 of 100 at least;
//! 3. the platform never tilts further than the limit and what the kind can add, until all cranks stand or the drives are off
//!    ([`bound`]);
//! 4. no axis is left running: once the controller has stopped one, no other is commanded to move, nor moved by its drive, for more
//!    than two ticks;
//! 5. with noise alone, nothing is reported.
//!
//! A *case* is what is drawn for a number ([`plan`]); its *faulty* run and its *clean* run are a row each ([`row`]). Rows depend on
//! seed and number alone, so that any range of them, on any number of threads, has the same ([`shards`]). What all of them come to
//! is a table and a picture ([`tally`], [`picture`]).

pub mod bound;
pub mod flag;
pub mod geometry;
pub mod interval;
pub mod judge;
pub mod moved;
pub mod names;
pub mod picture;
pub mod plan;
pub mod response;
pub mod row;
pub mod shards;
pub mod table;
pub mod tally;
pub mod watch;

use std::ops::Range;

use rayon::prelude::*;

use geometry::Geometry;
use host_sim::scene::{Checked, SceneError};
use host_sim::sim::simulate;
use plan::{Case, Plan};
use row::Row;
use watch::Watch;

/// Ticks that a machine of `axes` axes has to detect what an index pulse shows: one until the loop reads it, one until its response is
/// played, one for each axis, as a tick processes one pulse, and three to evaluate them.
pub const fn detection_ticks(axes: usize) -> usize {
    axes + 5
}

/// Runs one of the two runs of a case.
///
/// # Errors
/// A scene that cannot be run.
pub fn run(case: &Case, clean: bool) -> Result<Row, SceneError> {
    let checked = Checked::new(case.scene_of(clean))
        .map_err(|error| error.in_file(&format!("case {}", case.number)))?;
    let scene = &checked.scene;
    let geometry = Geometry::new(scene);
    let mut watch = Watch::new(geometry.as_ref(), &checked, judge::cranks_that_count(scene));
    let outcome = simulate(&checked, &mut watch, |_, _| {})?;
    let observation = watch.observation();
    let diverged = outcome.diverged.is_some();
    let slipped = outcome
        .statistics
        .slipped_cycles
        .iter()
        .any(|&cycles| cycles != 0);
    let judgement = judge::judge(scene, geometry.as_ref(), &observation, (diverged, slipped));
    Ok(Row::new(case, clean, &observation, &judgement, &outcome))
}

/// Runs cases, both runs of each, on all threads that rayon has; rows in the order of their numbers. `done` is called after
/// each case, on any thread.
///
/// # Errors
/// The first case that cannot be run.
pub fn run_all(
    plan: &Plan,
    numbers: Range<u64>,
    done: &(impl Fn() + Sync),
) -> Result<Vec<Row>, SceneError> {
    let rows: Vec<[Row; 2]> = numbers
        .into_par_iter()
        .map(|number| {
            let case = plan.case(number);
            let rows = [run(&case, false)?, run(&case, true)?];
            done();
            Ok(rows)
        })
        .collect::<Result<_, SceneError>>()?;
    Ok(rows.into_iter().flatten().collect())
}
