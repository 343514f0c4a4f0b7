//! What the device says of itself unasked, on CONSOLE: `[WARNINGS] 12 frames lost, core 0 was late`.
//!
//! | level | said |
//! |---|---|
//! | ERRORS | the crash that led to this start; stored settings that could not be read |
//! | WARNINGS | stored values that were no good; a GNSS receiver that refused its configuration or does not answer; frames lost between the cores; samples lost, so that there is no UTC any more |
//! | INFO | settings stored; the GNSS receiver configured; the image confirmed; messages for which a port had no room |
//!
//! `LOG_LEVEL` says from which level on. A line stands between whole messages, and never on a port whose protocol is binary.

use crate::console::Reply;
use crate::receiver::Receiver;
use crate::store::Trouble;
use boot_contract::hand_over::Cause;
use core::fmt;
use core::sync::atomic::Ordering;
use settings::Port;
use settings::choices::LogLevel;
use shell::Out;

/// What was told already.
#[derive(Default)]
pub struct Told {
    frames_lost: u32,
    is_broken: bool,
    is_confirmed: bool,
    /// Ends of the GNSS receiver's configuration.
    configured: u8,
    /// Messages dropped by CONSOLE and COMMS_UART.
    dropped: [u32; 2],
}

impl Receiver {
    /// A line of this level, if it is wanted.
    pub fn log(&mut self, level: LogLevel, text: fmt::Arguments<'_>) {
        let settings = &self.stored.settings;
        if level.code() > settings.log_level.code() || settings.console.is_binary() {
            return;
        }
        if !self.console.port.outlet.0.is_open() {
            return;
        }
        let mut line = Reply::new();
        line.line(format_args!("[{}] {text}", level.name()));
        line.send(self, Port::Console);
    }

    /// What the start found, told to a host that has just opened CONSOLE.
    pub fn log_start(&mut self) {
        // One that was followed by a start on command has been told before.
        if let Some(crash) = self.crash
            && self.start != Some(Cause::Command)
        {
            self.log(LogLevel::Errors, format_args!("crash: {crash}"));
        }
        match self.settings_trouble {
            // Said by the start itself.
            None | Some(Trouble::Missing) => {}
            Some(trouble) => self.log(
                LogLevel::Errors,
                format_args!("settings: {}", trouble.reason()),
            ),
        }
        let refused = self.stored.refused;
        if refused > 0 {
            self.log(
                LogLevel::Warnings,
                format_args!("settings: {refused} stored values were no good"),
            );
        }
    }

    /// Once a second: what changed.
    pub fn log_second(&mut self) {
        let lost = self.shared.queue.dropped.load(Ordering::Relaxed);
        let news = lost.wrapping_sub(self.told.frames_lost);
        self.told.frames_lost = lost;
        if news > 0 && self.states.is_receiving {
            self.log(
                LogLevel::Warnings,
                format_args!("{news} frames lost, core 0 was late"),
            );
        }
        if self.clock.is_broken() && !self.told.is_broken {
            self.told.is_broken = true;
            self.log(
                LogLevel::Warnings,
                format_args!("samples lost: no UTC until AT+REBOOT"),
            );
        }
        self.log_configuration();
        let dropped = [
            self.console.port.counters().total().dropped,
            self.comms.port.counters().total().dropped,
        ];
        let before = core::mem::replace(&mut self.told.dropped, dropped);
        for (n, port) in Port::ALL.into_iter().enumerate() {
            let news = dropped[n].wrapping_sub(before[n]);
            if news > 0 && self.states.is_receiving {
                let name = port.name();
                self.log(
                    LogLevel::Info,
                    format_args!("{name} had no room for {news} messages"),
                );
            }
        }
        if self.confirm.is_confirmed() && !self.told.is_confirmed {
            self.told.is_confirmed = true;
            self.log(LogLevel::Info, format_args!("the image is confirmed"));
        }
    }

    /// What became of the GNSS receiver's configuration.
    fn log_configuration(&mut self) {
        let (state, ended) = self.clock.configured();
        if core::mem::replace(&mut self.told.configured, ended) == ended {
            return;
        }
        match state {
            ubx::State::Configured => {
                self.log(LogLevel::Info, format_args!("GNSS receiver configured"));
            }
            ubx::State::Refused(message) => self.log(
                LogLevel::Warnings,
                format_args!("GNSS receiver refused {message}"),
            ),
            ubx::State::NoAnswer => self.log(
                LogLevel::Warnings,
                format_args!("GNSS receiver does not answer (AT+GNSS_CONFIG=OFF ends the asking)"),
            ),
            ubx::State::Off | ubx::State::Asking => {}
        }
    }
}
