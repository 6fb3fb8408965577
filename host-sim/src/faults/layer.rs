//! The fault layer: the active faults, tick by tick and reading by reading.

use cophase_core::signals::Feedback;
use cophase_scene::file::{FaultAt, FaultName, Lines};
use cophase_scene::units::nearest;

use super::Planned;
use crate::axes::{Axes, per_axis};
use crate::checked::Checked;
use crate::drives::Extra;
use crate::drives::{Disturbance, Sensor, Stream};

/// Faults and noise of a scene.
#[derive(Clone, Debug)]
pub struct Faults {
    planned: Vec<Planned>,
    /// True if no fault is planned and no encoder has noise. Ordinary runs then skip the layer.
    is_idle: bool,
    /// Planned faults that have begun.
    begun: Vec<bool>,
    /// Faults that have begun since they were last read, in this order.
    new_faults: Vec<FaultAt>,
    tick_us: u64,
    tick_s: f64,
    touches_drives: bool,
    /// Disturbance of each drive in the present tick. A tick reuses the memory of the one before.
    disturbance: Axes<Disturbance>,
    load: Axes<Option<Stream>>,
    encoder: Axes<Option<Stream>>,
    /// Two axes whose sensors are swapped.
    swapped_sensors: Vec<(usize, usize)>,
    /// Axis with a step FIFO underrun since the last reading; the last one if there were several.
    underrun: Option<usize>,
    /// Number of further index pulses that each axis loses; none without such a fault.
    missing: Axes<Option<u32>>,
}

impl Faults {
    /// Creates the faults of a scene.
    pub fn new(checked: &Checked) -> Self {
        let scene = &checked.scene;
        let noise = &scene.noise;
        let planned: Vec<_> = scene.fault.iter().map(Planned::new).collect();
        let tick_us = 1_000_000 / u64::from(scene.control.tick_hz);
        let count = checked.settings.axes.len();
        let streams =
            |sensor, deviation| per_axis(count, |i| Stream::new(noise.seed, sensor, i, deviation));
        let encoder = streams(Sensor::Encoder, noise.encoder_counts);
        Self {
            is_idle: planned.is_empty() && encoder.iter().all(Option::is_none),
            begun: vec![false; planned.len()],
            new_faults: Vec::new(),
            swapped_sensors: scene.fault.iter().filter_map(swapped_sensors).collect(),
            planned,
            tick_us,
            tick_s: tick_us as f64 * 1e-6,
            touches_drives: scene.touches_drives(),
            disturbance: Axes::new(),
            load: streams(Sensor::Load, noise.load_nm),
            encoder,
            underrun: None,
            missing: per_axis(count, |_| None),
        }
    }

    /// Adds a checked fault, which begins at its time.
    pub fn add(&mut self, fault: &FaultAt) {
        let planned = Planned::new(fault);
        self.swapped_sensors.extend(swapped_sensors(fault));
        self.planned.push(planned);
        self.begun.push(false);
        self.touches_drives |= fault.touches_drives();
        self.is_idle = false;
    }

    /// Returns the faults that have begun since the last call.
    pub fn new_faults(&mut self) -> impl Iterator<Item = FaultAt> {
        self.new_faults.drain(..)
    }

    /// Marks the faults that begin up to `at_us`, of the kinds that `which` selects. Returns the new ones.
    fn begin(&mut self, at_us: u64, which: fn(FaultName) -> bool) -> Vec<FaultAt> {
        let mut new = Vec::new();
        for (planned, begun) in self.planned.iter().zip(&mut self.begun) {
            if !*begun && planned.from_us <= at_us && which(planned.fault.kind) {
                *begun = true;
                new.push(planned.fault);
                self.new_faults.push(planned.fault);
            }
        }
        new
    }

    /// Returns the disturbance of each drive in the tick that begins at `start_us`; none in a scene that never has any.
    #[inline]
    pub fn disturbance(&mut self, start_us: u64) -> Option<&[Disturbance]> {
        if self.planned.is_empty() && !self.touches_drives {
            return None;
        }
        self.disturb(start_us)
    }

    #[inline(never)]
    fn disturb(&mut self, start_us: u64) -> Option<&[Disturbance]> {
        let new = self.begin(start_us, is_of_a_tick);
        if !self.touches_drives {
            return None;
        }
        self.disturbance.clear();
        let axes = 0..self.load.len();
        self.disturbance.extend(axes.map(Disturbance::nothing));
        let disturbance = &mut self.disturbance;
        for planned in self
            .planned
            .iter()
            .filter(|planned| planned.is_on(start_us))
        {
            let fault = &planned.fault;
            let Some(axis) = fault.axis else { continue };
            let with = |disturbance: &mut [Disturbance], with: usize| {
                (disturbance[axis].from, disturbance[with].from) =
                    (disturbance[with].from, disturbance[axis].from);
            };
            match fault.kind {
                FaultName::Slip => {
                    let rate_deg_per_s = fault.rate_deg_per_s.unwrap_or(0.0);
                    disturbance[axis].slip_turns += rate_deg_per_s / 360.0 * self.tick_s;
                }
                FaultName::Stuck => disturbance[axis].stuck = true,
                FaultName::Runaway => disturbance[axis].runaway_hz = fault.speed_hz,
                FaultName::Reversed => disturbance[axis].reversed ^= true,
                FaultName::LoadStep => disturbance[axis].load_nm += fault.torque_nm.unwrap_or(0.0),
                FaultName::SwappedWiring if fault.lines == Some(Lines::Drive) => {
                    if let Some(other) = fault.with {
                        with(disturbance, other);
                    }
                }
                _ => {}
            }
        }
        for fault in new {
            let Some(axis) = fault.axis else { continue };
            match fault.kind {
                FaultName::LostSteps => disturbance[axis].lost_cycles += fault.cycles.unwrap_or(1),
                FaultName::StepFifoUnderrun => {
                    disturbance[axis].travel_share = 0.5;
                    self.underrun = Some(axis);
                }
                _ => {}
            }
        }
        let tick = (start_us / self.tick_us) as i64;
        for (disturbance, load) in disturbance.iter_mut().zip(&self.load) {
            disturbance.load_nm += load.as_ref().map_or(0.0, |load| load.draw(tick));
        }
        Some(&self.disturbance)
    }

    /// Returns the extra index pulses that begin in the tick from `start_us`: for each axis, the fraction of the tick
    /// after which they begin, and their number.
    #[inline]
    pub fn extra(&mut self, start_us: u64) -> Vec<(usize, Extra)> {
        let is_of_index = |planned: &Planned| is_of_index(planned.fault.kind);
        if !self.planned.iter().any(is_of_index) {
            return Vec::new();
        }
        self.begin_extra(start_us)
    }

    #[inline(never)]
    fn begin_extra(&mut self, start_us: u64) -> Vec<(usize, Extra)> {
        let end_us = start_us + self.tick_us - 1;
        let new = self.begin(end_us, is_of_index);
        let mut extra = Vec::new();
        for fault in new {
            let Some(axis) = fault.axis else { continue };
            if fault.kind == FaultName::IndexMissing {
                self.missing[axis] = Some(fault.count.unwrap_or(u32::MAX));
                continue;
            }
            let from_us = Planned::new(&fault).from_us;
            extra.push((
                axis,
                Extra {
                    part: from_us.saturating_sub(start_us) as f64 / self.tick_us as f64,
                    count: fault.count.unwrap_or(1),
                },
            ));
        }
        extra
    }

    /// Returns true if the sensor of an axis misses its present flag. To be called once per flag.
    pub fn misses(&mut self, axis: usize) -> bool {
        match &mut self.missing[axis] {
            Some(0) | None => false,
            Some(u32::MAX) => true,
            Some(left) => {
                *left -= 1;
                true
            }
        }
    }

    /// Applies the active faults to the feedback that is read at `now_us`. The safety inputs already have their
    /// scheduled levels. The board notes alarms and safety inputs between two readings, so one that was active at any time since the
    /// last reading, at `since_us`, is read.
    pub fn read(&mut self, since_us: u64, now_us: u64, feedback: &mut Feedback) {
        if self.is_idle {
            return;
        }
        if !self.planned.is_empty() {
            self.begin(now_us, |kind| !is_of_a_tick(kind) && !is_of_index(kind));
        }
        let number = (now_us / self.tick_us) as i64;
        for (counts, noise) in feedback.encoder.iter_mut().zip(&self.encoder) {
            if let Some(noise) = noise {
                *counts = counts.wrapping_add(nearest(noise.draw(number)) as i32);
            }
        }
        for planned in &self.planned {
            let fault = &planned.fault;
            let from_us = if is_noted(fault.kind) {
                since_us
            } else {
                now_us
            };
            if !planned.is_on_within(from_us, now_us) {
                continue;
            }
            match (fault.kind, fault.axis) {
                (FaultName::EncoderGlitch, Some(axis)) => {
                    let counts = fault.counts.unwrap_or(0) as i32;
                    feedback.encoder[axis] = feedback.encoder[axis].wrapping_add(counts);
                }
                (FaultName::DriveAlarm, Some(axis)) => feedback.alarms |= 1 << axis,
                (FaultName::EnableLoss, _) => feedback.inputs.enable = false,
                (FaultName::StopInput, _) => feedback.inputs.stop = true,
                _ => {}
            }
        }
        for &(one, other) in &self.swapped_sensors {
            feedback.index.swap(one, other);
        }
        self.swap(&mut feedback.encoder);
        feedback.fifo_underrun = self.underrun.take();
    }

    /// Swaps the values of sensors whose wires are swapped.
    pub fn swap<T>(&self, of_each: &mut [T]) {
        for &(one, other) in &self.swapped_sensors {
            of_each.swap(one, other);
        }
    }
}

/// Returns the two axes whose sensors a fault swaps.
fn swapped_sensors(fault: &FaultAt) -> Option<(usize, usize)> {
    (fault.kind == FaultName::SwappedWiring && fault.lines == Some(Lines::Sensors)).then_some(())?;
    fault.axis.zip(fault.with)
}

/// True for kinds of faults that begin with a tick that is played.
const fn is_of_a_tick(kind: FaultName) -> bool {
    use FaultName as Kind;
    matches!(
        kind,
        Kind::LostSteps
            | Kind::Slip
            | Kind::Stuck
            | Kind::Runaway
            | Kind::Reversed
            | Kind::SwappedWiring
            | Kind::StepFifoUnderrun
            | Kind::LoadStep
    )
}

/// True for kinds of faults on lines whose changes the board notes between two readings.
const fn is_noted(kind: FaultName) -> bool {
    use FaultName as Kind;
    matches!(kind, Kind::DriveAlarm | Kind::EnableLoss | Kind::StopInput)
}

/// True for kinds of faults that begin within a tick.
const fn is_of_index(kind: FaultName) -> bool {
    matches!(kind, FaultName::IndexMissing | FaultName::IndexExtra)
}
