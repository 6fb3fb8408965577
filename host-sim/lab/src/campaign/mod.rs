//! A campaign of thousands of drawn machines. Each machine is run twice: once with one injected fault, and once without a fault.
//!
//! `docs/campaign.md` has the claims that a campaign tests, and the definitions of the *judge*. The judge computes the true phase errors of
//! the cranks ([`truth`], [`geometry`]), the responses of the controller's outputs to a fault ([`response`]), the right names ([`names`]),
//! the bounds on tilt ([`bound`], [`hold`]), and the verdict ([`judge`]). None of these modules uses a gate, a threshold or a table of the
//! monitor.
//!
//! A *case* is drawn from its number ([`plan`]). Its *faulty* run and its *clean* run are one row each ([`row`]). Rows depend on seed and
//! number alone. So a case has the same rows in any range of cases, and on any number of threads ([`shards`]). A table and a picture
//! summarize the rows ([`tally`], [`picture`]). One run is offered for a replay ([`example`]). For rare events, only cases of a few strata are simulated ([`selection`]). Their rates are
//! weighted with the shares of these strata ([`stratified`]).

pub mod bound;
pub mod example;
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

use cophase_scene::SceneError;
use host_sim::checked::Checked;
use host_sim::faults::Planned;
use host_sim::sim::{Outcome, Simulation};
use rayon::prelude::*;

use geometry::Geometry;
use plan::{Case, Plan};
use response::Twin;
use row::Row;
use watch::Watch;

/// Number of ticks that a machine needs to respond to what an index pulse shows. One passes until the loop reads the pulse, one if the
/// line's filter confirms it in the tick after, and one until the response is played.
pub const DETECTION_TICKS: usize = 3;

/// Runs the faulty or the clean run of a case. The faulty run is compared with its twin, so the clean run is simulated first in either
/// case.
///
/// # Errors
/// The scene cannot be run.
pub fn run(case: &Case, clean: bool) -> Result<Row, SceneError> {
    let [faulty_row, clean_row] = run_both(case)?;
    Ok(if clean { clean_row } else { faulty_row })
}

/// Runs the faulty and the clean run of a case. Both are one run up to the fault.
///
/// # Errors
/// The scene cannot be run.
pub fn run_both(case: &Case) -> Result<[Row; 2], SceneError> {
    let checked = |clean| {
        Checked::new(case.scene_of(clean))
            .map_err(|error| error.in_file(&format!("case {}", case.number)))
    };
    let (clean, faulty) = (checked(true)?, checked(false)?);
    let geometry = Geometry::new(&case.scene);
    let watch = |checked: &Checked| {
        Watch::new(
            geometry.as_ref(),
            checked,
            judge::cranks_that_count(checked),
        )
    };
    let mut clean_watch = watch(&clean);
    let mut twin = Twin::default();
    let mut clean_run = Simulation::new(u64::MAX, &clean)?;
    let fault_us = Planned::new(case.fault()).from_us;
    clean_run.run_until(fault_us, &mut (&mut clean_watch, &mut twin));
    let mut faulty_run = clean_run.clone();
    faulty_run.go_on_in(&faulty);
    let faulty_watch = clean_watch.go_on_in(&faulty, judge::cranks_that_count(&faulty));
    clean_run.run(&mut (&mut clean_watch, &mut twin));
    let mut faulty_watch = faulty_watch.compared_with(&twin);
    faulty_run.run(&mut faulty_watch);

    let row = |checked: &Checked, watch: Watch<'_>, outcome: &Outcome| {
        let observation = watch.observation();
        let diverged = outcome.diverged.is_some();
        let slipped = (outcome.record.axes.iter()).any(|axis| axis.motor_slips != 0);
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

/// Runs both runs of each case, on all threads of rayon, and returns the rows in the order of `numbers`. Calls `done` after each case, on
/// any thread.
///
/// # Errors
/// A case cannot be run. If there are several, the error is that of any one of them.
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
