//! Size of the firmware in flash and RAM, and its comparison with stored figures.
//!
//! Words: *text* is code in flash, *rodata* constants in flash, *data* the bytes copied from flash to RAM at
//! the start (code that runs from RAM too), *bss* the rest of RAM that is allocated. *Golden* figures are
//! those of a file that is stored with the code.

mod golden;

use std::io::Write;
use std::path::Path;

use crate::error::Error;
use crate::firmware::{Firmware, Kind};
use golden::Golden;

/// Number of functions and variables that are listed by name.
const NAMED: usize = 10;

/// Smaller variables are not buffers.
const MIN_BUFFER: u32 = 64;

/// Size of the firmware, bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Size {
    text: u64,
    rodata: u64,
    data: u64,
    bss: u64,
    /// None if it was not measured.
    stack: Option<Stack>,
}

/// The deepest stack, as measured elsewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stack {
    /// Its depth, bytes.
    pub bytes: u64,
    /// The number of axes at which it was measured.
    pub axes: Option<u64>,
}

impl Size {
    fn new(firmware: &Firmware, stack: Option<Stack>) -> Self {
        let sum = |kind| {
            let sections = firmware
                .sections
                .iter()
                .filter(|section| section.kind == kind);
            sections.map(|section| u64::from(section.size)).sum()
        };
        Self {
            text: sum(Kind::Text),
            rodata: sum(Kind::Constants),
            data: sum(Kind::Data),
            bss: sum(Kind::Bss),
            stack,
        }
    }

    fn flash(&self) -> u64 {
        self.text + self.rodata + self.data
    }

    fn ram(&self) -> u64 {
        self.data + self.bss
    }

    /// The stored figures, by name.
    fn figures(&self) -> Vec<(&'static str, u64)> {
        let mut figures = vec![
            ("flash_bytes", self.flash()),
            ("text_bytes", self.text),
            ("rodata_bytes", self.rodata),
            ("ram_bytes", self.ram()),
            ("data_bytes", self.data),
            ("bss_bytes", self.bss),
        ];
        figures.extend(self.stack.map(|stack| ("stack_bytes", stack.bytes)));
        let axes = self.stack.and_then(|stack| stack.axes);
        figures.extend(axes.map(|axes| ("stack_axes", axes)));
        figures
    }
}

/// The command: prints the size of the firmware and compares it with the golden figures, or rewrites them.
///
/// `stack`: the deepest stack that was measured. False if a figure has changed.
///
/// # Errors
/// Files that cannot be read or written.
pub fn check(
    elf: &Path,
    golden: Option<&Path>,
    bless: bool,
    stack: Option<Stack>,
) -> Result<bool, Error> {
    let firmware = Firmware::read(elf)?;
    let size = Size::new(&firmware, stack);
    let mut out = std::io::stdout().lock();
    print(&mut out, &firmware, &size)?;
    let Some(path) = golden else {
        return Ok(true);
    };
    let figures = size.figures();
    if bless {
        Golden::bless(path, &figures)?;
        writeln!(out, "written: {}", path.display())?;
        return Ok(true);
    }
    let changes = Golden::read(path)?.compare(&figures);
    for change in &changes {
        writeln!(out, "CHANGED {change}")?;
    }
    if !changes.is_empty() {
        writeln!(
            out,
            "If that is meant, run this again with --bless and keep {}.",
            path.display()
        )?;
    }
    Ok(changes.is_empty())
}

fn print(out: &mut impl Write, firmware: &Firmware, size: &Size) -> Result<(), Error> {
    let Size {
        text,
        rodata,
        data,
        bss,
        ..
    } = size;
    writeln!(
        out,
        "flash {:>7} bytes: text {text}, rodata {rodata}, data {data}",
        size.flash()
    )?;
    writeln!(out, "RAM   {:>7} bytes: data {data}, bss {bss}", size.ram())?;
    if let Some(stack) = size.stack {
        let with = stack
            .axes
            .map_or(String::new(), |axes| format!(", with {axes} axes"));
        writeln!(
            out,
            "stack {:>7} bytes at most, measured{with}",
            stack.bytes
        )?;
    }
    let functions = firmware
        .functions
        .iter()
        .map(|f| (f.end - f.address, f.name()));
    list(out, "largest functions", functions.collect())?;
    let buffers = firmware.variables.iter().filter(|v| v.size >= MIN_BUFFER);
    list(
        out,
        "largest variables in RAM",
        buffers.map(|v| (v.size, v.name.clone())).collect(),
    )
}

fn list(out: &mut impl Write, title: &str, mut entries: Vec<(u32, String)>) -> Result<(), Error> {
    // By name where sizes are equal, so that the same firmware gives the same list.
    entries.sort_by(|a, b| b.0.cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    writeln!(out, "{title}:")?;
    for (size, name) in entries.iter().take(NAMED) {
        writeln!(out, "{size:>8} {name}")?;
    }
    Ok(())
}
