//! The board as the BOOTLOADER state sees it: flash, time, two ports, the LED, the BOOT/CONFIG pin.

use boot_core::session::{Machine, Port, Session};
use embedded_hal::digital::{InputPin, OutputPin};
use hal::board::{BootConfig, Led};
use hal::flash::Flash;
use hal::kept::LastWords;
use hal::uart::CommsUart;
use hal::usb::UsbConsole;
use hal::watchdog::Watchdog;
use hal::{Parts, sleep, timer};

/// Half a blink of the LED: fast, microseconds.
const BLINK_US: u64 = 100_000;
/// The loop runs at least this often: the receiver of an update counts its silences. Microseconds.
const BEAT_US: u64 = 5_000;
/// How long a last reply may take to leave, microseconds: 64 bytes at 115 200 baud.
const DRAIN_US: u64 = 6_000;
/// Bytes taken from the UART a turn.
const BYTES_A_TURN: usize = 256;

/// The board.
pub struct Board {
    pub flash: Flash,
    console: UsbConsole,
    console_was_open: bool,
    comms: CommsUart,
    comms_greeted: bool,
    led: Led,
    boot_config: BootConfig,
    watchdog: Watchdog,
    next_beat_us: u64,
}

impl Board {
    /// Shows the console to its host.
    pub fn new(parts: Parts) -> Option<Self> {
        Some(Self {
            flash: parts.flash,
            console: parts.usb.attach()?,
            console_was_open: false,
            comms: parts.comms_uart,
            comms_greeted: false,
            led: parts.led,
            boot_config: parts.boot_config,
            watchdog: parts.watchdog,
            next_beat_us: 0,
        })
    }

    /// Whether the BOOT/CONFIG pin is held low.
    pub fn is_held(&mut self) -> bool {
        // The pin's error type is empty.
        self.boot_config.is_low().unwrap_or(false)
    }

    /// Moves bytes from both ports into the session; feeds the watchdog.
    pub fn serve(&mut self, session: &mut Session) {
        self.watchdog.feed();
        timer::acknowledge_alarm();
        let lit = (timer::now_us() / BLINK_US).is_multiple_of(2);
        // The pin's error type is empty.
        let _ = self.led.set_state(lit.into());
        if !self.comms_greeted {
            self.comms_greeted = true;
            session.greet(self, Port::CommsUart);
        }
        let is_open = self.console.is_open();
        if is_open && !self.console_was_open {
            session.greet(self, Port::Console);
        }
        self.console_was_open = is_open;
        self.comms.serve();
        for _ in 0..BYTES_A_TURN {
            let Some(byte) = self.comms.receive() else {
                break;
            };
            session.byte(self, Port::CommsUart, byte);
        }
        // Until nothing moves: what was answered leaves at once.
        while self.serve_console(session) {}
    }

    /// One packet each way.
    fn serve_console(&mut self, session: &mut Session) -> bool {
        let (mut packet, mut count) = ([0; hal::usb::PACKET], 0);
        let moved = self.console.poll(|byte| {
            packet[count] = byte;
            count += 1;
        });
        for &byte in &packet[..count] {
            session.byte(self, Port::Console, byte);
        }
        moved
    }

    /// Sleeps until something comes or the next beat, unless the session has work.
    pub fn rest(&mut self, session: &Session) {
        let now_us = timer::now_us();
        if session.is_busy(now_us / 1000) {
            return;
        }
        if now_us >= self.next_beat_us {
            self.next_beat_us = now_us + BEAT_US;
        }
        timer::set_alarm(self.next_beat_us);
        sleep::unless(|| self.comms.has_received() || timer::now_us() >= self.next_beat_us);
    }

    /// Lets the last replies leave.
    pub fn drain(&mut self) {
        let end_us = timer::now_us() + DRAIN_US;
        while timer::now_us() < end_us {
            self.console.poll(|_| {});
            self.comms.serve();
        }
    }
}

impl Machine for Board {
    type Flash = Flash;
    type Words = LastWords;

    fn flash(&mut self) -> &mut Flash {
        &mut self.flash
    }

    fn now_ms(&self) -> u64 {
        timer::now_us() / 1000
    }

    fn send(&mut self, port: Port, bytes: &[u8]) {
        // A port that cannot take it has nobody who reads.
        let _ = match port {
            Port::Console => self.console.send(bytes),
            Port::CommsUart => self.comms.send(bytes),
        };
    }

    fn last_words(&self) -> Option<LastWords> {
        // Left where they are: the firmware takes them at its start.
        LastWords::read()
    }
}
