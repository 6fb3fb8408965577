//! Power-up: from the reset vector to a running loop, or to a lamp that says why there is none.

use core::sync::atomic::{Ordering, compiler_fence};

use cophase_core::control_loop;
use cortex_m_rt::{ExceptionFrame, entry, exception};
use defmt_rtt as _;
use embassy_rp::executor::{Executor, InterruptExecutor};
use embassy_rp::gpio::{Input, Pull};
use embassy_rp::interrupt;
use embassy_rp::interrupt::{InterruptExt, Priority};
use embassy_time::{Duration, Timer};
use panic_probe as _;
use static_cell::StaticCell;

use crate::board::{lines, watchdog};
use crate::machine::Machine;
use crate::report::{self, Reporter};
use crate::settings;

/// Runs the guard: above the loop, so that it cuts the drives even while the loop reckons.
static GUARD: InterruptExecutor = InterruptExecutor::new();

/// Runs the loop: above all that may wait.
static LOOP: InterruptExecutor = InterruptExecutor::new();

#[interrupt]
fn SWI_IRQ_0() {
    // SAFETY: called from the interrupt that it was started with, and from nowhere else.
    unsafe { LOOP.on_interrupt() }
}

#[interrupt]
fn SWI_IRQ_1() {
    // SAFETY: as above.
    unsafe { GUARD.on_interrupt() }
}

/// What a panic and a fault of the core come to: drives off, and the watchdog does the rest.
#[exception]
unsafe fn HardFault(_frame: &ExceptionFrame) -> ! {
    lines::cut_drives();
    loop {
        cortex_m::asm::nop();
    }
}

unsafe extern "C" {
    /// What runs from RAM: where it belongs, and where in the flash it lies (`firmware/from-ram.x`).
    static mut __from_ram_start: u32;
    static mut __from_ram_end: u32;
    static __from_ram_load: u32;
}

/// Puts in place what runs from RAM. Nothing of that may be called before; hence word by word, and not by
/// `memcpy`, which is among it.
fn place_code() {
    // SAFETY: the linker's addresses, of words; nothing else knows that part of RAM.
    unsafe {
        let (mut to, end) = (&raw mut __from_ram_start, &raw mut __from_ram_end);
        let mut from = &raw const __from_ram_load;
        while to < end {
            to.write_volatile(from.read_volatile());
            to = to.add(1);
            from = from.add(1);
        }
    }
    compiler_fence(Ordering::SeqCst);
}

#[entry]
fn main() -> ! {
    place_code();
    let p = embassy_rp::init(embassy_rp::config::Config::default());
    lines::set_up();
    let last_seen = watchdog::last_seen();
    match last_seen {
        Some(seen) => defmt::error!("restarted by the watchdog: {}", seen),
        None => defmt::info!("power-up"),
    }
    let (to_tell, told) = report::queue();
    let machine = settings::load(p.FLASH).and_then(|setup| {
        let made = Machine::new(
            &setup,
            p.WATCHDOG,
            last_seen.is_some(),
            Reporter::new(to_tell),
        );
        made.inspect_err(|refusal| defmt::error!("settings refused: {}", refusal))
            .ok()
    });
    let mut enable = Input::new(p.PIN_26, Pull::Up);
    enable.set_schmitt(true);

    static EXECUTOR: StaticCell<Executor> = StaticCell::new();
    EXECUTOR.init(Executor::new()).run(|spawner| {
        spawner.spawn(defmt::unwrap!(report::tell(told)));
        let Some(machine) = machine else {
            spawner.spawn(defmt::unwrap!(refuse()));
            return;
        };
        // What wakes the guard must not wait for the loop either.
        interrupt::IO_IRQ_BANK0.set_priority(Priority::P0);
        interrupt::SWI_IRQ_1.set_priority(Priority::P1);
        let guards = GUARD.start(interrupt::SWI_IRQ_1);
        guards.spawn(defmt::unwrap!(guard(enable)));
        interrupt::SWI_IRQ_0.set_priority(Priority::P2);
        let loops = LOOP.start(interrupt::SWI_IRQ_0);
        loops.spawn(defmt::unwrap!(run_loop(machine)));
    })
}

/// Cuts the drives whenever the enable input goes.
#[embassy_executor::task]
async fn guard(mut enable: Input<'static>) -> ! {
    loop {
        enable.wait_for_high().await;
        lines::cut_drives();
        enable.wait_for_low().await;
    }
}

/// Says with the lamp that there is nothing to run on: two short flashes a second. The drives are off.
#[embassy_executor::task]
async fn refuse() -> ! {
    loop {
        for dark_ms in [150, 750] {
            lines::light(true);
            Timer::after(Duration::from_millis(50)).await;
            lines::light(false);
            Timer::after(Duration::from_millis(dark_ms)).await;
        }
    }
}

#[embassy_executor::task]
async fn run_loop(machine: &'static mut Machine) {
    match machine {
        Machine::Two(controller, board) => control_loop::run(controller, board).await,
        Machine::Three(controller, board) => control_loop::run(controller, board).await,
        Machine::Four(controller, board) => control_loop::run(controller, board).await,
        Machine::Five(controller, board) => control_loop::run(controller, board).await,
        Machine::Six(controller, board) => control_loop::run(controller, board).await,
    }
}
