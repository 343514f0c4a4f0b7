//! Gives the linker its layout: linker/bootloader.x as memory.x, which cortex-m-rt's link.x includes.

use std::{env, fs, path::PathBuf};

fn main() {
    let layout = "../linker/bootloader.x";
    println!("cargo:rerun-if-changed={layout}");
    println!("cargo:rerun-if-changed=build.rs");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy(layout, out.join("memory.x")).expect("the layout is readable and OUT_DIR writable");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        println!("cargo:rustc-link-search={}", out.display());
        println!("cargo:rustc-link-arg-bins=--nmagic");
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
    }
}
