//! A simulated controller behind the host link behaves as in a run of its scene.

use std::time::{Duration, Instant};

use cophase_core::supervisor::{FaultKind, State};
use cophase_link::client::Client;
use cophase_link::frame::MAX_FRAME_BYTES;
use cophase_link::message::{ControlRequest, Event, File, Message, ReplyBody, Request};
use cophase_link::program::MAX_PROGRAM_BYTES;
use cophase_link::sample::{ALL_CHANNELS, Sample, flags, unpack};
use cophase_link::server::Hub;
use cophase_scene::file::{FaultAt, FaultName};
use cophase_scene::load;
use host_sim::checked::Checked;
use host_sim::live::SimulatedDevice;
use host_sim::sim::{Moment, Observer, simulate};

/// Simulated seconds per second. At a much higher speed the queue of samples overflows.
const SPEED: f64 = 4.0;

/// Longest time that a test waits for the loop.
const PATIENCE: Duration = Duration::from_secs(60);

fn checked(level_g: f64) -> Checked {
    let text = format!(
        "name = \"link\"\n\
         fidelity = \"kinematic\"\n\
         [machine]\ncrank_radius_mm = 12\nlambda = 0.3\nload_kg = 5\n\
         [control]\nsettle_s = 0.01\n\
         [limits]\nspeed_hz = 20\nacceleration_hz_per_s = 100\njerk_hz_per_s2 = 4000\nhoming_speed_hz = 5\n\
         [axes]\ncount = 3\ndrive = \"stepper\"\nsteps_per_turn = 3200\n\
         [[program]]\namax_g = {level_g}\nramp_s = 0.2\nhold_s = 0.2\n\
         [[program]]\namax_g = 0\nramp_s = 0.2\nhold_s = 0.0\n"
    );
    Checked::new(load::parse(&text).unwrap()).unwrap()
}

/// A host and its controller.
struct Bench {
    hub: Hub<SimulatedDevice, 1>,
    client: Client,
    axes: usize,
    samples: Vec<Sample>,
}

impl Bench {
    fn new(checked: &Checked) -> Self {
        let device = SimulatedDevice::new(checked.clone(), SPEED).unwrap();
        Self::on(device, checked)
    }

    fn on(device: SimulatedDevice, checked: &Checked) -> Self {
        Self {
            hub: Hub::new(device),
            client: Client::new(),
            axes: checked.settings.axes.len(),
            samples: Vec::new(),
        }
    }

    fn request(&mut self, request: &Request<'_>) -> Result<Vec<u8>, String> {
        let mut frame = [0; MAX_FRAME_BYTES];
        let (number, length) = self.client.request(request, &mut frame).unwrap();
        self.hub.receive(0, &frame[..length]);
        let mut answer = None;
        self.read(|message| {
            if let Message::Reply { to, body } = message
                && *to == number
            {
                answer = Some(match body {
                    Ok(ReplyBody::Chunk { bytes, .. }) => Ok(bytes.to_vec()),
                    Ok(_) => Ok(Vec::new()),
                    Err(refusal) => Err(refusal.to_string()),
                });
            }
        });
        answer.expect("every request is answered")
    }

    /// Reads the messages of the controller, and keeps the samples.
    fn read(&mut self, mut visit: impl FnMut(&Message<'_>)) {
        let mut bytes = [0; 256];
        loop {
            let count = self.hub.transmit(0, &mut bytes);
            for &byte in &bytes[..count] {
                let Some(message) = self.client.push(byte) else {
                    continue;
                };
                visit(&message);
                if let Message::Samples {
                    tick,
                    every,
                    channels,
                    packet,
                    ..
                } = message
                {
                    let samples = unpack(tick, every, channels, self.axes, packet);
                    self.samples.extend(samples);
                }
            }
            if count == 0 {
                return;
            }
        }
    }

    /// Waits until a sample meets the condition, and returns the sample.
    fn wait(&mut self, is_there: impl Fn(&Sample) -> bool) -> Sample {
        let end = Instant::now() + PATIENCE;
        let mut read = self.samples.len();
        while Instant::now() < end {
            while self.hub.poll_one() {
                self.read(|_| {});
            }
            if let Some(sample) = self.samples[read..].iter().find(|sample| is_there(sample)) {
                return *sample;
            }
            read = self.samples.len();
            std::thread::yield_now();
        }
        panic!(
            "not within {PATIENCE:?}; the last is {:?}",
            self.samples.last()
        );
    }

    fn stream(&mut self) {
        let (channels, every) = (ALL_CHANNELS, 1);
        self.request(&Request::Stream { channels, every }).unwrap();
    }

    fn start(&mut self) {
        self.request(&Request::Control(ControlRequest::Take))
            .unwrap();
        self.request(&Request::Arm).unwrap();
        self.request(&Request::Start).unwrap();
    }
}

fn is_parked(sample: &Sample) -> bool {
    sample.state == State::Parked as u8
}

/// States of the loop at the end of each tick of a run.
#[derive(Default)]
struct Ticks(Vec<Sample>);

impl Observer for Ticks {
    fn tick(&mut self, moment: &Moment<'_>) {
        let flags = flags::ENABLE
            | if moment.drives_enabled {
                flags::DRIVES
            } else {
                0
            };
        self.0.push(Sample::new(0, moment.telemetry, flags, 0));
    }
}

/// If this fails, a program tried on the simulated controller does something else on a board.
#[test]
fn a_run_over_the_link_is_that_of_the_scene_bit_for_bit() {
    let checked = checked(2.0);
    let mut ticks = Ticks::default();
    simulate(&checked, &mut ticks, |_, _| {}).unwrap();
    let mut bench = Bench::new(&checked);
    bench.stream();
    bench.start();
    bench.wait(is_parked);
    let began = bench
        .samples
        .iter()
        .position(|sample| sample.state == State::Homing as u8);
    let live = &bench.samples[began.expect("it homes")..];
    let first = live[0].tick;
    let mut compared = 0;
    for sample in live {
        let Some(expected) = ticks.0.get((sample.tick - first) as usize) else {
            break;
        };
        let expected = Sample {
            tick: sample.tick,
            flags: sample.flags,
            index_count: sample.index_count, // The board counts pulses; a run of a scene does not.
            ..*expected
        };
        assert_eq!(*sample, expected);
        compared += 1;
    }
    println!("{compared} of {} ticks compared", ticks.0.len());
    assert!(compared > 1000, "only {compared} ticks were compared");
}

/// The loaded program runs, and not the one of the settings.
#[test]
fn a_program_that_is_loaded_runs() {
    let other = checked(3.0);
    let mut buffer = [0; MAX_PROGRAM_BYTES];
    let program = cophase_link::program::encode(&other.settings, &mut buffer).unwrap();
    let mut bench = Bench::new(&checked(1.0));
    bench
        .request(&Request::Control(ControlRequest::Take))
        .unwrap();
    let write = |bench: &mut Bench, bytes: &[u8]| {
        let file = File::Program;
        let (length, crc) = (bytes.len() as u32, cophase_link::checksum(bytes));
        bench
            .request(&Request::BeginWrite { file, length, crc })
            .unwrap();
        bench.request(&Request::Write { offset: 0, bytes }).unwrap();
        bench.request(&Request::FinishWrite)
    };
    write(&mut bench, program).unwrap();
    let (file, offset) = (File::Program, 0);
    let read = bench.request(&Request::Read { file, offset }).unwrap();
    assert_eq!(read, program);
    bench.stream();
    bench.start();
    bench.wait(is_parked);
    let peak = bench
        .samples
        .iter()
        .map(|sample| sample.amax().to_num::<f64>());
    let peak_g = peak.fold(0.0, f64::max) / 9.80665;
    assert!((peak_g - 3.0).abs() < 1e-9, "{peak_g} g");

    // A level that the machine cannot reach is refused by its entry, and the old program stays.
    let fast = checked(2.0).settings;
    let mut program = fast.program.clone();
    if let Some(cophase_core::program::EntrySettings::Segment(segment)) = program.get_mut(1) {
        segment.amax_mps2 = 5000.0;
    }
    let bytes = {
        let mut settings = fast.clone();
        settings.program = program;
        let mut buffer = [0; MAX_PROGRAM_BYTES];
        cophase_link::program::encode(&settings, &mut buffer)
            .unwrap()
            .to_vec()
    };
    let refused = write(&mut bench, &bytes).unwrap_err();
    assert!(
        refused.contains("program.amax_mps2 (number 1)"),
        "{refused}"
    );
    let read = bench.request(&Request::Read { file, offset }).unwrap();
    assert_ne!(read, bytes);
}

/// Settings take effect with a restart, as on a board.
#[test]
fn settings_take_effect_after_a_restart() {
    let other = checked(3.0);
    let mut buffer = vec![0; cophase_link::MAX_FILE_BYTES];
    let file = cophase_link::encode(&other.settings, 1, 0, &mut buffer)
        .unwrap()
        .to_vec();
    let mut bench = Bench::new(&checked(1.0));
    bench
        .request(&Request::Control(ControlRequest::Take))
        .unwrap();
    let begin = Request::BeginWrite {
        file: File::Settings,
        length: file.len() as u32,
        crc: cophase_link::checksum(&file),
    };
    bench.request(&begin).unwrap();
    for (i, bytes) in file.chunks(384).enumerate() {
        let offset = 384 * i as u32;
        bench.request(&Request::Write { offset, bytes }).unwrap();
    }
    bench.request(&Request::FinishWrite).unwrap();
    let crc = |bench: &mut Bench| {
        let request = Request::Read {
            file: File::Program,
            offset: 0,
        };
        cophase_link::checksum(&bench.request(&request).unwrap())
    };
    let before = crc(&mut bench);
    bench.request(&Request::Restart).unwrap();
    assert_ne!(crc(&mut bench), before);
}

/// If this fails, a fault is injected too late, or one that the scene's machine cannot have. The page then shows a
/// behaviour that no scene has.
#[test]
fn injected_faults_are_named_and_impossible_ones_are_refused() {
    let fault = |kind, axis| FaultAt {
        axis: Some(axis),
        ..FaultAt::new(0.0, kind)
    };
    let checked = checked(2.0);
    let device = SimulatedDevice::open_to_faults(checked.clone(), SPEED).unwrap();
    let mut bench = Bench::on(device, &checked);
    for (wrong, key) in [
        (fault(FaultName::Stuck, 3), "fault[0].axis"),
        (fault(FaultName::Slip, 0), "fault[0].rate_deg_per_s"),
        (fault(FaultName::LoadStep, 0), "fault[0].torque_nm"),
        (FaultAt::new(0.0, FaultName::Overrun), "fault[0].kind"),
    ] {
        let error = bench.hub.device().inject(&wrong).unwrap_err().to_string();
        assert!(error.contains(key), "{error}");
    }
    bench.stream();
    bench.start();
    bench.wait(|sample| sample.state == State::Run as u8 && sample.speed > 0);
    let slip = FaultAt {
        rate_deg_per_s: Some(90.0),
        ..fault(FaultName::Slip, 2)
    };
    bench.hub.device().inject(&slip).unwrap();
    bench.wait(|sample| sample.state == State::Fault as u8);
    let (from, mut fault) = (0, None);
    let mut frame = [0; MAX_FRAME_BYTES];
    let (_, length) = bench
        .client
        .request(&Request::Events { from }, &mut frame)
        .unwrap();
    bench.hub.receive(0, &frame[..length]);
    bench.read(|message| {
        if let Message::Reply {
            body: Ok(ReplyBody::Events(events)),
            ..
        } = message
        {
            // The last event has the most precise name.
            fault = events.iter().rev().find_map(|record| match &record.event {
                Event::Fault(fault) => fault.fault(),
                _ => None,
            });
        }
    });
    let fault = fault.expect("the log has it");
    assert_eq!((fault.kind, fault.axis), (FaultKind::Slip, Some(2)));
}
