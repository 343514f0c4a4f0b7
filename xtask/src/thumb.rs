//! Builds packages for the chip. rustup's toolchain with the thumbv6m target where it can be had, else Debian's.

use crate::workspace;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The Cortex-M0+ target.
pub const TARGET: &str = "thumbv6m-none-eabi";
/// The workspace's profile for images.
pub const PROFILE: &str = "firmware";

/// How to call cargo for the chip.
enum Toolchain {
    /// The cargo that runs us; the target is installed.
    Rustup,
    /// Debian's rustc-web, cargo-web and rust-web-src: core is built from source.
    Debian,
}

/// Builds the packages with these features and environment variables; returns the folder their binaries are in.
pub fn build(
    packages: &[&str],
    features: &[&str],
    environment: &[(&str, &str)],
) -> Result<PathBuf, String> {
    build_in(&workspace::root()?, packages, features, environment)
}

/// The same for a checkout in another folder.
pub fn build_in(
    root: &Path,
    packages: &[&str],
    features: &[&str],
    environment: &[(&str, &str)],
) -> Result<PathBuf, String> {
    let target = root.join("target");
    let mut command = match toolchain()? {
        Toolchain::Rustup => {
            Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        }
        Toolchain::Debian => {
            let mut command = Command::new("/usr/bin/cargo");
            command
                .env("RUSTC_BOOTSTRAP", "1")
                .env("RUSTC", "/usr/bin/rustc");
            command
        }
    };
    command.arg("build").current_dir(root);
    command.envs(environment.iter().copied());
    command.env("CARGO_ENCODED_RUSTFLAGS", nameless_paths(root)?);
    if let Toolchain::Debian = toolchain()? {
        command.arg("-Zbuild-std=core,alloc");
    }
    for package in packages {
        command.args(["--package", package]);
    }
    for feature in features {
        command.args(["--features", feature]);
    }
    command
        .args(["--target", TARGET, "--profile", PROFILE])
        .arg("--target-dir")
        .arg(&target);
    workspace::run(&mut command)?;
    Ok(target.join(TARGET).join(PROFILE))
}

/// Compiler flags that take this machine's folders out of the images: panics name their source file, and a checkout elsewhere must give the
/// same bytes. A crate of a registry is called by its own name and version.
fn nameless_paths(root: &Path) -> Result<String, String> {
    let mut flags = vec![format!("--remap-path-prefix={}=", root.display())];
    let home = std::env::var_os("CARGO_HOME")
        .map(PathBuf::from)
        .or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".cargo")))
        .ok_or("neither CARGO_HOME nor HOME is set: where do the registry's crates lie?")?;
    let registries = std::fs::read_dir(home.join("registry/src"));
    for registry in registries.into_iter().flatten().flatten() {
        flags.push(format!(
            "--remap-path-prefix={}/=",
            registry.path().display()
        ));
    }
    Ok(flags.join("\x1f"))
}

/// Installs the target if it is missing.
pub fn ensure_target() -> Result<(), String> {
    toolchain().map(|_| ())
}

/// Finds a toolchain, installing the target if rustup can.
fn toolchain() -> Result<Toolchain, String> {
    if target_installed() {
        return Ok(Toolchain::Rustup);
    }
    eprintln!("xtask: installing the {TARGET} target");
    let added = Command::new("rustup")
        .args(["target", "add", TARGET])
        .status();
    if added.is_ok_and(|status| status.success()) && target_installed() {
        return Ok(Toolchain::Rustup);
    }
    if Path::new("/usr/bin/cargo").exists() && Path::new("/usr/bin/rustc").exists() {
        eprintln!(
            "xtask: rustup cannot install it; building core from source with Debian's toolchain"
        );
        return Ok(Toolchain::Debian);
    }
    Err(format!(
        "no toolchain for {TARGET}: `rustup target add {TARGET}` failed, and Debian's rustc-web, cargo-web and rust-web-src are not installed"
    ))
}

/// The compiler has a core library for the target.
fn target_installed() -> bool {
    let libraries = Command::new("rustc")
        .args(["--print", "target-libdir", "--target", TARGET])
        .output();
    libraries.is_ok_and(|output| {
        let folder = PathBuf::from(String::from_utf8_lossy(&output.stdout).trim());
        output.status.success()
            && std::fs::read_dir(folder).is_ok_and(|mut files| {
                files.any(|file| {
                    file.is_ok_and(|file| {
                        file.file_name().to_string_lossy().starts_with("libcore-")
                    })
                })
            })
    })
}
