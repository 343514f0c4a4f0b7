//! Trigger levels and RSSI through the ADC.

use super::*;
use crate::board::kind::ADSBEE_1090_E;
use crate::chip::pins::Played;
use crate::front_end::detector::millivolt;
use crate::front_end::{FrontEnd, Level, Player};

const PWM: u32 = 0x4005_0000;
const ADC: u32 = 0x4004_c000;

/// PWM of 24 kHz with this many of 5000 counts high on a pin.
fn pwm(board: &mut Board, pin: u32, counts: u32) {
    function(board, pin, 4);
    let slice = PWM + 0x14 * (pin / 2 % 8);
    let at = 16 * (pin % 2);
    let compare = board.chip.bus.read32(slice + 0x0c) & !(0xffff << at);
    board.chip.bus.write32(slice + 0x10, 4999);
    board.chip.bus.write32(slice + 0x0c, compare | counts << at);
    board.chip.bus.write32(slice, 1);
}

/// A conversion of a channel, mV.
fn convert(board: &mut Board, channel: u32) -> f64 {
    board.chip.bus.write32(ADC, channel << 12 | 1 << 2 | 1);
    run_us(board, 3);
    f64::from(board.chip.bus.read32(ADC + 4)) * 3300.0 / 4096.0
}

#[test]
fn the_trigger_level_rises_behind_its_rc_at_the_adc() {
    let mut board = board(ADSBEE_1090);
    assert!(convert(&mut board, 1) < 1.0);
    pwm(&mut board, 25, 1970);
    run_us(&mut board, 10_000 - 3);
    let after_a_lag = convert(&mut board, 1);
    assert!((after_a_lag - 1300.2 * 0.6321).abs() < 2.0, "{after_a_lag}");
    assert!(!board.chip.bus.trigger_levels_settled());
    run_us(&mut board, 100_000);
    let settled = convert(&mut board, 1);
    assert!((settled - 1300.2).abs() < 1.0, "{settled}");
    assert!(board.chip.bus.trigger_levels_settled());
}

#[test]
fn revision_e_has_two_trigger_levels_each_at_its_own_adc_input() {
    let mut board = board(ADSBEE_1090_E);
    pwm(&mut board, 24, 2500);
    pwm(&mut board, 25, 1000);
    run_us(&mut board, 150_000);
    let (high, low) = (convert(&mut board, 0), convert(&mut board, 1));
    assert!(
        (high - 1650.0).abs() < 1.0 && (low - 660.0).abs() < 1.0,
        "{high} {low}"
    );
}

/// A level that steps from -90 to -50 dBm at 2 ms.
struct Step(u64);

impl Level for Step {
    fn step_ps(&self) -> u64 {
        62_500
    }

    fn fill(&mut self, dbm: &mut [f32]) -> usize {
        for level in dbm.iter_mut() {
            *level = if self.0 < 32_000 { -90.0 } else { -50.0 };
            self.0 += 1;
        }
        dbm.len()
    }
}

#[test]
fn the_rssi_is_the_detectors_level_at_the_instant_of_the_conversion() {
    let mut board = board(ADSBEE_1090);
    let start = board.chip.now() + 1200;
    board.chip.bus.play(
        Played::Once(Box::new(Player::new(Step(0), &FrontEnd::ADSBEE_1090))),
        19,
        start,
    );
    // Someone has to look at PULSES for the source to be asked.
    board.chip.bus.pins.look_ahead(start);
    let expected = [millivolt(-90.0), millivolt(-50.0)].map(f64::from);
    for (us, level) in [(1_000, expected[0]), (995, expected[0]), (20, expected[1])] {
        run_us(&mut board, us - 3);
        let now = board.chip.now();
        board.chip.bus.pins.look_ahead(now);
        let read = convert(&mut board, 2);
        assert!((read - level).abs() < 8.0, "{read} mV, not {level}");
    }
    let noisy: Vec<f64> = (0..50).map(|_| convert(&mut board, 2)).collect();
    assert!(noisy.iter().any(|mv| *mv != noisy[0]), "no noise");
}
