//! Gives the linker its layout.

use std::{env, fs, path::PathBuf};

fn main() {
    println!("cargo:rerun-if-changed=peer.x");
    println!("cargo:rerun-if-changed=build.rs");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy("peer.x", out.join("peer.x")).expect("the layout is readable and OUT_DIR writable");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        println!("cargo:rustc-link-search={}", out.display());
        println!("cargo:rustc-link-arg-bins=--nmagic");
        println!("cargo:rustc-link-arg-bins=-Tpeer.x");
    }
}
