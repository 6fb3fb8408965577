//! Samples of the loop as columns in physical units, in binary batches.
//!
//! A batch is little-endian. It begins with first tick, ticks between two samples, number of samples and number of columns, 32
//! bits each. The columns follow one after another, as 64-bit floats. Samples of a batch follow each other without a gap.
//!
//! Two amplitudes follow from speeds, by the controller's own mechanism. The *commanded* one is that of the master's speed. The
//! *actual* one is that of the mean speed of the cranks over the last turn of the master. This speed follows from the master's
//! phase and the common mode of the measured phase errors. It is not a number until a turn has been measured, and at rest.

use cophase_core::mechanism::{AnyMechanism, Mechanism};
use cophase_core::settings::Settings;
use cophase_core::units::Turns;
use cophase_link::sample::{ALL_CHANNELS, Channel, Channels, Sample};

/// Channels of the stream: all except those that no column needs.
pub(super) const CHANNELS: Channels =
    ALL_CHANNELS & !(Channel::Acceleration as Channels | Channel::Lead as Channels);

/// Bits of a turn.
const ONE_TURN: i64 = 1 << 48;

/// Last instant at which the master passed a whole turn.
#[derive(Clone, Copy, Debug)]
struct Turn {
    tick: u32,
    /// Mean phase of the cranks, turns, 48 fraction bits, wrapping.
    actual: i64,
}

#[derive(Debug)]
pub(super) struct Columns {
    names: Vec<String>,
    axes: usize,
    tick_hz: f64,
    mechanism: AnyMechanism,
    mrad_per_turn: f64,
    last: Option<Sample>,
    turn: Option<Turn>,
    /// Mean speed over the last turn, turns a tick, 48 fraction bits.
    actual_speed: Option<i64>,
}

impl Columns {
    pub(super) fn new(settings: &Settings) -> Self {
        let axes = settings.axes.len();
        let mechanism = settings.mechanism();
        let mut names: Vec<String> = [
            "state_code",
            "flags",
            "override_permille",
            "program_s",
            "amax_requested_mps2",
            "amax_commanded_mps2",
            "amax_actual_mps2",
            "speed_hz",
            "speed_actual_hz",
            "phase_turns",
            "common_deg",
            "tilt_x_mrad",
            "tilt_y_mrad",
            "warp_deg",
        ]
        .map(str::to_owned)
        .into();
        for kind in ["steps", "phase_error_deg", "correction_deg"] {
            names.extend((0..axes).map(|axis| format!("{kind}_{axis}")));
        }
        Self {
            names,
            axes,
            tick_hz: settings.tick_hz.into(),
            mechanism,
            mrad_per_turn: settings.machine.tilt_mrad_per_turn(settings.tick_hz),
            last: None,
            turn: None,
            actual_speed: None,
        }
    }

    pub(super) fn names(&self) -> &[String] {
        &self.names
    }

    /// Discards earlier samples, because the controller has restarted.
    pub(super) const fn restart(&mut self) {
        self.last = None;
        self.turn = None;
        self.actual_speed = None;
    }

    /// Returns the values of one sample, in the order of the names.
    pub(super) fn row(&mut self, sample: &Sample) -> Vec<f64> {
        self.follow(sample);
        let amax = |speed: i64| self.mechanism.amax(Turns::from_bits(speed)).to_num::<f64>();
        let degrees = |bits: &i64| turns(*bits) * 360.0;
        let [common, tilt_x, tilt_y, warp] = sample.modes;
        let mut row = vec![
            sample.state.into(),
            sample.flags.into(),
            sample.override_permille.into(),
            f64::from(sample.program_ticks) / self.tick_hz,
            sample.amax().to_num::<f64>(),
            amax(sample.speed),
            self.actual_speed.map_or(f64::NAN, amax),
            turns(sample.speed) * self.tick_hz,
            self.actual_speed
                .map_or(f64::NAN, |speed| turns(speed) * self.tick_hz),
            turns(sample.phase.rem_euclid(ONE_TURN)),
            degrees(&common),
            turns(tilt_x) * self.mrad_per_turn,
            turns(tilt_y) * self.mrad_per_turn,
            degrees(&warp),
        ];
        row.extend(sample.steps[..self.axes].iter().map(|&steps| steps as f64));
        row.extend(sample.phase_error[..self.axes].iter().map(degrees));
        row.extend(sample.correction[..self.axes].iter().map(degrees));
        row
    }

    /// Follows the turns of the master, for the mean speed of the cranks.
    fn follow(&mut self, sample: &Sample) {
        let Some(last) = self.last.replace(*sample) else {
            return;
        };
        if sample.speed == 0 {
            self.turn = None;
            self.actual_speed = None;
            return;
        }
        if sample.phase.div_euclid(ONE_TURN) == last.phase.div_euclid(ONE_TURN) {
            return;
        }
        let now = Turn {
            tick: sample.tick,
            actual: sample.phase.wrapping_add(sample.modes[0]),
        };
        if let Some(before) = self.turn.replace(now) {
            let ticks = i64::from(now.tick.wrapping_sub(before.tick)).max(1);
            self.actual_speed = Some(now.actual.wrapping_sub(before.actual) / ticks);
        }
    }
}

fn turns(bits: i64) -> f64 {
    bits as f64 / ONE_TURN as f64
}

/// Samples that wait to be sent together.
#[derive(Debug)]
pub(super) struct Batch {
    every: u16,
    first: u32,
    rows: Vec<Vec<f64>>,
}

impl Batch {
    pub(super) const fn new(every: u16) -> Self {
        Self {
            every,
            first: 0,
            rows: Vec::new(),
        }
    }

    /// Returns true if a sample of this tick follows those of the batch.
    pub(super) fn is_next(&self, tick: u32) -> bool {
        let ticks = (self.rows.len() as u32).wrapping_mul(self.every.into());
        self.rows.is_empty() || tick == self.first.wrapping_add(ticks)
    }

    pub(super) fn push(&mut self, tick: u32, row: Vec<f64>) {
        if self.rows.is_empty() {
            self.first = tick;
        }
        self.rows.push(row);
    }

    /// Takes the samples out. Returns the bytes of the batch and the number of samples, or `None` if there are no samples.
    pub(super) fn take(&mut self) -> Option<(Vec<u8>, u64)> {
        let rows = std::mem::take(&mut self.rows);
        let columns = rows.first()?.len();
        let header = [
            self.first,
            self.every.into(),
            rows.len() as u32,
            columns as u32,
        ];
        let mut bytes: Vec<u8> = header.iter().flat_map(|word| word.to_le_bytes()).collect();
        for column in 0..columns {
            bytes.extend(rows.iter().flat_map(|row| row[column].to_le_bytes()));
        }
        Some((bytes, rows.len() as u64))
    }
}
