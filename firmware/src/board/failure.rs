//! Failure: the one way in which the controller gives up. The drives are off at once, and the watchdog's reset restarts it.
//!
//! The reason survives the reset. The next start is in the fault `watchdog-reset`, with the drives off, and logs the reason.

use cortex_m_rt::{ExceptionFrame, exception};

use super::{lines, watchdog};

/// Reason for a reset by the watchdog.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
#[repr(u8)]
pub enum Failure {
    /// The loop did not feed the watchdog. It is the only reason for which [`fail`] is not called.
    Hang,
    /// A panic. Its message was logged before.
    Panic,
    /// A fault of the core.
    CoreFault,
    /// The guard did not report a loss of the enable input.
    Guard,
    /// Timer and step hardware count different times.
    Clock,
    /// Code in RAM is not what was placed there.
    Code,
    /// The stack ran over its end.
    Stack,
    /// A setting in use changed.
    Settings,
}

impl Failure {
    /// The failure with a number; [`Self::Hang`] if there is none.
    #[cold]
    pub fn from_number(number: u8) -> Self {
        use Failure::{Clock, Code, CoreFault, Guard, Hang, Panic, Settings, Stack};
        let all = [Hang, Panic, CoreFault, Guard, Clock, Code, Stack, Settings];
        let found = all.into_iter().find(|&one| one as u8 == number);
        found.unwrap_or(Hang)
    }
}

/// Turns of the wait before a forced reset: 50 ms or more, longer than the watchdog waits for a loop.
const TURNS: u32 = 2_000_000;

/// Switches the drives off and restarts the controller.
///
/// A probe can read the log until the watchdog resets the controller. Its clock may stand, so the reset is forced in the end. Before the
/// watchdog was started nothing moves, and the controller waits here for its operator.
#[inline(never)]
pub fn fail(reason: Failure) -> ! {
    cortex_m::interrupt::disable();
    lines::cut_drives();
    watchdog::keep(reason);
    for _ in 0..TURNS {
        cortex_m::asm::nop();
    }
    if watchdog::is_running() {
        watchdog::force();
    }
    loop {
        cortex_m::asm::nop();
    }
}

/// Handles a fault of the core.
#[exception]
unsafe fn HardFault(_frame: &ExceptionFrame) -> ! {
    fail(Failure::CoreFault)
}
