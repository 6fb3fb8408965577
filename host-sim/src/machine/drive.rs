//! The drive of a simulated axis: what commands it, and what it watches by itself.
//!
//! A drive is commanded by pulses or by setpoints. A stepper's turns its field and does not know where the rotor is. A servo's
//! closes a position loop, and raises its alarm where the rotor is beyond the *following-error window* from its command. It goes on
//! following then. Switched off, it clears its alarm; one that counts pulses clears its following error as well, and counts on
//! from where its rotor stands.

use super::PullOut;

/// How a simulated axis is driven.
#[derive(Clone, Debug)]
pub enum AxisDrive {
    /// By pulses, as long as the torque is below pull-out.
    Stepper {
        /// What the motor can give.
        pull_out: PullOut,
        /// Steps of one electrical cycle.
        cycle_steps: i64,
    },
    /// By setpoints.
    Servo(FollowingError),
    /// By pulses, each of which moves the command of a position loop by one count.
    PulseServo(FollowingError),
}

impl AxisDrive {
    /// Whether it counts the edges of STEP.
    pub const fn takes_pulses(&self) -> bool {
        matches!(self, Self::Stepper { .. } | Self::PulseServo(_))
    }

    /// Whether it gives up its command, as it is off, and follows its rotor.
    pub const fn follows_rotor(&self, energised: bool) -> bool {
        !energised && matches!(self, Self::PulseServo(_))
    }

    /// Steps of an electrical cycle; a servo has none.
    pub const fn cycle_steps(&self) -> Option<i64> {
        match self {
            Self::Stepper { cycle_steps, .. } => Some(*cycle_steps),
            Self::Servo(_) | Self::PulseServo(_) => None,
        }
    }

    /// The following error that it watches; a stepper knows of none.
    pub const fn following_error(&mut self) -> Option<&mut FollowingError> {
        match self {
            Self::Stepper { .. } => None,
            Self::Servo(error) | Self::PulseServo(error) => Some(error),
        }
    }

    /// Whether its alarm is on.
    pub const fn alarm(&self) -> bool {
        match self {
            Self::Stepper { .. } => false,
            Self::Servo(error) | Self::PulseServo(error) => error.alarm,
        }
    }
}

/// Following error of a position loop: command less rotor, against its window.
#[derive(Clone, Copy, Debug)]
pub struct FollowingError {
    window_turns: f64,
    alarm: bool,
}

impl FollowingError {
    /// Window of so many turns of the crank either way; `None` is no window.
    pub fn new(window_turns: Option<f64>) -> Self {
        Self {
            window_turns: window_turns.unwrap_or(f64::INFINITY),
            alarm: false,
        }
    }

    /// Takes the error at a tick's end, turns. The alarm stays on until the drive is off.
    pub fn update(&mut self, error_turns: f64, energised: bool) {
        self.alarm = energised && (self.alarm || error_turns.abs() > self.window_turns);
    }
}
