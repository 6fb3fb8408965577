//! A campaign: thousands of machines that are drawn, each with one thing that goes wrong, and each once more with nothing wrong.
//!
//! The claims that it tests are in `docs/campaign.md`, with the definitions of the *judge*: what is true of the cranks ([`truth`],
//! [`geometry`]), what the outputs of the controller do about a fault ([`response`]), which names are right ([`names`]), how far the
//! platform may tilt ([`bound`], [`hold`]), and the verdict ([`judge`]). None of it uses a gate, a threshold or a table of the monitor.
//!
//! A *case* is what is drawn for a number ([`plan`]); its *faulty* run and its *clean* run are a row each ([`row`]). Rows depend on
//! seed and number alone, so that any range of them, on any number of threads, has the same ([`shards`]). What all of them come to
//! is a table and a picture ([`tally`], [`picture`]). For rare events, cases of a few strata are simulated alone ([`selection`]), and
//! their rates are multiplied by the shares of these ([`stratified`]).

pub mod bound;
pub mod flag;
pub mod geometry;
pub mod hold;
pub mod interval;
pub mod judge;
pub mod names;
pub mod picture;
pub mod plan;
pub mod rates;
pub mod response;
pub mod row;
pub mod selection;
pub mod shards;
pub mod stratified;
pub mod table;
pub mod tally;
pub mod truth;
pub mod watch;

use rayon::prelude::*;

use geometry::Geometry;
use host_sim::faults::Planned;
use host_sim::scene::{Checked, SceneError};
use host_sim::sim::{Outcome, Simulation};
use plan::{Case, Plan};
use response::Twin;
use row::Row;
use watch::Watch;

/// Ticks that a machine of `axes` axes has to detect what an index pulse shows: one until the loop reads it, one until its response is
/// played, one for each axis, as a tick processes one pulse, and three to evaluate them.
pub const fn detection_ticks(axes: usize) -> usize {
    axes + 5
}

/// Runs one of the two runs of a case. The faulty run needs its twin, so that the clean run comes first in either case.
///
/// # Errors
/// A scene that cannot be run.
pub fn run(case: &Case, clean: bool) -> Result<Row, SceneError> {
    let [faulty_row, clean_row] = run_both(case)?;
    Ok(if clean { clean_row } else { faulty_row })
}

/// Runs the faulty and the clean run of a case. Up to the fault they are one run, unless the fault is of a kind that takes another machine.
///
/// # Errors
/// A scene that cannot be run.
pub fn run_both(case: &Case) -> Result<[Row; 2], SceneError> {
    let checked = |clean| {
        Checked::new(case.scene_of(clean))
            .map_err(|error| error.in_file(&format!("case {}", case.number)))
    };
    let (clean, faulty) = (checked(true)?, checked(false)?);
    let geometry = Geometry::new(&case.scene);
    let cranks_count = |checked: &Checked| judge::cranks_that_count(&checked.scene);
    let watch = |checked: &Checked| Watch::new(geometry.as_ref(), checked, cranks_count(checked));
    let mut clean_watch = watch(&clean);
    let mut twin = Twin::default();
    let start = |checked| Simulation::new(u64::MAX, checked, |_, _| {});

    let mut clean_run = start(&clean)?;
    let (mut faulty_run, faulty_watch) =
        if clean.scene.touches_drives() == faulty.scene.touches_drives() {
            let fault_us = Planned::new(case.fault()).from_us;
            clean_run.run_until(fault_us, &mut (&mut clean_watch, &mut twin));
            let mut faulty_run = clean_run.clone();
            faulty_run.go_on_in(&faulty);
            let faulty_watch = clean_watch.go_on_in(&faulty, cranks_count(&faulty));
            (faulty_run, faulty_watch)
        } else {
            (start(&faulty)?, watch(&faulty))
        };
    clean_run.run(&mut (&mut clean_watch, &mut twin));
    let mut faulty_watch = faulty_watch.compared_with(&twin);
    faulty_run.run(&mut faulty_watch);

    let row = |checked: &Checked, watch: Watch<'_>, outcome: &Outcome| {
        let observation = watch.observation();
        let diverged = outcome.diverged.is_some();
        let slipped = (outcome.statistics.slipped_cycles.iter()).any(|&cycles| cycles != 0);
        let judged = (diverged, slipped);
        let judgement = judge::judge(&checked.scene, geometry.as_ref(), &observation, judged);
        let is_clean = checked.scene.fault.is_empty();
        Row::new(case, is_clean, &observation, &judgement, outcome)
    };
    Ok([
        row(&faulty, faulty_watch, &faulty_run.finish()),
        row(&clean, clean_watch, &clean_run.finish()),
    ])
}

/// Runs cases, both runs of each, on all threads that rayon has; rows in the order of their numbers. `done` is called after
/// each case, on any thread.
///
/// # Errors
/// The first case that cannot be run.
pub fn run_all(
    plan: &Plan,
    numbers: impl IntoParallelIterator<Item = u64>,
    done: &(impl Fn() + Sync),
) -> Result<Vec<Row>, SceneError> {
    let rows: Vec<[Row; 2]> = numbers
        .into_par_iter()
        .map(|number| {
            let case = plan.case(number);
            let rows = run_both(&case)?;
            done();
            Ok(rows)
        })
        .collect::<Result<_, SceneError>>()?;
    Ok(rows.into_iter().flatten().collect())
}
