//! The loop's alarm: one of the timer's four, which polls the loop by itself.
//!
//! An executor and its timer queue serve any number of tasks, at 700 cycles a tick and an interrupt besides. The loop is one
//! task and waits for one thing, its next deadline: the alarm's interrupt polls it, and a poll that waits sets the alarm.

use core::cell::UnsafeCell;
use core::future::Future;
use core::pin::Pin;
use core::task::{Context, Poll, Waker};

use embassy_rp::interrupt;
use embassy_rp::interrupt::{InterruptExt, Priority};
use embassy_rp::pac;
use embassy_time::Instant;

use super::is_past;

/// The alarm; embassy's time driver has the first.
const ALARM: usize = 1;

type Task = Pin<&'static mut dyn Future<Output = ()>>;

struct Slot(UnsafeCell<Option<Task>>);

// SAFETY: it is written once, before the interrupt is enabled that alone looks at it from then on.
unsafe impl Sync for Slot {}

static TASK: Slot = Slot(UnsafeCell::new(None));

/// Runs a task from the alarm's interrupt on, above all that may wait. To be called once.
pub fn run(task: Task) {
    pac::TIMER.inte().modify(|w| w.set_alarm(ALARM, true));
    // SAFETY: the interrupt is not enabled yet.
    unsafe { *TASK.0.get() = Some(task) };
    interrupt::TIMER_IRQ_1.set_priority(Priority::P2);
    interrupt::TIMER_IRQ_1.pend();
    // SAFETY: the handler below is all that this interrupt calls, and what it looks at is in place.
    unsafe { interrupt::TIMER_IRQ_1.enable() };
}

#[interrupt]
fn TIMER_IRQ_1() {
    pac::TIMER.intr().write(|w| w.set_alarm(ALARM, true));
    // SAFETY: only this handler looks at it, and it does not preempt itself.
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
        if is_past(deadline) {
            return Poll::Ready(());
        }
        pac::TIMER
            .alarm(ALARM)
            .write_value(deadline.as_ticks() as u32);
        // The alarm goes off when the time becomes its own: it may just have become later. Should it have gone off besides, the
        // task is polled once more, and waits on.
        if is_past(deadline) {
            Poll::Ready(())
        } else {
            Poll::Pending
        }
    }
}
