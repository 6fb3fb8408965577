//! Format of a settings file: its version, and the lengths of its parts.

use cophase_core::axes::{CamSettings, MAX_CAMS};
use cophase_core::program::{CAPACITY, EntrySettings};
use cophase_core::settings::{
    AxisSettings, CorrectionSettings, Drift, HostLossSettings, IndexSettings, LimitSettings,
    MachineSettings, NAME_BYTES, PulseSettings, WiringSettings,
};
use cophase_core::units::MAX_AXES;
use postcard::experimental::max_size::MaxSize;

/// Length of the header, bytes: a write page of serial NOR flash.
pub const HEADER_BYTES: usize = 256;

/// Format version of the payload that is written and read here. Every change to the bytes of a [`Settings`](crate::Settings) changes it.
pub const VERSION: u16 = 8;

/// Length of the longest payload, bytes: the longest name, full lists, and the greatest numbers of variable length. The fields are in their
/// order in [`Settings`](crate::Settings), without those that no file contains.
pub const MAX_PAYLOAD_BYTES: usize = {
    const FLAG: usize = bool::POSTCARD_MAX_SIZE;
    const NUMBER: usize = f64::POSTCARD_MAX_SIZE;
    let name = heapless::String::<NAME_BYTES>::POSTCARD_MAX_SIZE;
    let park_settle_brake = 2 * NUMBER + FLAG;
    name + u32::POSTCARD_MAX_SIZE
        + MachineSettings::POSTCARD_MAX_SIZE
        + LimitSettings::POSTCARD_MAX_SIZE
        + PulseSettings::POSTCARD_MAX_SIZE
        + IndexSettings::POSTCARD_MAX_SIZE
        + heapless::Vec::<AxisSettings, MAX_AXES>::POSTCARD_MAX_SIZE
        + heapless::Vec::<CamSettings, MAX_CAMS>::POSTCARD_MAX_SIZE
        + heapless::Vec::<f64, MAX_AXES>::POSTCARD_MAX_SIZE
        + Drift::POSTCARD_MAX_SIZE
        + CorrectionSettings::POSTCARD_MAX_SIZE
        + park_settle_brake
        + WiringSettings::POSTCARD_MAX_SIZE
        + HostLossSettings::POSTCARD_MAX_SIZE
        + heapless::Vec::<EntrySettings, CAPACITY>::POSTCARD_MAX_SIZE
};

/// Length of the longest settings file, bytes.
pub const MAX_FILE_BYTES: usize = HEADER_BYTES + MAX_PAYLOAD_BYTES;
