//! `cargo xtask usbip`: the image's USB stack driven by a real Linux kernel.
//!
//! ```text
//!   squitter usbip (twin) ◀─ TCP ─▶ QEMU: Debian's kernel, vhci-hcd, cdc-acm ─ /dev/ttyACM0 ─ AT+INFO, squitter update ─ exit code 0
//! ```
//! Needs Debian with `qemu-system-x86`, `busybox-static`, `usbip` and `dpkg`; its kernel is downloaded as a package and unpacked under the target folder, not
//! installed. The guest lives in its initial RAM disk alone: busybox, usbip, `squitter`, their libraries, six modules. Two minutes on a quiet machine, most of it
//! waiting; not part of CI.

use crate::{fw, workspace};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Where the twin's server listens; the guest sees this computer as 10.0.2.2.
const LISTEN: &str = "127.0.0.1:3240";
/// The longest run, seconds.
const LONGEST_S: &str = "1200";
/// Modules, under `kernel/` of the package.
const MODULES: [&str; 6] = [
    "drivers/net/ethernet/intel/e1000/e1000.ko",
    "drivers/usb/common/usb-common.ko",
    "drivers/usb/core/usbcore.ko",
    "drivers/usb/usbip/usbip-core.ko",
    "drivers/usb/usbip/vhci-hcd.ko",
    "drivers/usb/class/cdc-acm.ko",
];
/// What the guest must have said.
const SAID: [&str; 5] = [
    "ttyACM0: USB ACM device",
    "names: Squitter, Squitter 1090, ",
    "Device: adsbee_1090",
    "slot B, confirmed",
    "update: 0",
];

/// Runs it.
pub fn run() -> Result<(), String> {
    fw::run()?;
    let root = workspace::root()?;
    workspace::run(
        Command::new(env!("CARGO"))
            .current_dir(&root)
            .args(["build", "--quiet", "-p", "cli"]),
    )?;
    let squitter = workspace::target()?.join("debug/squitter");
    let folder = workspace::target()?.join("usbip");
    let kernel = kernel(&folder)?;
    let disk = disk(&folder, &kernel, &squitter)?;
    let mut twin = Command::new(&squitter)
        .args(["usbip", "--listen", LISTEN])
        .stdin(Stdio::null())
        .spawn()
        .map_err(|error| format!("cannot start {}: {error}", squitter.display()))?;
    let said = guest(&kernel, &disk);
    // It may have ended by itself.
    let _ = twin.kill();
    let _ = twin.wait();
    let said = said?;
    println!("{said}");
    match SAID.iter().find(|text| !said.contains(**text)) {
        None => {
            println!("result: seen={} of={}", SAID.len(), SAID.len());
            Ok(())
        }
        Some(text) => Err(format!("the guest never said {text:?}")),
    }
}

fn told(what: &Path) -> impl Fn(std::io::Error) -> String {
    move |error| format!("{}: {error}", what.display())
}

/// What a command prints.
fn output(command: &mut Command) -> Result<String, String> {
    let shown = format!("{command:?}");
    let output = command
        .output()
        .map_err(|error| format!("cannot start {shown}: {error}"))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        let why = String::from_utf8_lossy(&output.stderr);
        Err(format!("{shown}: {why}"))
    }
}

/// Debian's kernel package, unpacked; downloaded once.
fn kernel(folder: &Path) -> Result<PathBuf, String> {
    let unpacked = folder.join("kernel");
    if unpacked.join("boot").exists() {
        return Ok(unpacked);
    }
    fs::create_dir_all(&unpacked).map_err(told(&unpacked))?;
    let depends = output(Command::new("apt-cache").args(["depends", "linux-image-amd64"]))?;
    let name = depends
        .lines()
        .find_map(|line| line.trim().strip_prefix("Depends: "))
        .ok_or("apt knows no linux-image-amd64")?;
    workspace::run(
        Command::new("apt-get")
            .args(["download", name])
            .current_dir(folder),
    )?;
    let package = only(folder, |file| {
        file.starts_with(name) && file.ends_with(".deb")
    })?;
    workspace::run(Command::new("dpkg").arg("-x").arg(&package).arg(&unpacked))?;
    Ok(unpacked)
}

/// The first entry of a folder that fits.
fn only(folder: &Path, fits: impl Fn(&str) -> bool) -> Result<PathBuf, String> {
    let entries = fs::read_dir(folder).map_err(told(folder))?;
    let mut names = entries.flatten().map(|entry| entry.path());
    names
        .find(|path| {
            path.file_name()
                .is_some_and(|name| fits(&name.to_string_lossy()))
        })
        .ok_or_else(|| format!("{}: not what was expected", folder.display()))
}

/// The guest's initial RAM disk.
fn disk(folder: &Path, kernel: &Path, squitter: &Path) -> Result<PathBuf, String> {
    let root = folder.join("root");
    if root.exists() {
        fs::remove_dir_all(&root).map_err(told(&root))?;
    }
    let put = |from: &Path, to: &str| -> Result<(), String> {
        let to = root.join(to.trim_start_matches('/'));
        let parent = to.parent().unwrap_or(&root);
        fs::create_dir_all(parent).map_err(told(parent))?;
        fs::copy(from, &to).map_err(told(from)).map(|_| ())
    };
    put(Path::new("/usr/bin/busybox"), "bin/busybox")?;
    put(Path::new("/usr/sbin/usbip"), "usr/sbin/usbip")?;
    put(squitter, "bin/squitter")?;
    put(
        &workspace::images()?.join("squitter-adsbee_1090.sqt"),
        "squitter.sqt",
    )?;
    for program in [Path::new("/usr/sbin/usbip"), squitter] {
        let libraries = output(Command::new("ldd").arg(program))?;
        let paths = libraries
            .split_whitespace()
            .filter(|word| word.starts_with('/'));
        for path in paths {
            put(Path::new(path), path)?;
        }
    }
    let modules = only(&kernel.join("lib/modules"), |_| true)?.join("kernel");
    for module in MODULES {
        let name = module.rsplit('/').next().unwrap_or(module);
        put(&modules.join(module), &format!("modules/{name}"))?;
    }
    // Where usbip notes what it attached.
    let notes = root.join("var/run/vhci_hcd");
    fs::create_dir_all(&notes).map_err(told(&notes))?;
    let init = root.join("init");
    fs::write(&init, include_str!("usbip_guest.sh")).map_err(told(&init))?;
    fs::set_permissions(&init, fs::Permissions::from_mode(0o755)).map_err(told(&init))?;
    let disk = folder.join("disk");
    let pack = format!(
        "find . | busybox cpio -o -H newc 2>/dev/null >'{}'",
        disk.display()
    );
    workspace::run(Command::new("sh").args(["-c", &pack]).current_dir(&root))?;
    Ok(disk)
}

/// Boots it; what it said.
fn guest(kernel: &Path, disk: &Path) -> Result<String, String> {
    let image = only(&kernel.join("boot"), |name| name.starts_with("vmlinuz"))?;
    let qemu = [
        "qemu-system-x86_64",
        "-accel",
        "tcg",
        "-m",
        "512",
        "-nographic",
        "-no-reboot",
        "-append",
        "console=ttyS0 quiet",
        "-nic",
        "user,model=e1000",
    ];
    let said = output(
        Command::new("timeout")
            .arg(LONGEST_S)
            .args(qemu)
            .arg("-kernel")
            .arg(image)
            .arg("-initrd")
            .arg(disk)
            .stdin(Stdio::null()),
    )?;
    Ok(said.replace('\r', "\n"))
}
