//! Blobs: there and back, and everything that is not one.

mod support;

use cophase_blob::codec::{MAX_PAYLOAD_BYTES, VERSION};
use cophase_blob::header::{HEADER_BYTES, OUTSIDE};
use cophase_blob::store::blob_in;
use cophase_blob::{BlobError, Header, MAX_BLOB_BYTES, Settings, decode, encode};
use proptest::prelude::*;
use support::{check, longest, settings};

fn blob(settings: &Settings) -> Vec<u8> {
    let mut buffer = [0; MAX_BLOB_BYTES];
    encode(settings, 7, OUTSIDE, &mut buffer).unwrap().to_vec()
}

/// A blob whose header is right for whatever payload it has.
fn blob_of(payload: &[u8], version: u16) -> Vec<u8> {
    let header = Header {
        version,
        length: payload.len() as u32,
        sequence: 1,
        origin: OUTSIDE,
        payload_crc: crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(payload),
    };
    [&header.page()[..], payload].concat()
}

/// Were it wrong, a board would run other numbers than the desk. NaN, infinities and -0.0 have bits too.
#[test]
fn what_goes_in_comes_out_to_the_bit() {
    for (axes, bands, entries) in [(0, 0, 0), (2, 1, 1), (4, 2, 9), (6, 4, 128)] {
        let mut told = settings(axes, bands, entries);
        told.settle_s = 0.1 + 0.2;
        told.park_turns = f64::MIN_POSITIVE / 8.0;
        let blob = blob(&told);
        assert_eq!(decode(&blob), Ok(told.clone()), "{axes} axes");
        let header = Header::read(&blob).unwrap();
        assert_eq!((header.sequence, header.origin), (7, OUTSIDE));
        for odd in [f64::NAN, -f64::NAN, f64::INFINITY, -0.0] {
            told.settle_s = odd;
            let back = decode(&self::blob(&told)).unwrap();
            assert_eq!(back.settle_s.to_bits(), odd.to_bits());
        }
    }
}

/// Were it wrong, a scene that runs on the desk would not fit the board's buffers.
#[test]
fn the_longest_setup_is_as_long_as_said() {
    let longest = longest();
    let blob = blob(&longest);
    assert_eq!(blob.len(), MAX_BLOB_BYTES);
    assert_eq!(blob.len() - HEADER_BYTES, MAX_PAYLOAD_BYTES);
    assert_eq!(decode(&blob), Ok(longest.clone()));
    for bytes in [0, HEADER_BYTES - 1, HEADER_BYTES, MAX_BLOB_BYTES - 1] {
        let error = encode(&longest, 1, 0, &mut vec![0; bytes]).unwrap_err();
        let bytes = bytes as u32;
        assert_eq!(error, BlobError::NoRoom { bytes });
    }
}

#[test]
fn every_truncation_is_refused() {
    let blob = blob(&settings(4, 2, 9));
    for bytes in 0..blob.len() {
        let error = decode(&blob[..bytes]).unwrap_err();
        let expected = if bytes < HEADER_BYTES {
            BlobError::TooShort {
                bytes: bytes as u32,
            }
        } else {
            BlobError::Cut {
                said: (blob.len() - HEADER_BYTES) as u32,
                here: (bytes - HEADER_BYTES) as u32,
            }
        };
        assert_eq!(error, expected);
    }
}

#[test]
fn every_flipped_bit_is_refused() {
    let mut blob = blob(&settings(4, 2, 9));
    for bit in 0..8 * blob.len() {
        blob[bit / 8] ^= 1 << (bit % 8);
        let error = decode(&blob).unwrap_err();
        let right = match bit / 8 {
            0..8 => error == BlobError::NotABlob,
            8..HEADER_BYTES => matches!(error, BlobError::HeaderCrc { .. }),
            _ => matches!(error, BlobError::PayloadCrc { .. }),
        };
        assert!(right, "bit {bit}: {error}");
        blob[bit / 8] ^= 1 << (bit % 8);
    }
    decode(&blob).unwrap();
}

#[test]
fn another_version_and_what_follows_are_told_from_damage() {
    let whole = blob(&settings(2, 0, 1));
    let payload = &whole[HEADER_BYTES..];
    let refused = |blob: &[u8]| decode(blob).unwrap_err();
    assert_eq!(
        refused(&blob_of(payload, VERSION + 1)),
        BlobError::Version { found: VERSION + 1 }
    );
    assert_eq!(
        refused(&[&whole[..], &[0xFF; 3]].concat()),
        BlobError::Trailing { bytes: 3 }
    );
    // Inside of what the CRC covers.
    assert_eq!(
        refused(&blob_of(&[payload, &[0; 5]].concat(), VERSION)),
        BlobError::Trailing { bytes: 5 }
    );
    assert_eq!(
        refused(&blob_of(&payload[..payload.len() - 1], VERSION)),
        BlobError::Unreadable
    );
    assert_eq!(
        refused(&blob_of(&[0; MAX_PAYLOAD_BYTES + 1], VERSION)),
        BlobError::TooLong {
            said: MAX_PAYLOAD_BYTES as u32 + 1
        }
    );
    assert_eq!(refused(b"name = \"default\"\n"), BlobError::NotABlob);
}

/// Each says what is wrong, and what to do.
#[test]
fn messages() {
    for (error, said) in [
        (
            BlobError::TooShort { bytes: 9 },
            "9 bytes are fewer than the 256 of a blob's header; give all that `cophase image` wrote",
        ),
        (
            BlobError::Version { found: 1 },
            "the blob has format version 1, and version 2 is read here; make it again with the `cophase` of the \
             same version as the image",
        ),
        (
            BlobError::PayloadCrc { said: 1, found: 2 },
            "the payload has CRC-32 0x00000002, and should have 0x00000001; write the blob again",
        ),
    ] {
        assert_eq!(error.to_string(), said);
    }
}

/// In flash a blob is followed by whatever was there.
#[test]
fn a_blob_is_found_at_the_beginning_of_its_slot() {
    let blob = blob(&settings(3, 1, 4));
    let slot = [&blob[..], &[0xA5; 5000]].concat();
    assert_eq!(blob_in(&slot), Ok(&blob[..]));
    assert!(blob_in(&slot[..blob.len() - 1]).is_err());
    assert!(blob_in(&[0xFF; 4096]).is_err());
}

/// Were it wrong, a blob from another hand could drive a machine past what any scene may ask.
#[test]
fn numbers_out_of_range_are_refused_when_the_controller_is_made() {
    let mut told = settings(3, 1, 4);
    assert_eq!(check(&decode(&blob(&told)).unwrap()), Ok(()));
    told.limits.speed_hz = 2000.0;
    let said = check(&decode(&blob(&told)).unwrap()).unwrap_err();
    assert_eq!(
        said,
        "limits.speed_hz: 2000 rev/s is outside 0.1 to 200 rev/s"
    );

    let mut told = settings(3, 1, 4);
    told.trims_turns[2] = 0.5;
    let said = check(&decode(&blob(&told)).unwrap()).unwrap_err();
    assert!(
        said.starts_with("axes.trim_deg (number 2): 180° is outside -5 to 5°"),
        "{said}"
    );

    let none = decode(&blob(&settings(0, 0, 1))).unwrap();
    assert_eq!(check(&none).unwrap_err(), "axes.count: 0 is outside 1 to 6");
}

proptest! {
    /// Whatever the bytes, they are decoded or refused.
    #[test]
    fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        prop_assert!(decode(&bytes).is_err());
        prop_assert!(blob_in(&bytes).is_err());
        // With a header that fits, all of it gets to the decoder behind.
        if let Ok(settings) = decode(&blob_of(&bytes, VERSION)) {
            let _ = check(&settings);
        }
    }

    /// The same of bytes that are nearly settings: few are refused before a controller is made of them.
    #[test]
    fn no_nearly_right_payload_panics(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        axes in 2_usize..=6,
    ) {
        let whole = blob(&settings(axes, 2, 9));
        let mut payload = whole[HEADER_BYTES..].to_vec();
        for (at, byte) in changes {
            let at = at.index(payload.len());
            payload[at] = byte;
        }
        if let Ok(settings) = decode(&blob_of(&payload, VERSION)) {
            let _ = check(&settings);
        }
    }
}
