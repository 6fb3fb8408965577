//! Interface for JavaScript: numbers and memory, no generated code.
//!
//! The page writes UTF-8 text into the room that [`room`] returns, and calls [`preview`]. The results remain until the next call:
//! [`answer`] is JSON (UTF-8), [`envelope`] is rows of 64-bit floats. A row is one bucket: its first and last time (s), then smallest
//! and largest value of each channel. Each pointer has its length in a second function, because a function returns one number.

#![expect(
    unsafe_code,
    reason = "an export needs a name of its own; nothing here reads a pointer"
)]

use std::cell::RefCell;

use cophase_files::trace::Envelope;

use crate::{CHANNELS, compute};

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Receives the state of a growing preview at intervals: rows so far, their number, and the ticks done and expected.
    safe fn progress(rows: *const f64, count: usize, ticks: f64, expected_ticks: f64);
}

thread_local! {
    static TEXT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static ANSWER: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static ROWS: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

/// Returns room for a text with a number of bytes.
#[unsafe(no_mangle)]
extern "C" fn room(length: usize) -> *mut u8 {
    TEXT.with_borrow_mut(|text| {
        text.clear();
        text.resize(length, 0);
        text.as_mut_ptr()
    })
}

/// Checks and previews the text in the room.
#[unsafe(no_mangle)]
extern "C" fn preview(max_buckets: usize, max_ticks: f64) {
    let text = TEXT.take();
    // The encoded text of a page has no lone surrogates.
    let text = String::from_utf8_lossy(&text);
    let (answer, envelope) = compute(&text, max_buckets, max_ticks as u64, |preview, expected| {
        let rows = rows(preview.envelope());
        let count = preview.envelope().buckets();
        progress(rows.as_ptr(), count, preview.ticks as f64, expected as f64);
    });
    // Strings and finite numbers can always be written.
    ANSWER.set(serde_json::to_vec(&answer).unwrap_or_default());
    ROWS.set(rows(&envelope));
}

/// Makes the JSON Schema of scenes the answer.
#[unsafe(no_mangle)]
extern "C" fn schema() {
    ANSWER.set(serde_json::to_vec(&cophase_scene::keys::schema()).unwrap_or_default());
}

/// Returns the answer of the last call.
#[unsafe(no_mangle)]
extern "C" fn answer() -> *const u8 {
    ANSWER.with_borrow(|answer| answer.as_ptr())
}

/// Returns the length of the answer, bytes.
#[unsafe(no_mangle)]
extern "C" fn answer_length() -> usize {
    ANSWER.with_borrow(Vec::len)
}

/// Returns the rows of the last preview.
#[unsafe(no_mangle)]
extern "C" fn envelope() -> *const f64 {
    ROWS.with_borrow(|rows| rows.as_ptr())
}

/// Returns the number of the rows.
#[unsafe(no_mangle)]
extern "C" fn envelope_rows() -> usize {
    ROWS.with_borrow(Vec::len) / ROW
}

/// Numbers in a row.
const ROW: usize = 2 + 2 * CHANNELS;

/// Numbers in a row.
#[unsafe(no_mangle)]
extern "C" fn row_length() -> usize {
    ROW
}

fn rows(envelope: &Envelope) -> Vec<f64> {
    let mut rows = Vec::with_capacity(envelope.buckets() * ROW);
    for (first_s, last_s, extents) in envelope.rows() {
        rows.extend([first_s, last_s]);
        rows.extend(extents.iter().flat_map(|extent| [extent.low, extent.high]));
    }
    rows
}
