//! `cophase run` on random valid scenes. No run panics, every number is finite, and exit status, text and report agree. On steady platforms
//! every printed amplitude, speed and limit is the crank's.
//!
//! Without arguments there are few scenes. This runs 10,000 of each kind, on all cores, in about an hour on two:
//!
//!     COPHASE_RANDOM_SCENES=10000 cargo test -p cophase-random-scenes -- --nocapture
//!
//! The name of a test after `-p cophase-random-scenes` runs that one alone.
//!
//! `COPHASE_RANDOM_SEED` is the first seed. A scene follows from its seed alone. Scenes that fail are kept under
//! `target/tmp/random-scenes`. Overflow checks must be on, so do not run the tests in release mode.

mod at_the_crank;
mod command;
mod files;
mod numbers;
mod refusal;

use std::any::Any;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use cophase::Status;
use cophase_random_scenes::{RandomScene, scene, steady};

use command::{Fate, run};

/// Number of scenes if no other is requested.
const FEW: u64 = 60;

/// Lowest percentage of scenes that must be accepted.
const MIN_ACCEPTED: u64 = 80;

/// One in this many scenes is run twice.
const TWICE: u64 = 10;

/// Interval of the progress messages of long tests.
const PROGRESS: Duration = Duration::from_secs(20);

/// Runs a scene and checks all that it leaves in a folder. With `twice`, it runs the scene again and compares.
fn play(scene: &Path, folder: &Path, twice: bool) -> Result<Fate, String> {
    let out = folder.join("out");
    let first = run(scene, &out, &[]);
    let fate = match first.status {
        Status::BadInput => {
            refusal::check(&first.err, scene)?;
            files::check_none(&out)?;
            return Ok(Fate::Refused);
        }
        Status::Done => Fate::Done,
        Status::Fault => Fate::Fault,
        Status::Interrupted => return Err("it ended as if by Ctrl-C".to_owned()),
    };
    files::check(&out, &first)?;
    if twice {
        let again = folder.join("again");
        let second = run(scene, &again, &[]);
        if second.status != first.status {
            return Err("a second run has another exit status".to_owned());
        }
        files::check_same(&out, &again)?;
    }
    Ok(fate)
}

/// Plays a drawn scene on a thread of its own. A panic ends that thread, and the virtual time with it.
fn play_apart(
    drawn: &RandomScene,
    play: impl FnOnce(&Path, &Path) -> Result<Fate, String> + Send,
) -> Result<Fate, String> {
    let folder = tempfile::tempdir().map_err(|error| format!("no folder: {error}"))?;
    let path = folder.path();
    let on_thread = || {
        let scene = drawn.write(path);
        let scene = scene.map_err(|error| format!("cannot write: {error}"))?;
        play(&scene, path)
    };
    thread::scope(|scope| scope.spawn(on_thread).join())
        .unwrap_or_else(|panic| Err(format!("panics: {}", words(panic.as_ref()))))
}

fn words(panic: &dyn Any) -> String {
    let owned = panic.downcast_ref::<String>().cloned();
    owned
        .or_else(|| Some((*panic.downcast_ref::<&str>()?).to_owned()))
        .unwrap_or_default()
}

/// Folder of scenes that failed.
fn kept() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("random-scenes")
}

fn keep(seed: u64, drawn: &RandomScene) {
    let folder = kept().join(seed.to_string());
    let written = fs::create_dir_all(&folder).and_then(|()| drawn.write(&folder));
    if let Err(error) = written {
        eprintln!("scene {seed} cannot be kept: {error}");
    }
}

fn number(variable: &str, default: u64) -> u64 {
    std::env::var(variable).map_or(default, |value| value.parse().expect("a whole number"))
}

/// Tally of all scenes.
#[derive(Default)]
struct Tally {
    done: u64,
    faults: u64,
    refused: u64,
    wrong: Vec<(u64, String)>,
    /// The longest time of a scene, and its seed.
    slowest: (Duration, u64),
}

impl Tally {
    fn add(&mut self, seed: u64, fate: Result<Fate, String>, took: Duration) {
        match fate {
            Ok(Fate::Done) => self.done += 1,
            Ok(Fate::Fault) => self.faults += 1,
            Ok(Fate::Refused) => self.refused += 1,
            Err(wrong) => {
                eprintln!("seed {seed}: {wrong}");
                self.wrong.push((seed, wrong));
            }
        }
        self.slowest = self.slowest.max((took, seed));
    }

    fn all(&self) -> u64 {
        self.done + self.faults + self.refused + self.wrong.len() as u64
    }
}

/// If this fails, an error that random scenes have found before is back.
#[test]
fn scenes_that_failed_before_now_run() {
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("kept");
    let scenes = fs::read_dir(kept)
        .expect("a folder")
        .map(|entry| entry.expect("a file").path());
    let played = scenes.map(|scene| {
        let folder = tempfile::tempdir().expect("a folder");
        let fate = play(&scene, folder.path(), true);
        assert!(
            matches!(fate, Ok(Fate::Done | Fate::Fault)),
            "{}: {fate:?}",
            scene.display()
        );
    });
    assert!(played.count() > 0);
}

/// Draws scenes and plays each, on all cores. The number of scenes and the first seed are those of the variables.
fn play_all(
    draw: impl Fn(u64) -> RandomScene + Sync,
    play: impl Fn(u64, &Path, &Path) -> Result<Fate, String> + Sync,
) -> Tally {
    let count = number("COPHASE_RANDOM_SCENES", FEW);
    let first = number("COPHASE_RANDOM_SEED", 0);
    let (next, tally) = (AtomicU64::new(0), Mutex::new(Tally::default()));
    let began = Instant::now();
    let work = || {
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= count {
                return;
            }
            let (seed, at) = (first + i, Instant::now());
            let drawn = draw(seed);
            let fate = play_apart(&drawn, |scene, folder| play(seed, scene, folder))
                .inspect_err(|_| keep(seed, &drawn));
            let mut tally = tally.lock().expect("no thread left it locked");
            tally.add(seed, fate, at.elapsed());
        }
    };
    thread::scope(|scope| {
        let cores = thread::available_parallelism().map_or(1, usize::from);
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        let mut said = Instant::now();
        while !workers.iter().all(|worker| worker.is_finished()) {
            thread::sleep(Duration::from_millis(50));
            if said.elapsed() > PROGRESS {
                said = Instant::now();
                let tally = tally.lock().expect("no thread left it locked");
                eprintln!(
                    "{} of {count} scenes, {:.0} s",
                    tally.all(),
                    began.elapsed().as_secs_f64()
                );
            }
        }
    });
    let tally = tally.into_inner().expect("no thread left it locked");
    println!(
        "{count} scenes from seed {first}: {} done, {} with status 1, {} refused; {:.0} s, the slowest {:.1} s (seed {})",
        tally.done,
        tally.faults,
        tally.refused,
        began.elapsed().as_secs_f64(),
        tally.slowest.0.as_secs_f64(),
        tally.slowest.1,
    );
    assert!(
        tally.wrong.is_empty(),
        "{} scenes fail; they are kept in {}: {:#?}",
        tally.wrong.len(),
        kept().display(),
        tally.wrong
    );
    tally
}

/// If this fails, some valid scene ends in a panic or in numbers that are not finite, or its exit status contradicts its report.
#[test]
fn every_scene_runs_or_is_refused() {
    let tally = play_all(scene, |seed, scene, folder| {
        play(scene, folder, seed.is_multiple_of(TWICE))
    });
    let count = tally.all();
    // Otherwise hardly anything would be tested.
    assert!(
        (count - tally.refused) * 100 >= MIN_ACCEPTED * count,
        "{} of {count} scenes are refused",
        tally.refused
    );
    assert!(tally.done > count / 5, "hardly any scene ends well");
    assert!(tally.faults > count / 20, "hardly anything goes wrong");
}

/// If this fails, a run prints an amplitude, a speed or a limit that the cranks under the platform do not have.
#[test]
fn every_printed_amplitude_speed_and_limit_is_the_cranks() {
    let judged = AtomicU64::new(0);
    let tally = play_all(steady, |_, scene, folder| {
        let (fate, speeds) = at_the_crank::play(scene, folder)?;
        judged.fetch_add(speeds, Ordering::Relaxed);
        Ok(fate)
    });
    let (count, judged) = (tally.all(), judged.into_inner());
    println!("{judged} steady speeds judged");
    // Otherwise hardly anything would be tested.
    assert!(
        tally.refused * 3 < count,
        "{} scenes refused",
        tally.refused
    );
    assert!(
        judged >= tally.done,
        "{judged} speeds of {} scenes",
        tally.done
    );
}
