//! Alarm of the control loop: its interrupt polls the loop directly.
//!
//! An executor and its timer queue serve any number of tasks, and cost 700 cycles a tick and a second interrupt. The loop is one task that
//! waits only for its next deadline. The alarm's interrupt polls it, and a poll that has to wait sets the alarm.

use core::cell::UnsafeCell;
use core::convert::Infallible;
use core::future::Future;
use core::mem;
use core::pin::Pin;
use core::task::{Context, Poll, Waker};

use embassy_rp::interrupt;
use embassy_rp::interrupt::{InterruptExt, Priority};
use embassy_rp::pac;
use embassy_time::Instant;

use super::has_passed;

/// Number of the alarm; embassy's time driver uses alarm 0.
const ALARM: usize = 1;

type Task = Pin<&'static mut dyn Future<Output = ()>>;

struct Slot(UnsafeCell<Option<Task>>);

// SAFETY: it is written once, before the interrupt is enabled; from then on only that interrupt accesses it.
unsafe impl Sync for Slot {}

static TASK: Slot = Slot(UnsafeCell::new(None));

/// Runs a task in the alarm's interrupt, at a higher priority than everything that may wait, and `beside` it. To be called once.
pub fn run(task: Pin<&mut dyn Future<Output = ()>>, beside: impl FnOnce() -> Infallible) -> ! {
    // SAFETY: this function never returns, and a panic does not unwind. So the task stays where it is, and nothing else uses it.
    let task = unsafe { mem::transmute::<Pin<&mut _>, Task>(task) };
    pac::TIMER.inte().modify(|w| w.set_alarm(ALARM, true));
    // SAFETY: the interrupt is not enabled yet.
    unsafe { *TASK.0.get() = Some(task) };
    interrupt::TIMER_IRQ_1.set_priority(Priority::P2);
    interrupt::TIMER_IRQ_1.pend();
    // SAFETY: this interrupt calls only the handler below, and the task is in its slot.
    unsafe { interrupt::TIMER_IRQ_1.enable() };
    match beside() {}
}

#[interrupt]
fn TIMER_IRQ_1() {
    pac::TIMER.intr().write(|w| w.set_alarm(ALARM, true));
    // SAFETY: only this handler accesses it, and it does not preempt itself.
    let task = unsafe { &mut *TASK.0.get() };
    let Some(running) = task else {
        return;
    };
    if running
        .as_mut()
        .poll(&mut Context::from_waker(Waker::noop()))
        .is_ready()
    {
        *task = None;
    }
}

/// Waits for a deadline less than half an hour away, in the task that [`run`] was given.
pub struct Until(pub Instant);

impl Future for Until {
    type Output = ();

    #[inline]
    fn poll(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<()> {
        let Self(deadline) = *self;
        if has_passed(deadline) {
            return Poll::Ready(());
        }
        pac::TIMER
            .alarm(ALARM)
            .write_value(deadline.as_ticks() as u32);
        // The alarm fires when the timer reaches its time, and not if that time has just passed. If it has fired as well, the task is
        // polled once more and keeps waiting.
        if has_passed(deadline) {
            Poll::Ready(())
        } else {
            Poll::Pending
        }
    }
}
