//! The drive of a simulated axis: its kind of command, and the following error that it monitors.
//!
//! A drive is commanded by pulses or by setpoints. A stepper's drive turns the field and does not measure the rotor. A
//! servo's drive closes a position loop. It raises its alarm when the rotor leaves the *following-error window* around the command,
//! and continues to follow. It clears its alarm when it is switched off. A drive that counts pulses then also clears its following
//! error, and continues to count from the position of its rotor.

use super::PullOut;

/// Drive of a simulated axis.
#[derive(Clone, Debug)]
pub enum AxisDrive {
    /// Stepper that follows pulses as long as the torque is below pull-out.
    Stepper {
        /// Torque that the motor can give at each speed.
        pull_out: PullOut,
        /// Steps per electrical cycle.
        cycle_steps: u32,
    },
    /// Servo that follows setpoints.
    Servo(FollowingError),
    /// Servo that follows pulses. Each pulse moves the command of its position loop by one count.
    PulseServo(FollowingError),
}

impl AxisDrive {
    /// True if the drive counts the edges of STEP.
    pub const fn takes_pulses(&self) -> bool {
        matches!(self, Self::Stepper { .. } | Self::PulseServo(_))
    }

    /// True if the drive is off, drops its command, and tracks its rotor instead.
    pub const fn follows_rotor(&self, energised: bool) -> bool {
        !energised && matches!(self, Self::PulseServo(_))
    }

    /// Steps per electrical cycle; none for a servo.
    pub const fn cycle_steps(&self) -> Option<u32> {
        match self {
            Self::Stepper { cycle_steps, .. } => Some(*cycle_steps),
            Self::Servo(_) | Self::PulseServo(_) => None,
        }
    }

    /// Following error that the drive monitors; none for a stepper.
    pub const fn following_error(&mut self) -> Option<&mut FollowingError> {
        match self {
            Self::Stepper { .. } => None,
            Self::Servo(error) | Self::PulseServo(error) => Some(error),
        }
    }

    /// True if the alarm of the drive is on.
    pub const fn alarm(&self) -> bool {
        match self {
            Self::Stepper { .. } => false,
            Self::Servo(error) | Self::PulseServo(error) => error.alarm,
        }
    }
}

/// Following error of a position loop, command minus rotor, with its window.
#[derive(Clone, Copy, Debug)]
pub struct FollowingError {
    window_turns: f64,
    alarm: bool,
}

impl FollowingError {
    /// Creates the monitor of a window of ± `window_turns` of the crank; `None` is no window.
    pub fn new(window_turns: Option<f64>) -> Self {
        Self {
            window_turns: window_turns.unwrap_or(f64::INFINITY),
            alarm: false,
        }
    }

    /// Takes in the error at the end of a tick, turns. The alarm stays on until the drive is off.
    pub fn update(&mut self, error_turns: f64, energised: bool) {
        self.alarm = energised && (self.alarm || error_turns.abs() > self.window_turns);
    }
}
