//! Gives the linker its map, and the firmware its built-in settings.
//!
//! A build for a host needs neither.

use std::path::{Path, PathBuf};
use std::{env, fs};

/// Variable that names a settings file, as `cophase settings` writes it, to build in instead of the default scene's.
const SETTINGS: &str = "COPHASE_SETTINGS";

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed={SETTINGS}");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let here = PathBuf::from(env::var("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets it"));

    // cortex-m-rt's link.x includes the map by this name.
    let map = here.join("../memory.x");
    fs::copy(&map, out.join("memory.x")).expect("memory.x lies at the top of the workspace");
    println!("cargo:rerun-if-changed={}", map.display());
    println!("cargo:rustc-link-search={}", out.display());
    // Sections in flash need no gaps, as no pages are mapped.
    println!("cargo:rustc-link-arg-bins=--nmagic");
    let from_ram = here.join("from-ram.x");
    println!("cargo:rerun-if-changed={}", from_ram.display());
    println!("cargo:rustc-link-arg-bins=-T{}", from_ram.display());
    for script in ["link.x", "link-rp.x", "defmt.x"] {
        println!("cargo:rustc-link-arg-bins=-T{script}");
    }

    let settings_file = match env::var_os(SETTINGS) {
        // Cargo runs this in the package's folder, but users give the path from the top of the workspace.
        Some(path) if !path.is_empty() => here.join("..").join(path),
        _ => here.join("link/golden/default.settings"),
    };
    println!("cargo:rerun-if-changed={}", settings_file.display());
    match check(&settings_file) {
        Ok((bytes, summary)) => {
            if env::var_os(SETTINGS).is_some_and(|path| !path.is_empty()) {
                println!("cargo::warning=settings built in: {summary}");
            }
            fs::write(out.join("built-in.settings"), bytes)
                .expect("cargo's own folder can be written");
        }
        Err(problem) => {
            println!(
                "cargo::error={}: {problem}; {SETTINGS} names a file that `cophase settings SCENE -o FILE` wrote, \
                 counted from the top of the workspace",
                settings_file.display()
            );
        }
    }
}

/// Checks that the firmware can read a settings file; returns its bytes and a summary.
fn check(path: &Path) -> Result<(Vec<u8>, String), String> {
    let bytes = fs::read(path).map_err(|error| error.to_string())?;
    let settings = cophase_link::decode(&bytes).map_err(|error| error.to_string())?;
    let summary = format!("{}, {} axes", settings.name, settings.axes.len());
    Ok((bytes, summary))
}
