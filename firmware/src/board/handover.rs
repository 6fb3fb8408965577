//! Handover of a program from the host link to the loop.
//!
//! A program is too large for a queue. It has one place, which either the link or the loop may use.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicU8, Ordering};

use cophase_core::program::Program;

/// The link may use the program.
const FREE: u8 = 0;
/// The loop may use it.
const SUBMITTED: u8 = 1;
/// The loop has loaded it, and the link may use it again.
const LOADED: u8 = 2;
/// The loop has refused it, and the link may use it again.
const REFUSED: u8 = 3;

struct Place(UnsafeCell<Program>);

// SAFETY: the link uses the program in every state but `SUBMITTED`, and the loop only in that one. Both are on one core,
// and a change of the state is the last access of the side that makes it.
unsafe impl Sync for Place {}

static PLACE: Place = Place(UnsafeCell::new(Program::new()));
static STATE: AtomicU8 = AtomicU8::new(FREE);

/// Lets the link fill the program, and submits it to the loop. Called by the link alone.
///
/// # Errors
/// Those of `fill`; nothing is submitted then.
#[cold]
pub fn submit<E>(fill: impl FnOnce(&mut Program) -> Result<(), E>) -> Result<(), E> {
    withdraw();
    // SAFETY: the state is not `SUBMITTED`, and only the link sets that.
    fill(unsafe { &mut *PLACE.0.get() })?;
    STATE.store(SUBMITTED, Ordering::Release);
    Ok(())
}

/// True while the loop has not answered. Called by the link.
pub fn is_waiting() -> bool {
    STATE.load(Ordering::Acquire) == SUBMITTED
}

/// Ends the handover. Returns true if the loop has loaded the program. Called by the link.
#[cold]
pub fn withdraw() -> bool {
    // The core has no atomic exchange, so the loop is kept out.
    critical_section::with(|_| {
        let state = STATE.load(Ordering::Acquire);
        STATE.store(FREE, Ordering::Release);
        state == LOADED
    })
}

/// Program that is submitted, if there is one. Called by the loop.
pub fn submitted() -> Option<&'static Program> {
    if STATE.load(Ordering::Acquire) != SUBMITTED {
        return None;
    }
    // SAFETY: in this state only the loop uses it, until it answers.
    Some(unsafe { &*PLACE.0.get() })
}

/// Answers a submission. Called by the loop.
pub fn answer(is_loaded: bool) {
    let state = if is_loaded { LOADED } else { REFUSED };
    STATE.store(state, Ordering::Release);
}
