//! Configuration of the monitor from settings, in place.

use super::axis_watch::{AxisWatch, Traits};
use super::detection::limits::DriftLimits;
use super::detection::modes::{Modes, Mount};
use super::diagnosis::findings::Findings;
use super::queue::Queue;
use super::sensing::tick_phase::TickClock;
use super::{DriftMonitor, NO_MARGIN};
use crate::settings::{AxisSettings, Settings};
use crate::units::{MAX_AXES, Phase, Turns};

impl Default for DriftMonitor {
    fn default() -> Self {
        Self::new()
    }
}

impl DriftMonitor {
    /// A monitor without axes.
    pub const fn new() -> Self {
        Self {
            limits: DriftLimits::NONE,
            mount: Mount::NONE,
            axes: heapless::Vec::new(),
            by_index: 0,
            by_encoder: 0,
            at_once: false,
            clock: TickClock::new(62_500),
            before_is_known: false,
            is_homing: true,
            moved: None,
            phase_error: [Turns::ZERO; MAX_AXES],
            peak: [Turns::ZERO; MAX_AXES],
            detected: 0,
            unchecked: 0,
            rounds: 0,
            averaged: Turns::ZERO,
            common_jump: Turns::ZERO,
            modes: Modes::ZERO,
            changed: false,
            findings: Findings::new(),
            queue: Queue::new(),
            is_busy: false,
            margin: NO_MARGIN,
        }
    }

    /// Replaces the configuration by that of checked settings, and resets the monitor.
    #[cold]
    #[inline(never)]
    pub fn configure(&mut self, settings: &Settings) {
        let limits = DriftLimits::new(&settings.drift, &settings.machine, settings.tick_hz);
        let set = |has: &dyn Fn(&AxisSettings) -> bool| {
            let axes = settings.axes.iter().enumerate();
            axes.fold(0, |set, (i, axis)| set | u8::from(has(axis)) << i)
        };
        let sensed = set(&|axis| axis.index_turns.is_some());
        let by_encoder = set(&|axis| axis.encoder);
        self.mount = Mount::with(settings.axes.len(), sensed | by_encoder);
        self.axes.clear();
        for (i, axis) in settings.axes.iter().enumerate() {
            let alone = limits.alone(&self.mount, i, settings.axes.len());
            let traits = Traits::new(axis, settings, limits.reading, alone);
            let pushed = self.axes.push(AxisWatch::new(axis, traits));
            debug_assert!(pushed.is_ok(), "settings hold no more axes than these");
        }
        self.limits = limits;
        self.by_index = sensed & !by_encoder;
        self.by_encoder = by_encoder;
        self.at_once = by_encoder != 0 || settings.detect_at_once;
        self.clock = TickClock::new(settings.tick_cycles());
        self.before_is_known = false;
        self.start_check();
        self.rounds = 0;
        self.reset_peak();
        self.reset(&[Phase::ZERO; MAX_AXES]);
    }
}
