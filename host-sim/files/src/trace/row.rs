//! Row: the values of one control tick, for all writers.
//!
//! Time and turns count from power-up. The program, the command and the phase error are the controller's
//! values. The actual turns, tilt, warp, height and acceleration are the true values of the simulated machine.

use host_sim::checked::Checked;

/// Machine whose rows a trace has. It decides the columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RowShape {
    /// Number of axes.
    pub axes: usize,
    /// True if the moved part pitches, and rows have its pitch.
    pub pitches: bool,
}

impl RowShape {
    /// Shape of the rows of a scene.
    pub fn for_scene(checked: &Checked) -> Self {
        Self {
            axes: checked.scene.axes.count,
            pitches: checked.machine.pitches(),
        }
    }
}

/// A machine with this number of axes, which does not pitch.
impl From<usize> for RowShape {
    fn from(axes: usize) -> Self {
        Self {
            axes,
            ..Self::default()
        }
    }
}

/// One row of `trace.csv`: the loop and the machine at one control tick.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// Time since power-up, seconds.
    pub t_s: f64,
    /// The supervisor's state, in lower case.
    pub state: &'static str,
    /// Its number: 0 idle, 1 homing, 2 run, 3 stop, 4 parked, 5 fault.
    pub state_code: u8,
    /// Amplitude that the program requests, m/s².
    pub amax_requested_mps2: f64,
    /// Amplitude at the commanded speed, m/s².
    pub amax_commanded_mps2: f64,
    /// Commanded speed of the master shaft, rad/s.
    pub omega_rad_s: f64,
    /// Commanded phase of the master shaft, turns since power-up.
    pub phase_turns: f64,
    /// One entry an axis.
    pub axes: Vec<AxisRow>,
    /// The platform's tilt along x, milliradians: positive where the side of axis 0 is high.
    pub tilt_x_mrad: f64,
    /// The platform's tilt along y, milliradians: positive where the side a quarter turn after axis 0 is high.
    pub tilt_y_mrad: f64,
    /// Largest deviation of a crank from the plane through all of them, degrees of crank angle.
    pub warp_deg: f64,
    /// The platform's height over the crank axis, metres.
    pub z_m: f64,
    /// The platform's acceleration, upwards, m/s².
    pub accel_mps2: f64,
    /// Amplitude of that acceleration, m/s²: the greatest magnitude in the last whole turn of the master; NaN in a recording.
    pub amax_actual_mps2: f64,
    /// Pitch of the moved part, milliradians; only machines that pitch have it.
    pub pitch_mrad: f64,
}

impl Row {
    /// Row at power-up of a machine with `axes` axes.
    pub fn of_axes(axes: usize) -> Self {
        Self {
            axes: vec![AxisRow::default(); axes],
            ..Self::default()
        }
    }

    /// Sets to NaN the values that only a simulated machine provides.
    pub fn forget_truth(&mut self) {
        for axis in &mut self.axes {
            axis.actual_turns = f64::NAN;
        }
        for truth in [
            &mut self.tilt_x_mrad,
            &mut self.tilt_y_mrad,
            &mut self.warp_deg,
            &mut self.z_m,
            &mut self.accel_mps2,
            &mut self.amax_actual_mps2,
            &mut self.pitch_mrad,
        ] {
            *truth = f64::NAN;
        }
    }
}

/// One axis at one control tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct AxisRow {
    /// Steps (or encoder counts) commanded since power-up, in the axis's own sense.
    pub steps: i64,
    /// Commanded phase, turns since power-up.
    pub command_turns: f64,
    /// The crank's true phase, turns since power-up.
    pub actual_turns: f64,
    /// Phase error as the monitor last measured it, degrees.
    pub phase_error_deg: f64,
    /// True if no measurement stands behind it any more: the next one is overdue by more than a turn, or the axis has no sensor.
    pub is_overdue: bool,
}
