//! Exchange of data between interrupts, tasks and DMA channels of the firmware, which do not wait for each other.
//!
//! A [`Loan`] gives a context of lower priority a view of a value that changes in each tick. A [`Reader`] reads a ring that a DMA channel
//! fills and may overrun. Both are generic and have no hardware, so that their tests can try all interleavings:
//!
//! ```console
//! $ cargo test -p cophase-exchange --features loom
//! ```
#![no_std]

mod loan;
mod ring;

pub use loan::Loan;
pub use ring::{AtomicU32, Reader};
