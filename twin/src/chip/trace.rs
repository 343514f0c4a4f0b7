//! Chosen signals recorded as a value change dump, for GTKWave and its like.
//!
//! Source: IEEE 1364-2005, clause 18 (VCD).
//!
//! | name | signal |
//! |---|---|
//! | `GPIO15`, or a net of the board | the pad's level; edges that come from outside with times of their own appear behind the synchroniser, two cycles late |
//! | `PIO0.SM1.PC`, `.X` `.Y` `.ISR` `.OSR` `.TX` `.RX` | a state machine; TX and RX are the FIFOs' levels |
//! | `DMA.BUSY` | a bit a channel |
//! | `CORE0.SLEEP` `CORE0.EXCEPTION` | whether it sleeps; the exception's number of lowest rank that is active, 0 for none |
//! | `[20001234]` | a word of SRAM, hexadecimal address |
//!
//! While something is recorded, the peripherals are looked at in every cycle, which costs speed; what the chip does stays the same.

use std::fmt::Write;

use super::bus::{Bus, SRAM, SRAM_BASE};
use super::pins::PADS;

/// What can be recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    Pin(u32),
    StateMachine {
        block: usize,
        machine: usize,
        what: Inside,
    },
    DmaBusy,
    Sleep(usize),
    Exception(usize),
    Word(u32),
}

/// The parts of a state machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inside {
    Pc,
    X,
    Y,
    Isr,
    Osr,
    TxLevel,
    RxLevel,
}

/// Why a name names nothing.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "no signal is called {0:?}; there are GPIO0 to GPIO29, the board's nets, PIO0.SM0.PC (X, Y, ISR, OSR, TX, RX), DMA.BUSY, \
     CORE0.SLEEP, CORE0.EXCEPTION and [20001234] for a word of SRAM"
)]
pub struct UnknownSignal(pub String);

impl Signal {
    /// The signal of a name; `nets` are names of the board with their pins.
    pub fn parse(name: &str, nets: &[(&str, u32)]) -> Result<Self, UnknownSignal> {
        let upper = name.trim().to_ascii_uppercase();
        let net = nets.iter().find(|(net, _)| *net == upper);
        net.map(|(_, pin)| Self::Pin(*pin))
            .or_else(|| Self::by_name(&upper))
            .ok_or_else(|| UnknownSignal(name.to_owned()))
    }

    fn by_name(name: &str) -> Option<Self> {
        if let Some(pin) = name.strip_prefix("GPIO") {
            let pin = pin.parse().ok()?;
            return ((pin as usize) < PADS).then_some(Self::Pin(pin));
        }
        if let Some(address) = name.strip_prefix('[').and_then(|n| n.strip_suffix(']')) {
            let address = u32::from_str_radix(address.trim_start_matches("0X"), 16).ok()?;
            let inside = address.wrapping_sub(SRAM_BASE) as usize <= SRAM - 4;
            return (inside && address.is_multiple_of(4)).then_some(Self::Word(address));
        }
        let number = |text: &str, prefix: &str, below: usize| {
            let n: usize = text.strip_prefix(prefix)?.parse().ok()?;
            (n < below).then_some(n)
        };
        match name.split('.').collect::<Vec<_>>()[..] {
            ["DMA", "BUSY"] => Some(Self::DmaBusy),
            [core, "SLEEP"] => Some(Self::Sleep(number(core, "CORE", 2)?)),
            [core, "EXCEPTION"] => Some(Self::Exception(number(core, "CORE", 2)?)),
            [block, machine, what] => Some(Self::StateMachine {
                block: number(block, "PIO", 2)?,
                machine: number(machine, "SM", 4)?,
                what: Inside::by_name(what)?,
            }),
            _ => None,
        }
    }

    fn width(self) -> u32 {
        match self {
            Self::Pin(_) | Self::Sleep(_) => 1,
            Self::DmaBusy => 12,
            Self::Exception(_) => 6,
            Self::StateMachine { what, .. } => match what {
                Inside::Pc => 5,
                Inside::TxLevel | Inside::RxLevel => 4,
                _ => 32,
            },
            Self::Word(_) => 32,
        }
    }

    fn value(self, bus: &Bus) -> u32 {
        match self {
            Self::Pin(pin) => u32::from(bus.pins.level(pin)),
            Self::DmaBusy => bus.dma.busy,
            Self::Sleep(core) => u32::from(bus.asleep[core]),
            Self::Exception(core) => match bus.ppb[core].active {
                0 => 0,
                active => active.trailing_zeros(),
            },
            Self::StateMachine {
                block,
                machine,
                what,
            } => {
                let inside = bus.pio[block].observe(machine);
                match what {
                    Inside::Pc => inside.pc,
                    Inside::X => inside.x,
                    Inside::Y => inside.y,
                    Inside::Isr => inside.isr,
                    Inside::Osr => inside.osr,
                    Inside::TxLevel => inside.tx.len() as u32,
                    Inside::RxLevel => inside.rx.len() as u32,
                }
            }
            Self::Word(address) => {
                let at = (address - SRAM_BASE) as usize;
                let bytes = bus.sram[at..at + 4].try_into();
                bytes.map_or(0, u32::from_le_bytes)
            }
        }
    }
}

impl Inside {
    fn by_name(name: &str) -> Option<Self> {
        Some(match name {
            "PC" => Self::Pc,
            "X" => Self::X,
            "Y" => Self::Y,
            "ISR" => Self::Isr,
            "OSR" => Self::Osr,
            "TX" => Self::TxLevel,
            "RX" => Self::RxLevel,
            _ => return None,
        })
    }
}

/// A recording under way.
#[derive(Clone)]
pub struct Trace {
    signals: Vec<Recorded>,
    text: String,
}

#[derive(Clone)]
struct Recorded {
    signal: Signal,
    last: Option<u32>,
}

/// The identifier of the n-th signal: printable characters from `!`.
fn identifier(n: usize) -> char {
    char::from(b'!' + (n % 94) as u8)
}

impl Trace {
    /// Most signals: one printable character each.
    pub const MOST: usize = 94;

    /// Records these signals, at most [`Trace::MOST`].
    pub fn new(signals: &[(String, Signal)]) -> Self {
        let mut text = String::from("$timescale 1 ps $end\n$scope module rp2040 $end\n");
        let signals = &signals[..signals.len().min(Self::MOST)];
        for (n, (name, signal)) in signals.iter().enumerate() {
            // A String takes all that is written to it.
            let _ = writeln!(
                text,
                "$var wire {} {} {name} $end",
                signal.width(),
                identifier(n)
            );
        }
        text.push_str("$upscope $end\n$enddefinitions $end\n");
        Self {
            signals: signals
                .iter()
                .map(|(_, signal)| Recorded {
                    signal: *signal,
                    last: None,
                })
                .collect(),
            text,
        }
    }

    /// The text since the last call.
    pub fn take_text(&mut self) -> String {
        std::mem::take(&mut self.text)
    }

    fn sample(&mut self, bus: &Bus) {
        let mut stamped = false;
        for (n, recorded) in self.signals.iter_mut().enumerate() {
            let value = recorded.signal.value(bus);
            if recorded.last == Some(value) {
                continue;
            }
            recorded.last = Some(value);
            if !std::mem::replace(&mut stamped, true) {
                let _ = writeln!(self.text, "#{}", bus.time_ps());
            }
            let _ = match recorded.signal.width() {
                1 => writeln!(self.text, "{value}{}", identifier(n)),
                _ => writeln!(self.text, "b{value:b} {}", identifier(n)),
            };
        }
    }
}

impl Bus {
    /// Starts to record.
    pub fn start_trace(&mut self, signals: &[(String, Signal)]) {
        let pins = signals.iter().filter_map(|(_, signal)| match signal {
            Signal::Pin(pin) => Some(1 << pin),
            _ => None,
        });
        let mask = pins.fold(0, |mask, bit| mask | bit);
        self.pins.watch(mask);
        self.trace = Some(Box::new(Trace::new(signals)));
        self.sample_trace();
    }

    /// Notes what has changed by now.
    pub(super) fn sample_trace(&mut self) {
        if let Some(mut trace) = self.trace.take() {
            trace.sample(self);
            self.trace = Some(trace);
        }
    }
}
