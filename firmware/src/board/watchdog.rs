//! The watchdog: restarts a controller whose loop hangs or does not meet its deadlines.
//!
//! It is fed for each output that was handed over in time, and by nothing else. A restart lets go of all
//! pins, and the drives' enable line with them: it is pulled down. What the loop was doing is kept over the
//! restart, in registers that it leaves alone, and told.

use cophase_core::supervisor::State;
use embassy_rp::Peri;
use embassy_rp::pac;
use embassy_rp::peripherals::WATCHDOG;
use embassy_rp::watchdog::Watchdog;
use embassy_time::Duration;

/// The loop may miss this many deadlines before the controller restarts. It faults by itself, and stops
/// the machine in order, after three: the watchdog is for when it can not.
const TICKS: u32 = 20;

/// Says that the registers hold what this image left there. Its last byte is the state.
const LEFT: u32 = 0xC0F4_5E00;

/// In place of a state, before the loop's first tick.
const NOT_BEGUN: u32 = 0xFF;

/// What was going on when the watchdog restarted the controller.
#[derive(Clone, Copy, Debug, defmt::Format)]
pub struct LastSeen {
    /// What the machine was doing; nothing if the loop had not begun.
    pub state: Option<State>,
    /// Control ticks since that power-up.
    pub tick: u32,
}

/// Whether it was the watchdog that started the controller, and what it was doing before.
pub fn last_seen() -> Option<LastSeen> {
    let reason = pac::WATCHDOG.reason().read();
    let left = pac::WATCHDOG.scratch0().read();
    pac::WATCHDOG.scratch0().write_value(0);
    // The boot ROM restarts through the watchdog too, after a download.
    if !(reason.timer() || reason.force()) || left & !0xFF != LEFT {
        return None;
    }
    let number = (left ^ LEFT) as usize; // beyond all states, if the loop had not begun
    Some(LastSeen {
        state: State::ALL.get(number).copied(),
        tick: pac::WATCHDOG.scratch1().read(),
    })
}

/// A running watchdog.
pub struct Fed {
    /// The register's value for [`TICKS`] ticks: it counts down twice a microsecond (erratum RP2040-E1).
    load: u32,
}

impl Fed {
    /// Starts the watchdog for a loop of `tick_us` µs.
    #[cold]
    pub fn start(watchdog: Peri<'static, WATCHDOG>, tick_us: u32) -> Self {
        pac::WATCHDOG.scratch0().write_value(LEFT | NOT_BEGUN);
        let mut watchdog = Watchdog::new(watchdog);
        // A core that a debugger has halted is a loop that hangs: the motors do not know the difference.
        watchdog.pause_on_debug(false);
        let timeout_us = TICKS * tick_us;
        watchdog.start(Duration::from_micros(timeout_us.into()));
        Self {
            load: 2 * timeout_us,
        }
    }

    /// Feeds it, and leaves word of what is going on.
    pub fn feed(&self, state: State, tick: u32) {
        pac::WATCHDOG.scratch0().write_value(LEFT | state as u32);
        pac::WATCHDOG.scratch1().write_value(tick);
        pac::WATCHDOG
            .load()
            .write_value(pac::watchdog::regs::Load(self.load));
    }
}
