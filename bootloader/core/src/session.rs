//! The BOOTLOADER state: a window of three seconds in which somebody may speak, the verification inside it, then the firmware.
//!
//! ```text
//!              ┌──────────── 3 s, both slots verified in slices ────────────┐
//!   start ─────┤ AT+LOCK=1, AT+UPDATE, pin held, or asked for by the app    ├─▶ firmware, or AT+ERROR (<reason>) once a second
//!              └─▶ locked: stays until AT+LOCK=0 or a good update           ┘
//! ```
//! | state | lock off at 3 s, image | lock off, no image | `AT+UPDATE` | transfer good | transfer bad |
//! |---|---|---|---|---|---|
//! | window | runs | stays, tells | transfer, locked | – | – |
//! | locked | – | – | transfer | runs the new image | locked, tells |
//!
//! Pure: flash, clock and ports are the [`Machine`]'s. What a session ends with is its [`Outcome`]; the caller carries it out.

use crate::choose::{Step, Verified, choose, update_target};
use crate::command::{COMMANDS, Command, Lines, Typed};
use crate::slot::{Refusal, Terms};
use crate::update::{Update, UpdateError};
use crate::verifier::Verifier;
use crate::ymodem::{Event, Receiver};
use boot_contract::boot_log::{SlotName, Standing};
use boot_contract::hand_over::Cause;
use boot_contract::header::board_name;
use boot_contract::log_store::BootLog;
use core::fmt::{self, Write};
use embedded_storage::nor_flash::NorFlash;

/// How long the bootloader stays when nobody speaks, ms of its timer. Three seconds from reset to reset: crystal and PLLs start before the timer
/// counts, and the last record and reply leave after it; together 59 ms in the twin.
pub const WINDOW_MS: u64 = 2950;
/// Verification begins here, so that an early word is answered at once, ms.
const VERIFY_AFTER_MS: u64 = 250;
/// Between two tellings that nothing can run, ms.
const TELL_EVERY_MS: u64 = 1000;
/// After a good update its reply has this long to leave, ms.
const RUN_AFTER_UPDATE_MS: u64 = 200;

/// A port somebody may speak on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    CommsUart,
    Console,
}

impl Port {
    /// Both.
    pub const ALL: [Port; 2] = [Port::CommsUart, Port::Console];

    const fn index(self) -> usize {
        match self {
            Port::CommsUart => 0,
            Port::Console => 1,
        }
    }
}

/// What a session needs of the device.
pub trait Machine {
    type Flash: NorFlash;
    /// Of a firmware's end, for people.
    type Words: fmt::Display;
    /// The flash.
    fn flash(&mut self) -> &mut Self::Flash;
    /// Milliseconds since the reset.
    fn now_ms(&self) -> u64;
    /// Sends bytes; what a port cannot take is lost.
    fn send(&mut self, port: Port, bytes: &[u8]);
    /// What the firmware that ran before could still say of its end, if it said anything.
    fn last_words(&self) -> Option<Self::Words>;
}

/// How a session ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The log is written as it must be: run this slot.
    Run(SlotName),
    /// Start again; stay in BOOTLOADER then, or not.
    Restart { locked: bool },
}

/// What the sender is told after an event.
#[derive(Clone, Copy)]
enum Answer {
    Nothing,
    Accept,
    /// It has said good-bye itself.
    Over,
}

/// A transfer under way.
struct Transfer<'a> {
    port: Port,
    receiver: Receiver,
    update: Option<Update<'a>>,
    /// The update is whole and logged.
    installed: bool,
}

impl<'a> Transfer<'a> {
    /// Not inlined: what is built here would lie on the stack below the check of a signature.
    #[inline(never)]
    fn begin(&mut self, terms: Terms<'a>, target: SlotName, length: u32) {
        self.update = Some(Update::new(terms, target, length));
    }
}

/// The session.
pub struct Session<'a> {
    terms: Terms<'a>,
    log: BootLog,
    cause: Cause,
    verifier: Verifier,
    lines: [Lines; 2],
    locked: bool,
    transfer: Option<Transfer<'a>>,
    /// When the firmware runs if nothing keeps it.
    run_at_ms: u64,
    tell_at_ms: u64,
    outcome: Option<Outcome>,
}

impl<'a> Session<'a> {
    /// After a reset of this cause. `terms.floor` is taken from the log.
    pub fn new(terms: Terms<'a>, log: BootLog, cause: Cause, locked: bool) -> Self {
        let floor = log.state().floor;
        Self {
            terms: Terms { floor, ..terms },
            log,
            cause,
            verifier: Verifier::new(),
            lines: [Lines::new(); 2],
            locked,
            transfer: None,
            run_at_ms: WINDOW_MS,
            tell_at_ms: 0,
            outcome: None,
        }
    }

    fn after_power_on(&self) -> bool {
        self.cause == Cause::PowerOn
    }

    /// What a port says when it opens.
    pub fn greet(&self, machine: &mut impl Machine, port: Port) {
        machine.send(port, b"AT+BOOTLOADER_START\r\n");
    }

    /// Whether it stays, for the LED and for the caller's sleep.
    pub fn is_locked(&self) -> bool {
        self.locked
    }

    /// Whether [`Session::turn`] has more to do at once.
    pub fn is_busy(&self, now_ms: u64) -> bool {
        now_ms >= VERIFY_AFTER_MS && self.verifier.verified().is_none()
    }

    /// Time passes: to be called often. `pin_held`: the BOOT/CONFIG pin is low.
    pub fn turn(&mut self, machine: &mut impl Machine, pin_held: bool) -> Option<Outcome> {
        let now_ms = machine.now_ms();
        if self.transfer.is_some() {
            self.pump(machine, None);
        } else if now_ms >= VERIFY_AFTER_MS && self.verifier.verified().is_none() {
            self.verifier.step(&self.terms, machine.flash());
            if self.log.needs_room() {
                // Now, so that the window does not become longer by it. What fails here fails again where it is told.
                let _ = self.log.make_room(machine.flash());
            }
        }
        if self.outcome.is_none()
            && !self.locked
            && !pin_held
            && self.transfer.is_none()
            && now_ms >= self.run_at_ms
            && let Some(verified) = self.verifier.verified()
            && let Err(reason) = self.run(machine, &verified)
            && now_ms >= self.tell_at_ms
        {
            self.tell_at_ms = now_ms + TELL_EVERY_MS;
            for port in Port::ALL {
                self.fail(machine, port, reason.reason());
            }
        }
        self.outcome
    }

    /// A byte came.
    pub fn byte(&mut self, machine: &mut impl Machine, port: Port, byte: u8) {
        match &self.transfer {
            Some(transfer) if transfer.port == port => self.pump(machine, Some(byte)),
            // The other port waits: an update owns the flash.
            Some(_) => {}
            None => match self.lines[port.index()].byte(byte) {
                Typed::Nothing => {}
                Typed::Command(command) => self.command(machine, port, command),
                Typed::Unknown => self.fail(machine, port, "unknown command"),
                Typed::TooLong => self.fail(machine, port, "line too long"),
            },
        }
    }

    fn fail(&self, machine: &mut impl Machine, port: Port, reason: &str) {
        say(machine, port, format_args!("AT+ERROR ({reason})\r\n"));
    }

    fn ok(&self, machine: &mut impl Machine, port: Port) {
        machine.send(port, b"AT+OK\r\n");
    }

    fn command(&mut self, machine: &mut impl Machine, port: Port, command: Command) {
        match command {
            Command::Attention => self.ok(machine, port),
            Command::Lock => {
                self.locked = true;
                self.ok(machine, port);
            }
            Command::Unlock => {
                let verified = self.verify_now(machine);
                match choose(self.log.state(), &verified, self.after_power_on()) {
                    Step::Stay(reason) => self.fail(machine, port, reason.reason()),
                    Step::Run { .. } | Step::Reject(_) => {
                        self.locked = false;
                        self.ok(machine, port);
                    }
                }
            }
            Command::IsLocked => {
                let lock = u8::from(self.locked);
                say(machine, port, format_args!("AT+LOCK={lock}\r\n"));
            }
            Command::IsBoot => machine.send(port, b"AT+BOOT=1\r\n"),
            Command::Update => {
                self.locked = true;
                self.ok(machine, port);
                self.transfer = Some(Transfer {
                    port,
                    receiver: Receiver::new(machine.now_ms()),
                    update: None,
                    installed: false,
                });
            }
            Command::Reboot => self.restart(machine, port, false),
            Command::RebootBootloader => self.restart(machine, port, true),
            Command::Info => self.info(machine, port),
            Command::Device => {
                let name = board_name(&self.terms.board);
                say(machine, port, format_args!("AT+DEVICE={name}\r\n"));
            }
            Command::FirmwareVersion => self.firmware_version(machine, port),
            Command::Help => {
                for (line, _, help) in COMMANDS {
                    say(machine, port, format_args!("{line} [{help}]\r\n"));
                }
                self.ok(machine, port);
            }
        }
    }

    fn restart(&mut self, machine: &mut impl Machine, port: Port, locked: bool) {
        self.ok(machine, port);
        self.outcome = Some(Outcome::Restart { locked });
    }

    fn firmware_version(&mut self, machine: &mut impl Machine, port: Port) {
        let verified = self.verify_now(machine);
        let runs = match choose(self.log.state(), &verified, self.after_power_on()) {
            Step::Run { slot, .. } => verified[slot.index()],
            Step::Reject(_) => Err(Refusal::Rejected),
            Step::Stay(reason) => Err(reason),
        };
        match runs {
            Ok(header) => say(
                machine,
                port,
                format_args!("AT+FIRMWARE_VERSION={}\r\n", header.version_text()),
            ),
            Err(reason) => self.fail(machine, port, reason.reason()),
        }
    }

    fn info(&mut self, machine: &mut impl Machine, port: Port) {
        let verified = self.verify_now(machine);
        for name in SlotName::ALL {
            let letter = name.letter();
            match verified[name.index()] {
                Ok(header) => {
                    let version = header.version_text();
                    let standing = match self.log.state().standing(name, header.image_id()) {
                        None => "not logged",
                        Some(Standing::Pending) => "pending",
                        Some(Standing::Trial(_)) => "on trial",
                        Some(Standing::Confirmed) => "confirmed",
                        Some(Standing::Rejected) => "rejected",
                    };
                    say(
                        machine,
                        port,
                        format_args!("Slot {letter}: {version}, {standing}\r\n"),
                    );
                }
                Err(reason) => {
                    let reason = reason.reason();
                    say(machine, port, format_args!("Slot {letter}: {reason}\r\n"));
                }
            }
        }
        let cause = self.cause.name();
        say(machine, port, format_args!("Started by: {cause}\r\n"));
        if let Some(words) = machine.last_words() {
            say(machine, port, format_args!("Last words: {words}\r\n"));
        }
        let floor = self.terms.floor;
        say(machine, port, format_args!("Security counter: {floor}\r\n"));
        self.ok(machine, port);
    }

    /// The verdicts, whatever is left of the verification done at once.
    fn verify_now(&mut self, machine: &mut impl Machine) -> Verified {
        self.verifier.all(&self.terms, machine.flash())
    }

    /// Writes what must be logged, and decides.
    fn run(&mut self, machine: &mut impl Machine, verified: &Verified) -> Result<(), Refusal> {
        loop {
            let (record, run) = match choose(self.log.state(), verified, self.after_power_on()) {
                Step::Reject(record) => (Some(record), None),
                Step::Run { slot, first } => (first, Some(slot)),
                Step::Stay(reason) => return Err(reason),
            };
            if let Some(record) = record {
                self.log
                    .append(machine.flash(), record)
                    .map_err(|_| Refusal::Log)?;
            }
            if let Some(slot) = run {
                self.outcome = Some(Outcome::Run(slot));
                return Ok(());
            }
        }
    }

    /// Moves the transfer on by a byte, or by the time that passed. It stays where it is meanwhile: a signature is checked below here, and the stack
    /// has no room for copies of it.
    fn pump(&mut self, machine: &mut impl Machine, byte: Option<u8>) {
        let Some(transfer) = &mut self.transfer else {
            return;
        };
        let now_ms = machine.now_ms();
        let event = match byte {
            Some(byte) => transfer.receiver.byte(byte, now_ms),
            None => transfer.receiver.tick(now_ms),
        };
        let answer = match event {
            Event::Nothing => Ok(Answer::Nothing),
            Event::Begin(length) => {
                let verified = self.verifier.all(&self.terms, machine.flash());
                let target = update_target(self.log.state(), &verified);
                transfer.begin(self.terms, target, length);
                Ok(Answer::Accept)
            }
            Event::Data(bytes) => match &mut transfer.update {
                Some(update) => update.take(machine.flash(), bytes),
                None => Ok(()),
            }
            .map(|()| Answer::Accept)
            .map_err(UpdateError::reason),
            Event::End => match &mut transfer.update {
                Some(update) => update
                    .finish(machine.flash(), &mut self.log)
                    .map(|_| transfer.installed = true),
                None => Ok(()),
            }
            .map(|()| Answer::Accept)
            .map_err(UpdateError::reason),
            Event::Done => Ok(Answer::Over),
            Event::Aborted(why) => Err(why.reason()),
        };
        match answer {
            Ok(Answer::Accept) => transfer.receiver.accept(machine.now_ms()),
            Ok(Answer::Nothing | Answer::Over) => {}
            Err(_) => transfer.receiver.cancel(),
        }
        while let Some(byte) = transfer.receiver.reply() {
            machine.send(transfer.port, &[byte]);
        }
        let (port, installed) = (transfer.port, transfer.installed);
        match answer {
            Ok(Answer::Nothing | Answer::Accept) => {}
            Ok(Answer::Over) => self.transferred(machine, port, installed),
            Err(reason) => {
                self.transfer = None;
                self.verifier = Verifier::new();
                self.fail(machine, port, reason);
            }
        }
    }

    /// The sender has said good-bye.
    fn transferred(&mut self, machine: &mut impl Machine, port: Port, installed: bool) {
        self.transfer = None;
        self.verifier = Verifier::new();
        if installed {
            self.locked = false;
            self.run_at_ms = machine.now_ms() + RUN_AFTER_UPDATE_MS;
            self.ok(machine, port);
        } else {
            self.fail(machine, port, "nothing was sent");
        }
    }
}

/// Sends formatted text, in pieces as they are made.
fn say(machine: &mut impl Machine, port: Port, text: fmt::Arguments) {
    struct Out<'m, M> {
        machine: &'m mut M,
        port: Port,
    }
    impl<M: Machine> Write for Out<'_, M> {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            self.machine.send(self.port, text.as_bytes());
            Ok(())
        }
    }
    // Sending does not fail: what a port cannot take is lost.
    let _ = Out { machine, port }.write_fmt(text);
}
