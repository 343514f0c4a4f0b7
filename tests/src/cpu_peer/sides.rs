//! Runs an image: in the twin, and in QEMU's microbit (nRF51, Cortex-M0).

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use twin::chip::Chip;
use twin::chip::flash::Flash;

use super::image::{self, DONE, RAM, RAM_BYTES};

/// QEMU's system emulator for 32-bit ARM.
const QEMU: &str = "qemu-system-arm";
/// Most cycles an image may take in the twin: ten times what one takes.
const MOST_CYCLES: u64 = 100_000;
/// Cycles between two looks at DONE.
const LOOK: u64 = 2_000;
/// Longest an image may take in QEMU; it takes about a tenth of a second.
const PATIENCE: Duration = Duration::from_secs(20);

/// What is left in RAM, and what went wrong.
pub struct End {
    /// The RAM.
    pub ram: Vec<u8>,
    /// Cycles charged at each instruction address (the twin alone).
    pub cycles: BTreeMap<u32, u64>,
    /// The fault that ended the run.
    pub fault: Option<String>,
}

/// Runs the image in the twin, where a HardFault ends it.
pub fn in_twin(ram: &[u8]) -> End {
    run_in_twin(ram, None)
}

/// Runs an image that handles its HardFaults, with its vectors at this address.
pub fn in_twin_with(ram: &[u8], vectors: u32) -> End {
    run_in_twin(ram, Some(vectors))
}

fn run_in_twin(ram: &[u8], vectors: Option<u32>) -> End {
    let mut chip = Chip::new(Flash::new(1 << 20, [0; 8]));
    // The flash is empty on purpose: no program but the image.
    chip.bus.fault = None;
    chip.take_over(0, RAM, ram, 0);
    if let Some(vectors) = vectors {
        chip.bus.ppb[0].vtor = vectors;
        chip.stop_at_hard_fault = false;
    }
    chip.start_profile();
    let mut fault = None;
    let limit = chip.now() + MOST_CYCLES;
    while fault.is_none() && image::word(&chip.bus.sram[..RAM_BYTES], DONE) == 0 {
        if chip.now() > limit {
            // HardFault without a vector, as here, locks the core up.
            fault = Some(format!("locked up: no end after {MOST_CYCLES} cycles"));
        } else if let Err(halt) = chip.run_until(chip.now() + LOOK) {
            fault = Some(halt.to_string());
        }
    }
    End {
        ram: chip.bus.sram[..RAM_BYTES].to_vec(),
        cycles: chip
            .profile()
            .map(|cores| {
                let spent = cores[0].addresses();
                spent.map(|(at, spent)| (at, spent.cycles)).collect()
            })
            .unwrap_or_default(),
        fault,
    }
}

/// Fails with what to install when QEMU is missing.
pub fn find_qemu() -> Result<String, String> {
    let output = Command::new(QEMU)
        .arg("--version")
        .output()
        .map_err(|error| {
            format!("{QEMU} does not start ({error}); install it: apt-get install qemu-system-arm")
        })?;
    let text = String::from_utf8_lossy(&output.stdout);
    Ok(text.lines().next().unwrap_or(QEMU).to_owned())
}

/// Runs the image in QEMU.
pub fn in_qemu(ram: &[u8]) -> Result<End, String> {
    in_qemu_with(ram, &image::vectors())
}

/// Runs an image in QEMU with these vectors.
pub fn in_qemu_with(ram: &[u8], vectors: &[u8]) -> Result<End, String> {
    static RUNS: AtomicU32 = AtomicU32::new(0);
    let run = RUNS.fetch_add(1, Ordering::Relaxed);
    let folder = Scratch::new(&format!("squitter-cpu-{}-{run}", std::process::id()))?;
    let write = |name: &str, bytes: &[u8]| {
        std::fs::write(folder.0.join(name), bytes).map_err(|e| format!("{name}: {e}"))
    };
    write("vectors.raw", vectors)?;
    write("image.raw", &image::for_qemu(ram.to_vec()))?;
    let mut qemu = Command::new(QEMU)
        .current_dir(&folder.0)
        .args(["-M", "microbit", "-accel", "tcg", "-nodefaults"])
        .args(["-display", "none", "-serial", "none", "-monitor", "none"])
        .args(["-semihosting-config", "enable=on,target=native"])
        .args(["-device", "loader,file=vectors.raw,addr=0x0,force-raw=on"])
        .args([
            "-device",
            &format!("loader,file=image.raw,addr={RAM:#x},force-raw=on"),
        ])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| format!("{QEMU}: {error}"))?;
    let start = Instant::now();
    let ended = loop {
        match qemu.try_wait().map_err(|e| e.to_string())? {
            Some(_) => break true,
            None if start.elapsed() > PATIENCE => break false,
            None => std::thread::sleep(Duration::from_millis(5)),
        }
    };
    if !ended {
        qemu.kill().map_err(|e| e.to_string())?;
    }
    let output = qemu.wait_with_output().map_err(|e| e.to_string())?;
    let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    if !ended {
        return Err(format!("{QEMU} did not end in {PATIENCE:?}: {said}"));
    }
    let ram = std::fs::read(folder.0.join(image::RESULT_FILE))
        .map_err(|error| format!("{QEMU} left no result ({error}): {said}"))?;
    if ram.len() != RAM_BYTES {
        return Err(format!("{QEMU} left {} bytes of RAM: {said}", ram.len()));
    }
    let fault = (image::word(&ram, DONE) != image::DONE_WELL).then(|| "a fault".to_owned());
    Ok(End {
        ram,
        cycles: BTreeMap::new(),
        fault,
    })
}

/// A folder of its own, gone with the value.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Result<Self, String> {
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(Self(path))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // A folder that stays behind does no harm.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
