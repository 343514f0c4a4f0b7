//! The device among this computer's serial ports, by the names its USB descriptors tell (`hal::usb`).
//!
//! ```text
//!   /sys/class/tty/ttyACM0/device ─▶ the interface's folder ─ its parent: the device's, with `manufacturer`, `product`, `serial`
//! ```
//! Source: Linux, Documentation/ABI/testing/sysfs-bus-usb.

use std::path::{Path, PathBuf};

/// Where Linux lists terminals.
pub const TERMINALS: &str = "/sys/class/tty";
/// What a device of ours calls itself.
const MANUFACTURER: &str = "Squitter";
const PRODUCT: &str = "Squitter 1090";

/// A device that was found.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Found {
    pub serial: String,
    pub path: PathBuf,
}

/// All devices, by serial number.
pub fn devices(terminals: &Path) -> Vec<Found> {
    let entries = std::fs::read_dir(terminals).into_iter().flatten().flatten();
    let mut found: Vec<Found> = entries
        .filter_map(|entry| {
            let device = std::fs::canonicalize(entry.path().join("device")).ok()?;
            let told = |name: &str| {
                let text = std::fs::read_to_string(device.parent()?.join(name)).ok()?;
                Some(text.trim_end().to_string())
            };
            let is_ours = told("manufacturer")? == MANUFACTURER && told("product")? == PRODUCT;
            is_ours.then_some(())?;
            Some(Found {
                serial: told("serial")?,
                path: Path::new("/dev").join(entry.file_name()),
            })
        })
        .collect();
    found.sort();
    found
}

/// The one device there is, or the one of this serial number; else why not.
pub fn only(terminals: &Path, serial: Option<&str>) -> Result<Found, String> {
    let mut all = devices(terminals);
    if let Some(serial) = serial {
        all.retain(|device| device.serial.eq_ignore_ascii_case(serial));
    }
    match (all.len(), serial) {
        (1, _) => Ok(all.remove(0)),
        (0, Some(serial)) => Err(format!(
            "no device with the serial number {serial} is connected"
        )),
        (0, None) => {
            Err("no device is connected by USB; name its serial port with --port".to_string())
        }
        _ => {
            let list = all
                .iter()
                .map(|device| format!("\n  {}  {}", device.serial, device.path.display()));
            Err(format!(
                "several devices are connected; say which with --serial:{}",
                list.collect::<String>()
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tree as sysfs shows it: terminal, its USB interface, the device around it.
    fn plug(root: &Path, terminal: &str, names: [&str; 3]) {
        let device = root.join(format!("devices/usb/{terminal}"));
        let interface = device.join("interface");
        std::fs::create_dir_all(&interface).unwrap();
        for (file, text) in ["manufacturer", "product", "serial"].iter().zip(names) {
            std::fs::write(device.join(file), format!("{text}\n")).unwrap();
        }
        let class = root.join("class").join(terminal);
        std::fs::create_dir_all(&class).unwrap();
        std::os::unix::fs::symlink(&interface, class.join("device")).unwrap();
    }

    #[test]
    fn devices_are_told_apart_by_their_names_and_serial_numbers() {
        let root = std::env::temp_dir().join(format!("squitter-find-{}", std::process::id()));
        let class = root.join("class");
        plug(&root, "ttyACM0", ["Raspberry Pi", "Pico", "E6"]);
        std::fs::create_dir_all(class.join("tty1")).unwrap();
        assert!(only(&class, None).unwrap_err().contains("--port"));
        plug(
            &root,
            "ttyACM3",
            ["Squitter", "Squitter 1090", "5351554954544552"],
        );
        let found = only(&class, None).unwrap();
        assert_eq!(found.path, Path::new("/dev/ttyACM3"));
        plug(
            &root,
            "ttyACM1",
            ["Squitter", "Squitter 1090", "E6605838834A0F01"],
        );
        let several = only(&class, None).unwrap_err();
        assert!(
            several.contains("E6605838834A0F01  /dev/ttyACM1"),
            "{several}"
        );
        let found = only(&class, Some("e6605838834a0f01")).unwrap();
        assert_eq!(found.path, Path::new("/dev/ttyACM1"));
        assert!(only(&class, Some("00")).is_err());
        std::fs::remove_dir_all(&root).unwrap();
    }
}
