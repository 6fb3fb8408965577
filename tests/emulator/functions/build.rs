//! Links the board's ELF by `functions.x`; a host build needs nothing.

fn main() {
    println!("cargo::rerun-if-changed=functions.x");
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        let here = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
        println!("cargo::rustc-link-arg-bins=-T{here}/functions.x");
    }
}
