//! Measurement of any figure: the CPU time of its work, compared with that of a fixed calibration load.
//!
//! - *Work*: one call does some work, and returns its number of units, for example control ticks.
//! - *Load*: a fixed loop of integer and floating-point operations that no change of the project touches. Units per load
//!   compare across machines far better than units per second, so only they are asserted.
//! - *Round*: load, work, load. Rounds are short, so that the two loads run at the same clock frequency and beside the same
//!   other processes as the work. A figure is the median of its rounds.
//!
//! Each figure is two lines, `name value unit`: units per second of CPU time, and units per load. Other lines begin with `#`.
//!
//! This file does not depend on the project, so that `tests/baseline/bench` measures another commit by the same code.

use std::hint::black_box;
use std::time::Instant;

/// One call does some work and returns how many units it did.
pub type Work = Box<dyn FnMut() -> u64>;

/// Figure: a kind of work whose speed is measured.
pub struct Figure {
    /// Name in the output.
    pub name: &'static str,
    /// Unit of its work.
    pub unit: &'static str,
    /// Least units per load, which are asserted. Leave a wide margin: processors differ in their strengths.
    pub min_per_load: f64,
    /// Sets the work up. The time for this does not count.
    pub set_up: fn() -> Work,
}

/// Least CPU time in one round, s: of the work, and of each load, before and after it.
const WORK_S: f64 = 0.02;
const LOAD_S: f64 = 0.005;
/// Least number of rounds of a figure, and least CPU time of its work in all rounds, s.
const ROUNDS: usize = 5;
const ALL_WORK_S: f64 = 0.6;

/// Measures the figures that the command line names, or all, and prints them.
///
/// `--test` runs each figure as briefly as possible, and asserts only that it runs.
///
/// # Panics
/// If a figure is below its least units per load.
pub fn run(figures: &[Figure]) {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|argument| argument != "--bench") // cargo adds it
        .collect();
    let is_test = arguments.iter().any(|argument| argument == "--test");
    let selected: Vec<&String> = arguments
        .iter()
        .filter(|argument| *argument != "--test")
        .collect();
    let known = |name: &str| figures.iter().any(|figure| figure.name.contains(name));
    if let Some(unknown) = selected.iter().find(|name| !known(name)) {
        panic!("no figure has {unknown} in its name");
    }
    let chosen = figures.iter().filter(|figure| {
        selected.is_empty() || selected.iter().any(|name| figure.name.contains(*name))
    });
    let mut too_slow = Vec::new();
    for figure in chosen {
        let Measured { per_s, per_load } = measure(figure, is_test);
        let Figure { name, unit, .. } = figure;
        println!("{name} {per_s:.0} {unit}/s");
        println!("{name}-per-load {per_load:.1} {unit}/load");
        if !is_test && per_load < figure.min_per_load {
            too_slow.push(format!(
                "{name} does {per_load:.1} {unit} per load; {} are asserted",
                figure.min_per_load
            ));
        }
    }
    assert!(too_slow.is_empty(), "{}", too_slow.join("; "));
}

struct Measured {
    per_s: f64,
    per_load: f64,
}

fn measure(figure: &Figure, is_test: bool) -> Measured {
    let (min_rounds, all_work_s, work_s, load_s) = if is_test {
        (1, 0.0, 0.0, 0.0)
    } else {
        (ROUNDS, ALL_WORK_S, WORK_S, LOAD_S)
    };
    let mut work = (figure.set_up)();
    if !is_test {
        work(); // fills caches
    }
    let (mut per_s, mut per_load) = (Vec::new(), Vec::new());
    let mut elapsed_s = 0.0;
    while per_s.len() < min_rounds || elapsed_s < all_work_s {
        let before = Sample::of(&mut load, load_s);
        let worked = Sample::of(&mut work, work_s);
        let after = Sample::of(&mut load, load_s);
        elapsed_s += worked.cpu_s;
        per_s.push(worked.per_s());
        per_load.push(worked.per_s() / ((before.per_s() + after.per_s()) / 2.0));
    }
    Measured {
        per_s: median(per_s),
        per_load: median(per_load),
    }
}

/// Number of units done in a CPU time.
struct Sample {
    units: u64,
    cpu_s: f64,
}

impl Sample {
    /// Does the work for at least this time.
    fn of(work: &mut dyn FnMut() -> u64, min_s: f64) -> Self {
        let clock = CpuClock::start();
        let mut units = 0;
        loop {
            units += work();
            let cpu_s = clock.elapsed_s();
            if cpu_s >= min_s && cpu_s > 0.0 {
                return Self { units, cpu_s };
            }
        }
    }

    fn per_s(&self) -> f64 {
        self.units as f64 / self.cpu_s
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// CPU time of this thread where Linux provides it, so that other processes do not count. Elsewhere it is wall time.
struct CpuClock {
    cpu_ns: Option<u64>,
    wall: Instant,
}

impl CpuClock {
    fn start() -> Self {
        Self {
            cpu_ns: Self::cpu_ns(),
            wall: Instant::now(),
        }
    }

    fn elapsed_s(&self) -> f64 {
        match (self.cpu_ns, Self::cpu_ns()) {
            (Some(before), Some(now)) => now.saturating_sub(before) as f64 * 1e-9,
            _ => self.wall.elapsed().as_secs_f64(),
        }
    }

    fn cpu_ns() -> Option<u64> {
        // The scheduler updates its accounting when it is called.
        std::thread::yield_now();
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        text.split(' ').next()?.parse().ok()
    }
}

/// Iterations of one load: about a millisecond.
const LOAD_ITERATIONS: u32 = 80_000;

/// Result of a load, the same on every machine.
const LOAD_RESULT: u64 = 0x8C0C_F37A_1A1E_7A93;

/// Number of chains of operations that do not wait for each other. Most work fills the units of a processor, so another process
/// on the same core slows it down. A single chain would not slow down.
const LANES: usize = 4;

/// Runs the calibration load: in each lane, a chain of integer operations with a table and a branch, and a chain of f64
/// operations.
fn load() -> u64 {
    let mut random =
        black_box([1, 2, 3, 4].map(|seed| 0x9E37_79B9_7F4A_7C15_u64.rotate_left(seed)));
    let mut table = [0_u64; 256];
    let (mut sum, mut root) = ([0.0_f64; LANES], [1.0_f64; LANES]);
    for _ in 0..LOAD_ITERATIONS {
        for lane in 0..LANES {
            let mut bits = random[lane];
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            let entry = &mut table[(bits >> 56) as usize];
            *entry = entry.wrapping_mul(5).wrapping_add(bits);
            if *entry & 7 == 0 {
                bits = bits.rotate_left(9);
            }
            random[lane] = bits;
            sum[lane] = sum[lane] * 0.9 + (bits >> 11) as f64 * 1.0e-17;
            root[lane] = root[lane] * 0.5 + sum[lane] * (1.5 - sum[lane] * root[lane]);
        }
    }
    let root = root
        .iter()
        .fold(0_u64, |all, root| all.rotate_left(1) ^ root.to_bits());
    let random = random.iter().fold(root, |all, bits| all ^ bits);
    let result = table
        .iter()
        .fold(random, |all, &entry| all.rotate_left(1) ^ entry);
    assert_eq!(result, LOAD_RESULT, "the calibration load is another one");
    1
}
