//! Runs PIO programs in the twin's model of one state machine and prints what it holds after every cycle, for `pio_peer.py`.
//!
//! A program is a line of words on standard input, all numbers in hexadecimal:
//!
//! | words | meaning |
//! |---|---|
//! | 32 | the instruction memory |
//! | 3 | EXECCTRL, SHIFTCTRL, PINCTRL |
//! | 5 | first address, X, Y, output levels and output enables at the start |
//! | 1 | cycles to run |
//! | rest | events `<cycle>i<levels>` (inputs), `<cycle>t<word>` (into the TX FIFO), `<cycle>r` (out of the RX FIFO), by cycle |
//!
//! The answer is a line for the state at the start and one after each cycle,
//! `pc x y isr isr_count osr osr_count delay levels enables tx rx`, where a FIFO is its words joined by commas, or `-`.
//! Events of a cycle happen before its tick. The initial values enter as a driver would set them: TX FIFO and forced instructions.

#![forbid(unsafe_code)]

use std::io::{BufRead, Write};

use twin::chip::pins::{Drivers, PADS, Pins};
use twin::chip::pio::Pio;

/// Register offsets of state machine 0 (RP2040 datasheet 3.7).
const CTRL: u32 = 0x000;
const TXF0: u32 = 0x010;
const RXF0: u32 = 0x020;
const INPUT_SYNC_BYPASS: u32 = 0x038;
const INSTR_MEM0: u32 = 0x048;
const SM0_EXECCTRL: u32 = 0x0cc;
const SM0_SHIFTCTRL: u32 = 0x0d0;
const SM0_INSTR: u32 = 0x0d8;
const SM0_PINCTRL: u32 = 0x0dc;
/// GPIOn_CTRL value that gives a pad to PIO 0 (datasheet 2.19.2).
const FUNCTION_PIO0: u32 = 6;
/// Forced instructions of the start: `pull block`, `mov x, osr`, `mov y, osr`, `mov pins, osr`, `out pindirs, 32`.
const PULL: u32 = 0x80a0;
const MOV_X_OSR: u32 = 0xa027;
const MOV_Y_OSR: u32 = 0xa047;
const MOV_PINS_OSR: u32 = 0xa007;
const OUT_PINDIRS_32: u32 = 0x6080;
/// PINCTRL whose OUT pins are all 32.
const ALL_OUT: u32 = 32 << 20;

struct Machine {
    pio: Pio,
    pins: Pins,
    inputs: u32,
}

impl Machine {
    fn write(&mut self, offset: u32, value: u32, now: u64) {
        assert!(
            self.pio.write(offset, value, now, &mut self.pins),
            "register {offset:#x} is not modelled"
        );
    }

    fn resolve(&mut self) {
        self.pins.resolve(&Drivers {
            pio: [(self.pio.pad_out, self.pio.pad_oe), (0, 0)],
            ..Drivers::default()
        });
    }

    fn force(&mut self, instructions: &[u32], word: u32) {
        self.write(TXF0, word, 0);
        for instruction in [&[PULL], instructions].concat() {
            self.write(SM0_INSTR, instruction, 0);
        }
    }

    fn start(program: &[u32]) -> Self {
        let mut machine = Self {
            pio: Pio::new(),
            pins: Pins::new(),
            inputs: 0,
        };
        for pin in 0..PADS as u32 {
            machine.pins.write_io(8 * pin + 4, FUNCTION_PIO0);
            machine.pins.drive(pin, false);
        }
        for n in 0..32 {
            machine.write(INSTR_MEM0 + 4 * n, program[n as usize], 0);
        }
        let [execctrl, shiftctrl, pinctrl, pc, x, y, levels, enables] =
            *program[32..40].first_chunk().expect("a whole program");
        machine.write(SM0_PINCTRL, ALL_OUT, 0);
        machine.force(&[MOV_PINS_OSR], levels);
        machine.force(&[OUT_PINDIRS_32], enables);
        machine.force(&[MOV_X_OSR], x);
        machine.force(&[MOV_Y_OSR], y);
        machine.write(SM0_INSTR, pc, 0);
        machine.write(SM0_EXECCTRL, execctrl, 0);
        machine.write(SM0_SHIFTCTRL, shiftctrl, 0);
        machine.write(SM0_PINCTRL, pinctrl, 0);
        // The peer has no synchroniser.
        machine.write(INPUT_SYNC_BYPASS, u32::MAX, 0);
        machine.resolve();
        // Restart empties the shift registers' counts; enable.
        machine.write(CTRL, 1 << 4 | 1, 0);
        machine
    }

    fn event(&mut self, event: &str, now: u64) {
        let (kind, value) = event.split_at(1);
        let value = u32::from_str_radix(value, 16).unwrap_or(0);
        match kind {
            "i" => {
                for pin in (0..PADS as u32).filter(|pin| (self.inputs ^ value) >> pin & 1 != 0) {
                    self.pins.drive(pin, value >> pin & 1 != 0);
                }
                self.inputs = value;
            }
            "t" => self.write(TXF0, value, now),
            "r" => {
                self.pio.read(RXF0);
            }
            _ => panic!("no such event: {event}"),
        }
    }

    fn print(&self, out: &mut impl Write) -> std::io::Result<()> {
        let o = self.pio.observe(0);
        let fifo = |words: &[u32]| match words {
            [] => "-".to_string(),
            _ => words
                .iter()
                .map(|w| format!("{w:x}"))
                .collect::<Vec<_>>()
                .join(","),
        };
        writeln!(
            out,
            "{:x} {:x} {:x} {:x} {:x} {:x} {:x} {:x} {:x} {:x} {} {}",
            o.pc,
            o.x,
            o.y,
            o.isr,
            o.isr_count,
            o.osr,
            o.osr_count,
            o.delay,
            self.pio.pad_out,
            self.pio.pad_oe,
            fifo(&o.tx),
            fifo(&o.rx)
        )
    }
}

fn main() -> std::io::Result<()> {
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let (fixed, events) = words.split_at(41);
        let fixed: Vec<u32> = fixed
            .iter()
            .map(|w| u32::from_str_radix(w, 16).expect("a hexadecimal word"))
            .collect();
        let mut machine = Machine::start(&fixed);
        machine.print(&mut out)?;
        let mut events = events.iter().peekable();
        for cycle in 0..u64::from(fixed[40]) {
            while let Some(event) = events.peek() {
                let letter = event.find(['i', 't', 'r']).expect("an event has a letter");
                let (at, what) = event.split_at(letter);
                if u64::from_str_radix(at, 16).expect("an event has a cycle") > cycle {
                    break;
                }
                machine.event(what, cycle);
                events.next();
            }
            // The machine was enabled at cycle 0, so its first tick is at 1.
            while machine.pio.next_tick() <= cycle + 1 {
                machine.pio.run(cycle + 1, &mut machine.pins);
            }
            machine.resolve();
            machine.print(&mut out)?;
        }
    }
    out.flush()
}
