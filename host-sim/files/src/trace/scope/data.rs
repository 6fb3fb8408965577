//! Data of a run that its drawing needs.

use host_sim::checked::Checked;
use host_sim::machines::Shown;

use super::envelope::{Envelope, PAGE_BUCKETS};
use super::timeline::Timeline;
use crate::trace::Row;

/// Texts and limits around the curves.
#[derive(Clone, Debug, Default)]
pub struct ScopeFrame {
    /// Name of the scene.
    pub title: String,
    /// Line below the name: the machine, the method, the end of the run.
    pub subtitle: String,
    /// Forbidden bands, Hz, each from low to high.
    pub bands_hz: Vec<(f64, f64)>,
    /// Size of one g, m/s². If it is not above zero, standard gravity is used.
    pub gravity_mps2: f64,
    /// Limit of the tilt, mrad, in both directions.
    pub tilt_limit_mrad: Option<f64>,
    /// Limit of phase errors, degrees, in both directions.
    pub phase_error_limit_deg: Option<f64>,
    /// Motion of the part that the axes move, in the last panel.
    pub shown: Shown,
}

impl ScopeFrame {
    /// Frame of a scene's page.
    pub fn for_scene(checked: &Checked) -> Self {
        let scene = &checked.scene;
        Self {
            title: scene.name.clone(),
            subtitle: scene.description.clone(),
            bands_hz: scene
                .limits
                .band
                .iter()
                .map(|band| (band.from_hz, band.to_hz))
                .collect(),
            gravity_mps2: cophase_scene::units::STANDARD_GRAVITY_MPS2,
            tilt_limit_mrad: checked.tilt_limit_mrad(),
            shown: checked.machine.shown(),
            phase_error_limit_deg: None, // limits are on the modes of all phase errors, not on one
        }
    }
}

/// Channels of the envelope; the phase errors of the axes follow those named here.
pub(super) mod channel {
    pub const PROGRAM: usize = 0;
    pub const COMMAND: usize = 1;
    pub const SPEED: usize = 2;
    pub const TILT_X: usize = 3;
    pub const TILT_Y: usize = 4;
    pub const ACCEL: usize = 5;
    pub const ACTUAL: usize = 6;
    pub const PLACE: usize = 7;
    pub const PITCH: usize = 8;
    pub const PHASE_ERROR: usize = 9;
}

/// Collects a run and draws it.
///
/// ```
/// use cophase_files::trace::{AxisRow, Row, ScopeData, ScopeFrame};
///
/// let mut scope = ScopeData::new(3, ScopeFrame { title: "first turn".into(), ..ScopeFrame::default() });
/// for tick in 0..2000 {
///     let t_s = f64::from(tick) * 0.0005;
///     scope.push(&Row { t_s, state: "run", axes: vec![AxisRow::default(); 3], ..Row::default() });
/// }
/// scope.mark(0.5, "band crossed");
/// assert!(scope.render().starts_with("<svg"));
/// ```
#[derive(Clone, Debug)]
pub struct ScopeData {
    pub(super) axes: usize,
    pub(super) frame: ScopeFrame,
    pub(super) envelope: Envelope,
    pub(super) timeline: Timeline,
    pub(super) is_corrected: bool,
    /// One row's values in channel order, kept to save an allocation per row.
    values: Vec<f64>,
}

impl ScopeData {
    /// Creates an empty page for a machine with `axes` axes.
    pub fn new(axes: usize, frame: ScopeFrame) -> Self {
        let channels = channel::PHASE_ERROR + axes;
        Self {
            axes,
            frame,
            envelope: Envelope::new(channels, PAGE_BUCKETS),
            timeline: Timeline::default(),
            is_corrected: false,
            values: vec![f64::NAN; channels],
        }
    }

    /// Adds a control tick. Rows come in the order of their times. Phase errors of axes that the row or the page lacks are left
    /// out.
    pub fn push(&mut self, row: &Row) {
        if !row.t_s.is_finite() {
            return;
        }
        self.timeline.state(row.t_s, row.state);
        let (fixed, phase_errors) = self.values.split_at_mut(channel::PHASE_ERROR);
        fixed[channel::PROGRAM] = row.amax_requested_mps2;
        fixed[channel::COMMAND] = row.amax_commanded_mps2;
        fixed[channel::SPEED] = row.omega_rad_s;
        fixed[channel::TILT_X] = row.tilt_x_mrad;
        fixed[channel::TILT_Y] = row.tilt_y_mrad;
        fixed[channel::ACCEL] = row.accel_mps2;
        fixed[channel::PLACE] = row.z_m;
        fixed[channel::PITCH] = row.pitch_mrad;
        fixed[channel::ACTUAL] = row.amax_actual_mps2;
        for (i, phase_error) in phase_errors.iter_mut().enumerate() {
            let measured = row.axes.get(i).filter(|axis| !axis.is_overdue);
            *phase_error = measured.map_or(f64::NAN, |axis| axis.phase_error_deg);
        }
        self.envelope.push(row.t_s, &self.values);
    }

    /// Notes that the controller corrected cranks in this run. The panel of phase errors then states why these remain.
    pub fn corrected(&mut self) {
        self.is_corrected = true;
    }

    /// Marks an event with a short name, such as `band crossed`. Names that begin with `fault` are highlighted. They are
    /// counted separately, so that a thousand crossings cannot displace a fault.
    pub fn mark(&mut self, t_s: f64, label: &str) {
        self.timeline.mark(t_s, label);
    }
}
