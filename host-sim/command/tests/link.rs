//! `cophase link` against a simulated controller: in its own process, and behind a TCP port.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use cophase_link::server::Hub;
use cophase_scene::load;
use host_sim::checked::Checked;
use host_sim::live::SimulatedDevice;

use assert_cmd::Command;

/// Simulated seconds per second.
const SPEED: f64 = 4.0;

fn scene(level_g: f64, load_kg: f64) -> String {
    scene_holding(level_g, load_kg, 0.2)
}

fn scene_holding(level_g: f64, load_kg: f64, hold_s: f64) -> String {
    format!(
        "name = \"link\"\n\
         fidelity = \"kinematic\"\n\
         [machine]\ncrank_radius_mm = 12\nlambda = 0.3\nload_kg = {load_kg}\n\
         [control]\nsettle_s = 0.01\n\
         [limits]\nspeed_hz = 20\nacceleration_hz_per_s = 100\njerk_hz_per_s2 = 4000\nhoming_speed_hz = 5\n\
         [axes]\ncount = 3\ndrive = \"stepper\"\nsteps_per_turn = 3200\n\
         [[program]]\namax_g = {level_g}\nramp_s = 0.2\nhold_s = {hold_s}\n\
         [[program]]\namax_g = 0\nramp_s = 0.2\nhold_s = 0.0\n"
    )
}

/// A simulated controller behind a TCP port, like a board behind the bridge of the emulator bench.
struct Served {
    port: u16,
    is_over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Served {
    fn new(scene: &str) -> Self {
        let checked = Checked::new(load::parse(scene).unwrap()).unwrap();
        let mut hub = Hub::<_, 1>::new(SimulatedDevice::new(checked, SPEED).unwrap());
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        listener.set_nonblocking(true).unwrap();
        let is_over = Arc::new(AtomicBool::new(false));
        let ends = is_over.clone();
        let thread = std::thread::spawn(move || {
            while !ends.load(Ordering::Relaxed) {
                hub.poll();
                if let Ok((stream, _)) = listener.accept() {
                    hub.connect(0);
                    exchange(&mut hub, stream);
                    hub.disconnect(0);
                }
                std::thread::sleep(Duration::from_millis(1));
            }
        });
        Self {
            port,
            is_over,
            thread: Some(thread),
        }
    }

    fn link(&self, args: &[&str]) -> Command {
        let mut command = Command::cargo_bin("cophase").unwrap();
        command.args(["link", "--to", &format!("tcp:127.0.0.1:{}", self.port)]);
        command.args(args).timeout(Duration::from_secs(60));
        command
    }

    fn out(&self, args: &[&str]) -> String {
        let done = self.link(args).assert().success();
        String::from_utf8(done.get_output().stdout.clone()).unwrap()
    }

    fn refused(&self, args: &[&str]) -> String {
        let done = self.link(args).assert().code(2);
        String::from_utf8(done.get_output().stderr.clone()).unwrap()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// Passes bytes until the client leaves.
fn exchange(hub: &mut Hub<SimulatedDevice, 1>, mut stream: TcpStream) {
    stream.set_nonblocking(false).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_millis(1)))
        .unwrap();
    let mut bytes = [0; 1024];
    loop {
        hub.poll();
        let count = hub.transmit(0, &mut bytes);
        if stream.write_all(&bytes[..count]).is_err() {
            return;
        }
        match stream.read(&mut bytes) {
            Ok(0) => return,
            Ok(count) => hub.receive(0, &bytes[..count]),
            Err(_) => {}
        }
    }
}

/// Writes a scene to a file.
fn file(name: &str, text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

#[test]
fn a_program_is_loaded_run_and_watched() {
    let served = Served::new(&scene(1.0, 5.0));
    let identity = served.out(&["identify"]);
    assert!(
        identity.contains("simulated") && identity.contains("3, 2000 ticks"),
        "{identity}"
    );
    let (_folder, program) = file("program.toml", &scene(3.0, 5.0));
    let loaded = served.out(&["load", program.to_str().unwrap()]);
    assert!(loaded.contains("2 entries"), "{loaded}");
    assert_ne!(
        served.out(&["identify"]),
        identity,
        "the program's CRC changes"
    );
    let run = served.out(&["start", "--yes", "--wait"]);
    for state in ["homing", "run", "stop", "parked"] {
        assert!(run.contains(state), "{run}");
    }
    let log = served.out(&["log"]);
    assert!(log.contains("homing") && log.contains("parked"), "{log}");
    let shown = served.out(&["monitor", "--for", "0.5"]);
    assert!(
        shown.contains("parked") && shown.contains("override 100 %"),
        "{shown}"
    );
    assert!(served.out(&["counters"]).contains("frames damaged       0"));
}

#[test]
fn a_run_is_held_scaled_resumed_and_stopped() {
    let served = Served::new(&scene_holding(1.0, 5.0, 1000.0));
    served.out(&["start", "--yes"]);
    while !served.out(&["log"]).contains("run") {}
    served.out(&["hold"]);
    served.out(&["override", "50"]);
    assert!(
        served
            .out(&["monitor", "--for", "0.3"])
            .contains("override 50 %")
    );
    served.out(&["resume"]);
    served.out(&["stop", "--now"]);
}

/// A request that cannot be met is refused by name, with exit status 2. The machine does not move.
/// Ctrl-C ends the wait and not the machine.
#[cfg(unix)]
#[test]
fn an_interrupted_wait_states_that_the_machine_goes_on_and_what_stops_it() {
    use std::io::{BufRead, BufReader};

    let served = Served::new(&scene_holding(1.0, 5.0, 1000.0));
    let mut waiting = std::process::Command::new(assert_cmd::cargo::cargo_bin("cophase"))
        .args(["link", "--to", &format!("tcp:127.0.0.1:{}", served.port)])
        .args(["start", "--yes", "--wait"])
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(waiting.stdout.take().unwrap()).lines();
    // The machine runs, so the command waits.
    assert!(lines.any(|line| line.unwrap().contains("run")));
    let interrupt = std::process::Command::new("kill")
        .args(["-INT", &waiting.id().to_string()])
        .status();
    assert!(interrupt.unwrap().success());
    let last = lines.last().unwrap().unwrap();
    assert!(
        last.contains("The machine goes on") && last.contains("`cophase link stop`"),
        "{last}"
    );
    assert_eq!(waiting.wait().unwrap().code(), Some(130));
    assert!(served.out(&["monitor", "--for", "0.1"]).contains("run"));
    served.out(&["stop"]);
}

#[test]
fn refusals_name_the_reason() {
    let served = Served::new(&scene(1.0, 5.0));
    for (args, reason) in [
        (
            vec!["hold"],
            "not possible in state idle; it is possible in state run (after `start`, once homing is over)",
        ),
        (vec!["start"], "give --yes"),
        (
            vec!["jog", "--yes"],
            "not possible in state idle; it is possible in state parked (once `home` or `stop` is done)",
        ),
        (vec!["reset"], "it is possible in state fault\n"),
        (vec!["override", "121"], "0 to 120"),
        (vec!["load", "no-such-scene"], "no-such-scene"),
    ] {
        let error = served.refused(&args);
        assert!(error.contains(reason), "{args:?}: {error}");
    }
    let (_folder, other) = file("other.toml", &scene(1.0, 6.0));
    let error = served.refused(&["load", other.to_str().unwrap()]);
    assert!(error.contains("machine differs"), "{error}");
    assert!(served.out(&["log"]).contains("No event"), "something moved");
}

/// If this fails, an operator reads about arming, which he did not ask for, or a command that the machine drops seems to be obeyed.
#[test]
fn a_command_to_a_running_machine_is_refused_under_its_own_name() {
    let served = Served::new(&scene_holding(1.0, 5.0, 1000.0));
    served.out(&["start", "--yes"]);
    while !served.out(&["log"]).contains("run") {}
    let home = served.refused(&["home", "--yes"]);
    let idle = "home: refused: not possible in state run; it is possible in state idle (";
    assert!(
        home.contains(idle) && !home.contains("parked (once"),
        "{home}"
    );
    let jog = served.refused(&["jog", "--yes"]);
    assert!(
        jog.contains("jog: refused: a program runs; `stop` it first"),
        "{jog}"
    );
    served.out(&["stop", "--now"]);
    while !served.out(&["log"]).contains("parked") {}
    // The arm that came before the refusal is taken back.
    let home = served.refused(&["home", "--yes"]);
    assert!(
        home.contains("home: refused: not possible in state parked"),
        "{home}"
    );
    assert!(!served.out(&["monitor", "--for", "0.3"]).contains("armed"));
}

/// Brings up axis 1 of a simulated machine whose drive makes a turn with these steps. Returns what is printed, and the exit status.
fn bring_up(drive_steps: u32, more: &str) -> (String, i32) {
    let axis = format!("[[axis]]\nnumber = 1\ndrive_steps_per_turn = {drive_steps}\n");
    let (_folder, scene) = file("wrong.toml", &(scene(1.0, 5.0) + &axis + more));
    let mut command = Command::cargo_bin("cophase").unwrap();
    let to = format!("sim:{}", scene.display());
    let done = command
        .args(["link", "--to", &to, "bring-up", "axis", "1", "--yes"])
        .timeout(Duration::from_secs(60))
        .output()
        .unwrap();
    let text = String::from_utf8(done.stdout).unwrap();
    (text, done.status.code().expect("it ends by itself"))
}

/// Steps of a drive, the exit status of the bring-up, and what it says.
const RATIOS: [(u32, i32, &str); 7] = [
    (
        6400,
        1,
        "6400 steps from index to index, 3200 in the settings",
    ),
    (6400, 1, "`gear = [2, 1]`"),
    (1600, 1, "the drive makes twice the steps"),
    (800, 1, "multiply `steps_per_turn` by 1/4"),
    (5120, 1, "set its switches to 5/8 of their pulses per turn"),
    // A belt of 57:11 makes 16,582 steps of 3200, to a step.
    (16_582, 1, "`gear = [57, 11]`"),
    (
        3200,
        0,
        "axis 1: 3200 steps from index to index, as the settings say",
    ),
];

/// If this fails, wrong microsteps, or a gear that nobody stated, are found only when the platform tilts.
#[test]
fn bring_up_of_an_axis_names_a_wrong_ratio_of_steps() {
    // Most of a bring-up is waiting.
    std::thread::scope(|scope| {
        for (steps, status, words) in RATIOS {
            scope.spawn(move || {
                let (text, ended) = bring_up(steps, "");
                assert!(
                    text.contains(words) && ended == status,
                    "{steps}: {ended}, {text}"
                );
            });
        }
    });
}

/// If this fails, bring-up attributes to the steps a crank that stands, or for a dead sensor.
#[test]
fn bring_up_of_an_axis_distinguishes_a_missing_pulse_from_a_wrong_ratio() {
    let dead = "[[fault]]\nat_s = 0\nkind = \"index-missing\"\naxis = 1\n";
    let (text, status) = bring_up(3200, dead);
    assert!(
        text.contains("no index pulse in 20.") && text.contains("commanded turns") && status == 1,
        "{text}"
    );
    // A fault of another axis is none of this crank.
    let other = "[[fault]]\nat_s = 0\nkind = \"index-missing\"\naxis = 2\n";
    assert_eq!(bring_up(3200, other).1, 0);
}

#[test]
fn an_unreachable_controller_is_named_in_the_error() {
    for (to, problem) in [
        ("tcp:127.0.0.1:1", "--to tcp:127.0.0.1:1"),
        ("/dev/no-such-port", "--to /dev/no-such-port"),
        ("sim:no-such-scene", "no-such-scene"),
    ] {
        let mut command = Command::cargo_bin("cophase").unwrap();
        let done = command
            .args(["link", "--to", to, "identify"])
            .assert()
            .code(2);
        let error = String::from_utf8(done.get_output().stderr.clone()).unwrap();
        assert!(error.contains(problem), "{to}: {error}");
    }
}

/// Settings that differ are stored, and take effect after the restart.
#[test]
fn settings_are_loaded_with_a_restart() {
    let mut command = Command::cargo_bin("cophase").unwrap();
    let (_folder, other) = file("other.toml", &scene(1.0, 6.0));
    let (_folder, first) = file("first.toml", &scene(1.0, 5.0));
    let to = format!("sim:{}", first.display());
    let done = command
        .args(["link", "--to", &to, "load", "--settings"])
        .arg(&other)
        .timeout(Duration::from_secs(60))
        .assert()
        .success();
    let out = String::from_utf8(done.get_output().stdout.clone()).unwrap();
    assert!(out.contains("Restarted with the settings link"), "{out}");
}

/// Simulated time from the last run to its stop, s.
fn ran_s(log: &str) -> f64 {
    let at = |state: &str| {
        let line = log.lines().rfind(|line| line.trim_end().ends_with(state));
        let line = line.unwrap_or_else(|| panic!("no {state} in {log}"));
        line.split_whitespace()
            .next()
            .unwrap()
            .parse::<f64>()
            .unwrap()
    };
    at(" stop") - at(" run")
}

/// Settings can require the connection to the host that started the machine. A host that waits for the end keeps it. If
/// the host leaves, the machine stops.
#[test]
fn losing_the_host_stops_the_machine_if_configured() {
    const HOLD_S: f64 = 12.0;
    let text = scene_holding(1.0, 5.0, HOLD_S) + "[link]\ntimeout_s = 0.25\n";
    let served = Served::new(&text);
    let waited = served.out(&["start", "--yes", "--wait"]);
    assert!(ran_s(&waited) > HOLD_S, "{waited}");
    served.out(&["start", "--yes"]);
    let log = loop {
        std::thread::sleep(Duration::from_millis(100));
        let log = served.out(&["log"]);
        if log.matches(" parked").count() == 2 {
            break log;
        }
    };
    assert!(ran_s(&log) < HOLD_S, "{log}");
}
