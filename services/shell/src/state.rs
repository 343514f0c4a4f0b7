//! The device's states and what moves it between them.
//!
//! ```text
//!              AT+LOCK=0, 3 s over                 AT+CONFIG=1, =2, pin low
//!   BOOTLOADER ───────────────────▶ RUN ──────────────────────────────────▶ CONFIGURATION
//!       ▲                            ▲  ◀────────────────────────────────── │
//!       │        AT+REBOOT, AT+REBOOT_BOOTLOADER    AT+CONFIG=0, AT+LOCK=0, pin released
//!       └───────────────────────────────────────────────────────────────────┘
//! ```
//! | event | in RUN | in CONFIGURATION |
//! |---|---|---|
//! | `AT+CONFIG=1` | OK, `AT+RUN_END` at the set rate, 115200, `AT+CONFIG_START`; locked | OK, 115200; locked |
//! | `AT+CONFIG=2` | OK, `AT+RUN_END`, `AT+CONFIG_START` at the set rate; locked | OK, the set rate; locked |
//! | `AT+CONFIG=0` | OK | saves, OK, `AT+CONFIG_END`, the set rate, `AT+RUN_START`; unlocked |
//! | `AT+LOCK=1` | refused | OK; locked |
//! | `AT+LOCK=0` | refused | unlocked; as `AT+CONFIG=0` unless the pin is held |
//! | pin low | as `AT+CONFIG=1` without OK; not locked | – |
//! | pin released | – | as `AT+CONFIG=0` without OK, unless locked |
//! | `AT+REBOOT` | OK, restart | saves, OK, restart |
//! | `AT+REBOOT_BOOTLOADER` | OK, restart into BOOTLOADER, locked there | saves, OK, the same |
//! | `AT+BOOT_USB_UF2` | OK, restart into the ROM's USB drive | saves, OK, the same |
//!
//! BOOTLOADER is a program of its own (`bootloader/core/src/session.rs` has its table). Both ports enter and leave together, so the messages go
//! to both. What a step costs in time (a rate is changed when the line is silent) is the app's matter: it carries the steps out in order.

/// Where the device is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// It receives and reports.
    Run,
    /// It is being configured.
    Configuration {
        /// COMMS_UART's rate: as set, or 115200.
        as_set: bool,
        /// The pin's release does not end it.
        locked: bool,
    },
}

/// What happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// `AT+CONFIG=1`
    ConfigFixed,
    /// `AT+CONFIG=2`
    ConfigAsSet,
    /// `AT+CONFIG=0`
    ConfigEnd,
    /// `AT+LOCK=1`
    Lock,
    /// `AT+LOCK=0`
    Unlock,
    /// BOOT/CONFIG went low.
    PinLow,
    /// BOOT/CONFIG went high.
    PinReleased,
    /// `AT+REBOOT`
    Reboot,
    /// `AT+REBOOT_BOOTLOADER`
    RebootBootloader,
    /// `AT+BOOT_USB_UF2`
    BootUsb,
}

/// COMMS_UART's rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rate {
    /// 115200 bits a second.
    Fixed,
    /// As the settings say.
    AsSet,
}

/// How to restart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Restart {
    /// Through the bootloader's window.
    Again,
    /// Into BOOTLOADER, which stays.
    Bootloader,
    /// Into the ROM's USB drive.
    UsbDrive,
}

/// What the app does, one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Store the settings; its failure is what `Answer` tells.
    Save,
    /// Answer the line that asked, if a line did.
    Answer,
    /// Refuse the line that asked.
    Refuse,
    /// End reports and reception: what is left of a burst is dropped.
    Stop,
    /// Begin reception and reports.
    Start,
    /// Say this on both ports.
    Say(&'static str),
    /// Wait until COMMS_UART is silent, then change its rate.
    SetRate(Rate),
    /// Restart this way.
    Restart(Restart),
}

/// Sent before the first report.
pub const RUN_START: &str = "AT+RUN_START";
/// Sent behind the last report.
pub const RUN_END: &str = "AT+RUN_END";
/// Sent on entering CONFIGURATION.
pub const CONFIG_START: &str = "AT+CONFIG_START";
/// Sent on leaving it.
pub const CONFIG_END: &str = "AT+CONFIG_END";

const ENTER_FIXED: &[Step] = &[
    Step::Answer,
    Step::Stop,
    Step::Say(RUN_END),
    Step::SetRate(Rate::Fixed),
    Step::Say(CONFIG_START),
];
const ENTER_AS_SET: &[Step] = &[
    Step::Answer,
    Step::Stop,
    Step::Say(RUN_END),
    Step::Say(CONFIG_START),
];
const LEAVE: &[Step] = &[
    Step::Save,
    Step::Answer,
    Step::Say(CONFIG_END),
    Step::SetRate(Rate::AsSet),
    Step::Say(RUN_START),
    Step::Start,
];
const ANSWER: &[Step] = &[Step::Answer];
const REFUSE: &[Step] = &[Step::Refuse];
const TO_FIXED: &[Step] = &[Step::Answer, Step::SetRate(Rate::Fixed)];
const TO_SET: &[Step] = &[Step::Answer, Step::SetRate(Rate::AsSet)];
const RESTART: &[Step] = &[Step::Answer, Step::Restart(Restart::Again)];
const RESTART_LOCKED: &[Step] = &[Step::Answer, Step::Restart(Restart::Bootloader)];
const RESTART_USB: &[Step] = &[Step::Answer, Step::Restart(Restart::UsbDrive)];
const SAVE_RESTART: &[Step] = &[Step::Save, Step::Answer, Step::Restart(Restart::Again)];
const SAVE_RESTART_LOCKED: &[Step] =
    &[Step::Save, Step::Answer, Step::Restart(Restart::Bootloader)];
const SAVE_RESTART_USB: &[Step] = &[Step::Save, Step::Answer, Step::Restart(Restart::UsbDrive)];

/// The state, and whether the pin is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Machine {
    state: State,
    pin_held: bool,
}

impl Machine {
    /// In RUN. `pin_held`: as found at the start; only its next fall enters CONFIGURATION.
    pub const fn new(pin_held: bool) -> Self {
        Self {
            state: State::Run,
            pin_held,
        }
    }

    /// Where it is.
    pub const fn state(&self) -> State {
        self.state
    }

    /// Whether BOOT/CONFIG was low when last told.
    pub const fn is_pin_held(&self) -> bool {
        self.pin_held
    }

    /// Moves, and gives what is to be done.
    pub fn take(&mut self, event: Event) -> &'static [Step] {
        match event {
            Event::PinLow => self.pin_held = true,
            Event::PinReleased => self.pin_held = false,
            _ => {}
        }
        let (next, steps) = transition(self.state, event, self.pin_held);
        self.state = next;
        steps
    }
}

const fn configuration(as_set: bool, locked: bool) -> State {
    State::Configuration { as_set, locked }
}

fn transition(state: State, event: Event, pin_held: bool) -> (State, &'static [Step]) {
    match (state, event) {
        (State::Run, Event::ConfigFixed) => (configuration(false, true), ENTER_FIXED),
        (State::Run, Event::ConfigAsSet) => (configuration(true, true), ENTER_AS_SET),
        (State::Run, Event::PinLow) => (configuration(false, false), ENTER_FIXED),
        (State::Run, Event::ConfigEnd) => (state, ANSWER),
        (State::Run, Event::Lock | Event::Unlock) => (state, REFUSE),
        (State::Run, Event::PinReleased) => (state, &[]),
        (State::Run, Event::Reboot) => (state, RESTART),
        (State::Run, Event::RebootBootloader) => (state, RESTART_LOCKED),
        (State::Run, Event::BootUsb) => (state, RESTART_USB),

        (State::Configuration { .. }, Event::ConfigFixed) => (configuration(false, true), TO_FIXED),
        (State::Configuration { .. }, Event::ConfigAsSet) => (configuration(true, true), TO_SET),
        (State::Configuration { .. }, Event::ConfigEnd) => (State::Run, LEAVE),
        (State::Configuration { as_set, .. }, Event::Lock) => (configuration(as_set, true), ANSWER),
        (State::Configuration { as_set, .. }, Event::Unlock) if pin_held => {
            (configuration(as_set, false), ANSWER)
        }
        (State::Configuration { .. }, Event::Unlock) => (State::Run, LEAVE),
        (State::Configuration { .. }, Event::PinLow) => (state, &[]),
        (State::Configuration { locked: true, .. }, Event::PinReleased) => (state, &[]),
        (State::Configuration { .. }, Event::PinReleased) => (State::Run, LEAVE),
        (State::Configuration { .. }, Event::Reboot) => (state, SAVE_RESTART),
        (State::Configuration { .. }, Event::RebootBootloader) => (state, SAVE_RESTART_LOCKED),
        (State::Configuration { .. }, Event::BootUsb) => (state, SAVE_RESTART_USB),
    }
}

#[cfg(test)]
#[path = "state_tests.rs"]
mod tests;
