//! What the shipped image remembers of a crash: provoked in the twin by a core that hangs or goes astray, told by `AT+INFO` of the next start.

use twin::board::Board;
use twin::chip::bus::Fault as Stopped;
use twin::fault::Fault;

fn booted() -> Board {
    let mut board = Board::power_on(&tests::image()).expect("the image is flashed");
    board.wait_for_capture().expect("capture starts");
    board.wait_for_console().expect("the console opens");
    board
}

/// Sends a line and returns what the console says within 50 ms.
fn ask(board: &mut Board, line: &str) -> String {
    board.console_read();
    board.console_write(format!("{line}\r\n").as_bytes());
    board.run_ms(50).expect("the chip runs");
    String::from_utf8(board.console_read()).expect("the console speaks text")
}

/// What the console has said so far.
fn said(board: &mut Board) -> String {
    String::from_utf8(board.console_read()).expect("the console speaks text")
}

/// The answer to `AT+INFO`, without what it says of crashes, and that.
fn info(board: &mut Board) -> (Vec<String>, String) {
    ask(board, "AT+PROTOCOL=CONSOLE,NONE");
    let said = ask(board, "AT+INFO");
    let (crash, rest): (Vec<&str>, _) = said.lines().partition(|l| l.starts_with("Last crash: "));
    let [crash] = crash[..] else {
        panic!("{said}");
    };
    let crash = crash.trim_start_matches("Last crash: ").to_owned();
    (rest.iter().map(|line| line.to_string()).collect(), crash)
}

/// Runs through the reset that must come within `seconds`, and the bootloader, to the app's console.
fn restarted(board: &mut Board, seconds: u64) {
    let resets = board.chip.resets.len();
    let reset = |board: &mut Board| board.chip.resets.len() > resets;
    assert!(board.run_until(seconds, reset).expect("the chip runs"));
    let captures = |board: &mut Board| board.chip.bus.pio[0].enabled_at[0] != 0;
    assert!(board.run_until(6, captures).expect("the chip runs"));
    board.wait_for_console().expect("the console opens");
}

/// Address of the first function of the shipped app whose name holds all of `parts`.
fn function(parts: &[&str]) -> u32 {
    let path = tests::root().join("target/fw/app.elf");
    let bytes = std::fs::read(path).expect("`cargo xtask fw` makes it");
    let file = object::File::parse(&*bytes).expect("an ELF file");
    use object::{Object, ObjectSymbol};
    let found = file.symbols().find(|symbol| {
        let name = symbol.name().unwrap_or_default();
        parts.iter().all(|part| name.contains(part)) && !name.contains("Thunk")
    });
    found.expect("the app has the function").address() as u32 & !1
}

#[test]
fn without_a_crash_info_tells_the_device_alone() {
    let mut board = booted();
    let (device, crash) = info(&mut board);
    assert_eq!(device[0], "Device: adsbee_1090");
    assert_eq!(device[1], "Serial number: 5351554954544552");
    assert!(device[2].starts_with("Firmware: 0.1.0.0 ("), "{device:?}");
    assert!(device[2].ends_with("), slot A, on trial"), "{device:?}");
    assert_eq!(device[3..], ["Started by: power_on", "OK"]);
    assert_eq!(crash, "none since power-on");
}

#[test]
fn a_core_that_hangs_is_named_with_the_time_and_the_counters_of_its_end() {
    for core in [0, 1] {
        let mut board = booted();
        board.run_ms(2_000).expect("the chip runs");
        board.carry_out(Fault::Hang { core }).expect("it hangs");
        restarted(&mut board, 4);
        // The start itself says so, as LOG_LEVEL's factory value wants.
        let log = said(&mut board);
        let line =
            format!("[ERRORS] crash: watchdog: core {core} stopped; firmware 0.1.0.0 after ");
        assert!(log.contains(&line), "{log}");
        let (device, crash) = info(&mut board);
        assert!(
            device.contains(&"Started by: watchdog".into()),
            "{device:?}"
        );
        let what = format!("watchdog: core {core} stopped; firmware 0.1.0.0 after ");
        let rest = crash
            .strip_prefix(&what)
            .unwrap_or_else(|| panic!("{crash}"));
        let seconds: f64 = rest.split(' ').next().unwrap().parse().unwrap();
        // Core 0 goes on telling the time until the watchdog bites, three seconds after core 1's last block.
        let expected = [2.0..2.6, 4.9..5.7][core].clone();
        assert!(expected.contains(&seconds), "core {core}: {crash}");
        // A block is 128 us.
        let blocks = crash
            .split("blocks=")
            .nth(1)
            .and_then(|t| t.split(',').next());
        let blocks: f64 = blocks.expect("counters").parse().expect("a number");
        assert!((blocks * 128e-6 - 2.2).abs() < 0.4, "core {core}: {crash}");
        assert!(crash.ends_with("(1 since power-on)"), "{crash}");
    }
}

#[test]
fn a_crash_is_remembered_over_a_reboot_counted_and_forgotten_with_the_power() {
    let mut board = booted();
    // Once it has confirmed itself an image may crash as often as it likes.
    board.run_ms(11_000).expect("the chip runs");
    board.carry_out(Fault::Hang { core: 0 }).expect("it hangs");
    restarted(&mut board, 4);
    ask(&mut board, "AT+REBOOT");
    restarted(&mut board, 1);
    // Remembered, but not the reason of this start: the log does not tell it again.
    let log = said(&mut board);
    assert!(
        log.contains("AT+RUN_START") && !log.contains("crash:"),
        "{log}"
    );
    let (device, crash) = info(&mut board);
    assert!(device.contains(&"Started by: command".into()), "{device:?}");
    assert!(crash.starts_with("watchdog: core 0 stopped"), "{crash}");
    assert!(crash.ends_with("(1 since power-on)"), "{crash}");
    board.carry_out(Fault::Hang { core: 1 }).expect("it hangs");
    restarted(&mut board, 4);
    let (_, crash) = info(&mut board);
    assert!(crash.starts_with("watchdog: core 1 stopped"), "{crash}");
    assert!(crash.ends_with("(2 since power-on)"), "{crash}");
    // A brown-out keeps most of SRAM: it is a power-on all the same.
    board.carry_out(Fault::BrownOut).expect("the supply dips");
    // Its reset has been; the hand-over's is awaited.
    restarted(&mut board, 4);
    assert_eq!(info(&mut board).1, "none since power-on");
}

#[test]
fn a_hard_fault_tells_where() {
    for core in [0, 1] {
        let mut board = booted();
        // Erased flash: 0xFFFF is no instruction.
        let address = 0x101F_F000;
        let stray = Fault::Stray { core, address };
        board.carry_out(stray).expect("it strays");
        restarted(&mut board, 1);
        let (_, crash) = info(&mut board);
        let what = format!("hard fault on core {core} at 0x101ff000, called from 0x");
        assert!(crash.starts_with(&what), "{crash}");
    }
}

/// Core 0 enters core's own panic for an index out of bounds, as if a check had failed: r2 is the place in the source, here the first one that
/// stands in the image.
#[test]
fn a_panic_tells_file_and_line() {
    let mut board = booted();
    let (place, file, line) = location(&board);
    board.chip.registers_mut(0).r[2] = place;
    let address = function(&["9panicking", "18panic_bounds_check"]);
    board
        .carry_out(Fault::Stray { core: 0, address })
        .expect("it strays");
    let tail = &file[file.len().saturating_sub(32)..];
    let what = format!("panic on core 0 at {tail}:{line}");
    // The bootloader tells it too: a device that cannot start any firmware has nobody else.
    board.run_ms(500).expect("the chip runs");
    board.comms_write(b"AT+INFO\r\n");
    board.run_ms(700).expect("the chip runs");
    let told = String::from_utf8_lossy(&board.comms_read()).into_owned();
    let lines = format!("Started by: panic\r\nLast words: {what}\r\nSecurity counter: 0\r\n");
    assert!(told.contains(&lines), "{lines} / {told}");
    let captures = |board: &mut Board| board.chip.bus.pio[0].enabled_at[0] != 0;
    assert!(board.run_until(6, captures).expect("the chip runs"));
    board.wait_for_console().expect("the console opens");
    let (device, crash) = info(&mut board);
    assert!(device.contains(&"Started by: panic".into()), "{device:?}");
    assert!(
        crash.starts_with(&format!("{what}; firmware 0.1.0.0 after 0.")),
        "{what} / {crash}"
    );
}

/// A `core::panic::Location` in slot A: its address, file and line.
fn location(board: &Board) -> (u32, String, u32) {
    let flash = &board.chip.bus.flash.bytes;
    let image = 0x1_5000..0x4_0000;
    let word = |at: usize| u32::from_le_bytes(flash[at..at + 4].try_into().expect("four bytes"));
    for at in image.clone().step_by(4) {
        let (name, length) = (
            word(at).wrapping_sub(0x1000_0000) as usize,
            word(at + 4) as usize,
        );
        if image.contains(&name)
            && (8..200).contains(&length)
            && flash[name..name + length].ends_with(b".rs")
        {
            let file = String::from_utf8(flash[name..name + length].to_vec()).expect("a name");
            return (0x1000_0000 + at as u32, file, word(at + 8));
        }
    }
    panic!("no location in the image");
}

#[test]
fn the_roms_usb_drive_is_reached_when_it_was_enabled_and_only_then() {
    let mut board = booted();
    ask(&mut board, "AT+PROTOCOL=CONSOLE,NONE");
    assert_eq!(ask(&mut board, "AT+BOOT_USB_UF2?"), "+BOOT_USB_UF2=0\r\n");
    assert!(ask(&mut board, "AT+BOOT_USB_UF2").starts_with("ERROR not enabled"));
    board.run_ms(500).expect("the chip runs");
    assert_eq!(ask(&mut board, "AT+BOOT_USB_UF2=1"), "OK\r\n");
    // COMMS_UART cannot ask for it.
    board.comms_write(b"AT+BOOT_USB_UF2\r\n");
    board.run_ms(500).expect("the chip runs");
    board.console_write(b"AT+BOOT_USB_UF2\r\n");
    let end = board.run_ms(500);
    let Err(twin::board::Error::Halted(halt)) = end else {
        panic!("{end:?}");
    };
    let drive = Stopped::UsbDrive {
        led_pins: 1 << 15,
        disabled: 0,
    };
    assert_eq!(halt.fault, drive);
    assert_eq!(board.console_read(), b"OK\r\n");
}
