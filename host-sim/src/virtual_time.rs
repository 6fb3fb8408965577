//! Virtual time: embassy-time's clock for the host. It stands still while code runs, and jumps to the next alarm when
//! there is nothing to run.
//!
//! The clock and its alarms belong to the thread, so that simulations run side by side. Alarms go off in the order of
//! their times. Alarms of equal times go off in the order of arming. Nothing here depends on anything else, so the same
//! futures see the same times on every run.
//!
//! Code takes no virtual time. [`run`] can delay alarms on purpose.
//!
//! Unlike embassy-time's own mock driver, this one has the time of the next alarm.

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
    /// Time at which the running future continues ([`until`]).
    static DEADLINE: Cell<u64> = const { Cell::new(NEVER) };
    static ARMED: Cell<u64> = const { Cell::new(0) };
    /// Time of the earliest alarm.
    static NEXT: Cell<u64> = const { Cell::new(NEVER) };
    static ALARMS: RefCell<BinaryHeap<Reverse<Alarm>>> = const { RefCell::new(BinaryHeap::new()) };
    static IS_RUNNING: Cell<bool> = const { Cell::new(false) };
}

const NEVER: u64 = u64::MAX;

struct Alarm {
    at: u64,
    /// Number of alarms armed before this one.
    number: u64,
    waker: Waker,
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
        let alarm = Alarm {
            at,
            number,
            waker: waker.clone(),
        };
        ALARMS.with_borrow_mut(|alarms| alarms.push(Reverse(alarm)));
        NEXT.set(NEXT.get().min(at));
    }
}

/// Waits until a time, in clock ticks (µs), as a timer of embassy-time does, without an alarm and a waker.
///
/// Only for the future that [`run`] was given. A part of it that is polled only after its own waker was called would wait
/// forever.
pub fn until(at: u64) -> impl Future<Output = ()> {
    std::future::poll_fn(move |_| {
        if NOW.get() >= at {
            return Poll::Ready(());
        }
        DEADLINE.set(DEADLINE.get().min(at));
        Poll::Pending
    })
}

/// Flag that a wake sets, for the next poll.
#[derive(Default)]
struct Ready(AtomicBool);

impl Ready {
    /// Returns true if it was woken since the last call.
    fn take(&self) -> bool {
        // No exchange is needed, because only one thread uses the flag.
        let ready = self.0.load(Ordering::Relaxed);
        if ready {
            self.0.store(false, Ordering::Relaxed);
        }
        ready
    }
}

impl Wake for Ready {
    fn wake(self: Arc<Self>) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Runs a future from time 0 until it is done, on this thread's clock.
///
/// `lateness` is called each time that the clock is about to jump to an alarm. It returns the overshoot in clock ticks
/// (µs), which simulates a busy processor.
///
/// # Panics
/// If called from within itself, or if the future waits for something that no alarm triggers.
pub fn run<F: Future>(future: F, mut lateness: impl FnMut(u64) -> u64) -> F::Output {
    let _guard = Guard::new();
    let ready = Arc::new(Ready::default());
    let waker = Waker::from(ready.clone());
    let mut context = Context::from_waker(&waker);
    let mut future = pin!(future);
    let mut is_due = true;
    loop {
        while is_due {
            if let Poll::Ready(output) = future.as_mut().poll(&mut context) {
                return output;
            }
            is_due = ready.take();
        }
        let next = NEXT.get().min(DEADLINE.get());
        assert!(
            next != NEVER,
            "the future waits, and no alarm is armed that could wake it"
        );
        let next = next.max(NOW.get());
        let now = next + lateness(next);
        NOW.set(now);
        if DEADLINE.get() <= now {
            DEADLINE.set(NEVER);
            is_due = true;
        }
        if NEXT.get() <= now {
            wake(now);
            is_due |= ready.take();
        }
    }
}

/// Wakes the futures of all alarms that are due.
fn wake(now: u64) {
    while let Some(alarm) = ALARMS.with_borrow_mut(|alarms| {
        let due = alarms.peek().is_some_and(|alarm| alarm.0.at <= now);
        if due { alarms.pop() } else { None }
    }) {
        alarm.0.waker.wake();
    }
    let next = ALARMS.with_borrow(|alarms| alarms.peek().map_or(NEVER, |alarm| alarm.0.at));
    NEXT.set(next);
}

/// Resets the clock, and marks it as running while the guard exists.
struct Guard;

impl Guard {
    fn new() -> Self {
        assert!(
            !IS_RUNNING.replace(true),
            "virtual time is already running on this thread"
        );
        NOW.set(0);
        DEADLINE.set(NEVER);
        NEXT.set(NEVER);
        ARMED.set(0);
        ALARMS.with_borrow_mut(BinaryHeap::clear);
        Self
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        IS_RUNNING.set(false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embassy_time::{Duration, Instant, Timer};

    #[test]
    fn the_clock_jumps_to_alarms_in_order() {
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

    /// If this fails, a loop that waits without alarms gets other times than one with timers.
    #[test]
    fn a_deadline_and_alarms_come_in_order() {
        let times = run(
            async {
                let mut alarm = pin!(Timer::at(Instant::from_micros(2_000)));
                let mut times = Vec::new();
                for at in [1_000, 2_500] {
                    let mut deadline = pin!(until(at));
                    std::future::poll_fn(|context| {
                        let _ = alarm.as_mut().poll(context);
                        times.push(Instant::now().as_micros());
                        deadline.as_mut().poll(context)
                    })
                    .await;
                }
                until(2_500).await; // has already passed
                times
            },
            |at| if at == 1_000 { 30 } else { 0 },
        );
        assert_eq!(times, [0, 1_030, 1_030, 2_000, 2_500]);
    }

    #[test]
    fn alarms_are_late_by_the_requested_time() {
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

    /// If this fails, two threads share one clock.
    #[test]
    fn each_thread_has_its_own_clock() {
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

    /// If this fails, a future that gives its parts wakers of their own waits forever.
    #[test]
    fn a_wrapped_waker_is_woken() {
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
