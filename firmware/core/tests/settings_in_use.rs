//! The settings in use are checked completely: every word of a controller that a setting decides, and that no tick changes.
//!
//! The words are found in the memory of controllers, not in a list. One key of some settings is changed at a time. The words that differ
//! then, and that no tick of a long run changes, hold that setting. Every flipped bit of them must be found, unless it changes nothing in a
//! run: it lies between fields.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use cophase_core::axes::{CamSettings, CamTableSettings, FollowerSettings, GearSettings};
use cophase_core::controller::Controller;
use cophase_core::mechanism::{MechanismSettings, ScotchYokeSettings, SliderCrankSettings};
use cophase_core::monitor::IndexPulse;
use cophase_core::program::{EntrySettings, SegmentSettings, Shape};
use cophase_core::settings::{
    AxisSettings, BandSettings, CorrectionSettings, Drift, DriveKind, HostLossSettings,
    IndexSettings, LimitSettings, MachineSettings, Platform, PlatformSettings, PulseSettings,
    Settings, ShaftSettings, Transmission, WiringSettings, short_name,
};
use cophase_core::signals::Feedback;
use cophase_core::supervisor::{Command, State};
use cophase_core::units::{Phase, Turns};

/// Ticks of a run, and more than a round of the check has.
const TICKS: u32 = 30_000;
const ROUND: u32 = 2000;

/// Part of a controller that a key decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Decides {
    /// Constants.
    Constants,
    /// The state at the start, such as a phase. It is no setting any more, once the machine moves.
    State,
    /// Nothing: it is for set-up, or for what is around the controller.
    Nothing,
}

/// Changes one key, by its number among those that [`visit`] passes.
struct Change {
    left: usize,
    key: Option<(&'static str, Decides)>,
}

impl Change {
    fn key<T>(
        &mut self,
        key: &'static str,
        decides: Decides,
        value: &mut T,
        to: impl FnOnce(&T) -> T,
    ) {
        if self.left == 0 {
            *value = to(value);
            self.key = Some((key, decides));
        }
        self.left = self.left.wrapping_sub(1);
    }

    fn number(&mut self, key: &'static str, decides: Decides, value: &mut f64) {
        self.key(key, decides, value, |value| value * 0.96);
    }

    fn flag(&mut self, key: &'static str, decides: Decides, value: &mut bool) {
        self.key(key, decides, value, |value| !value);
    }
}

use Decides::{Constants, Nothing, State as Start};

/// Passes all keys. Settings are taken apart completely, so a new key does not compile until it is here.
fn visit(settings: &mut Settings, on: &mut Change) {
    let Settings {
        name,
        tick_hz,
        clock_hz,
        machine,
        limits,
        pulse,
        index,
        axes,
        cams,
        trims_turns,
        drift,
        correction,
        park_turns,
        settle_s,
        has_brake,
        wiring:
            WiringSettings {
                step: _,
                drive_enable: _,
                index: _,
                alarm: _,
                enable: _,
                stop: _,
                start: _,
            },
        host_loss: HostLossSettings {
            timeout_s,
            reaction: _,
        },
        program,
    } = settings;
    on.key("name", Nothing, name, |_| short_name("other"));
    on.key("tick_hz", Constants, tick_hz, |_| 2500);
    on.key("clock_hz", Constants, clock_hz, |_| 126_000_000);
    match machine {
        MachineSettings::Shafts(ShaftSettings { length_m }) => {
            on.number("length_m", Constants, length_m);
        }
        MachineSettings::Platform(platform) => visit_platform(platform, on),
    }
    let LimitSettings {
        speed_hz,
        acceleration_hz_per_s,
        jerk_hz_per_s2,
        stop_acceleration_hz_per_s,
        stop_jerk_hz_per_s2,
        homing_speed_hz,
        bands,
    } = limits;
    on.number("speed_hz", Constants, speed_hz);
    on.number("acceleration_hz_per_s", Constants, acceleration_hz_per_s);
    on.number("jerk_hz_per_s2", Constants, jerk_hz_per_s2);
    on.key(
        "stop_acceleration_hz_per_s",
        Constants,
        stop_acceleration_hz_per_s,
        |value| value * 1.04,
    );
    on.key(
        "stop_jerk_hz_per_s2",
        Constants,
        stop_jerk_hz_per_s2,
        |value| value * 1.04,
    );
    on.number("homing_speed_hz", Constants, homing_speed_hz);
    for BandSettings { from_hz, to_hz } in bands {
        on.number("band.from_hz", Constants, from_hz);
        on.number("band.to_hz", Constants, to_hz);
    }
    pulse.visit(|row, value| on.number(row.name, Constants, value));
    index.visit(|row, value| on.number(row.name, Constants, value));
    axes.iter_mut().for_each(|axis| visit_axis(axis, on));
    for CamSettings {
        net_turns,
        max_speed_hz,
        max_acceleration_hz_per_s,
        points_turns,
    } in cams
    {
        if on.left == 0 {
            // The points go on by as much, or the table would jump where it closes.
            let count = points_turns.len() as f64;
            for (i, point) in points_turns.iter_mut().enumerate() {
                *point += i as f64 / count;
            }
        }
        on.key("cam.net_turns", Constants, net_turns, |turns| turns + 1);
        on.number("cam.max_speed_hz", Nothing, max_speed_hz);
        on.number(
            "cam.max_acceleration_hz_per_s",
            Nothing,
            max_acceleration_hz_per_s,
        );
        for point in points_turns {
            on.key("cam.points_turns", Constants, point, |point| point + 1e-4);
        }
    }
    for trim in trims_turns {
        on.number("trims_turns", Start, trim);
    }
    drift.visit(|row, value| on.number(row.name, Constants, value));
    let CorrectionSettings {
        gain,
        prove_wiring,
        coupling,
        coupling_per_s,
    } = correction;
    on.number("gain", Constants, gain);
    on.flag("prove_wiring", Constants, prove_wiring);
    on.number("coupling", Constants, coupling);
    on.number("coupling_per_s", Constants, coupling_per_s);
    on.number("park_turns", Constants, park_turns);
    on.number("settle_s", Constants, settle_s);
    on.flag("has_brake", Constants, has_brake);
    on.key("timeout_s", Nothing, timeout_s, |_| 1.0);
    for entry in program {
        match entry {
            EntrySettings::Segment(SegmentSettings {
                amax_mps2,
                ramp_s,
                hold_s,
                shape,
            }) => {
                on.number("program.amax_mps2", Constants, amax_mps2);
                on.number("program.ramp_s", Constants, ramp_s);
                on.number("program.hold_s", Constants, hold_s);
                on.key("program.shape", Constants, shape, |_| Shape::Linear);
            }
            EntrySettings::Repeat { first, times } => {
                on.key("program.first", Constants, first, |_| 1);
                on.key("program.times", Constants, times, |_| 4);
            }
        }
    }
}

fn visit_platform(platform: &mut PlatformSettings, on: &mut Change) {
    let PlatformSettings {
        crank_radius_m,
        mechanism,
        load_kg,
        platform,
        gravity_mps2,
        mount_radius_m,
        allow_commanded_tilt,
    } = platform;
    on.number("crank_radius_m", Constants, crank_radius_m);
    mechanism.visit(|key, number| on.number(key, Constants, number));
    on.number("load_kg", Constants, load_kg);
    on.key("platform", Constants, platform, |_| Platform::Below);
    on.number("gravity_mps2", Constants, gravity_mps2);
    on.number("mount_radius_m", Constants, mount_radius_m);
    on.flag("allow_commanded_tilt", Nothing, allow_commanded_tilt);
}

fn visit_axis(axis: &mut AxisSettings, on: &mut Change) {
    let AxisSettings {
        drive,
        steps_per_turn,
        gear: Transmission {
            motor_turns,
            crank_turns,
        },
        reversed,
        follower,
        offset_turns,
        index_turns,
        index_width_turns,
        index_delay_s,
        encoder,
        cycle_steps,
        trim_limit_turns,
        trim_rate_hz,
        rotor_inertia_kgm2,
    } = axis;
    on.key("drive", Constants, drive, |drive| match drive {
        DriveKind::Servo => DriveKind::Stepper,
        DriveKind::Stepper | DriveKind::PulseServo => DriveKind::Servo,
    });
    on.key("steps_per_turn", Constants, steps_per_turn, |steps| {
        steps / 2
    });
    on.key("motor_turns", Constants, motor_turns, |turns| turns + 1);
    on.key("crank_turns", Constants, crank_turns, |turns| turns + 2);
    on.flag("reversed", Constants, reversed);
    match follower {
        FollowerSettings::Gear(GearSettings {
            numerator,
            denominator,
        }) => {
            on.key("numerator", Constants, numerator, |turns| turns + 1);
            on.key("denominator", Constants, denominator, |turns| turns + 1);
        }
        FollowerSettings::CamTable(CamTableSettings { table, shift_turns }) => {
            on.key("table", Constants, table, |table| 1 - table);
            on.number("shift_turns", Start, shift_turns);
        }
    }
    on.key("offset_turns", Start, offset_turns, |turns| turns + 1e-4);
    on.key("index_turns", Constants, index_turns, |turns| {
        turns.map(|turns| turns + 0.01)
    });
    on.key("index_width_turns", Constants, index_width_turns, |turns| {
        turns + 0.01
    });
    on.key("index_delay_s", Constants, index_delay_s, |time_s| {
        time_s + 1e-5
    });
    on.flag("encoder", Constants, encoder);
    on.key("cycle_steps", Constants, cycle_steps, |steps| steps * 2);
    on.number("trim_limit_turns", Constants, trim_limit_turns);
    on.number("trim_rate_hz", Constants, trim_rate_hz);
    on.number("rotor_inertia_kgm2", Constants, rotor_inertia_kgm2);
}

// ---- machines, which together use all keys ----

const AXIS: AxisSettings = AxisSettings {
    index_turns: Some(0.05),
    index_width_turns: 0.02,
    index_delay_s: 1e-5,
    rotor_inertia_kgm2: 1e-3,
    ..AxisSettings::DEFAULT
};

/// Steppers under a platform on a mechanism; every feature for steppers is on.
fn platform(mechanism: MechanismSettings) -> Settings {
    let segment = |amax_mps2| {
        EntrySettings::Segment(SegmentSettings {
            amax_mps2,
            ramp_s: 1.0,
            hold_s: 1.5,
            shape: Shape::Smooth,
        })
    };
    Settings {
        tick_hz: 2000,
        clock_hz: 125_000_000,
        machine: MachineSettings::Platform(PlatformSettings {
            crank_radius_m: 0.02,
            mechanism,
            load_kg: 10.0,
            platform: Platform::Above,
            gravity_mps2: 9.80665,
            mount_radius_m: 0.25,
            allow_commanded_tilt: true,
        }),
        limits: LimitSettings {
            speed_hz: 20.0,
            acceleration_hz_per_s: 20.0,
            jerk_hz_per_s2: 200.0,
            stop_acceleration_hz_per_s: 40.0,
            stop_jerk_hz_per_s2: 400.0,
            homing_speed_hz: 1.0,
            bands: [BandSettings {
                from_hz: 6.0,
                to_hz: 7.0,
            }]
            .into_iter()
            .collect(),
        },
        pulse: PulseSettings::DEFAULT,
        index: IndexSettings::DEFAULT,
        axes: core::iter::repeat_n(AXIS, 4).collect(),
        trims_turns: [0.001, -0.001].into_iter().collect(),
        drift: Drift {
            lag_us: 100.0,
            ..Drift::DEFAULT
        },
        correction: CorrectionSettings {
            gain: 0.3,
            ..CorrectionSettings::NONE
        },
        park_turns: 0.5,
        settle_s: 0.05,
        program: heapless::Vec::from_array([
            segment(60.0),
            segment(100.0),
            EntrySettings::Repeat { first: 0, times: 3 },
        ]),
        ..Settings::new()
    }
}

/// Servos with encoders under a platform, coupled.
fn servos() -> Settings {
    let mut settings = platform(MechanismSettings::SliderCrank(SliderCrankSettings {
        lambda: 0.3,
    }));
    for axis in &mut settings.axes {
        axis.drive = DriveKind::Servo;
        axis.encoder = true;
    }
    settings.correction.coupling = 0.5;
    settings.correction.coupling_per_s = 1.0;
    settings
}

/// Shafts without a platform: a gear, a belt whose half-steps leave a remainder, and two cam tables.
fn shafts() -> Settings {
    let mut settings = platform(MechanismSettings::ScotchYoke(ScotchYokeSettings {}));
    settings.machine = MachineSettings::Shafts(ShaftSettings { length_m: 0.026 });
    settings.correction = CorrectionSettings::NONE;
    let points = |height: f64| {
        (0..8).map(move |i| height * (f64::from(i) * core::f64::consts::FRAC_PI_4).sin())
    };
    for height in [0.05, 0.08] {
        settings
            .cams
            .push(CamSettings {
                net_turns: 0,
                max_speed_hz: CamSettings::USUAL_MAX_SPEED_HZ,
                max_acceleration_hz_per_s: CamSettings::USUAL_MAX_ACCELERATION_HZ_PER_S,
                points_turns: points(height).collect(),
            })
            .unwrap();
    }
    settings.axes[1].follower = FollowerSettings::gear((2, 3));
    settings.axes[1].gear = Transmission {
        motor_turns: 57,
        crank_turns: 11,
    };
    settings.axes[1].steps_per_turn = 200;
    for axis in &mut settings.axes[2..] {
        axis.index_turns = None;
        axis.follower = FollowerSettings::CamTable(CamTableSettings {
            table: 0,
            shift_turns: 0.2,
        });
    }
    settings
}

fn machines() -> Vec<(String, Settings)> {
    let mut mechanisms: Vec<_> = MechanismSettings::samples().collect();
    mechanisms.dedup_by_key(|settings| core::mem::discriminant(settings));
    let mut machines: Vec<_> = mechanisms
        .into_iter()
        .map(|settings| (format!("{settings:?}"), platform(settings)))
        .collect();
    machines.extend([
        ("servos".to_owned(), servos()),
        ("shafts".to_owned(), shafts()),
    ]);
    machines
}

// ---- controllers, and their memory ----

/// Creates a controller in memory that was zero, so that the bytes between its fields are, too.
fn controller(settings: &Settings) -> Option<Box<Controller>> {
    let mut memory = Box::<Controller>::new_zeroed();
    memory.write(Controller::new());
    // SAFETY: it was written.
    let mut controller = unsafe { memory.assume_init() };
    controller.configure(settings).ok()?;
    Some(controller)
}

const BYTES: usize = size_of::<Controller>();

fn bytes(controller: &Controller) -> Vec<u8> {
    let start = core::ptr::from_ref(controller).cast::<u8>();
    // SAFETY: all of these bytes belong to the controller. A volatile read takes each as it is.
    (0..BYTES)
        .map(|at| unsafe { start.add(at).read_volatile() })
        .collect()
}

/// Bytes of the last output, which is state: what was commanded so far.
fn output() -> core::ops::Range<usize> {
    let mut controller = Box::new(Controller::new());
    let start = core::ptr::from_ref(&*controller).addr();
    let output = controller.tick(&Feedback::with_command(None));
    let from = core::ptr::from_ref(output).addr() - start;
    from..from + size_of_val(output)
}

fn flip(controller: &mut Controller, at: usize, mask: u8) {
    assert!(at < BYTES);
    let start = core::ptr::from_mut(controller).cast::<u8>();
    // SAFETY: the byte belongs to the controller. The check alone reads it, which takes any bits.
    unsafe {
        let byte = start.add(at);
        byte.write_volatile(byte.read_volatile() ^ mask);
    }
}

fn is_unchanged(controller: &mut Controller) -> bool {
    (0..ROUND).all(|_| controller.check_settings())
}

/// Plays a run with cranks that drift, and commands and inputs at random. Passes the controller to `observe` after each tick. Returns the
/// states, and a hash of all outputs.
fn play(
    mut controller: Box<Controller>,
    settings: &Settings,
    ticks: u32,
    mut observe: impl FnMut(u32, &mut Controller),
) -> (Vec<State>, u64) {
    let mut outputs = DefaultHasher::new();
    let mut feedback = Feedback::with_command(None);
    let mut states = Vec::new();
    let mut seed = 1_u64;
    let mut random = |below: u64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) % below
    };
    let mut errors = [0.0_f64; 6];
    let mut last = [None; 6];
    for tick in 0..ticks {
        let output = controller.tick(&feedback);
        let telemetry = output.telemetry.clone();
        (
            output.drives_enabled,
            telemetry.phase.since(Phase::ZERO),
            telemetry.state as u8,
        )
            .hash(&mut outputs);
        (telemetry.event_count, telemetry.amax_requested).hash(&mut outputs);
        for (axis, setpoint) in output.setpoints.iter().enumerate() {
            (
                setpoint.position.since(Phase::ZERO),
                setpoint.torque,
                telemetry.steps(axis),
            )
                .hash(&mut outputs);
            output
                .runs(axis)
                .iter()
                .for_each(|run| run.bits().hash(&mut outputs));
        }
        if !states.contains(&telemetry.state) {
            states.push(telemetry.state);
        }
        feedback = Feedback::with_command(None);
        for (axis, own) in settings.axes.iter().enumerate() {
            if random(4000) == 0 {
                errors[axis] += (random(200) as f64 - 100.0) * 1e-5;
            }
            let steps = telemetry.steps(axis) as i32;
            feedback.encoder[axis] = if own.reversed { -steps } else { steps };
            let place = own.index_turns.unwrap_or(0.0) - errors[axis];
            let phase = telemetry
                .axis_phase(axis)
                .since(Phase::from_turns(Turns::from_num(place)));
            let turn = phase.to_num::<f64>().floor() as i64;
            if last[axis].replace(turn).is_some_and(|last| turn > last) {
                feedback.index.set(axis, Some(IndexPulse { cycle: 0 }));
            }
        }
        feedback.command = match telemetry.state {
            State::Idle | State::Parked if random(50) == 0 => Some(Command::Start),
            State::Fault if random(200) == 0 => Some(Command::Reset),
            _ => match random(6000) {
                0 => Some(Command::Stop),
                1 => Some(Command::Hold),
                2 => Some(Command::Resume),
                3 => Some(Command::ResetPeak),
                4 => Some(Command::Override(random(1200) as u16)),
                _ => None,
            },
        };
        // The machine reaches the run before the first of these.
        let may_fail = tick > TICKS / 2;
        feedback.alarms = u8::from(may_fail && random(8000) == 0);
        feedback.inputs.enable = !may_fail || random(8000) != 0;
        feedback.inputs.stop = may_fail && random(12_000) == 0;
        if random(3000) == 0 {
            let trim = (random(200) as f64 - 100.0) * 3e-5;
            controller.set_trim(random(6) as usize, Turns::from_num(trim));
        }
        if random(9000) == 0 {
            controller.late(1, false);
        }
        observe(tick, &mut controller);
    }
    (states, outputs.finish())
}

/// If this fails for a key, a flipped bit of that setting stays missed while the machine runs. If the check fails in a tick, it takes state
/// for a setting, and switches the drives off for no reason.
#[test]
fn every_flipped_bit_of_the_settings_in_use_is_found() {
    let mut keys = BTreeMap::<_, usize>::new();
    for (name, settings) in machines() {
        let mut changed = vec![false; BYTES / 4];
        let before = bytes(&controller(&settings).unwrap());
        let output = output();
        let (states, _) = play(
            controller(&settings).unwrap(),
            &settings,
            TICKS,
            |tick, controller| {
                assert!(
                    controller.check_settings(),
                    "{name}: the check fails in tick {tick}"
                );
                let now = bytes(controller);
                for (word, changed) in changed.iter_mut().enumerate() {
                    let bytes = word * 4..word * 4 + 4;
                    *changed |= now[bytes.clone()] != before[bytes];
                }
            },
        );
        assert!(
            states.contains(&State::Run) && states.contains(&State::Fault),
            "{name}: {states:?}"
        );
        let mut held = vec![false; BYTES];
        for number in 0.. {
            let mut other = settings.clone();
            let mut change = Change {
                left: number,
                key: None,
            };
            visit(&mut other, &mut change);
            let Some(key) = change.key else {
                break;
            };
            let words = keys.entry(key).or_default();
            let Some(other) = controller(&other) else {
                continue;
            };
            for (at, byte) in bytes(&other).into_iter().enumerate() {
                let holds = byte != before[at] && !changed[at / 4] && !output.contains(&at);
                if holds && key.1 == Decides::Constants {
                    *words += 1;
                    held[at] = true;
                }
            }
        }
        let mut flipped = controller(&settings).unwrap();
        let mut missed = BTreeMap::<usize, [u8; 4]>::new();
        for at in (0..BYTES).filter(|&at| held[at]) {
            for mask in (0..8).map(|bit| 1 << bit) {
                flip(&mut flipped, at, mask);
                if is_unchanged(&mut flipped) {
                    missed.entry(at / 4 * 4).or_default()[at % 4] |= mask;
                }
                flip(&mut flipped, at, mask);
                is_unchanged(&mut flipped); // The round in which a bit changes may fail.
            }
        }
        let run = |controller| play(controller, &settings, TICKS / 2, |_, _| {}).1;
        let usual = run(controller(&settings).unwrap());
        for (&word, masks) in &missed {
            let mut flipped = controller(&settings).unwrap();
            (word..)
                .zip(masks)
                .for_each(|(at, &mask)| flip(&mut flipped, at, mask));
            assert_eq!(
                run(flipped),
                usual,
                "{name}: missed bits {masks:?} at {word} of {BYTES}"
            );
        }
        let count = held.iter().filter(|held| **held).count();
        let detected = count - missed.values().flatten().filter(|mask| **mask != 0).count();
        let constant = changed.iter().filter(|changed| !**changed).count() * 4;
        println!(
            "{name}: of {BYTES} bytes, {constant} are in words that no tick changed; {count} of these differ with a setting; \
             the check finds a flipped bit in {detected} of these, and in the others it changes nothing"
        );
    }
    for ((key, decides), bytes) in keys {
        assert!(
            decides != Decides::Constants || bytes > 0,
            "{key} is in no constant"
        );
    }
}
