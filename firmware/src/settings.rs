//! Settings of the firmware: their choice and their storage.
//!
//! A settings file is built in. Two slots at the end of the flash keep files that were stored or placed there. See
//! `docs/settings-file.md` and the crate `cophase-link`, which decides and is tested. This module connects it to the
//! flash.
#![expect(
    clippy::result_large_err,
    reason = "a refusal holds its text, as there is no heap"
)]

use cophase_core::settings::Settings;
use cophase_core::supervisor::FaultKind;
use cophase_link::board::{self, Board as _, Rp2040};
use cophase_link::header::OUTSIDE;
use cophase_link::layout::{FLASH_BYTES, SLOT_A_OFFSET, SLOT_B_OFFSET, SLOT_BYTES};
use cophase_link::message::{Text, text};
use cophase_link::store::{Choice, Slot, Store, StoreError, choose, inspect, settings_file_in};
use cophase_link::{SettingsFileError, decode_into, verify};
use embassy_rp::Peri;
use embassy_rp::flash::{Blocking, ERASE_SIZE, Flash, WRITE_SIZE};
use embassy_rp::peripherals::FLASH;
use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

use crate::board::flash::slot;
use crate::board::watchdog;
use crate::report;

static BUILT_IN: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/built-in.settings"));

/// Reads the chosen settings into `settings`; returns the settings file that they are from. None if they cannot be read,
/// which is logged.
#[cold]
#[inline(never)] // Its stack frame is released before the machine is made.
pub fn load(flash: Peri<'_, FLASH>, settings: &mut Settings) -> Option<&'static [u8]> {
    match read(flash, settings) {
        Ok(file) => {
            settings.clock_hz = Rp2040::CLOCK_HZ;
            defmt::info!(
                "settings: {=str}, {=usize} axes, {=u32} ticks a second",
                settings.name.as_str(),
                settings.axes.len(),
                settings.tick_hz
            );
            Some(file)
        }
        Err(error) => {
            report::refused(FaultKind::SettingsRejected, error);
            None
        }
    }
}

#[cold]
fn read(
    flash: Peri<'_, FLASH>,
    settings: &mut Settings,
) -> Result<&'static [u8], SettingsFileError> {
    let built_in = verify(BUILT_IN)?;
    let file = match choose(&built_in, &inspect(slot(Slot::A), slot(Slot::B))) {
        Choice::Refuse(slot, error) => {
            defmt::error!("slot {} is corrupt", slot);
            return Err(error);
        }
        Choice::Stored(from) => {
            defmt::info!("settings from slot {}", from);
            settings_file_in(slot(from))?
        }
        Choice::BuiltIn => {
            defmt::info!("settings built in");
            match store(flash, BUILT_IN, built_in.mark()) {
                Ok(slot) => defmt::info!("stored in slot {}", slot),
                // These settings run all the same.
                Err(error) => defmt::warn!("not stored: {}", error),
            }
            BUILT_IN
        }
    };
    decode_into(file, settings)?;
    Ok(file)
}

/// Checks settings from a host as far as this is possible without running them.
#[cold]
#[inline(never)] // Settings take kilobytes of stack.
pub fn check(file: &[u8]) -> Result<(), Text> {
    let mut settings = Settings::new();
    decode_into(file, &mut settings).map_err(|error| text(&error))?;
    settings.clock_hz = Rp2040::CLOCK_HZ;
    settings.check().map_err(|error| text(&error))?;
    board::check::<Rp2040>(&settings).map_err(|error| text(&error))
}

/// Stores a settings file, which the next start chooses if its origin is [`OUTSIDE`] or `mark`.
#[cold]
#[inline(never)]
pub fn store(flash: Peri<'_, FLASH>, file: &[u8], mark: u32) -> Result<Slot, StoreError> {
    let flash = Watched(Flash::new_blocking(flash));
    let mut store = Store::new(flash, SLOT_A_OFFSET, SLOT_B_OFFSET, SLOT_BYTES)?;
    let (slot, _) = store.save(file, mark)?;
    Ok(slot)
}

/// Stores a settings file of a host.
#[cold]
pub fn store_from_host(flash: Peri<'_, FLASH>, file: &[u8]) -> Result<(), Text> {
    store(flash, file, OUTSIDE).map_err(|error| text(&error))?;
    Ok(())
}

/// Flash that keeps the watchdog waiting. While it is erased or written, nothing can be read from it, and all interrupts
/// are off.
struct Watched<'a>(Flash<'a, FLASH, Blocking, { FLASH_BYTES as usize }>);

impl ErrorType for Watched<'_> {
    type Error = embassy_rp::flash::Error;
}

impl ReadNorFlash for Watched<'_> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.0.blocking_read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl NorFlash for Watched<'_> {
    const WRITE_SIZE: usize = WRITE_SIZE;
    const ERASE_SIZE: usize = ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        critical_section::with(|_| {
            watchdog::wait();
            self.0.blocking_erase(from, to)
        })
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        critical_section::with(|_| {
            watchdog::wait();
            self.0.blocking_write(offset, bytes)
        })
    }
}
