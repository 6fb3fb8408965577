//! Settings of the firmware: their choice and their storage.
//!
//! A settings file is built in. Two slots at the end of the flash keep files that were stored or placed there. See
//! `docs/settings-file.md` and the crate `cophase-link`, which decides and is tested. This module connects it to the
//! flash.

use cophase_core::settings::Settings;
use cophase_core::supervisor::FaultKind;
use cophase_link::board::{Board as _, Rp2040};
use cophase_link::layout::{FLASH_ADDRESS, FLASH_BYTES, SLOT_A_OFFSET, SLOT_B_OFFSET, SLOT_BYTES};
use cophase_link::store::{Choice, Slot, Store, choose, inspect, settings_file_in};
use cophase_link::{SettingsFileError, decode_into, verify};
use embassy_rp::Peri;
use embassy_rp::flash::{Blocking, Flash};
use embassy_rp::peripherals::FLASH;

use crate::report;

static BUILT_IN: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/built-in.settings"));

/// Reads the chosen settings into `settings`; returns false if they cannot be read, which is logged.
#[cold]
#[inline(never)] // Its stack frame is released before the machine is made.
pub fn load(flash: Peri<'static, FLASH>, settings: &mut Settings) -> bool {
    if let Err(error) = read(flash, settings) {
        report::refused(FaultKind::SettingsRejected, error);
        return false;
    }
    settings.clock_hz = Rp2040::CLOCK_HZ;
    defmt::info!(
        "settings: {=str}, {=usize} axes, {=u32} ticks a second",
        settings.name.as_str(),
        settings.axes.len(),
        settings.tick_hz
    );
    true
}

#[cold]
fn read(flash: Peri<'static, FLASH>, settings: &mut Settings) -> Result<(), SettingsFileError> {
    let built_in = verify(BUILT_IN)?;
    match choose(&built_in, &inspect(slot(Slot::A), slot(Slot::B))) {
        Choice::Refuse(slot, error) => {
            defmt::error!("slot {} is corrupt", slot);
            Err(error)
        }
        Choice::Stored(from) => {
            defmt::info!("settings from slot {}", from);
            decode_into(settings_file_in(slot(from))?, settings)
        }
        Choice::BuiltIn => {
            defmt::info!("settings built in");
            store(flash, built_in.mark());
            decode_into(BUILT_IN, settings)
        }
    }
}

/// Stores the built-in settings. A failure is logged, and the settings run all the same.
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

/// Returns a slot as memory-mapped flash.
#[cold]
fn slot(slot: Slot) -> &'static [u8] {
    let offset = match slot {
        Slot::A => SLOT_A_OFFSET,
        Slot::B => SLOT_B_OFFSET,
    };
    let start = (FLASH_ADDRESS + offset) as *const u8;
    // SAFETY: all of it is flash, which nothing writes while such a slice is in use. Only `store` writes, and it uses
    // the built-in settings and no slice of a slot.
    unsafe { core::slice::from_raw_parts(start, SLOT_BYTES as usize) }
}
