//! Push button of the operator: start, and reset after a fault. Order of its commands and those of a host.
//!
//! The level of the button is read once a tick. Contacts bounce for some milliseconds, and a long wire picks up pulses.
//! So a level counts once it has lasted [`STEADY_S`]. A press is the *change* to pressed: a button that is held, or
//! stuck, gives one command.
//!
//! The loop takes one command a tick. One that comes at the same time as another waits for the next tick, so that each is obeyed, or
//! refused with a reason.

use crate::supervisor::{Command, State};

/// Time for which a level must last to count, in seconds.
pub const STEADY_S: f64 = 0.01;

/// A push button, debounced.
#[derive(Clone, Debug)]
pub struct Button {
    /// Ticks in [`STEADY_S`].
    steady_ticks: u32,
    /// Ticks for which the level has differed from the debounced one.
    changing: u32,
    pressed: bool,
}

impl Button {
    /// Creates a button that counts as pressed. A button that is stuck at power-up must be released before it gives a
    /// command.
    #[cold]
    pub fn new(tick_hz: u32) -> Self {
        Self {
            steady_ticks: libm::ceil(STEADY_S * f64::from(tick_hz)) as u32,
            changing: 0,
            pressed: true,
        }
    }

    /// Reads the level of one tick; returns true if the button has just been pressed.
    pub const fn read(&mut self, down: bool) -> bool {
        if down == self.pressed {
            self.changing = 0;
            return false;
        }
        self.changing += 1;
        if self.changing < self.steady_ticks {
            return false;
        }
        self.changing = 0;
        self.pressed = down;
        down
    }
}

/// Button and host, which share the loop's one command a tick.
#[derive(Clone, Debug)]
pub struct Panel {
    button: Button,
    /// A press has not been taken yet.
    is_pressed: bool,
}

impl Panel {
    /// Creates a panel whose button has to be released before it gives a command.
    #[cold]
    pub fn new(tick_hz: u32) -> Self {
        Self {
            button: Button::new(tick_hz),
            is_pressed: false,
        }
    }

    /// Reads the button's level of one tick, and returns whose command the loop takes in it. `waiting` is the host's next command, which
    /// goes on waiting unless it is the host's turn. A stop comes first, then a press.
    pub const fn turn(&mut self, down: bool, waiting: Option<Command>) -> Option<Source> {
        self.is_pressed |= self.button.read(down);
        match waiting {
            Some(Command::Stop | Command::StopNow) => Some(Source::Host),
            _ if self.is_pressed => {
                self.is_pressed = false;
                Some(Source::Button)
            }
            Some(_) => Some(Source::Host),
            None => None,
        }
    }
}

/// Source of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The button: [`command`].
    Button,
    /// The host.
    Host,
}

/// Command of a press: a reset in the fault state, otherwise a start.
pub const fn command(state: State) -> Command {
    match state {
        State::Fault => Command::Reset,
        _ => Command::Start,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    const TICK_HZ: u32 = 2000;
    const STEADY: usize = 20; // ticks in 10 ms

    fn presses(levels: &[bool]) -> Vec<usize> {
        let mut button = Button::new(TICK_HZ);
        let read = levels.iter().map(|&down| button.read(down));
        let at = read.enumerate().filter(|(_, pressed)| *pressed);
        at.map(|(tick, _)| tick).collect()
    }

    #[test]
    fn a_press_counts_once_after_the_debounce_time() {
        let mut levels = std::vec![false; STEADY];
        levels.extend([true; 200]);
        assert_eq!(presses(&levels), [2 * STEADY - 1]);
        levels.extend([false; STEADY]);
        levels.extend([true; STEADY]);
        assert_eq!(presses(&levels).len(), 2);
    }

    #[test]
    fn a_button_stuck_since_power_up_requests_nothing() {
        assert!(presses(&[true; 1000]).is_empty());
    }

    /// If this fails, a command that comes in the tick of another one is lost, or delays a stop.
    #[test]
    fn of_a_press_and_a_hosts_command_at_once_neither_is_lost() {
        for (queue, expected) in [
            (
                std::vec![Command::Hold],
                [Some(Source::Button), Some(Source::Host), None],
            ),
            (
                std::vec![Command::Stop],
                [Some(Source::Host), Some(Source::Button), None],
            ),
            (
                std::vec![Command::Hold, Command::Stop],
                [Some(Source::Button), Some(Source::Host), Some(Source::Host)],
            ),
            (std::vec![], [Some(Source::Button), None, None]),
        ] {
            let mut panel = Panel::new(TICK_HZ);
            for _ in 0..STEADY {
                assert_eq!(panel.turn(false, None), None);
            }
            for _ in 1..STEADY {
                assert_eq!(panel.turn(true, None), None);
            }
            let mut waiting = queue.iter().copied().peekable();
            for source in expected {
                let turn = panel.turn(true, waiting.peek().copied());
                assert_eq!(turn, source, "{queue:?}");
                if turn == Some(Source::Host) {
                    waiting.next();
                }
            }
            assert_eq!(waiting.next(), None);
        }
    }

    proptest! {
        /// Bouncing in any pattern gives no command, and delays a press by at most [`STEADY_S`].
        #[test]
        fn bounces_are_not_counted_as_presses(bounces in prop::collection::vec(1..STEADY, 0..40)) {
            let mut levels = std::vec![false; STEADY];
            let mut down = false;
            for bounce in bounces {
                down = !down;
                levels.extend(std::iter::repeat_n(down, bounce));
            }
            prop_assert!(presses(&levels).is_empty());
            levels.extend([true; STEADY]);
            let settled = presses(&levels);
            prop_assert_eq!(settled.len(), 1);
            prop_assert!(settled[0] < levels.len());
        }
    }
}
