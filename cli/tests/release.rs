//! Keys, packages and factory files as scripts make them: `squitter keygen`, `pack`, `sign`, `verify`, `factory`, and the exit codes of `update`.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root() -> PathBuf {
    let manifest = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().map(PathBuf::from).unwrap_or(manifest)
}

fn squitter(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_squitter"))
        .current_dir(root())
        .args(arguments)
        .output()
        .expect("squitter runs")
}

fn done(arguments: &[&str]) -> String {
    let output = squitter(arguments);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{arguments:?}: {error}");
    String::from_utf8(output.stdout).expect("text")
}

/// What it says, and its exit code.
fn failed(arguments: &[&str]) -> (i32, String) {
    let output = squitter(arguments);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code().expect("an exit code"), error)
}

/// A folder that is gone again afterwards.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("squitter-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        Self(path)
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().expect("UTF-8").to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn a_release_is_packed_here_signed_there_and_verified_from_the_public_key_alone() {
    let folder = Folder::new("release");
    let (mine, other, package) = (
        folder.path("mine"),
        folder.path("other"),
        folder.path("a.sqt"),
    );
    done(&["keygen", &mine]);
    done(&["keygen", &other]);
    assert_eq!(failed(&["keygen", &mine]).0, 1, "a key was overwritten");
    let (key, public) = (format!("{mine}.key"), format!("{mine}.pub"));
    let release = [
        "--release",
        "1.2.3.4",
        "--date",
        "2026-11-25",
        "--counter",
        "7",
    ];
    let said = done(&[&["pack"], &release[..], &[&package]].concat());
    assert!(
        said.contains("unsigned") && said.contains("1.2.3.4 (Nov 25 2026)"),
        "{said}"
    );
    let (code, reason) = failed(&["verify", "--public", &public, &package]);
    assert_eq!(
        (code, reason.contains("unknown key")),
        (1, true),
        "{reason}"
    );
    // An update does not even open a port for it.
    let (code, reason) = failed(&["update", "--port", "/nowhere", &package]);
    assert_eq!((code, reason.contains("unsigned")), (3, true), "{reason}");
    done(&["sign", "--key", &key, &package]);
    let said = done(&["verify", "--public", &public, &package]);
    assert!(
        said.contains("counter  7") && said.contains("genuine"),
        "{said}"
    );
    let (code, reason) = failed(&["verify", "--public", &format!("{other}.pub"), &package]);
    assert_eq!(
        (code, reason.contains("unknown key")),
        (1, true),
        "{reason}"
    );
    // The same images at once, signed: the same bytes, since Ed25519 has no dice.
    let again = folder.path("b.sqt");
    done(&[&["pack", "--key", &key], &release[..], &[&again]].concat());
    assert!(std::fs::read(&again).unwrap() == std::fs::read(&package).unwrap());
    let (code, reason) = failed(&["update", "--port", "/nowhere", &package]);
    assert_eq!((code, reason.contains("/nowhere")), (4, true), "{reason}");
    let mut bytes = std::fs::read(&package).unwrap();
    bytes[5000] ^= 1;
    std::fs::write(&package, bytes).unwrap();
    let (code, reason) = failed(&["verify", "--public", &public, &package]);
    assert_eq!((code, reason.contains("image hash")), (1, true), "{reason}");
}

/// The file of `squitter factory` is the one of `cargo xtask fw`, and a bootloader that does not know the key is not flashed.
#[test]
fn a_factory_file_is_made_of_a_bootloader_and_a_package_it_accepts() {
    let folder = Folder::new("factory");
    let uf2 = folder.path("factory.uf2");
    let shipped = root().join("target/fw/squitter-adsbee_1090");
    let sqt = shipped.with_extension("sqt");
    done(&["factory", sqt.to_str().unwrap(), &uf2]);
    let expected = std::fs::read(shipped.with_extension("uf2")).expect("`cargo xtask fw` makes it");
    assert!(std::fs::read(Path::new(&uf2)).unwrap() == expected);
    let (mine, package) = (folder.path("mine"), folder.path("a.sqt"));
    done(&["keygen", &mine]);
    let key = format!("{mine}.key");
    let release = [
        "--release",
        "1.0.0.0",
        "--date",
        "2026-11-25",
        "--key",
        &key,
    ];
    done(&[&["pack"], &release[..], &[&package]].concat());
    let (code, reason) = failed(&["factory", &package, &folder.path("b.uf2")]);
    assert_eq!(
        (code, reason.contains("does not hold the key")),
        (1, true),
        "{reason}"
    );
}

#[test]
fn wrong_command_lines_are_told_apart() {
    assert_eq!(failed(&["update"]).0, 2);
    let (code, reason) = failed(&["pack", "--release", "1.2", "--date", "2026-11-25", "x"]);
    assert_eq!(
        (code, reason.contains("four numbers")),
        (1, true),
        "{reason}"
    );
    assert_eq!(failed(&["update", "/nowhere.sqt"]).0, 3);
}
