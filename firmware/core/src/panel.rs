//! The operator's one push button: start, and reset after a fault.
//!
//! The button's level is read once a tick. Contacts bounce for some milliseconds, and a long wire picks up
//! pulses; so a level counts once it has lasted [`STEADY_S`]. A press is the *change* to pressed: a button
//! that is held, or stuck, asks once.

use crate::supervisor::{Command, State};

/// How long a level must have lasted to count, in seconds.
pub const STEADY_S: f64 = 0.01;

/// A push button, debounced.
#[derive(Clone, Debug)]
pub struct Button {
    /// Ticks in [`STEADY_S`].
    steady_ticks: u32,
    /// Ticks for which the level has differed from the one that counts.
    changing: u32,
    pressed: bool,
}

impl Button {
    /// A button that counts as pressed: one that is stuck at power-up must be let go before it asks.
    #[cold]
    pub fn new(tick_hz: u32) -> Self {
        Self {
            steady_ticks: libm::ceil(STEADY_S * f64::from(tick_hz)) as u32,
            changing: 0,
            pressed: true,
        }
    }

    /// Takes in the level of one tick; says whether the button has just been pressed.
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

/// What a press asks for: a reset where there is something to reset, else a start.
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
    fn a_press_asks_once_and_only_when_it_has_lasted() {
        let mut levels = std::vec![false; STEADY];
        levels.extend([true; 200]);
        assert_eq!(presses(&levels), [2 * STEADY - 1]);
        levels.extend([false; STEADY]);
        levels.extend([true; STEADY]);
        assert_eq!(presses(&levels).len(), 2);
    }

    #[test]
    fn a_button_that_is_stuck_since_power_up_asks_nothing() {
        assert!(presses(&[true; 1000]).is_empty());
    }

    proptest! {
        /// Bouncing, however it goes, neither asks nor delays by more than the time that counts.
        #[test]
        fn bouncing_is_not_pressing(bounces in prop::collection::vec(1..STEADY, 0..40)) {
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
