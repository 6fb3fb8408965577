//! Two slots in flash, of which one always holds a whole settings file, once one has been stored.
//!
//! - *Committed*: a slot with a whole header. What has none, because it is empty or power was cut, is nothing.
//! - *Newest*: of the committed slots the one with the later sequence number; of equals, slot A.
//! - *Corrupt*: committed, but its payload is not as it was written. A power cut cannot do that to the newest
//!   slot, so something else has; an older settings file is not run instead, as nobody would notice.
//!
//! Reading goes over slices ([`inspect`]), which flash that is mapped into memory is; writing over the traits of
//! `embedded-storage` ([`Store`]).

mod choose;
mod inspect;
mod save;

pub use choose::{Choice, choose};
pub use inspect::{Newest, Slot, inspect, settings_file_in};
pub use save::{Store, StoreError};
