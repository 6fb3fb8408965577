//! NOR flash whose power can be cut.
//!
//! Erasing sets all bits of a sector to 1, and programming sets some of them to 0. The model is stricter than most
//! chips: programmed pages must have been erased, and whole pages are programmed. A cut leaves the current operation
//! half done, and nothing happens after it until the power is back.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

pub const PAGE: usize = 256;
pub const SECTOR: usize = 4096;

/// Order in which an interrupted operation has changed bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cut {
    /// Bytes change one after the other, from the first.
    FirstToLast,
    /// Sectors are erased from the last.
    LastToFirst,
    /// Every byte of the page or sector may be as before, done, or anything between. Bytes that are being erased may
    /// have any value.
    Mixture,
}

pub const CUTS: [Cut; 3] = [Cut::FirstToLast, Cut::LastToFirst, Cut::Mixture];

#[derive(Clone, Debug)]
pub struct Nor {
    pub bytes: Vec<u8>,
    /// Bytes to be erased or programmed before the power is cut.
    pub power: Option<usize>,
    pub cut: Cut,
    /// Bytes erased and programmed so far.
    pub done: usize,
    /// A byte in which bits stay 1.
    pub worn: Option<usize>,
    random: u64,
}

impl Nor {
    pub fn new(bytes: Vec<u8>) -> Self {
        Self {
            bytes,
            power: None,
            cut: Cut::FirstToLast,
            done: 0,
            worn: None,
            random: 0x9E37_79B9_7F4A_7C15,
        }
    }

    /// Selects other random mixtures.
    pub fn seed(&mut self, seed: usize) {
        self.random ^= (seed as u64).wrapping_mul(0xD134_2543_DE82_EF95);
    }

    /// Random byte by xorshift64: all values are equally likely.
    fn random(&mut self) -> u8 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 32) as u8
    }

    /// Takes the power for `bytes` from the rest. Returns whether it was enough, and for how many bytes.
    fn spend(&mut self, bytes: usize) -> (bool, usize) {
        let written = self.power.map_or(bytes, |left| left.min(bytes));
        self.power = self.power.map(|left| left - written);
        self.done += written;
        (written == bytes, written)
    }

    fn erase_sector(&mut self, at: usize) -> Result<(), NorFlashErrorKind> {
        let (whole, written) = self.spend(SECTOR);
        for i in 0..SECTOR {
            let before = self.bytes[at + i];
            self.bytes[at + i] = match self.cut {
                _ if whole => 0xFF,
                // No byte was begun.
                _ if written == 0 => before,
                Cut::Mixture => match self.random() % 4 {
                    0 => before,
                    1 => 0xFF,
                    2 => before | self.random(),
                    _ => self.random(),
                },
                _ if i < written => 0xFF,
                _ => before,
            };
        }
        if whole {
            Ok(())
        } else {
            Err(NorFlashErrorKind::Other)
        }
    }
}

impl ErrorType for Nor {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Nor {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        if self.power == Some(0) {
            return Err(NorFlashErrorKind::Other);
        }
        let offset = offset as usize;
        bytes.copy_from_slice(&self.bytes[offset..offset + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Nor {
    const WRITE_SIZE: usize = PAGE;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        let mut sectors: Vec<usize> = (from as usize..to as usize).step_by(SECTOR).collect();
        if self.cut == Cut::LastToFirst {
            sectors.reverse();
        }
        sectors.into_iter().try_for_each(|at| self.erase_sector(at))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        for (at, page) in (offset as usize..).step_by(PAGE).zip(bytes.chunks(PAGE)) {
            assert!(
                self.bytes[at..at + PAGE].iter().all(|&byte| byte == 0xFF),
                "page {at:#x} is written twice, or was not erased"
            );
            let (whole, written) = self.spend(PAGE);
            for (i, &byte) in page.iter().enumerate() {
                let kept = match self.cut {
                    _ if whole => 0,
                    _ if written == 0 => 0xFF,
                    Cut::Mixture => match self.random() % 3 {
                        0 => 0xFF,
                        1 => 0,
                        _ => self.random(),
                    },
                    _ if i < written => 0,
                    _ if i == written => self.random(), // The byte during which the power fails.
                    _ => 0xFF,
                };
                let worn = if self.worn == Some(at + i) { 0x10 } else { 0 };
                self.bytes[at + i] &= byte | kept | worn;
            }
            if !whole {
                return Err(NorFlashErrorKind::Other);
            }
        }
        Ok(())
    }
}
