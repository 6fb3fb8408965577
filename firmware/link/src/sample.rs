//! Samples: the state of the control loop at the end of one tick, in the loop's own numbers.
//!
//! The loop makes a sample every n-th tick. A stream sends those of its channels that the host selected, without loss of
//! precision. Every value is a 64-bit integer. A packet begins with the first sample as it is; each further one is a
//! difference to the sample before, as a number of variable length. Most channels change little, so that a sample of six
//! axes takes about 50 bytes.

use cophase_core::signals::Telemetry;
use cophase_core::supervisor::{SafetyInputs, Situation, State};
use cophase_core::units::{Amax, MAX_AXES, PerAxis, Phase, Turns};

/// Set of channels, a bit for each [`Channel`].
pub type Channels = u16;

/// Signal of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Channel {
    /// State, flags, the amplitude's override, and the number of index pulses.
    State = 1,
    /// Requested amplitude, m/s², 48 fraction bits.
    Amax = 1 << 1,
    /// Speed of the master, turns a tick, 48 fraction bits.
    Speed = 1 << 2,
    /// Acceleration of the master, turns a tick², 48 fraction bits.
    Acceleration = 1 << 3,
    /// Phase of the master, turns, 48 fraction bits, wrapping.
    Phase = 1 << 4,
    /// Commanded phase of each axis less the master's, turns, 48 fraction bits.
    Lead = 1 << 5,
    /// Commanded steps of each axis since power-up.
    Steps = 1 << 6,
    /// Phase error of each axis as last measured, turns, 48 fraction bits.
    PhaseError = 1 << 7,
    /// Common mode, both tilts and warp of the phase errors, turns of crank angle, 48 fraction bits.
    Modes = 1 << 8,
    /// Part of each axis's phase offset that corrects phase errors, turns, 48 fraction bits.
    Correction = 1 << 9,
    /// Ticks of the program that are over.
    Program = 1 << 10,
}

/// All channels.
pub const ALL_CHANNELS: Channels = (1 << 11) - 1;

/// Flags of a sample.
pub mod flags {
    /// The drives are on.
    pub const DRIVES: u8 = 1;
    /// A hold stops the program's time.
    pub const HOLDING: u8 = 1 << 1;
    /// A fault has latched.
    pub const FAULT: u8 = 1 << 2;
    /// The enable input is closed.
    pub const ENABLE: u8 = 1 << 3;
    /// The stop input is active.
    pub const STOP: u8 = 1 << 4;
    /// The cranks have been homed.
    pub const HOMED: u8 = 1 << 5;
    /// The program is over.
    pub const PROGRAM_DONE: u8 = 1 << 6;
    /// A jog turns the machine.
    pub const JOGS: u8 = 1 << 7;
}

/// State of the loop at the end of a tick. The numbers are those of [`Telemetry`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct Sample {
    /// Control ticks since power-up.
    pub tick: u32,
    /// Number of the state ([`cophase_core::supervisor::State`]).
    pub state: u8,
    /// [`flags`].
    pub flags: u8,
    /// Override of the amplitude, in thousandths.
    pub override_permille: u16,
    /// Ticks of the program that are over.
    pub program_ticks: u32,
    /// Index pulses of all axes since power-up, wrapping.
    pub index_count: u8,
    /// Requested amplitude, bits of an [`Amax`].
    pub amax: i64,
    /// Speed of the master, bits of [`Turns`].
    pub speed: i64,
    /// Acceleration of the master.
    pub acceleration: i64,
    /// Phase of the master.
    pub phase: i64,
    /// Commanded phases less the master's.
    pub lead: PerAxis<i64>,
    /// Commanded steps.
    pub steps: PerAxis<i64>,
    /// Phase errors.
    pub phase_error: PerAxis<i64>,
    /// Common mode, tilt about both axes, warp.
    pub modes: [i64; 4],
    /// Corrections.
    pub correction: PerAxis<i64>,
}

impl Sample {
    /// All zeros: the sample before the first one of a packet.
    pub const ZERO: Self = Self {
        tick: 0,
        state: 0,
        flags: 0,
        override_permille: 0,
        program_ticks: 0,
        index_count: 0,
        amax: 0,
        speed: 0,
        acceleration: 0,
        phase: 0,
        lead: [0; MAX_AXES],
        steps: [0; MAX_AXES],
        phase_error: [0; MAX_AXES],
        modes: [0; 4],
        correction: [0; MAX_AXES],
    };

    /// Sample of a tick. `flags` has the bits of the drives and the inputs; the others are added. `index_count` is the number of index
    /// pulses so far.
    pub fn new(tick: u32, telemetry: &Telemetry, flags: u8, index_count: u8) -> Self {
        let mut all = flags;
        for (bit, is_set) in [
            (flags::HOLDING, telemetry.holding),
            (flags::FAULT, telemetry.fault.is_some()),
            (flags::HOMED, telemetry.homed),
            (flags::PROGRAM_DONE, telemetry.program_done),
            (
                flags::JOGS,
                telemetry.is_at_homing_speed && telemetry.state == State::Run,
            ),
        ] {
            all |= if is_set { bit } else { 0 };
        }
        let modes = &telemetry.modes;
        Self {
            tick,
            state: telemetry.state as u8,
            flags: all,
            override_permille: telemetry.override_permille,
            program_ticks: telemetry.program_ticks as u32,
            index_count,
            amax: telemetry.amax_requested.to_bits().cast_signed(),
            speed: telemetry.motion.speed.to_bits(),
            acceleration: telemetry.motion.acceleration.to_bits(),
            phase: telemetry.phase.since(Phase::ZERO).to_bits(),
            lead: telemetry.lead.map(Turns::to_bits),
            steps: core::array::from_fn(|axis| telemetry.steps(axis)),
            phase_error: telemetry.phase_error.map(Turns::to_bits),
            modes: [modes.common, modes.tilt_x, modes.tilt_y, modes.warp].map(Turns::to_bits),
            correction: telemetry.correction.map(Turns::to_bits),
        }
    }

    /// The part of the machine's state that decides which commands are possible.
    pub fn situation(&self) -> Situation {
        let has = |flag: u8| self.flags & flag != 0;
        let state = State::ALL.get(usize::from(self.state));
        Situation {
            state: state.copied().unwrap_or_default(),
            inputs: SafetyInputs {
                enable: has(flags::ENABLE),
                stop: has(flags::STOP),
            },
            jogs: has(flags::JOGS),
            homed: has(flags::HOMED),
            ends: false,
        }
    }

    /// Requested amplitude.
    pub const fn amax(&self) -> Amax {
        Amax::from_bits(self.amax.cast_unsigned())
    }

    /// Calls `visit` for every value of the given channels, in the order of the packet.
    fn values(&mut self, channels: Channels, axes: usize, mut visit: impl FnMut(&mut i64)) {
        let has = |channel: Channel| channels & channel as Channels != 0;
        if has(Channel::State) {
            let mut packed = i64::from(self.state)
                | i64::from(self.flags) << 8
                | i64::from(self.override_permille) << 16
                | i64::from(self.index_count) << 32;
            visit(&mut packed);
            self.state = packed as u8;
            self.flags = (packed >> 8) as u8;
            self.override_permille = (packed >> 16) as u16;
            self.index_count = (packed >> 32) as u8;
        }
        if has(Channel::Program) {
            let mut ticks = i64::from(self.program_ticks);
            visit(&mut ticks);
            self.program_ticks = ticks as u32;
        }
        for (channel, value) in [
            (Channel::Amax, &mut self.amax),
            (Channel::Speed, &mut self.speed),
            (Channel::Acceleration, &mut self.acceleration),
            (Channel::Phase, &mut self.phase),
        ] {
            if has(channel) {
                visit(value);
            }
        }
        for (channel, values) in [
            (Channel::Lead, &mut self.lead),
            (Channel::Steps, &mut self.steps),
            (Channel::PhaseError, &mut self.phase_error),
            (Channel::Correction, &mut self.correction),
        ] {
            if has(channel) {
                values.iter_mut().take(axes).for_each(&mut visit);
            }
        }
        if has(Channel::Modes) {
            self.modes.iter_mut().for_each(visit);
        }
    }
}

/// Greatest number of values of a sample.
const VALUES: usize = 2 + 4 + 4 * MAX_AXES + 4;

/// Greatest length of one packed sample, bytes.
pub const MAX_PACKED_BYTES: usize = VARINT_BYTES * VALUES;

/// Appends a sample to a packet, after the sample `before` (zeros for the first one).
///
/// Returns false if the packet has no room for it. The packet then stays as it was.
pub fn pack<const N: usize>(
    sample: &Sample,
    before: &Sample,
    channels: Channels,
    axes: usize,
    packet: &mut heapless::Vec<u8, N>,
) -> bool {
    let start = packet.len();
    let mut deltas = [0; VALUES];
    let mut count = 0;
    let (mut now, mut last) = (*sample, *before);
    now.values(channels, axes, |value| {
        deltas[count] = *value;
        count += 1;
    });
    let mut i = 0;
    last.values(channels, axes, |value| {
        deltas[i] = deltas[i].wrapping_sub(*value);
        i += 1;
    });
    let fits = deltas[..count]
        .iter()
        .all(|&delta| push_varint(delta, packet));
    if !fits {
        packet.truncate(start);
    }
    fits
}

/// Samples of a packet. `tick` is the tick of the first one, and `every` is the distance of two in ticks. They end with
/// the packet, or where its bytes are no sample. Channels that are not in the packet are zero.
pub fn unpack(
    tick: u32,
    every: u16,
    channels: Channels,
    axes: usize,
    mut packet: &[u8],
) -> impl Iterator<Item = Sample> {
    let mut last = Sample {
        tick: tick.wrapping_sub(every.into()),
        ..Sample::ZERO
    };
    core::iter::from_fn(move || {
        // A packet without channels has no samples, whatever its bytes are.
        if packet.is_empty() || channels & ALL_CHANNELS == 0 || axes == 0 {
            return None;
        }
        let mut complete = true;
        last.values(channels, axes, |value| match take_varint(&mut packet) {
            Some(delta) => *value = value.wrapping_add(delta),
            None => complete = false,
        });
        last.tick = last.tick.wrapping_add(every.into());
        complete.then_some(last)
    })
}

/// Greatest length of a number of 64 bits, 7 bits a byte.
const VARINT_BYTES: usize = 10;

/// Appends a number: zigzag, then seven bits a byte, the lowest first.
fn push_varint<const N: usize>(value: i64, packet: &mut heapless::Vec<u8, N>) -> bool {
    let mut rest = ((value << 1) ^ (value >> 63)).cast_unsigned();
    while rest > 0x7F {
        if packet.push(rest as u8 | 0x80).is_err() {
            return false;
        }
        rest >>= 7;
    }
    packet.push(rest as u8).is_ok()
}

fn take_varint(packet: &mut &[u8]) -> Option<i64> {
    let mut value = 0_u64;
    for i in 0..VARINT_BYTES {
        let (&byte, rest) = packet.split_first()?;
        *packet = rest;
        value |= u64::from(byte & 0x7F).checked_shl(7 * i as u32)?;
        if byte & 0x80 == 0 {
            return Some((value >> 1).cast_signed() ^ -(value & 1).cast_signed());
        }
    }
    None
}
