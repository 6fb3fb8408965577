//! Cranks whose errors are known, and a monitor that watches them tick by tick.

use super::*;
use crate::commanded::{TickPhase, TickTurns};
use crate::settings::Settings;
use crate::settings::sample;

pub(super) const CLOCK_HZ: u32 = 125_000_000;
pub(super) const TICK_CYCLES: u32 = CLOCK_HZ / 2000;

pub(super) fn settings(count: usize, tilt_mrad: f64, warp_deg: f64, common_deg: f64) -> Settings {
    let mut settings = sample::settings(count);
    settings.drift.tilt_limit_mrad = tilt_mrad;
    settings.drift.warp_limit_deg = warp_deg;
    settings.drift.common_limit_deg = common_deg;
    settings
}

pub(super) fn configured(settings: &Settings) -> DriftMonitor {
    let mut monitor = DriftMonitor::new();
    monitor.configure(settings);
    monitor
}

pub(super) fn monitor(
    count: usize,
    tilt_mrad: f64,
    warp_deg: f64,
    common_deg: f64,
) -> DriftMonitor {
    configured(&settings(count, tilt_mrad, warp_deg, common_deg))
}

/// Largest true error of one crank alone, turns, under the limits of `monitor(3.0, 5.0, 15.0)`.
pub(super) fn true_alone(count: usize, axis: usize) -> f64 {
    let mut settings = settings(count, 3.0, 5.0, 15.0);
    settings.drift.reading_error_deg = 0.0;
    configured(&settings).single_axis_limit(axis).to_num()
}

/// Commanded phases at the end of a tick, and the history that leads to them after a tick in which all axes made `before` turns.
pub(super) fn history_of(
    commanded: &PerAxis<TickPhase>,
    before: Turns,
) -> (PerAxis<Turns>, History) {
    let mut history = History::new();
    let mut over = TickTurns::by_master(Turns::ZERO);
    for (axis, phase) in commanded.iter().enumerate() {
        over.set(axis, phase.turns);
    }
    let next = TickTurns::by_master(Turns::ZERO);
    for turns in [TickTurns::by_master(before), over, next] {
        history.push(&turns);
    }
    let leads = commanded.map(|phase| phase.start.advanced(phase.turns).since(Phase::ZERO));
    (leads, history)
}

/// A monitor's finding in one tick.
pub(super) fn detect(
    monitor: &mut DriftMonitor,
    index: &PerAxis<Option<IndexPulse>>,
    encoder: &PerAxis<i32>,
    commanded: &PerAxis<TickPhase>,
) -> Option<Finding> {
    detect_after(monitor, index, encoder, commanded, commanded[0].turns)
}

/// The same after a tick with other turns.
pub(super) fn detect_after(
    monitor: &mut DriftMonitor,
    index: &PerAxis<Option<IndexPulse>>,
    encoder: &PerAxis<i32>,
    commanded: &PerAxis<TickPhase>,
    before: Turns,
) -> Option<Finding> {
    let (lead, history) = history_of(commanded, before);
    monitor.observe(&Sensed {
        index: &(*index).into(),
        encoder,
        phase: Phase::ZERO,
        lead: &lead,
        history: &history,
        correction: &PerAxis::default(),
        speed: commanded[0].turns,
    })
}

/// Findings that wait, taken while the cranks stand.
pub(super) fn take_all(monitor: &mut DriftMonitor, at: &PerAxis<TickPhase>) -> Vec<Finding> {
    let still = at.map(|phase| TickPhase::still(phase.start.advanced(phase.turns)));
    (0..MAX_AXES + 3)
        .filter_map(|_| detect(monitor, &[None; MAX_AXES], &[0; MAX_AXES], &still))
        .collect()
}

/// Cranks that turn with the master at an even speed, apart from the phase error of each. A clock runs with them.
pub(super) struct Cranks {
    pub(super) monitor: DriftMonitor,
    pub(super) tick: i32,
    pub(super) speed: f64,
    /// Phases at which the flags are.
    pub(super) flags: PerAxis<f64>,
    pub(super) before: PerAxis<f64>,
}

impl Cranks {
    pub(super) fn new(monitor: DriftMonitor, speed: f64) -> Self {
        Self {
            monitor,
            tick: 0,
            speed,
            flags: PerAxis::default(),
            before: PerAxis::default(),
        }
    }

    /// Turns for `ticks`, with the phase error `off(i, turns)` of crank i. Returns the findings, each with its tick.
    pub(super) fn turn(
        &mut self,
        ticks: u32,
        off: impl Fn(usize, f64) -> f64,
    ) -> Vec<(i32, Finding)> {
        self.turn_with(ticks, off, |_, _, pulse| pulse)
    }

    /// The same with sensors that change the pulses: of axis, turns and pulse.
    pub(super) fn turn_with(
        &mut self,
        ticks: u32,
        off: impl Fn(usize, f64) -> f64,
        sensor: impl Fn(usize, f64, Option<IndexPulse>) -> Option<IndexPulse>,
    ) -> Vec<(i32, Finding)> {
        self.turn_motors(ticks, &off, sensor, &off)
    }

    /// Turns for `ticks`, with motors as commanded, and the phase error `off(i, turns)` of crank i on its shaft.
    pub(super) fn turn_shafts(
        &mut self,
        ticks: u32,
        off: impl Fn(usize, f64) -> f64,
    ) -> Vec<(i32, Finding)> {
        self.turn_motors(ticks, off, |_, _, pulse| pulse, |_, _| 0.0)
    }

    /// Turns for `ticks`, with the phase error `off(i, turns)` of crank i and `motor_off(i, turns)` of its motor.
    pub(super) fn turn_motors(
        &mut self,
        ticks: u32,
        off: impl Fn(usize, f64) -> f64,
        sensor: impl Fn(usize, f64, Option<IndexPulse>) -> Option<IndexPulse>,
        motor_off: impl Fn(usize, f64) -> f64,
    ) -> Vec<(i32, Finding)> {
        let mut found = Vec::new();
        for _ in 0..ticks {
            // The end equals the next tick's start to the last bit. Otherwise a passage could fall between the two.
            let (start, end) = (
                f64::from(self.tick) * self.speed,
                f64::from(self.tick + 1) * self.speed,
            );
            let commanded = TickPhase {
                start: Phase::from_turns(Turns::wrapping_from_num(start)),
                turns: Turns::from_num(self.speed),
            };
            let now: PerAxis<f64> = core::array::from_fn(|i| {
                end + if i < self.monitor.axes.len() {
                    off(i, end)
                } else {
                    0.0
                }
            });
            let pulses = core::array::from_fn(|i| {
                let (from, to) = (self.before[i] - self.flags[i], now[i] - self.flags[i]);
                let passes = to.floor() > from.floor();
                let pulse = passes.then(|| IndexPulse {
                    cycle: ((to.floor() - from) / (to - from) * f64::from(TICK_CYCLES)) as i32,
                });
                if i < self.monitor.axes.len() {
                    sensor(i, end, pulse)
                } else {
                    None
                }
            });
            let counts = core::array::from_fn(|i| {
                let own = if i < self.monitor.axes.len() {
                    motor_off(i, end)
                } else {
                    0.0
                };
                ((end + own) * 3200.0).floor() as i32
            });
            self.before = now;
            if let Some(finding) =
                detect(&mut self.monitor, &pulses, &counts, &[commanded; MAX_AXES])
            {
                found.push((self.tick, finding));
            }
            self.tick += 1;
        }
        found
    }

    /// Begins homing a turn before zero, with cranks that have the phase error `off(i, turns)`.
    pub(super) fn reset(&mut self, off: impl Fn(usize, f64) -> f64) {
        self.tick = -((1.0 / self.speed) as i32);
        let start = f64::from(self.tick) * self.speed;
        self.before = core::array::from_fn(|i| start + off(i, start));
        let left = Phase::from_turns(Turns::wrapping_from_num(start));
        self.monitor.reset(&[left; MAX_AXES]);
    }

    /// Ticks after the reset in which a turn confirms every index: up to 1.2 turns, and some.
    pub(super) fn homing_ticks(&self) -> u32 {
        (1.2 / self.speed) as u32 + (1.0 / self.speed) as u32 + MAX_AXES as u32
    }

    /// Turns until a turn has confirmed every index, and settles at these positions.
    pub(super) fn homed(mut self) -> Self {
        self.reset(|_, _| 0.0);
        assert_eq!(self.turn(self.homing_ticks(), |_, _| 0.0), []);
        assert!(self.monitor.is_homed());
        self.monitor.settle();
        self
    }
}

/// Moves the flag of one axis `by` turns further on.
pub(super) fn move_flag(monitor: &mut DriftMonitor, axis: usize, by: f64) {
    let by = Turns::from_num(by);
    let config = &mut monitor.axes[axis].config;
    config.index = config.index.wrapping_add(by);
    monitor.axes[axis].shift(angle(by));
}

/// True if every index has been detected, though a turn may not have confirmed it.
pub(super) fn are_detected(monitor: &DriftMonitor) -> bool {
    monitor.axes.iter().all(|watch| watch.index.is_known())
}

/// The first finding, where cranks with the phase errors `errors` from the start are homed.
pub(super) fn found_in_homing(
    monitor: DriftMonitor,
    errors: PerAxis<f64>,
    ticks: u32,
) -> Option<(i32, FaultKind, Option<usize>)> {
    let mut cranks = Cranks::new(monitor, 0.01);
    cranks.before = errors;
    let found = cranks.turn(ticks, |i, _| errors[i]);
    let first = found.first();
    first.map(|(tick, finding)| (*tick, finding.fault.kind, finding.fault.axis))
}

pub(super) fn encoders(tilt_mrad: f64) -> Cranks {
    encoders_at(0.01, tilt_mrad)
}

pub(super) fn encoders_at(speed: f64, tilt_mrad: f64) -> Cranks {
    Cranks::new(monitor_with_encoders(tilt_mrad), speed).homed()
}

pub(super) fn monitor_with_encoders(tilt_mrad: f64) -> DriftMonitor {
    let mut settings = settings(3, tilt_mrad, 5.0, 15.0);
    for axis in &mut settings.axes {
        axis.encoder = true;
    }
    let mut monitor = configured(&settings);
    monitor.reset(&[Phase::ZERO; MAX_AXES]);
    monitor
}
