//! Time outside the chip: true time against cycles, what is attached and acts by itself, the analog nets.

use super::Bus;
use crate::chip::adc::{AnalogInput, Steady};
use crate::chip::outside::{Outside, Wires};
use crate::chip::pins::Played;
use crate::front_end::rssi_mv;
use crate::front_end::trigger_level::{SUPPLY_MV, TriggerLevel};
use serde::{Deserialize, Serialize};

use crate::snapshot::Part;

const PS_A_SECOND: u128 = 1_000_000_000_000;

/// A trigger level: the pin whose PWM makes it, the ADC channel that reads it back, the voltage behind its RC.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct TriggerNet {
    pub gpio: usize,
    pub adc: usize,
    pub level: TriggerLevel,
}

impl AnalogInput for TriggerLevel {
    fn volts(&mut self, time_ps: u128) -> f64 {
        self.mv(time_ps) / 1000.0
    }

    fn clone_box(&self) -> Box<dyn AnalogInput> {
        Box::new(*self)
    }

    fn part(&self) -> Option<Part> {
        Some(Part::TriggerLevel(*self))
    }
}

impl Bus {
    /// True time since power-on in picoseconds: the instant of the present cycle.
    pub fn true_ps(&mut self) -> u128 {
        let nominal = self.time_ps();
        self.crystal.true_ps(nominal)
    }

    /// The first cycle at or after a true instant, at the present rate of the system clock; the present one for the past.
    pub fn cycle_at(&mut self, true_ps: u128) -> u64 {
        let count = self.crystal.count_at_or_after(true_ps);
        let ahead = count.saturating_sub(self.time_ps);
        let cycles = (ahead * u128::from(self.sys_hz)).div_ceil(PS_A_SECOND);
        match u64::try_from(cycles) {
            Ok(cycles) if self.sys_hz != 0 => self.since.saturating_add(cycles).max(self.now),
            _ => u64::MAX,
        }
    }

    /// Attaches something that acts by itself.
    pub fn attach(&mut self, device: Box<dyn Outside>) {
        if let Some(uart) = device.listens_to() {
            self.uart[uart].is_heard_outside = true;
        }
        self.surroundings.devices.push((device, u64::MAX));
        self.time_surroundings();
    }

    /// Everything outside is told of the supply.
    pub fn power_surroundings(&mut self, on: bool) {
        let now_ps = self.true_ps();
        for (device, _) in &mut self.surroundings.devices {
            device.power(on, now_ps);
        }
        self.time_surroundings();
    }

    /// Works out anew at which cycle each thing outside acts: the clock has changed, or one of them was set otherwise.
    pub fn time_surroundings(&mut self) {
        let mut devices = std::mem::take(&mut self.surroundings.devices);
        for (device, at) in &mut devices {
            *at = device.next_ps().map_or(u64::MAX, |ps| self.cycle_at(ps));
        }
        self.surroundings.next = devices.iter().map(|d| d.1).min().unwrap_or(u64::MAX);
        self.surroundings.devices = devices;
        self.quiet_until = 0;
    }

    /// Lets everything outside act that is due.
    #[cold]
    pub(super) fn run_surroundings(&mut self) {
        let now = self.now;
        let levels = self.pins.levels();
        let mut devices = std::mem::take(&mut self.surroundings.devices);
        for (device, at) in &mut devices {
            while *at <= now {
                let Some(ps) = device.next_ps() else {
                    *at = u64::MAX;
                    break;
                };
                let mut wires = Wires::new(ps, levels);
                device.act(&mut wires);
                for (pin, level) in wires.pins {
                    self.pins.change_at(pin, level, *at);
                }
                for (uart, bytes) in wires.bytes {
                    self.uart_send(uart, &bytes);
                }
                *at = device.next_ps().map_or(u64::MAX, |ps| self.cycle_at(ps));
            }
        }
        self.surroundings.next = devices.iter().map(|d| d.1).min().unwrap_or(u64::MAX);
        self.surroundings.devices = devices;
    }

    /// Hands on what the far end of a UART has heard.
    #[cold]
    pub(super) fn tell_outside(&mut self, uart: usize) {
        let bytes = std::mem::take(&mut self.uart[uart].outside_hears);
        let now_ps = self.true_ps();
        for (device, _) in &mut self.surroundings.devices {
            if device.listens_to() == Some(uart) {
                device.hear(&bytes, now_ps);
            }
        }
        self.time_surroundings();
    }

    /// The far end of a UART sends bytes.
    pub fn uart_send(&mut self, uart: usize, bytes: &[u8]) {
        self.uart[uart].send(bytes, self.now);
        self.touched();
    }

    /// The crystal stops: for good.
    pub fn stop_crystal(&mut self) {
        self.clocks.stop_crystal(self.now);
        self.clocks_changed();
    }

    /// The crystal was stopped.
    pub fn crystal_is_dead(&self) -> bool {
        self.clocks.crystal_is_dead()
    }

    /// Time passes without a cycle: the supply is off.
    pub fn skip_ps(&mut self, ps: u128) {
        self.time_ps = self.time_ps() + ps;
        self.since = self.now;
        self.pins.skip_ps(self.now, ps as u64);
        self.clocks_changed();
    }

    /// Plays `source` into `pin`, its time zero at cycle `start`, which lies ahead; gives the true time of that, picoseconds since power-on.
    pub fn play(&mut self, source: Played, pin: u32, start: u64) -> u128 {
        let hz = u128::from(self.sys_hz.max(1));
        let start_ps = self.time_ps + u128::from(start - self.since) * PS_A_SECOND / hz;
        self.apply_trigger_level();
        self.pins.play(source, pin, start, start_ps, &self.crystal);
        self.crystal.true_ps(start_ps)
    }

    // ---- analog nets -------------------------------------------------------------------------------------------------------

    /// Follows the PWM of every trigger level, and tells the comparator of the first.
    pub fn apply_trigger_level(&mut self) {
        let now_ps = self.true_ps();
        for net in &mut self.trigger_nets {
            let driven = self.pins.function(net.gpio) == 4;
            let duty = self.pwm.duty(net.gpio).filter(|_| driven);
            net.level.aim(duty.unwrap_or(0.0) * SUPPLY_MV, now_ps);
            self.adc.set_input(net.adc, Box::new(net.level));
        }
        if let Some(net) = self.trigger_nets.first() {
            self.pins.set_trigger_level(net.level);
        }
    }

    /// Every trigger level stands where its PWM wants it.
    pub fn trigger_levels_settled(&mut self) -> bool {
        let now_ps = self.true_ps();
        self.trigger_nets.iter().all(|n| n.level.settled(now_ps))
    }

    /// The voltage of a trigger level now, mV.
    pub fn trigger_level_mv(&mut self, which: usize) -> Option<f64> {
        let now_ps = self.true_ps();
        self.trigger_nets.get(which).map(|n| n.level.mv(now_ps))
    }

    /// The supply was away: the RCs are empty.
    pub fn discharge_trigger_levels(&mut self) {
        let now_ps = self.true_ps();
        for net in &mut self.trigger_nets {
            net.level = TriggerLevel::discharged(now_ps);
        }
        self.apply_trigger_level();
    }

    /// Puts the RSSI net's present voltage on its ADC channel, if a conversion is about to hold that one.
    pub(super) fn hold_rssi(&mut self, channel: usize) {
        if self.rssi_adc == Some(channel) {
            let volts = self.rssi_mv() / 1000.0;
            self.adc.set_input(channel, Box::new(Steady(volts)));
        }
    }

    /// The voltage of the RSSI net at this instant, mV: the detector's level and a little noise of its own.
    pub fn rssi_mv(&mut self) -> f64 {
        self.pins.look_ahead(self.now);
        rssi_mv(
            self.pins.detector_mv(self.now),
            self.pins.since_playback(self.now),
        )
    }
}
