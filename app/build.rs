//! Gives the linker its layout as memory.x, which cortex-m-rt's link.x includes: the slot that `SQUITTER_SLOT` names (A without it), then
//! linker/app.x.

use std::{env, fs, path::PathBuf};

fn main() {
    let slot = env::var("SQUITTER_SLOT").unwrap_or_else(|_| "A".into());
    let layouts = [
        match slot.as_str() {
            "A" => "../linker/slot_a.x",
            "B" => "../linker/slot_b.x",
            other => panic!("SQUITTER_SLOT is {other}; slots are A and B"),
        },
        "../linker/app.x",
    ];
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=SQUITTER_SLOT");
    let mut memory = String::new();
    for layout in layouts {
        println!("cargo:rerun-if-changed={layout}");
        memory += &fs::read_to_string(layout).expect("the layout is readable");
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::write(out.join("memory.x"), memory).expect("OUT_DIR is writable");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        println!("cargo:rustc-link-search={}", out.display());
        println!("cargo:rustc-link-arg-bins=--nmagic");
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
    }
}
