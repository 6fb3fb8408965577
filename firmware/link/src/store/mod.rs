//! Two slots in flash, of which one always holds an intact settings file, once one has been stored.
//!
//! - *Committed*: a slot with an intact header. A slot without one, because it is empty or power was cut, is ignored.
//! - *Newest*: of the committed slots the one with the later sequence number; of equals, slot A.
//! - *Corrupt*: committed, but with a damaged payload. A power cut cannot damage the newest slot in this way, so there
//!   is another cause. The firmware does not run the older file instead, as nobody would notice.
//!
//! Memory-mapped flash is read as slices ([`inspect`]). It is written through the traits of `embedded-storage`
//! ([`Store`]).

mod choose;
mod inspect;
mod save;

pub use choose::{Choice, choose};
pub use inspect::{Newest, Slot, inspect, settings_file_in};
pub use save::{Store, StoreError};
