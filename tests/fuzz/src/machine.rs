//! A machine that follows its commands, except for the disturbances of the script.

use cophase_core::controller::Controller;
use cophase_core::monitor::IndexPulse;
use cophase_core::settings::Settings;
use cophase_core::signals::{Feedback, Output};
use cophase_core::supervisor::Command;
use cophase_core::units::AxisSet;
use cophase_core::units::{ONE_TURN, Phase, Turns};

use crate::Script;

/// One crank and its sensors.
#[derive(Clone, Copy, Debug)]
struct Crank {
    /// Counts of its encoder in turns of the crank, as an exact ratio.
    counts: i128,
    in_turns: i128,
    reversed: bool,
    /// The phase at which its flag begins.
    index: i64,
    /// Commanded positions at the ends of the last ticks, the latest first; units of a turn, not wrapped.
    commanded: [i64; 4],
    /// Its distance from the command.
    apart: i64,
    /// Change of that distance per tick.
    walks: i64,
    stuck: bool,
    reversed_by_mistake: bool,
    index_dead: bool,
    /// Error of its encoder, counts.
    glitch: i32,
    encoder_dead: bool,
    was: i64,
    is: i64,
}

/// All cranks, and the rest of the feedback.
pub struct Machine {
    cranks: Vec<Crank>,
    tick_cycles: i64,
    enable: bool,
    stop: bool,
    alarms: AxisSet,
    /// Two axes whose lines are swapped.
    swapped: Option<(usize, usize)>,
    /// All feedback is random.
    wild: bool,
    command: Option<Command>,
    fifo_underrun: Option<usize>,
    pulse: Option<(usize, i32)>,
}

const COMMANDS: [Command; 11] = [
    Command::Start,
    Command::Stop,
    Command::Hold,
    Command::Resume,
    Command::Reset,
    Command::ResetPeak,
    Command::Home,
    Command::Jog,
    Command::StopNow,
    Command::Override(0),
    Command::Override(1200),
];

impl Machine {
    pub fn new(settings: &Settings) -> Self {
        let units = |turns: f64| (turns * ONE_TURN as f64) as i64;
        Self {
            cranks: settings
                .axes
                .iter()
                .map(|axis| {
                    let at = units(settings.home_turns(axis));
                    Crank {
                        counts: i128::from(axis.steps_per_turn) * i128::from(axis.gear.motor_turns),
                        in_turns: i128::from(axis.gear.crank_turns),
                        reversed: axis.reversed,
                        index: units(axis.index_turns.unwrap_or_default()),
                        commanded: [at; 4],
                        apart: 0,
                        walks: 0,
                        stuck: false,
                        reversed_by_mistake: false,
                        index_dead: axis.index_turns.is_none(),
                        glitch: 0,
                        encoder_dead: false,
                        was: at,
                        is: at,
                    }
                })
                .collect(),
            tick_cycles: i64::from(settings.tick_cycles()),
            enable: true,
            stop: false,
            alarms: 0,
            swapped: None,
            wild: false,
            command: Some(Command::Start),
            fifo_underrun: None,
            pulse: None,
        }
    }

    /// Applies an event. In 18 of 48 cases it removes the disturbances, and resets or starts the machine.
    pub fn disturb(&mut self, script: &mut Script<'_>, controller: &mut Controller) {
        let count = self.cranks.len();
        let axis = script.below(count);
        let what = script.byte() % 48;
        let crank = &mut self.cranks[axis];
        match what {
            0 => self.command = Some(COMMANDS[script.below(6)]),
            1 => self.enable = !self.enable,
            2 => self.stop = !self.stop,
            3 => self.alarms ^= 1 << axis,
            4 => self.fifo_underrun = Some(axis),
            5 => self.fifo_underrun = Some(script.word() as usize),
            6 => self.pulse = Some((axis, script.number())),
            7 => {
                self.pulse = Some((
                    axis,
                    script.below(200) as i32 * self.tick_cycles as i32 / 200,
                ));
            }
            8 => crank.index_dead = !crank.index_dead,
            9 => crank.glitch = crank.glitch.wrapping_add(script.number()),
            10 => crank.encoder_dead = !crank.encoder_dead,
            11 => crank.stuck = !crank.stuck,
            12 => crank.reversed_by_mistake = !crank.reversed_by_mistake,
            13 => crank.walks = i64::from(script.number()) << 8,
            // Whole electrical cycles, of a 50-pole motor.
            14 => crank.apart += i64::from(script.number() % 8) * (ONE_TURN / 50),
            15 => {
                crank.apart =
                    crank.apart.wrapping_add(i64::from(script.number()) << 20) % (8 * ONE_TURN);
            }
            16 => self.swapped = Some((axis, script.below(count))),
            17 => self.wild = true,
            18 => controller.late(script.number().unsigned_abs(), script.one_in(2)),
            19 => controller.held_over(script.number().unsigned_abs()),
            20 => controller.late(1 + script.below(2) as u32, script.one_in(2)),
            21 => {
                let turns = Turns::from_bits(i64::from(script.number()) << 20);
                let _whole = controller.set_trim(script.below(count + 2), turns);
            }
            22 => controller.seek(u64::from(script.number().unsigned_abs())),
            23..=30 => self.fix(Command::Reset),
            31..=40 => self.fix(Command::Start),
            _ => {}
        }
    }

    /// Removes all disturbances except encoder glitches, and gives a command.
    fn fix(&mut self, command: Command) {
        (self.enable, self.stop, self.wild) = (true, false, false);
        (self.alarms, self.swapped) = (0, None);
        self.command = Some(command);
        for crank in &mut self.cranks {
            (crank.walks, crank.stuck, crank.reversed_by_mistake) = (0, false, false);
            (crank.index_dead, crank.encoder_dead) = (false, false);
            crank.apart = 0;
        }
    }

    /// Number of ticks without another event.
    pub fn quiet_ticks(&self, script: &mut Script<'_>) -> u32 {
        match script.byte() {
            short @ 0..64 => u32::from(short % 4),
            long => u32::from(long),
        }
    }

    /// Returns the feedback at this deadline.
    pub fn feedback(&mut self, script: &mut Script<'_>) -> Feedback {
        for crank in &mut self.cranks {
            crank.move_on();
        }
        let mut feedback = Feedback::with_command(self.command.take());
        feedback.inputs.enable = self.enable;
        feedback.inputs.stop = self.stop;
        feedback.alarms = self.alarms;
        feedback.fifo_underrun = self.fifo_underrun.take();
        for (i, crank) in self.cranks.iter().enumerate() {
            let source = match self.swapped {
                Some((a, b)) if i == a => b,
                Some((a, b)) if i == b => a,
                _ => i,
            };
            let source = &self.cranks[source];
            feedback.index.set(i, source.pulse(self.tick_cycles));
            feedback.encoder[i] = if crank.encoder_dead {
                0
            } else {
                source.counts()
            };
        }
        if let Some((axis, cycle)) = self.pulse.take() {
            feedback.index.set(axis, Some(IndexPulse { cycle }));
        }
        if self.wild {
            let count = self.cranks.len();
            for axis in 0..count {
                let cycle = script.number();
                let pulse = script.one_in(3).then_some(IndexPulse { cycle });
                feedback.index.set(axis, pulse);
            }
            for encoder in &mut feedback.encoder[..count] {
                *encoder = script.number();
            }
            let alarm = 1 << script.below(count);
            if script.one_in(64) {
                feedback.alarms |= alarm;
            } else {
                feedback.alarms &= !alarm;
            }
            if script.one_in(8) {
                feedback.command = Some(COMMANDS[script.below(6)]);
            }
        }
        feedback
    }

    /// Stores the phases that are to be played from the next deadline on.
    pub fn play(&mut self, output: &Output) {
        for (axis, crank) in self.cranks.iter_mut().enumerate() {
            let phase = output.telemetry.axis_phase(axis);
            let last = crank.commanded[0];
            let step = phase.since(Phase::from_turns(Turns::from_bits(last)));
            crank.commanded = [
                last + step.to_bits(),
                last,
                crank.commanded[1],
                crank.commanded[2],
            ];
        }
    }
}

impl Crank {
    /// Advances to the position at this deadline: the command of two ticks ago has just been played.
    fn move_on(&mut self) {
        self.was = self.is;
        let step = self.commanded[1] - self.commanded[2];
        if self.stuck {
            self.apart -= step;
        } else if self.reversed_by_mistake {
            self.apart -= 2 * step;
        }
        self.apart = self.apart.wrapping_add(self.walks) % (1 << 60);
        self.is = self.commanded[1].wrapping_add(self.apart);
    }

    /// The pulse of a crank that met its flag going forward in the last tick, at that cycle.
    fn pulse(&self, tick_cycles: i64) -> Option<IndexPulse> {
        let (from, to) = (
            self.was.wrapping_sub(self.index),
            self.is.wrapping_sub(self.index),
        );
        let distance = to.wrapping_sub(from);
        let met = distance > 0 && from.div_euclid(ONE_TURN) != to.div_euclid(ONE_TURN);
        let left = ONE_TURN - from.rem_euclid(ONE_TURN);
        let cycle = (left as f64 / distance as f64 * tick_cycles as f64) as i64;
        (met && !self.index_dead).then_some(IndexPulse {
            cycle: cycle.clamp(0, tick_cycles) as i32,
        })
    }

    fn counts(&self) -> i32 {
        let exact = i128::from(self.is) * self.counts;
        let counts = exact.div_euclid(self.in_turns * i128::from(ONE_TURN)) as i64;
        let counts = if self.reversed { -counts } else { counts };
        (counts as i32).wrapping_add(self.glitch)
    }
}
