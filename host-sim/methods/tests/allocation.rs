//! A step allocates nothing, with any method.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use cophase_methods::problems::{Andrews, Cam, Chain, DenHartog, Law, Pendulum, Shaft};
use cophase_methods::{Equations, Scheme, advance};

/// System allocator with a count for each thread, because the test harness has threads of its own.
struct Counted;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call passes its arguments unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counted {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static COUNTED: Counted = Counted;

/// If this fails, a step allocates a workspace, and a loop of a million steps spends its time in the
/// allocator.
#[test]
fn a_step_allocates_nothing() {
    let chain = Chain::wrapper(Cam::wrapper(Law::ModifiedSine), Shaft::DampedToCam);
    let machines: [&dyn Equations; 4] = [&chain, &Andrews, &Pendulum::DRIVEN, &DenHartog::STOPPING];
    for machine in machines {
        for scheme in Scheme::ALL {
            // Where a contact changes, exact discretisation needs another matrix.
            let fits = scheme == Scheme::Exact && machine.friction().is_some();
            if fits || !scheme.suits(machine) {
                continue;
            }
            let mut method = scheme.prepare(machine, 1e-5).unwrap();
            let mut y = vec![0.1; machine.dimension()];
            y[..7.min(machine.dimension())].fill(0.5);
            let before = ALLOCATIONS.get();
            advance(method.as_mut(), machine, 0.0, 2000, &mut y).unwrap();
            let made = ALLOCATIONS.get() - before;
            assert_eq!(made, 0, "{scheme}");
        }
    }
}
