//! Encoding and decoding of settings files, and refusal of everything that is not one.

use crate::support::{check, longest, settings};
use cophase_link::board::{Board, Rp2040};
use cophase_link::file_format::{HEADER_BYTES, MAX_PAYLOAD_BYTES, VERSION};
use cophase_link::header::OUTSIDE;
use cophase_link::store::settings_file_in;
use cophase_link::{Header, MAX_FILE_BYTES, Settings, SettingsFileError, encode};
use proptest::prelude::*;

fn settings_file(settings: &Settings) -> Vec<u8> {
    let mut buffer = [0; MAX_FILE_BYTES];
    encode(settings, 7, OUTSIDE, &mut buffer).unwrap().to_vec()
}

/// Decodes settings, and sets the clock that all settings have here, as no file contains one.
fn decode(settings_file: &[u8]) -> Result<Settings, SettingsFileError> {
    let settings = cophase_link::decode(settings_file)?;
    assert_eq!(settings.clock_hz, 0);
    let clock_hz = Rp2040::CLOCK_HZ;
    Ok(Settings {
        clock_hz,
        ..settings
    })
}

/// Makes a settings file of any payload, with a matching header.
fn settings_file_of(payload: &[u8], version: u16) -> Vec<u8> {
    let header = Header {
        version,
        length: payload.len() as u32,
        sequence: 1,
        origin: OUTSIDE,
        payload_crc: crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(payload),
    };
    [&header.page()[..], payload].concat()
}

/// If this fails, a board runs other numbers than the desk. NaN, infinities and -0.0 have bits too.
#[test]
fn settings_round_trip_bit_for_bit() {
    for (axes, bands, entries) in [(0, 0, 0), (2, 1, 1), (4, 2, 9), (6, 4, 128)] {
        let mut given = settings(axes, bands, entries);
        given.settle_s = 0.1 + 0.2;
        given.park_turns = f64::MIN_POSITIVE / 8.0;
        let settings_file = settings_file(&given);
        assert_eq!(decode(&settings_file), Ok(given.clone()), "{axes} axes");
        let header = Header::read(&settings_file).unwrap();
        assert_eq!((header.sequence, header.origin), (7, OUTSIDE));
        for odd in [f64::NAN, -f64::NAN, f64::INFINITY, -0.0] {
            given.settle_s = odd;
            let back = decode(&self::settings_file(&given)).unwrap();
            assert_eq!(back.settle_s.to_bits(), odd.to_bits());
        }
    }
}

/// If this fails, a scene that runs on the desk does not fit the board's buffers.
#[test]
fn the_longest_settings_are_as_long_as_documented() {
    let longest = longest();
    let settings_file = settings_file(&longest);
    assert_eq!(settings_file.len(), MAX_FILE_BYTES);
    assert_eq!(settings_file.len() - HEADER_BYTES, MAX_PAYLOAD_BYTES);
    assert_eq!(decode(&settings_file), Ok(longest.clone()));
    for bytes in [0, HEADER_BYTES - 1, HEADER_BYTES, MAX_FILE_BYTES - 1] {
        let error = encode(&longest, 1, 0, &mut vec![0; bytes]).unwrap_err();
        let bytes = bytes as u32;
        assert_eq!(error, SettingsFileError::NoRoom { bytes });
    }
}

#[test]
fn every_truncation_is_refused() {
    let settings_file = settings_file(&settings(4, 2, 9));
    for bytes in 0..settings_file.len() {
        let error = decode(&settings_file[..bytes]).unwrap_err();
        let expected = if bytes < HEADER_BYTES {
            SettingsFileError::TooShort {
                bytes: bytes as u32,
            }
        } else {
            SettingsFileError::Cut {
                said: (settings_file.len() - HEADER_BYTES) as u32,
                here: (bytes - HEADER_BYTES) as u32,
            }
        };
        assert_eq!(error, expected);
    }
}

#[test]
fn every_flipped_bit_is_refused() {
    let mut settings_file = settings_file(&settings(4, 2, 9));
    for bit in 0..8 * settings_file.len() {
        settings_file[bit / 8] ^= 1 << (bit % 8);
        let error = decode(&settings_file).unwrap_err();
        let right = match bit / 8 {
            0..8 => error == SettingsFileError::NotASettingsFile,
            8..HEADER_BYTES => matches!(error, SettingsFileError::HeaderCrc { .. }),
            _ => matches!(error, SettingsFileError::PayloadCrc { .. }),
        };
        assert!(right, "bit {bit}: {error}");
        settings_file[bit / 8] ^= 1 << (bit % 8);
    }
    decode(&settings_file).unwrap();
}

#[test]
fn another_version_and_trailing_bytes_are_distinguished_from_damage() {
    let whole = settings_file(&settings(2, 0, 1));
    let payload = &whole[HEADER_BYTES..];
    let refused = |settings_file: &[u8]| decode(settings_file).unwrap_err();
    assert_eq!(
        refused(&settings_file_of(payload, VERSION + 1)),
        SettingsFileError::Version { found: VERSION + 1 }
    );
    assert_eq!(
        refused(&[&whole[..], &[0xFF; 3]].concat()),
        SettingsFileError::Trailing { bytes: 3 }
    );
    // The extra bytes are under the CRC.
    assert_eq!(
        refused(&settings_file_of(&[payload, &[0; 5]].concat(), VERSION)),
        SettingsFileError::Trailing { bytes: 5 }
    );
    assert_eq!(
        refused(&settings_file_of(&payload[..payload.len() - 1], VERSION)),
        SettingsFileError::Unreadable
    );
    assert_eq!(
        refused(&settings_file_of(&[0; MAX_PAYLOAD_BYTES + 1], VERSION)),
        SettingsFileError::TooLong {
            said: MAX_PAYLOAD_BYTES as u32 + 1
        }
    );
    assert_eq!(
        refused(b"name = \"default\"\n"),
        SettingsFileError::NotASettingsFile
    );
}

/// Messages name the problem and how to solve it.
#[test]
fn error_messages_name_the_problem_and_the_fix() {
    for (error, said) in [
        (
            SettingsFileError::TooShort { bytes: 9 },
            "9 bytes are fewer than the 256 of a settings file's header; give the whole file that `cophase settings` wrote",
        ),
        (
            SettingsFileError::Version { found: 1 },
            &format!(
                "the settings file has format version 1, and version {VERSION} is read here; make it again with the `cophase` of the \
                 same version as the firmware"
            ),
        ),
        (
            SettingsFileError::PayloadCrc { said: 1, found: 2 },
            "the payload has CRC-32 0x00000002, and should have 0x00000001; write the settings file again",
        ),
    ] {
        assert_eq!(error.to_string(), said);
    }
}

/// In flash arbitrary bytes follow a settings file.
#[test]
fn a_settings_file_is_found_at_the_beginning_of_its_slot() {
    let settings_file = settings_file(&settings(3, 1, 4));
    let slot = [&settings_file[..], &[0xA5; 5000]].concat();
    assert_eq!(settings_file_in(&slot), Ok(&settings_file[..]));
    assert!(settings_file_in(&slot[..settings_file.len() - 1]).is_err());
    assert!(settings_file_in(&[0xFF; 4096]).is_err());
}

/// If this fails, a foreign settings file can drive a machine beyond the limits of any scene.
#[test]
fn numbers_out_of_range_are_refused_when_the_controller_is_made() {
    let mut given = settings(3, 1, 4);
    assert_eq!(check(&decode(&settings_file(&given)).unwrap()), Ok(()));
    given.limits.speed_hz = 2000.0;
    let said = check(&decode(&settings_file(&given)).unwrap()).unwrap_err();
    assert_eq!(
        said,
        "limits.speed_hz: 2000 rev/s is outside 0.1 to 200 rev/s"
    );

    let mut given = settings(3, 1, 4);
    given.trims_turns[2] = 0.5;
    let said = check(&decode(&settings_file(&given)).unwrap()).unwrap_err();
    assert!(
        said.starts_with("axes.trim_deg (number 2): 180° is outside -5 to 5°"),
        "{said}"
    );

    let none = decode(&settings_file(&settings(0, 0, 1))).unwrap();
    assert_eq!(check(&none).unwrap_err(), "axes.count: 0 is outside 1 to 6");
}

proptest! {
    /// All bytes are decoded or refused.
    #[test]
    fn decoding_arbitrary_bytes_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        prop_assert!(decode(&bytes).is_err());
        prop_assert!(settings_file_in(&bytes).is_err());
        // With a matching header all bytes reach the decoder behind it.
        if let Ok(settings) = decode(&settings_file_of(&bytes, VERSION)) {
            let _ = check(&settings);
        }
    }

    /// The same for bytes that are nearly settings: few are refused before a controller is made.
    #[test]
    fn decoding_a_nearly_valid_payload_never_panics(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        axes in 2_usize..=6,
    ) {
        let whole = settings_file(&settings(axes, 2, 9));
        let mut payload = whole[HEADER_BYTES..].to_vec();
        for (at, byte) in changes {
            let at = at.index(payload.len());
            payload[at] = byte;
        }
        if let Ok(settings) = decode(&settings_file_of(&payload, VERSION)) {
            let _ = check(&settings);
        }
    }
}
