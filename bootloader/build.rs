//! Gives the linker its layout (linker/bootloader.x as memory.x, which cortex-m-rt's link.x includes) and the code its public keys.
//!
//! `SQUITTER_PUBLIC_KEYS`: the keys this bootloader accepts, 64 hexadecimal digits each, separated by commas; `cargo xtask fw` sets it. Without
//! it the bootloader accepts nothing, which is good for a lint only.

use std::{env, fs, path::PathBuf};

/// Bytes of a public key.
const KEY: usize = 32;

fn main() {
    let layout = "../linker/bootloader.x";
    println!("cargo:rerun-if-changed={layout}");
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=SQUITTER_PUBLIC_KEYS");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy(layout, out.join("memory.x")).expect("the layout is readable and OUT_DIR writable");
    let keys = env::var("SQUITTER_PUBLIC_KEYS").unwrap_or_default();
    let keys: Vec<[u8; KEY]> = keys
        .split(',')
        .filter(|key| !key.is_empty())
        .map(key)
        .collect();
    let code = format!("const KEYS: [[u8; {KEY}]; {}] = {keys:?};\n", keys.len());
    fs::write(out.join("keys.rs"), code).expect("OUT_DIR is writable");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        println!("cargo:rustc-link-search={}", out.display());
        println!("cargo:rustc-link-arg-bins=--nmagic");
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
    }
}

fn key(hex: &str) -> [u8; KEY] {
    assert!(
        hex.len() == 2 * KEY && hex.is_ascii(),
        "SQUITTER_PUBLIC_KEYS: {hex:?} is no public key of {KEY} bytes"
    );
    std::array::from_fn(|n| {
        u8::from_str_radix(&hex[2 * n..2 * n + 2], 16)
            .unwrap_or_else(|_| panic!("SQUITTER_PUBLIC_KEYS: {hex:?} is not hexadecimal"))
    })
}
