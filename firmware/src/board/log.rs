//! Log: frames of defmt for a debug probe, over RTT, written without blocking an interrupt.
//!
//! The crate `defmt-rtt` blocks interrupts while it writes a frame, and a tick of the loop begins later by that time. Its mode that does
//! not block them needs compare-and-swap, which this processor lacks.
//!
//! A *frame* is one message. It is written behind the *cursor* that the probe has, and published as a whole when it ends.
//! A frame that begins while another one is written, in an interrupt, is dropped. So a frame has one writer at a time.
//! If no probe reads, the newest frames overwrite the oldest.

use core::cell::{Cell, UnsafeCell};
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicU32, Ordering, compiler_fence};

/// Bytes of the buffer that a probe reads.
const SIZE: usize = 1024;

/// Buffer towards the probe, as RTT lays it out.
#[repr(C)]
struct Channel {
    name: *const u8,
    buffer: *mut u8,
    size: u32,
    write: AtomicU32,
    read: AtomicU32,
    /// Mode that the probe requests. Blocking is ignored: a probe that stops reading must not stop the loop.
    flags: AtomicU32,
}

/// Control block of RTT. Probes find it by its name, or by its identifier in RAM.
#[repr(C)]
struct ControlBlock {
    identifier: [u8; 16],
    up_channels: u32,
    down_channels: u32,
    up: Channel,
}

// SAFETY: the fields that change are atomic. Only the one frame that is open writes the buffer.
unsafe impl Sync for ControlBlock {}

struct Buffer(UnsafeCell<MaybeUninit<[u8; SIZE]>>);

// SAFETY: as for the control block.
unsafe impl Sync for Buffer {}

/// Not set to zero at power-up: its earlier contents are of no use.
#[unsafe(link_section = ".uninit.log")]
static BUFFER: Buffer = Buffer(UnsafeCell::new(MaybeUninit::uninit()));

/// In RAM, where it can be read while the flash is erased.
#[unsafe(link_section = ".data.log")]
static NAME: [u8; 6] = *b"defmt\0";

#[unsafe(no_mangle)]
static _SEGGER_RTT: ControlBlock = ControlBlock {
    identifier: *b"SEGGER RTT\0\0\0\0\0\0",
    up_channels: 1,
    down_channels: 0,
    up: Channel {
        name: NAME.as_ptr(),
        buffer: BUFFER.0.get().cast(),
        size: SIZE as u32,
        write: AtomicU32::new(0),
        read: AtomicU32::new(0),
        flags: AtomicU32::new(0),
    },
};

/// The frame that is written.
struct Frame {
    /// Frames that have begun and not ended. The processor returns from interrupts in reverse order, so loads and stores suffice.
    depth: AtomicU32,
    encoder: UnsafeCell<defmt::Encoder>,
    /// Place of the next byte.
    cursor: Cell<usize>,
}

// SAFETY: encoder and cursor belong to the frame that found no other one open.
unsafe impl Sync for Frame {}

static FRAME: Frame = Frame {
    depth: AtomicU32::new(0),
    encoder: UnsafeCell::new(defmt::Encoder::new()),
    cursor: Cell::new(0),
};

impl Frame {
    fn begin(&self) {
        let depth = self.depth.load(Ordering::Relaxed) + 1;
        self.depth.store(depth, Ordering::Relaxed);
        compiler_fence(Ordering::SeqCst);
        if depth == 1 {
            let published = _SEGGER_RTT.up.write.load(Ordering::Relaxed);
            self.cursor.set(published as usize);
            self.encode(|encoder, write| encoder.start_frame(write));
        }
    }

    fn write(&self, bytes: &[u8]) {
        if self.is_open() {
            self.encode(|encoder, write| encoder.write(bytes, write));
        }
    }

    fn end(&self) {
        if self.is_open() {
            self.encode(|encoder, write| encoder.end_frame(write));
            compiler_fence(Ordering::SeqCst);
            let end = self.cursor.get() as u32;
            _SEGGER_RTT.up.write.store(end, Ordering::Release);
        }
        compiler_fence(Ordering::SeqCst);
        let depth = self.depth.load(Ordering::Relaxed);
        self.depth.store(depth.saturating_sub(1), Ordering::Relaxed);
    }

    /// True for the frame that began first.
    fn is_open(&self) -> bool {
        self.depth.load(Ordering::Relaxed) == 1
    }

    /// Encodes for the frame that is open.
    fn encode(&self, encode: impl FnOnce(&mut defmt::Encoder, fn(&[u8]))) {
        // SAFETY: only the open frame comes here, and the encoder does not call itself.
        encode(unsafe { &mut *self.encoder.get() }, |bytes| {
            FRAME.stage(bytes);
        });
    }

    /// Puts bytes behind the cursor, where the probe does not read yet.
    fn stage(&self, bytes: &[u8]) {
        let mut cursor = self.cursor.get();
        for &byte in bytes {
            // SAFETY: the cursor is below the buffer's size, and one frame is open.
            unsafe { _SEGGER_RTT.up.buffer.add(cursor).write(byte) };
            cursor = (cursor + 1) % SIZE;
        }
        self.cursor.set(cursor);
    }
}

/// Discards the frame that is being written, so that a panic in the middle of it can be logged. No interrupt may come any more.
pub fn discard() {
    FRAME.depth.store(0, Ordering::Relaxed);
}

#[defmt::global_logger]
struct Logger;

// SAFETY: a frame that finds another one open writes nothing, so calls of two frames do not mix.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        FRAME.begin();
    }

    unsafe fn flush() {}

    unsafe fn release() {
        FRAME.end();
    }

    unsafe fn write(bytes: &[u8]) {
        FRAME.write(bytes);
    }
}
