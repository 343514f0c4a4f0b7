//! The steps between RUN and CONFIGURATION, carried out one after the other (`shell::state` decides which).
//!
//! ```text
//!   event ─▶ Machine ─▶ steps ─▶ here, a turn of the loop each while COMMS_UART has to fall silent
//! ```
//! While steps are under way no line is answered and no report begins.

use crate::console::Reply;
use crate::receiver::Receiver;
use boot_contract::hand_over::{Cause, HandOver};
use drivers::led::Shows;
use reporter::Kind;
use settings::Port;
use shell::{
    Dialect, Event, Failure, Machine, Out, Place, Rate, Refusal, Restart, State, Step, state,
};

/// COMMS_UART's rate in CONFIGURATION, bits a second (003, chapter 3).
const FIXED_BAUD: u32 = 115_200;
/// Told at each start until settings are stored (003, chapter 5).
const MISSING: &str = "AT+ERROR (Settings missing, loaded default)";

/// Steps of a start.
const BOOT: &[Step] = &[Step::Say(state::RUN_START), Step::Start];
const BOOT_WITHOUT_SETTINGS: &[Step] =
    &[Step::Say(MISSING), Step::Say(state::RUN_START), Step::Start];

/// The machine and its steps under way.
pub struct States {
    machine: Machine,
    steps: &'static [Step],
    asker: Option<(Port, Dialect)>,
    failure: Option<Failure>,
    /// The settings were missing at the start, and have not been stored since.
    pub are_missing: bool,
    /// Whether frames are taken: in RUN.
    pub is_receiving: bool,
    /// Uptime at which RUN was entered, milliseconds.
    pub run_since_ms: u64,
}

impl States {
    /// Starting. `pin_held`: BOOT/CONFIG as found.
    pub const fn new(are_missing: bool, pin_held: bool) -> Self {
        Self {
            machine: Machine::new(pin_held),
            steps: if are_missing {
                BOOT_WITHOUT_SETTINGS
            } else {
                BOOT
            },
            asker: None,
            failure: None,
            are_missing,
            is_receiving: false,
            run_since_ms: 0,
        }
    }

    /// Whether steps are under way.
    pub const fn is_moving(&self) -> bool {
        !self.steps.is_empty()
    }

    /// Whether the state is RUN.
    pub const fn is_run(&self) -> bool {
        matches!(self.machine.state(), State::Run)
    }
}

impl Receiver {
    /// Where a port is.
    pub fn place(&self, port: Port) -> Place {
        Place {
            port,
            state: self.states.machine.state(),
        }
    }

    /// Something happened; a line asked for it, or the pin.
    pub fn take_event(&mut self, event: Event, asker: Option<(Port, Dialect)>) {
        self.states.steps = self.states.machine.take(event);
        self.states.asker = asker;
        self.states.failure = None;
        self.go_on_moving();
    }

    /// Looks at the pin, between moves.
    pub fn see_pin(&mut self) {
        let is_held = self.hardware.is_config_held();
        if !self.states.is_moving() && is_held != self.states.machine.is_pin_held() {
            let event = if is_held {
                Event::PinLow
            } else {
                Event::PinReleased
            };
            self.take_event(event, None);
        }
    }

    /// Goes on with the steps until one has to wait.
    pub fn go_on_moving(&mut self) {
        while let [step, rest @ ..] = self.states.steps {
            if !self.carry_out(*step) {
                return;
            }
            self.states.steps = rest;
        }
    }

    /// Does a step; `false`: it has to wait.
    fn carry_out(&mut self, step: Step) -> bool {
        // A change of rate under way, or a ring full of reports: COMMS_UART's line moves by itself.
        let is_comms_ready = self.comms.port.room(Kind::Reply) >= 64;
        match step {
            Step::Save => self.states.failure = self.save_at_once().err(),
            Step::Answer | Step::Refuse if !is_comms_ready => return false,
            Step::Answer => self.tell_asker(
                self.states
                    .failure
                    .map_or(Ok(()), |why| Err(Refusal::Device(why))),
            ),
            Step::Refuse => self.tell_asker(Err(Refusal::State)),
            Step::Stop => {
                self.states.is_receiving = false;
                self.console.stop();
                self.comms.stop();
            }
            Step::Start => {
                self.states.run_since_ms = self.now_ms();
                self.states.is_receiving = true;
                self.console.run();
                self.comms.run();
            }
            Step::Say(_) if !is_comms_ready => return false,
            Step::Say(text) => self.say(text),
            Step::SetRate(rate) => {
                let baud = match rate {
                    Rate::Fixed => FIXED_BAUD,
                    Rate::AsSet => self.stored.settings.comms_baud,
                };
                // Both are in range; what follows waits until it is done.
                let _ = self.comms.port.outlet.0.request_baud(baud);
            }
            Step::Restart(Restart::Again) => self.reboot_soon(HandOver::Restart(Cause::Command)),
            Step::Restart(Restart::Bootloader) => self.reboot_soon(HandOver::Stay(Cause::Command)),
            Step::Restart(Restart::UsbDrive) => self.usb_drive_soon(),
        }
        true
    }

    fn tell_asker(&mut self, result: Result<(), Refusal>) {
        if let Some((port, dialect)) = self.states.asker {
            let mut reply = Reply::new();
            dialect.tell(&mut reply, result);
            reply.send(self, port);
        }
    }

    /// A line on both ports.
    fn say(&mut self, text: &str) {
        let mut reply = Reply::new();
        reply.line(format_args!("{text}"));
        if self.console.port.outlet.0.is_open() {
            reply.send(self, Port::Console);
        }
        reply.send(self, Port::CommsUart);
    }

    /// A host has opened CONSOLE: what it would have heard.
    pub fn greet_console(&mut self) {
        let mut reply = Reply::new();
        if self.states.are_missing {
            reply.line(format_args!("{MISSING}"));
        }
        let text = match self.states.machine.state() {
            State::Run => state::RUN_START,
            State::Configuration { .. } => state::CONFIG_START,
        };
        reply.line(format_args!("{text}"));
        reply.send(self, Port::Console);
        self.log_start();
    }

    /// Whole seconds since RUN was entered.
    pub fn run_s(&self) -> u32 {
        (self.now_ms().saturating_sub(self.states.run_since_ms) / 1000) as u32
    }

    /// Whether COMMS_UART's rate is the set one, or is about to be.
    pub fn is_rate_as_set(&self) -> bool {
        match self.states.machine.state() {
            State::Run => true,
            State::Configuration { as_set, .. } => as_set,
        }
    }

    /// What the LED shows.
    pub fn shows(&self) -> Shows {
        match self.states.machine.state() {
            _ if !self.stored.settings.led => Shows::Dark,
            State::Run => Shows::Frames,
            State::Configuration { .. } => Shows::Slow,
        }
    }
}
