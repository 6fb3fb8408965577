//! Virtual time: embassy-time's clock for the host, which stands still while code runs and jumps to
//! the next alarm when there is nothing to run.
//!
//! The clock and its alarms belong to the thread, so that simulations run side by side. Alarms go off
//! in order of time, and of arming where times are equal; nothing here depends on anything else, so
//! the same futures see the same times on every run.
//!
//! Code takes no time here. What is to be late is made late on purpose: see [`run`].
//!
//! Unlike embassy-time's own mock driver, this one knows when the next alarm is due.

use std::cell::{Cell, RefCell};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Context, Poll, Wake, Waker};

/// Clock ticks in a second: microseconds.
pub const TICKS_PER_S: u64 = embassy_time::TICK_HZ;

thread_local! {
    static NOW: Cell<u64> = const { Cell::new(0) };
    static ARMED: Cell<u64> = const { Cell::new(0) };
    static ALARMS: RefCell<BinaryHeap<Reverse<Alarm>>> = const { RefCell::new(BinaryHeap::new()) };
    static RUNNING: RefCell<Option<Waker>> = const { RefCell::new(None) };
}

struct Alarm {
    at: u64,
    /// How many alarms were armed before.
    number: u64,
    /// Waker of a part of the future; none is the future itself, which most alarms wake.
    waker: Option<Waker>,
}

impl Alarm {
    const fn key(&self) -> (u64, u64) {
        (self.at, self.number)
    }
}

impl PartialEq for Alarm {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl Eq for Alarm {}

impl PartialOrd for Alarm {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Alarm {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.key().cmp(&other.key())
    }
}

struct VirtualClock;

embassy_time_driver::time_driver_impl!(static CLOCK: VirtualClock = VirtualClock);

impl embassy_time_driver::Driver for VirtualClock {
    fn now(&self) -> u64 {
        NOW.get()
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        let number = ARMED.replace(ARMED.get() + 1);
        let is_own =
            RUNNING.with_borrow(|own| own.as_ref().is_some_and(|own| own.will_wake(waker)));
        let alarm = Alarm {
            at,
            number,
            waker: (!is_own).then(|| waker.clone()),
        };
        ALARMS.with_borrow_mut(|alarms| alarms.push(Reverse(alarm)));
    }
}

/// Polled when woken.
#[derive(Default)]
struct Ready(AtomicBool);

impl Wake for Ready {
    fn wake(self: Arc<Self>) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Runs a future from time 0 until it is done, on this thread's clock.
///
/// `lateness` is called each time that the clock is about to jump to an alarm, and says by how
/// many clock ticks (µs) it is to overshoot: that is how a busy processor looks from inside.
///
/// # Panics
/// If called from within itself, or if the future waits for something that no alarm will bring.
pub fn run<F: Future>(future: F, mut lateness: impl FnMut(u64) -> u64) -> F::Output {
    let ready = Arc::new(Ready(AtomicBool::new(true)));
    let waker = Waker::from(ready.clone());
    let _guard = Guard::new(waker.clone());
    let mut context = Context::from_waker(&waker);
    let mut future = pin!(future);
    loop {
        while ready.0.load(Ordering::Relaxed) {
            ready.0.store(false, Ordering::Relaxed);
            if let Poll::Ready(output) = future.as_mut().poll(&mut context) {
                return output;
            }
        }
        let next = ALARMS.with_borrow(|alarms| alarms.peek().map(|alarm| alarm.0.at));
        let next = next.expect("the future waits, and no alarm is armed that could wake it");
        let next = next.max(NOW.get());
        if go_to(next + lateness(next)) {
            ready.0.store(true, Ordering::Relaxed);
        }
    }
}

/// Sets the clock, and wakes all whose alarms are due; whether the future that runs is one of them.
fn go_to(time: u64) -> bool {
    NOW.set(time);
    let mut is_due = false;
    while let Some(alarm) = ALARMS.with_borrow_mut(|alarms| {
        let due = alarms.peek().is_some_and(|alarm| alarm.0.at <= time);
        if due { alarms.pop() } else { None }
    }) {
        match alarm.0.waker {
            None => is_due = true,
            Some(waker) => waker.wake(),
        }
    }
    is_due
}

/// A clean clock while it lives.
struct Guard;

impl Guard {
    fn new(waker: Waker) -> Self {
        assert!(
            RUNNING.with_borrow(Option::is_none),
            "virtual time is already running on this thread"
        );
        RUNNING.set(Some(waker));
        NOW.set(0);
        ARMED.set(0);
        ALARMS.with_borrow_mut(BinaryHeap::clear);
        Self
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        RUNNING.set(None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embassy_time::{Duration, Instant, Timer};

    #[test]
    fn jumps_to_alarms_in_order_without_waiting() {
        let times = run(
            async {
                let mut times = Vec::new();
                for millis in [5, 1, 3_600_000] {
                    Timer::after(Duration::from_millis(millis)).await;
                    times.push(Instant::now().as_micros());
                }
                times
            },
            |_| 0,
        );
        assert_eq!(times, [5_000, 6_000, 3_600_006_000]);
    }

    #[test]
    fn lateness_is_as_requested() {
        let late = |at| if at == 2_000 { 150 } else { 0 };
        let times = run(
            async {
                Timer::at(Instant::from_micros(2_000)).await;
                let first = Instant::now().as_micros();
                Timer::at(Instant::from_micros(3_000)).await;
                (first, Instant::now().as_micros())
            },
            late,
        );
        assert_eq!(times, (2_150, 3_000));
    }

    /// Two threads, two clocks.
    #[test]
    fn clocks_are_of_their_thread() {
        let other = std::thread::spawn(|| {
            run(async { Timer::after(Duration::from_secs(7)).await }, |_| 0);
            Instant::now().as_secs()
        });
        let here = run(
            async {
                Timer::after(Duration::from_secs(1)).await;
                Instant::now().as_secs()
            },
            |_| 0,
        );
        assert_eq!((here, other.join().unwrap()), (1, 7));
    }

    /// Were it wrong, a future that gives its parts wakers of their own would wait for ever.
    #[test]
    fn wakers_of_parts_are_woken() {
        struct Part(Waker);
        impl Wake for Part {
            fn wake(self: Arc<Self>) {
                self.0.wake_by_ref();
            }
        }
        let woken_us = run(
            async {
                let mut timer = pin!(Timer::after(Duration::from_millis(5)));
                std::future::poll_fn(|context| {
                    let waker = Waker::from(Arc::new(Part(context.waker().clone())));
                    timer.as_mut().poll(&mut Context::from_waker(&waker))
                })
                .await;
                Instant::now().as_micros()
            },
            |_| 0,
        );
        assert_eq!(woken_us, 5_000);
    }

    #[test]
    #[should_panic(expected = "no alarm is armed")]
    fn a_deadlock_is_reported() {
        run(std::future::pending::<()>(), |_| 0);
    }
}
