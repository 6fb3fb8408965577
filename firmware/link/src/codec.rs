//! Converts settings to a settings file and back.

use cophase_core::axes::{CamSettings, MAX_CAMS};
use cophase_core::settings::Settings;
use serde::Deserialize;

use crate::file_format::{HEADER_BYTES, MAX_PAYLOAD_BYTES, VERSION};
use crate::header::Header;
use crate::{CRC, SettingsFileError};

/// Encodes settings as a settings file at the beginning of `buffer`, and returns that part of it.
///
/// `origin` is [`OUTSIDE`](crate::header::OUTSIDE) or a [`Header::mark`].
///
/// # Errors
/// The buffer is too small; one of [`MAX_FILE_BYTES`](crate::MAX_FILE_BYTES) never is.
pub fn encode<'a>(
    settings: &Settings,
    sequence: u32,
    origin: u32,
    buffer: &'a mut [u8],
) -> Result<&'a [u8], SettingsFileError> {
    let no_room = SettingsFileError::NoRoom {
        bytes: count(buffer.len()),
    };
    let (page, rest) = buffer
        .split_first_chunk_mut::<HEADER_BYTES>()
        .ok_or(no_room)?;
    let payload = postcard::to_slice(settings, rest).map_err(|_| no_room)?;
    let header = Header {
        version: VERSION,
        length: count(payload.len()),
        sequence,
        origin,
        payload_crc: CRC.checksum(payload),
    };
    *page = header.page();
    let bytes = HEADER_BYTES + payload.len();
    Ok(&buffer[..bytes])
}

/// Checks that the bytes are exactly one intact settings file of this version, and returns its header. The settings in
/// it are not checked.
///
/// # Errors
/// The first deviation from the format.
pub fn verify(settings_file: &[u8]) -> Result<Header, SettingsFileError> {
    let header = Header::read(settings_file)?;
    if header.version != VERSION {
        return Err(SettingsFileError::Version {
            found: header.version,
        });
    }
    if header.length as usize > MAX_PAYLOAD_BYTES {
        return Err(SettingsFileError::TooLong {
            said: header.length,
        });
    }
    verify_payload(&header, settings_file)?;
    match count(settings_file.len()) - header.file_bytes() {
        0 => Ok(header),
        bytes => Err(SettingsFileError::Trailing { bytes }),
    }
}

/// Checks that the payload behind a header is intact; bytes after it are ignored.
pub(crate) fn verify_payload(
    header: &Header,
    settings_file: &[u8],
) -> Result<(), SettingsFileError> {
    let rest = settings_file.get(HEADER_BYTES..).unwrap_or_default();
    let Some(payload) = rest.get(..header.length as usize) else {
        return Err(SettingsFileError::Cut {
            said: header.length,
            here: count(rest.len()),
        });
    };
    let found = CRC.checksum(payload);
    if found != header.payload_crc {
        return Err(SettingsFileError::PayloadCrc {
            said: header.payload_crc,
            found,
        });
    }
    Ok(())
}

/// Decodes the settings in a settings file. See [`decode_into`].
///
/// # Errors
/// The bytes are not exactly one intact settings file of this version. No bytes cause a panic.
pub fn decode(settings_file: &[u8]) -> Result<Settings, SettingsFileError> {
    let mut settings = Settings::new();
    decode_into(settings_file, &mut settings)?;
    Ok(settings)
}

/// Decodes the settings in a settings file in place.
///
/// The numbers are returned as written. `Controller::configure` checks them. The clock stays as it was, as it is the
/// board's. Settings have 7 KiB, most of it the program and the cam tables. So they are read field by field, and long
/// lists entry by entry. A board's stack then need not hold them twice.
///
/// # Errors
/// The bytes are not exactly one intact settings file of this version. The settings are then a mixture of old and new.
/// No bytes cause a panic.
#[inline(never)]
pub fn decode_into(settings_file: &[u8], settings: &mut Settings) -> Result<(), SettingsFileError> {
    verify(settings_file)?;
    let mut payload = Payload(&settings_file[HEADER_BYTES..]);
    // `encode` writes the fields in their order, which is the order here.
    let Settings {
        name,
        tick_hz,
        clock_hz: _, // The board's clock, which no file contains.
        machine,
        limits,
        pulse,
        index,
        axes,
        cams,
        trims_turns,
        drift,
        correction,
        park_turns,
        settle_s,
        has_brake,
        wiring,
        host_loss,
        program,
    } = settings;
    *name = payload.take()?;
    *tick_hz = payload.take()?;
    *machine = payload.take()?;
    *limits = payload.take()?;
    *pulse = payload.take()?;
    *index = payload.take()?;
    payload.take_list(axes)?;
    payload.take_cams(cams)?;
    payload.take_list(trims_turns)?;
    *drift = payload.take()?;
    *correction = payload.take()?;
    *park_turns = payload.take()?;
    *settle_s = payload.take()?;
    *has_brake = payload.take()?;
    *wiring = payload.take()?;
    *host_loss = payload.take()?;
    payload.take_list(program)?;
    match count(payload.0.len()) {
        0 => Ok(()),
        bytes => Err(SettingsFileError::Trailing { bytes }),
    }
}

/// Remaining bytes of a payload.
struct Payload<'a>(&'a [u8]);

impl<'a> Payload<'a> {
    fn take<T: Deserialize<'a>>(&mut self) -> Result<T, SettingsFileError> {
        let (value, rest) =
            postcard::take_from_bytes(self.0).map_err(|_| SettingsFileError::Unreadable)?;
        self.0 = rest;
        Ok(value)
    }

    /// Reads cam tables point by point, as each has a kilobyte.
    fn take_cams(
        &mut self,
        cams: &mut heapless::Vec<CamSettings, MAX_CAMS>,
    ) -> Result<(), SettingsFileError> {
        cams.clear();
        for _ in 0..self.take::<u32>()? {
            cams.push(CamSettings::default())
                .map_err(|_| SettingsFileError::Unreadable)?;
            if let Some(cam) = cams.last_mut() {
                cam.net_turns = self.take()?;
                cam.max_speed_hz = self.take()?;
                cam.max_acceleration_hz_per_s = self.take()?;
                self.take_list(&mut cam.points_turns)?;
            }
        }
        Ok(())
    }

    /// Reads a list: its length, then its values.
    fn take_list<T: Deserialize<'a>, const N: usize>(
        &mut self,
        list: &mut heapless::Vec<T, N>,
    ) -> Result<(), SettingsFileError> {
        list.clear();
        for _ in 0..self.take::<u32>()? {
            list.push(self.take()?)
                .map_err(|_| SettingsFileError::Unreadable)?;
        }
        Ok(())
    }
}

/// Converts a length for messages. No settings file, and no flash, is near 4 GiB.
fn count(bytes: usize) -> u32 {
    u32::try_from(bytes).unwrap_or(u32::MAX)
}
