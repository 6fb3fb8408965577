//! Watchdog: resets a controller whose loop hangs or does not meet its deadlines.
//!
//! Only output that was submitted in time feeds it. A reset releases all pins, and with them the drives' enable line,
//! which is pulled down. Registers that survive the reset keep the state of the loop and the [`Failure`], which are then reported.

use cophase_core::supervisor::State;
use embassy_rp::Peri;
use embassy_rp::pac;
use embassy_rp::peripherals::WATCHDOG;
use embassy_rp::watchdog::Watchdog;
use embassy_time::Duration;

use super::failure::Failure;

/// Number of deadlines that the loop may miss before a watchdog reset.
///
/// After three the loop itself faults and makes a coordinated stop. The watchdog is for a loop that cannot.
const TICKS: u32 = 20;

/// Mark of a register that this firmware has written. The last byte is the state, the one before it the failure.
const LEFT: u32 = 0xC0F4_0000;

/// Bits of the mark.
const MARK: u32 = 0xFFFF_0000;

/// Mark of the register that selects a single axis. The last byte is the axis.
const ONLY: u32 = 0xA715_0100;

/// Value in place of a state, before the loop's first tick.
const NOT_BEGUN: u32 = 0xFF;

/// State of the loop before a watchdog reset.
#[derive(Clone, Copy, Debug, defmt::Format)]
pub struct LastState {
    /// State of the machine; none if the loop had not begun.
    pub state: Option<State>,
    /// Control ticks from that power-up to the reset.
    pub tick: u32,
    /// Reason for the reset.
    pub failure: Failure,
}

/// Reads the state before a watchdog reset; none after any other reset.
pub fn last_state() -> Option<LastState> {
    let reason = pac::WATCHDOG.reason().read();
    let left = pac::WATCHDOG.scratch0().read();
    pac::WATCHDOG.scratch0().write_value(0);
    // The boot ROM also resets through the watchdog, after a download.
    if !(reason.timer() || reason.force()) || left & MARK != LEFT {
        return None;
    }
    let [state, failure, ..] = left.to_le_bytes();
    Some(LastState {
        // The number is beyond all states if the loop had not begun.
        state: State::ALL.get(usize::from(state)).copied(),
        tick: pac::WATCHDOG.scratch1().read(),
        failure: Failure::from_number(failure),
    })
}

/// Keeps the reason for a reset, beside the state.
pub fn keep(failure: Failure) {
    let left = pac::WATCHDOG.scratch0();
    let before = left.read();
    let state = if before & MARK == LEFT {
        before & 0xFF
    } else {
        NOT_BEGUN
    };
    left.write_value(LEFT | (failure as u32) << 8 | state);
}

/// True if the watchdog was started.
pub fn is_running() -> bool {
    pac::WATCHDOG.ctrl().read().enable()
}

/// Resets the controller as the watchdog would, even if the clock of the watchdog stands.
pub fn force() -> ! {
    // All blocks but the two oscillators, as `embassy_rp` selects them.
    const ALL_BUT_OSCILLATORS: u32 = 0x1_FFFC;
    pac::PSM
        .wdsel()
        .write_value(pac::psm::regs::Wdsel(ALL_BUT_OSCILLATORS));
    pac::WATCHDOG.ctrl().modify(|w| w.set_trigger(true));
    loop {
        cortex_m::asm::nop();
    }
}

/// Requested restarts since power-up. The register is zero then.
pub fn restarts() -> u32 {
    pac::WATCHDOG.scratch3().read()
}

/// Lets the watchdog wait for its longest time, 8 s, until the loop feeds it again.
pub fn wait() {
    pac::WATCHDOG
        .load()
        .write_value(pac::watchdog::regs::Load(0xFF_FFFF));
}

/// Axis that is the only one after this start, if the restart before selected one. To be read once.
pub fn only_axis() -> Option<u8> {
    let selected = pac::WATCHDOG.scratch2().read();
    pac::WATCHDOG.scratch2().write_value(0);
    (selected & !0xFF == ONLY).then_some(selected as u8)
}

/// Restarts the controller as after power-up; with a single axis, if one is selected.
#[cold]
pub fn restart(only_axis: Option<u8>) -> ! {
    critical_section::with(|_| {
        super::lines::cut_drives();
        // Without the mark, the start does not treat this as a reset by the watchdog.
        pac::WATCHDOG.scratch0().write_value(0);
        let selected = only_axis.map_or(0, |axis| ONLY | u32::from(axis));
        pac::WATCHDOG.scratch2().write_value(selected);
        let restarts = restarts().wrapping_add(1);
        pac::WATCHDOG.scratch3().write_value(restarts);
        force()
    })
}

/// A running watchdog.
pub struct Fed {
    /// Register value for [`TICKS`] ticks; the register counts down twice a microsecond (erratum RP2040-E1).
    load: u32,
}

impl Fed {
    /// Starts the watchdog for a loop of `tick_us` µs.
    #[cold]
    pub fn start(watchdog: Peri<'static, WATCHDOG>, tick_us: u32) -> Self {
        pac::WATCHDOG.scratch0().write_value(LEFT | NOT_BEGUN);
        let mut watchdog = Watchdog::new(watchdog);
        // A core that a debugger has halted counts as a loop that hangs. For the motors there is no difference.
        watchdog.pause_on_debug(false);
        let timeout_us = TICKS * tick_us;
        watchdog.start(Duration::from_micros(timeout_us.into()));
        Self {
            load: 2 * timeout_us,
        }
    }

    /// Feeds the watchdog, and stores state and tick for after a reset. Until then the failure is [`Failure::Hang`].
    pub fn feed(&self, state: State, tick: u32) {
        pac::WATCHDOG.scratch0().write_value(LEFT | state as u32);
        pac::WATCHDOG.scratch1().write_value(tick);
        pac::WATCHDOG
            .load()
            .write_value(pac::watchdog::regs::Load(self.load));
    }
}
