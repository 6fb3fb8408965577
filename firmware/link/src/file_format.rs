//! Format of a settings file: its version, and the lengths of its parts.

use cophase_core::axes::{MAX_CAM_POINTS, MAX_CAMS};
use cophase_core::program::CAPACITY;
use cophase_core::settings::{MAX_BANDS, NAME_BYTES};
use cophase_core::units::MAX_AXES;

/// Length of the header, bytes: a write page of serial NOR flash.
pub const HEADER_BYTES: usize = 256;

/// Format version of the payload that is written and read here. Every change to the bytes of a [`Settings`](crate::Settings) changes it.
pub const VERSION: u16 = 7;

/// Length of the longest payload, bytes: the longest name, full lists, and the greatest numbers of variable length.
pub const MAX_PAYLOAD_BYTES: usize = {
    const F64: usize = 8;
    const U32: usize = 5; // Seven bits a byte.
    const SMALL: usize = 1; // A flag, a variant, or a length below 128.
    let name = SMALL + NAME_BYTES;
    let platform = 6 * F64 + 3 * SMALL;
    let shafts = F64;
    let machine = SMALL + if platform > shafts { platform } else { shafts };
    let limits = 6 * F64 + SMALL + MAX_BANDS * 2 * F64;
    let pulse = 3 * F64;
    let index_width = F64;
    let index = (SMALL + F64) + 2 * F64;
    let gear = 2 * U32; // The follower's ratio, or the transmission.
    let cam = SMALL + F64;
    let follower = SMALL + if gear > cam { gear } else { cam };
    let axis = SMALL + U32 + gear + SMALL + follower + F64 + index + SMALL + U32 + 3 * F64;
    let axes = SMALL + MAX_AXES * axis;
    const { assert!(MAX_CAM_POINTS < 128) }; // The number of points takes one byte.
    let table = U32 + 2 * F64 + SMALL + MAX_CAM_POINTS * F64;
    let cams = SMALL + MAX_CAMS * table;
    let trims = SMALL + MAX_AXES * F64;
    let drift = 4 * F64;
    let correction = 3 * F64 + SMALL;
    let park_settle = 2 * F64;
    let brake = SMALL;
    let input = 2 * SMALL;
    let wiring = 2 * SMALL + 5 * input;
    let host_loss = F64 + SMALL;
    let segment = SMALL + 3 * F64 + SMALL;
    let program = 2 * SMALL + CAPACITY * segment;
    name + U32
        + machine
        + limits
        + pulse
        + index_width
        + axes
        + cams
        + trims
        + drift
        + correction
        + park_settle
        + brake
        + wiring
        + host_loss
        + program
};

/// Length of the longest settings file, bytes.
pub const MAX_FILE_BYTES: usize = HEADER_BYTES + MAX_PAYLOAD_BYTES;
