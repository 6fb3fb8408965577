//! Cost of a step: each method on the elastic chain of three masses, six components and one cam law.
//!
//! `cargo bench -p cophase-methods`. Each sample is 1000 steps of 10 us. The samples together pass through the
//! cam's whole turn many times. A printed microsecond is a nanosecond per step. Steps allocate nothing
//! (`tests/allocation.rs`).

use cophase_methods::Scheme;
use cophase_methods::problems::{Cam, Chain, Law, Shaft};
use divan::{Bencher, black_box, counter::ItemsCount};

const STEP_S: f64 = 1e-5;
const STEPS: u32 = 1000;

fn main() {
    divan::main();
}

#[divan::bench(args = Scheme::ALL)]
fn chain(bencher: Bencher, scheme: Scheme) {
    let machine = Chain::wrapper(Cam::wrapper(Law::ModifiedSine), Shaft::DampedToCam);
    let mut method = scheme.prepare(&machine, STEP_S).unwrap();
    let mut y = [0.0; 6];
    let mut tick = 0_u32;
    bencher.counter(ItemsCount::new(STEPS)).bench_local(|| {
        for _ in 0..STEPS {
            let t_s = f64::from(tick) * STEP_S;
            method.step(black_box(&machine), t_s, &mut y).unwrap();
            tick += 1;
        }
        y
    });
}
