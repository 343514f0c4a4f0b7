//! The analog-digital converter: five inputs, one conversion in 96 cycles of clk_adc, round robin, FIFO.
//!
//! Source: RP2040 datasheet 4.9.
//!
//! | offset | register |
//! |---|---|
//! | 00 | CS: EN 0, TS_EN 1, START_ONCE 2, START_MANY 3, READY 8, ERR 9, ERR_STICKY 10, AINSEL 14:12, RROBIN 20:16 |
//! | 04 | RESULT |
//! | 08 | FCS: EN 0, SHIFT 1, ERR 2, DREQ_EN 3, EMPTY 8, FULL 9, UNDER 10, OVER 11, LEVEL 19:16, THRESH 27:24 |
//! | 0c | FIFO: value 11:0, error 15 |
//! | 10 | DIV: INT 23:8, FRAC 7:0 |
//! | 14-20 | INTR INTE INTF INTS |
//!
//! ```text
//!   START_MANY  |<-- 96 -->|<-- 96 -->|      DIV ≤ 95: one after the other
//!               |<-- 96 -->|     |<-- 96 -->|      else every 1 + INT + FRAC / 256 cycles, the fraction by delta-sigma
//!               ^ input held                       each result is ready at the end of its 96
//! ```
//! An input gives the voltage at the moment it is held. One that gives no number (NaN) makes the conversion fail, which is how ERR is
//! seen here; so does the temperature sensor while TS_EN is 0. An input to which nothing is connected stops the chip when it is used.
//!
//! Not modelled: noise, offset, and erratum RP2040-E11 (the steps at codes 512, 1536, 2560, 3584 are as wide as the others).

use super::time::{Domain, Instant};
use serde::{Deserialize, Serialize};

use crate::snapshot::Part;
use std::collections::VecDeque;

/// Cycles of clk_adc a conversion takes (datasheet 4.9.2).
const CONVERSION: u64 = 96;
/// Results the FIFO holds (datasheet 4.9.2.5).
const FIFO: usize = 4;
/// External inputs (GPIO 26 to 29), and the temperature sensor behind them.
const EXTERNAL: usize = 4;
const TEMPERATURE: usize = 4;
/// ADC_AVDD of the boards, volts.
const REFERENCE_V: f64 = 3.3;
/// Sensor at 27 °C, and volts a degree (datasheet 4.9.5).
const SENSOR_V: f64 = 0.706;
const SENSOR_V_PER_C: f64 = -0.001_721;

const EN: u32 = 1 << 0;
const TS_EN: u32 = 1 << 1;
const START_ONCE: u32 = 1 << 2;
const START_MANY: u32 = 1 << 3;
const ERR: u32 = 1 << 9;
const ERR_STICKY: u32 = 1 << 10;
const CS_WRITABLE: u32 = 0x001f_700b;
const FCS_WRITABLE: u32 = 0x0f00_000f;
const UNDER: u32 = 1 << 10;
const OVER: u32 = 1 << 11;
/// Marks a failed conversion in the FIFO.
const FAILED: u16 = 1 << 15;

/// A voltage on an input.
pub trait AnalogInput: Send {
    /// Volts at this time.
    fn volts(&mut self, time_ps: u128) -> f64;
    /// For snapshots.
    fn clone_box(&self) -> Box<dyn AnalogInput>;
    /// For snapshots in a file: itself as a value, if it is one of the twin's parts.
    fn part(&self) -> Option<Part> {
        None
    }
}

impl Clone for Box<dyn AnalogInput> {
    fn clone(&self) -> Self {
        self.clone_box()
    }
}

/// A voltage that does not change.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Steady(pub f64);

impl AnalogInput for Steady {
    fn volts(&mut self, _: u128) -> f64 {
        self.0
    }
    fn clone_box(&self) -> Box<dyn AnalogInput> {
        Box::new(*self)
    }

    fn part(&self) -> Option<Part> {
        Some(Part::Steady(*self))
    }
}

/// The converter.
#[derive(Clone, Serialize, Deserialize)]
pub struct Adc {
    cs: u32,
    fcs: u32,
    div: u32,
    inte: u32,
    intf: u32,
    result: u16,
    fifo: VecDeque<u16>,
    clock: Domain,
    /// Tick at which the running conversion ends, and what it will give.
    converting: Option<(u64, u16)>,
    /// Tick of the next start while START_MANY runs, and the fraction carried to the one after it.
    next_start: Option<u64>,
    carry: u32,
    inputs: [Option<Box<dyn AnalogInput>>; EXTERNAL],
    /// Temperature of the die, °C.
    pub die_celsius: f64,
    /// An input without a source was converted.
    pub unconnected: Option<usize>,
    /// Tick at which START_MANY last began, once it did.
    first_start: Option<u64>,
}

impl Default for Adc {
    fn default() -> Self {
        Self {
            cs: 0,
            fcs: 0,
            div: 0,
            inte: 0,
            intf: 0,
            result: 0,
            fifo: VecDeque::new(),
            clock: Domain::default(),
            converting: None,
            next_start: None,
            carry: 0,
            inputs: [None, None, None, None],
            die_celsius: 27.0,
            unconnected: None,
            first_start: None,
        }
    }
}

impl Adc {
    /// Registers back to reset; what is connected outside stays.
    pub fn reset(&mut self) {
        *self = Self {
            clock: self.clock,
            inputs: std::mem::take(&mut self.inputs),
            die_celsius: self.die_celsius,
            ..Self::default()
        };
    }

    /// Connects a source to an external input: channel 0 to 3, that is GPIO 26 to 29.
    pub fn set_input(&mut self, channel: usize, input: Box<dyn AnalogInput>) {
        self.inputs[channel] = Some(input);
    }

    /// The input that the next conversion holds.
    pub fn selected(&self) -> usize {
        (self.cs >> 12 & 7) as usize
    }

    /// clk_adc or clk_sys changed at cycle `now`.
    pub fn set_clock(&mut self, adc_hz: u64, sys_hz: u64, now: u64) {
        self.clock.set(adc_hz, sys_hz, now);
    }

    /// Cycle at which the first conversion of the free run was held.
    pub fn running_since(&self) -> Option<u64> {
        self.first_start.map(|tick| self.clock.cycle_of(tick))
    }

    /// Cycle of the next thing that happens by itself.
    pub fn next_event(&self) -> u64 {
        let tick = match (self.converting, self.next_start) {
            (None, None) => return u64::MAX,
            (Some((end, _)), _) => end,
            (None, Some(start)) => start,
        };
        self.clock.cycle_of(tick)
    }

    /// Everything due now.
    pub fn advance(&mut self, now: Instant) {
        let tick = self.clock.tick_at(now.cycle);
        if let Some((end, word)) = self.converting
            && end <= tick
        {
            self.converting = None;
            self.finish(word);
        }
        if let Some(start) = self.next_start
            && self.converting.is_none()
            && start <= tick
        {
            self.begin(start, now.time_ps);
            self.next_start = Some(start + self.interval());
        }
    }

    /// Cycles of clk_adc from one start to the next.
    fn interval(&mut self) -> u64 {
        let sum = self.carry + (self.div & 0xff);
        self.carry = sum & 0xff;
        (1 + u64::from(self.div >> 8) + u64::from(sum >> 8)).max(CONVERSION)
    }

    /// Holds the selected input at tick `start`.
    fn begin(&mut self, start: u64, time_ps: u128) {
        let channel = self.selected();
        let volts = self.volts(channel, time_ps);
        let word = if volts.is_nan() {
            FAILED
        } else {
            (volts / REFERENCE_V * 4096.0).clamp(0.0, 4095.0) as u16
        };
        self.converting = Some((start + CONVERSION, word));
        self.next_channel(channel);
    }

    fn volts(&mut self, channel: usize, time_ps: u128) -> f64 {
        match self.inputs.get_mut(channel) {
            Some(Some(input)) => input.volts(time_ps),
            Some(None) => {
                self.unconnected = Some(channel);
                f64::NAN
            }
            None if channel == TEMPERATURE && self.cs & TS_EN != 0 => {
                SENSOR_V + (self.die_celsius - 27.0) * SENSOR_V_PER_C
            }
            None => f64::NAN,
        }
    }

    /// Round robin: AINSEL moves to the next channel of the mask.
    fn next_channel(&mut self, channel: usize) {
        let mask = self.cs >> 16 & 0x1f;
        if mask == 0 {
            return;
        }
        let next = (1..=5)
            .map(|step| (channel + step) % 5)
            .find(|n| mask >> n & 1 != 0)
            .unwrap_or(channel);
        self.cs = self.cs & !0x7000 | (next as u32) << 12;
    }

    fn finish(&mut self, word: u16) {
        self.result = word & 0xfff;
        self.cs &= !ERR;
        if word & FAILED != 0 {
            self.cs |= ERR | ERR_STICKY;
        }
        if self.fcs & 1 == 0 {
            return;
        }
        if self.fifo.len() >= FIFO {
            self.fcs |= OVER;
            return;
        }
        let value = self.result >> if self.fcs & 2 != 0 { 4 } else { 0 };
        let mark = if self.fcs & 4 != 0 { word & FAILED } else { 0 };
        self.fifo.push_back(value | mark);
    }

    fn at_threshold(&self) -> bool {
        self.fifo.len() >= (self.fcs >> 24 & 0xf) as usize
    }

    /// DREQ.
    pub fn ready(&self) -> bool {
        self.fcs & 8 != 0 && !self.fifo.is_empty() && self.at_threshold()
    }

    /// The interrupt output.
    pub fn irq_line(&self) -> bool {
        u32::from(self.at_threshold()) & self.inte | self.intf != 0
    }

    /// Reads a register.
    pub fn read(&mut self, offset: u32) -> Option<u32> {
        let raw = u32::from(self.at_threshold());
        Some(match offset {
            0x00 => {
                let ready = self.cs & EN != 0 && self.converting.is_none();
                self.cs | u32::from(ready) << 8
            }
            0x04 => u32::from(self.result),
            0x08 => {
                self.fcs
                    | u32::from(self.fifo.is_empty()) << 8
                    | u32::from(self.fifo.len() >= FIFO) << 9
                    | (self.fifo.len() as u32) << 16
            }
            0x0c => match self.fifo.pop_front() {
                Some(word) => u32::from(word),
                None => {
                    self.fcs |= UNDER;
                    0
                }
            },
            0x10 => self.div,
            0x14 => raw,
            0x18 => self.inte,
            0x1c => self.intf,
            0x20 => raw & self.inte | self.intf,
            _ => return None,
        })
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32, now: Instant) -> bool {
        match offset {
            0x00 => self.write_cs(value, now),
            0x08 => {
                let cleared = value & (UNDER | OVER);
                self.fcs = value & FCS_WRITABLE | self.fcs & (UNDER | OVER) & !cleared;
            }
            0x10 => {
                self.div = value & 0x00ff_ffff;
                // Writing the divider restarts it.
                self.carry = 0;
                if self.next_start.is_some() {
                    let tick = self.clock.tick_at(now.cycle);
                    self.next_start = Some(tick + self.interval());
                }
            }
            0x18 => self.inte = value & 1,
            0x1c => self.intf = value & 1,
            0x04 | 0x14 | 0x20 => {}
            _ => return false,
        }
        true
    }

    fn write_cs(&mut self, value: u32, now: Instant) {
        let kept = self.cs & (ERR | ERR_STICKY) & !(value & ERR_STICKY);
        self.cs = value & CS_WRITABLE | kept;
        if self.cs & EN == 0 {
            self.converting = None;
            self.next_start = None;
            return;
        }
        let tick = self.clock.tick_at(now.cycle);
        if self.cs & START_MANY == 0 {
            self.next_start = None;
            if value & START_ONCE != 0 && self.converting.is_none() {
                self.begin(tick, now.time_ps);
            }
        } else if self.next_start.is_none() {
            self.carry = 0;
            self.next_start = Some(tick);
            self.first_start = Some(tick);
            self.advance(now);
        }
    }
}

#[cfg(test)]
#[path = "adc_tests.rs"]
mod tests;
