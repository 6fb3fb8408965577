//! Which settings the image runs on, and where they are kept.
//!
//! A blob is built in, and two slots at the end of the flash keep what was stored or placed there: see
//! `docs/settings-file.md` and the crate `cophase-blob`, where all of this is decided and tested. Here it meets the flash.

use cophase_blob::layout::{FLASH_ADDRESS, FLASH_BYTES, SLOT_A_OFFSET, SLOT_B_OFFSET, SLOT_BYTES};
use cophase_blob::store::{Choice, Slot, Store, blob_in, choose, inspect};
use cophase_blob::{BlobError, decode_into, verify};
use cophase_core::settings::Settings;
use cophase_core::supervisor::FaultKind;
use embassy_rp::Peri;
use embassy_rp::flash::{Blocking, Flash};
use embassy_rp::peripherals::FLASH;

use crate::report;

static BUILT_IN: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/built-in.blob"));

/// Reads the settings to run on into `settings`; false if those that should be run cannot be read, which is logged.
#[cold]
#[inline(never)] // what decodes them is off the stack when a machine is made of them
pub fn load(flash: Peri<'static, FLASH>, settings: &mut Settings) -> bool {
    if let Err(error) = read(flash, settings) {
        report::refused(FaultKind::SettingsRejected, error);
        return false;
    }
    defmt::info!(
        "settings: {=str}, {=usize} axes, {=u32} ticks a second",
        settings.name.as_str(),
        settings.axes.len(),
        settings.tick_hz
    );
    true
}

#[cold]
fn read(flash: Peri<'static, FLASH>, settings: &mut Settings) -> Result<(), BlobError> {
    let built_in = verify(BUILT_IN)?;
    match choose(&built_in, &inspect(slot(Slot::A), slot(Slot::B))) {
        Choice::Refuse(slot, error) => {
            defmt::error!("slot {} is corrupt", slot);
            Err(error)
        }
        Choice::Stored(from) => {
            defmt::info!("settings from slot {}", from);
            decode_into(blob_in(slot(from))?, settings)
        }
        Choice::BuiltIn => {
            defmt::info!("settings built in");
            store(flash, built_in.mark());
            decode_into(BUILT_IN, settings)
        }
    }
}

/// Stores the built-in blob. That it could not be is told; it can be run all the same.
#[cold]
#[inline(never)]
fn store(flash: Peri<'static, FLASH>, mark: u32) {
    let flash = Flash::<_, Blocking, { FLASH_BYTES as usize }>::new_blocking(flash);
    let stored = Store::new(flash, SLOT_A_OFFSET, SLOT_B_OFFSET, SLOT_BYTES)
        .and_then(|mut store| store.save(BUILT_IN, mark));
    match stored {
        Ok((slot, _)) => defmt::info!("stored in slot {}", slot),
        Err(error) => defmt::warn!("not stored: {}", error),
    }
}

/// A slot as the chip shows it, among its other memory.
#[cold]
fn slot(slot: Slot) -> &'static [u8] {
    let offset = match slot {
        Slot::A => SLOT_A_OFFSET,
        Slot::B => SLOT_B_OFFSET,
    };
    let start = (FLASH_ADDRESS + offset) as *const u8;
    // SAFETY: all of it is flash, which nothing writes while such a slice is in use: `store` is the only one
    // that does, and it has what was read before copied, or built in.
    unsafe { core::slice::from_raw_parts(start, SLOT_BYTES as usize) }
}
