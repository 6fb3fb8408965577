//! Streams of samples: exact, complete, or with every loss counted.

use crate::support::device::{AXES, Effect, TICK_HZ};
use crate::support::line::{Host, TestHub, hub};
use cophase_core::settings::{HostLossReaction, HostLossSettings};
use cophase_core::supervisor::{Command, State};
use cophase_link::message::{ControlRequest, Message, ReplyBody, Request, StopKind};
use cophase_link::sample::{ALL_CHANNELS, Channel, Sample, unpack};
use proptest::prelude::*;

/// Samples with every value different.
fn samples(count: u32, seed: u64) -> Vec<Sample> {
    let mut state = seed | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> (state % 64)).cast_signed()
    };
    (0..count)
        .map(|tick| Sample {
            tick,
            state: next() as u8,
            flags: next() as u8,
            index_count: next() as u8,
            override_permille: next() as u16,
            program_ticks: next() as u32,
            amax: next(),
            speed: next(),
            acceleration: next(),
            phase: next(),
            lead: std::array::from_fn(|_| next()),
            steps: std::array::from_fn(|_| next()),
            phase_error: std::array::from_fn(|_| next()),
            modes: std::array::from_fn(|_| next()),
            correction: std::array::from_fn(|_| next()),
        })
        .collect()
}

/// Reads the samples that have been sent.
fn received(host: &mut Host, hub: &mut TestHub) -> Vec<Sample> {
    let mut all = Vec::new();
    host.read(hub, |message| {
        if let Message::Samples {
            tick,
            every,
            channels,
            count,
            packet,
        } = message
        {
            let before = all.len();
            all.extend(unpack(tick, every, channels, AXES, packet));
            assert_eq!(all.len() - before, usize::from(count));
        }
    });
    all
}

/// If this fails, a bit is lost, and a recorded run differs from the run of the controller.
#[test]
fn a_stream_has_every_sample_bit_for_bit() {
    let mut hub = hub();
    let mut host = Host::new(0);
    hub.poll();
    let stream = Request::Stream {
        channels: ALL_CHANNELS,
        every: 1,
    };
    host.request(&mut hub, &stream).unwrap();
    assert_eq!(hub.device().every, 1);
    let sent = samples(500, 7);
    let mut all = Vec::new();
    for sample in &sent {
        hub.device().samples.push_back(*sample);
        hub.poll();
        all.extend(received(&mut host, &mut hub));
    }
    // The last packet waits for more.
    let missing = sent.len() - all.len();
    assert!(missing <= TICK_HZ as usize / 50, "{missing} samples wait");
    assert_eq!(all, sent[..all.len()]);
}

/// If this fails, a host that reads too slowly does not get the number of samples that it missed.
#[test]
fn every_sample_is_received_or_counted_as_lost() {
    let mut hub = hub();
    let mut host = Host::new(0);
    hub.poll();
    let stream = Request::Stream {
        channels: ALL_CHANNELS,
        every: 2,
    };
    host.request(&mut hub, &stream).unwrap();
    let mut all = Vec::new();
    for (i, sample) in samples(4000, 3).iter().enumerate() {
        // The loop itself drops some, too.
        if i % 97 != 0 {
            hub.device().samples.push_back(*sample);
        }
        hub.poll();
        if i % 250 == 249 {
            all.extend(received(&mut host, &mut hub));
        }
    }
    all.extend(received(&mut host, &mut hub));
    let lost = host.ask(&mut hub, &Request::Counters, |reply| match reply {
        Ok(ReplyBody::Counters(counters)) => counters.samples_lost as usize,
        other => panic!("{other:?}"),
    });
    println!("{} received, {lost} lost", all.len());
    assert!(lost > 100, "the line was not too slow");
    let waiting = 2000 - all.len() - lost;
    assert!(
        waiting <= 20,
        "{waiting} samples are neither received nor lost"
    );
    // Frame numbers show the same to a host that does not request it.
    assert!(host.client.counts().missing > 0);
}

/// If this fails, such packets have samples without end, and a damaged controller stops its host.
#[test]
fn packets_without_channels_have_no_samples() {
    assert_eq!(unpack(0, 1, 0, AXES, &[1, 2, 3]).count(), 0);
    assert_eq!(unpack(0, 1, Channel::Lead as u16, 0, &[1, 2, 3]).count(), 0);
}

proptest! {
    /// Packing and unpacking is exact for any values and any selection of channels.
    #[test]
    fn samples_survive_packing(seed in any::<u64>(), axes in 1..=AXES) {
        let mut packet = heapless::Vec::<u8, 4096>::new();
        let all = samples(10, seed);
        let mut before = Sample::ZERO;
        for sample in &all {
            prop_assert!(cophase_link::sample::pack(sample, &before, ALL_CHANNELS, axes, &mut packet));
            before = *sample;
        }
        let unpacked: Vec<_> = unpack(0, 1, ALL_CHANNELS, axes, &packet).collect();
        prop_assert_eq!(unpacked.len(), all.len());
        for (sample, mut expected) in unpacked.into_iter().zip(all) {
            for axis in axes..AXES {
                for values in [&mut expected.lead, &mut expected.steps, &mut expected.phase_error, &mut expected.correction] {
                    values[axis] = 0;
                }
            }
            prop_assert_eq!(sample, expected);
        }
    }
}

/// Samples that wait: more than a link moves that has little time.
const WAITING: usize = 10_000;

/// If this fails, a stop waits for a stream, which may be endless.
#[test]
fn a_stop_waits_for_a_few_samples_and_not_for_a_stream() {
    let mut hub = hub();
    let mut host = Host::new(0);
    hub.device().samples.extend(samples(WAITING as u32, 5));
    let before = hub.device().samples.len();
    host.request(&mut hub, &Request::Stop(StopKind::Now))
        .unwrap();
    let stop = Effect::Command(Command::StopNow);
    assert!(hub.device().effects.contains(&stop));
    let moved = before - hub.device().samples.len();
    assert!(moved <= 8, "{moved} samples are moved before the stop");
}

/// If this fails, the machine of a lost host turns on while samples come faster than the link moves them.
#[test]
fn a_lost_host_stops_the_machine_while_samples_wait() {
    let mut hub = hub();
    let mut host = Host::new(0);
    hub.device().host_loss = HostLossSettings {
        timeout_s: 0.5,
        reaction: HostLossReaction::Stop,
    };
    hub.poll();
    for request in [
        Request::Control(ControlRequest::Take),
        Request::Arm,
        Request::Start,
    ] {
        host.request(&mut hub, &request).unwrap();
    }
    hub.device().enters(State::Run);
    hub.poll();
    hub.device().samples.extend(samples(WAITING as u32, 5));
    hub.device().now_ms += 500;
    hub.check_times();
    let stop = Effect::Command(Command::Stop);
    assert_eq!(hub.device().effects.last(), Some(&stop));
}
