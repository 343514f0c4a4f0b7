//! Planned faults: the board runs to each one's moment and carries it out.
//!
//! ```text
//!   run to a cycle ── next planned moment before it? ── run there ── carry out ── go on
//!                     flash operation: the chip pauses where it begins; EEPROM: the device names the instant; then as a moment
//! ```
//! A moment in true time is turned into a cycle at the clock's present rate; where the clock changes before it, the cycle is worked out
//! anew, so it is exact but for a clock that slows down within the last millisecond.

use super::eeprom::Eeprom;
use super::gnss::Gnss;
use super::{Board, Error};
use crate::fault::{Fault, Memory, Planned, When, Wire};

const PS_A_SECOND: f64 = 1e12;
const PS_A_MS: u128 = 1_000_000_000;
/// While a write cycle of the EEPROM is waited for, the board looks this often, ps: a fiftieth of one.
const EEPROM_LOOK_PS: u128 = 100_000_000;

impl Board {
    /// Plans a fault. One that is due now happens before the next cycle.
    pub fn plan(&mut self, planned: Planned) {
        match planned.when {
            When::FlashOperation { number, .. } => {
                let journal = &mut self.chip.bus.flash.journal;
                journal.pause_at = Some(journal.count + number);
            }
            When::EepromWrite { number, share } => {
                if let Some(eeprom) = self.eeprom() {
                    eeprom.watch(number, share);
                }
            }
            When::Time(_) | When::Cycle(_) => {}
        }
        self.planned.push(planned);
    }

    /// Faults that have not happened yet.
    pub fn planned(&self) -> &[Planned] {
        &self.planned
    }

    /// Runs to cycle `until`, with whatever happens on the way. The supply may fail and come back meanwhile.
    pub(super) fn run_to(&mut self, until: u64) -> Result<(), Error> {
        loop {
            self.carry_out_due()?;
            if self.chip.now() >= until || self.chip.debug_hit().is_some() {
                return Ok(());
            }
            let stop = self.next_moment().unwrap_or(until).min(until);
            let stop = stop.max(self.chip.now() + 1);
            self.chip.run_until(stop)?;
            if self.chip.bus.paused {
                self.operation_began();
            }
        }
    }

    /// The cycle of the next planned moment, as far as it can be said now.
    fn next_moment(&mut self) -> Option<u64> {
        let mut next: Option<u64> = None;
        for n in 0..self.planned.len() {
            let cycle = match self.planned[n].when {
                When::Cycle(cycle) => Some(cycle),
                When::Time(ps) => Some(self.chip.bus.cycle_at(ps)),
                When::FlashOperation { .. } => None,
                When::EepromWrite { .. } => {
                    let cut_at = self.eeprom().and_then(|e| e.cut_at_ps());
                    let look = self.chip.bus.true_ps() + EEPROM_LOOK_PS;
                    Some(self.chip.bus.cycle_at(cut_at.unwrap_or(look)))
                }
            };
            next = [next, cycle].into_iter().flatten().min();
        }
        next
    }

    /// The flash operation a fault waits for has begun: its moment is known now.
    fn operation_began(&mut self) {
        let Some(operation) = &self.chip.bus.flash.journal.last else {
            return;
        };
        let (start, length) = (operation.start, operation.end - operation.start);
        for planned in &mut self.planned {
            if let When::FlashOperation { share, .. } = planned.when {
                planned.when = When::Cycle(start + (length as f64 * share) as u64);
                return;
            }
        }
    }

    fn carry_out_due(&mut self) -> Result<(), Error> {
        let mut n = 0;
        while n < self.planned.len() {
            let now = self.chip.now();
            let due = match self.planned[n].when {
                When::Cycle(cycle) => cycle <= now,
                When::Time(ps) => self.chip.bus.cycle_at(ps) <= now,
                When::FlashOperation { .. } => false,
                When::EepromWrite { .. } => {
                    let now_ps = self.chip.bus.true_ps();
                    let cut_at = self.eeprom().and_then(|e| e.cut_at_ps());
                    cut_at.is_some_and(|at| at <= now_ps)
                }
            };
            if due {
                let planned = self.planned.remove(n);
                self.carry_out(planned.fault)?;
            } else {
                n += 1;
            }
        }
        Ok(())
    }

    /// Carries a fault out now.
    pub fn carry_out(&mut self, fault: Fault) -> Result<(), Error> {
        match fault {
            Fault::PowerCut { off_ms } => self.power_cut(off_ms),
            Fault::BrownOut => self.brown_out(),
            Fault::Flip {
                memory,
                address,
                bit,
            } => self.flip(memory, address, bit)?,
            Fault::Flips { memory, per_second } => self.flip_at_random(memory, per_second)?,
            Fault::HoldI2c { sda, scl } => match self.kind.i2c {
                Some(nets) => self.chip.bus.hold_i2c(nets.controller, sda, scl),
                None => return Err(self.lacks("I2C bus")),
            },
            Fault::Eeprom(defect) => match self.eeprom() {
                Some(eeprom) => eeprom.defect = defect,
                None => return Err(self.lacks("EEPROM")),
            },
            Fault::Hang { core } => self.chip.hang(core),
            Fault::Stray { core, address } => self.chip.stray(core, address),
            Fault::StarveDma { us } => self.chip.bus.starve_dma(us),
            Fault::CrystalDead => self.chip.bus.stop_crystal(),
            Fault::Pps(present) => self.gnss_outage(present, |o| &mut o.pps)?,
            Fault::Fix(present) => self.gnss_outage(present, |o| &mut o.fix)?,
            Fault::Nmea(present) => self.gnss_outage(present, |o| &mut o.nmea)?,
            Fault::UartNoise { wire, rate } => {
                let uart = match wire {
                    Wire::Comms => self.kind.comms_uart,
                    Wire::Gnss => 0,
                };
                self.noise_from_device[uart].rate = rate;
                let seed = self.next_seed();
                let far = &mut self.chip.bus.uart[uart].far;
                far.set_noise((rate * 1e6) as u32, seed);
            }
            Fault::UsbPlug(plugged) => self.chip.bus.usb_host.plug(plugged),
            Fault::UsbRead(reading) => self.chip.bus.usb_host.reading = reading,
            Fault::UsbNoOpen => self.chip.bus.usb_host.opens = false,
        }
        Ok(())
    }

    fn lacks(&self, what: &'static str) -> Error {
        Error::NoSuchPart {
            board: self.kind.name,
            what,
        }
    }

    /// The supply fails now and returns after `off_ms`, with what is left in the memories.
    pub fn power_cut(&mut self, off_ms: u64) {
        let seed = self.next_seed();
        let now_ps = self.chip.bus.true_ps();
        if let Some(eeprom) = self.eeprom() {
            eeprom.power_cut(now_ps, seed);
        }
        if let Some(potentiometer) = self.potentiometer() {
            potentiometer.power_cut();
        }
        self.chip.bus.power_surroundings(false);
        self.chip.power_cut(u128::from(off_ms) * PS_A_MS, seed);
        self.chip.bus.discharge_trigger_levels();
        self.chip.bus.power_surroundings(true);
        self.power_cuts += 1;
    }

    /// The supply dips.
    pub fn brown_out(&mut self) {
        let seed = self.next_seed();
        let now_ps = self.chip.bus.true_ps();
        if let Some(eeprom) = self.eeprom() {
            eeprom.power_cut(now_ps, seed);
        }
        self.chip.brown_out(seed);
        self.power_cuts += 1;
    }

    fn next_seed(&mut self) -> u64 {
        self.random.word()
    }

    fn flip(&mut self, memory: Memory, address: u32, bit: u8) -> Result<(), Error> {
        let done = match memory {
            Memory::Flash => self.chip.flip_flash(address, bit),
            Memory::Sram => self.chip.flip_sram(address, bit),
            Memory::Eeprom => match self.eeprom() {
                Some(eeprom) => {
                    let cell = eeprom.bytes_mut().get_mut(address as usize);
                    cell.map(|byte| *byte ^= 1 << bit).is_some()
                }
                None => return Err(self.lacks("EEPROM")),
            },
        };
        if done {
            self.flips += 1;
            Ok(())
        } else {
            Err(Error::NoSuchByte { memory, address })
        }
    }

    /// One random bit, and the plan of the next: times between them are exponential.
    fn flip_at_random(&mut self, memory: Memory, per_second: f64) -> Result<(), Error> {
        let bytes = match memory {
            Memory::Flash => self.chip.bus.flash.bytes.len(),
            Memory::Sram => self.chip.bus.sram.len(),
            Memory::Eeprom => super::eeprom::BYTES,
        };
        if self.flips_began(memory) {
            let word = self.random.word();
            let address = (word >> 8) as usize % bytes;
            self.flip(memory, address as u32, (word & 7) as u8)?;
        }
        if per_second > 0.0 {
            // -ln u by halving: no library's logarithm, so the same on every host.
            let wait_s = exponential(self.random.unit()) / per_second;
            let at = self.chip.bus.true_ps() + (wait_s * PS_A_SECOND) as u128;
            self.planned.push(Planned {
                fault: Fault::Flips { memory, per_second },
                when: When::Time(at),
            });
        }
        Ok(())
    }

    /// Whether random flips of this memory are under way; they are from now on.
    fn flips_began(&mut self, memory: Memory) -> bool {
        let began = self.flipping.contains(&memory);
        if !began {
            self.flipping.push(memory);
        }
        began
    }

    /// Something of the GNSS receiver's goes, or is back, from now on.
    fn gnss_outage(
        &mut self,
        present: bool,
        which: fn(&mut super::gnss::Outages) -> &mut Vec<std::ops::Range<u64>>,
    ) -> Result<(), Error> {
        let now_ms = (self.chip.bus.true_ps() / PS_A_MS) as u64;
        let Some(gnss) = self.chip.bus.surroundings.find::<Gnss>() else {
            return Err(self.lacks("GNSS receiver"));
        };
        let ranges = which(&mut gnss.options.outages);
        // What stands for later is cut off; what is under way ends or goes on.
        ranges.retain(|r| r.start <= now_ms);
        for range in ranges.iter_mut() {
            range.end = range.end.min(now_ms);
        }
        if !present {
            ranges.push(now_ms..u64::MAX);
        }
        self.chip.bus.time_surroundings();
        Ok(())
    }

    /// The EEPROM, where the board has one.
    pub fn eeprom(&mut self) -> Option<&mut Eeprom> {
        let nets = self.kind.i2c?;
        self.chip.bus.i2c[nets.controller].find()
    }

    /// The receive gain's potentiometer, where the board has one.
    pub fn potentiometer(&mut self) -> Option<&mut super::potentiometer::Potentiometer> {
        let nets = self.kind.i2c?;
        self.chip.bus.i2c[nets.controller].find()
    }

    /// The GNSS receiver, where the board has one and it is fitted.
    pub fn gnss(&mut self) -> Option<&mut Gnss> {
        self.chip.bus.surroundings.find()
    }
}

/// -ln u for u in 0 to 1: an exponential variate of mean 1.
fn exponential(u: f64) -> f64 {
    let u = u.max(1e-12);
    f64::from(-crate::front_end::decibel::from_power(u as f32)) * std::f64::consts::LN_10 / 10.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waiting_times_have_mean_one() {
        let mut random = crate::source::random::Random::new(3);
        let sum: f64 = (0..20_000).map(|_| exponential(random.unit())).sum();
        assert!((sum / 2e4 - 1.0).abs() < 0.03, "{sum}");
    }
}
