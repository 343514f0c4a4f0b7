//! Makes a block: random instructions over random registers, flags and data, with an end that stores the state.
//!
//! Every instruction is defined by the ARMv6-M ARM (DDI 0419) for the operands it meets: nothing UNPREDICTABLE, no faults, no sleep.
//! To keep that, the generator knows which registers hold a value it chose ([`Generator::known`]) and takes its addresses from those;
//! all else is what the program made of it. SP is always known and stays inside the record's stack.

use super::assembly::Assembly;
use super::class::Class;
use super::dice::Dice;
use super::image::{self, Block, CODE, CODE_BYTES, DATA, STACK};

/// Bytes of code and literals that the longest unit needs (a call with two inner units each side).
const LONGEST_UNIT: usize = 110;
/// `push {r0-r7, lr}`; `bl leave`.
const EXIT_BYTES: usize = 6;
/// Bytes of stack that the exit pushes.
const EXIT_STACK: u32 = 36;

/// The state while a block is made.
pub(super) struct Generator {
    pub(super) a: Assembly,
    pub(super) dice: Dice,
    /// Values of registers that were chosen here.
    pub(super) known: [Option<u32>; 15],
    /// Address of the record.
    record: u32,
}

/// The block of this seed in slot `n`, of at most `units` units.
pub fn block(seed: u64, n: usize, units: usize) -> Block {
    let at = image::slot(n);
    let mut g = Generator {
        a: Assembly::new(at + CODE),
        dice: Dice::new(seed),
        known: [None; 15],
        record: at,
    };
    let record = g.start();
    for _ in 0..units {
        if g.a.bytes() + EXIT_BYTES + LONGEST_UNIT > CODE_BYTES {
            break;
        }
        g.unit(0);
    }
    finish(g.a, record)
}

/// A block of these halfwords over the start of this seed, for forms that the generator leaves out.
pub fn fixed(seed: u64, n: usize, halfwords: &[u16]) -> Block {
    let mut block = block(seed, n, 0);
    let mut a = Assembly::new(image::slot(n) + CODE);
    for halfword in halfwords {
        a.put(Class::Mrs, *halfword);
    }
    block = finish(a, block.record);
    block
}

fn finish(mut a: Assembly, record: Vec<u32>) -> Block {
    let counted = a.listing.len();
    a.put(Class::Push, 0xb5ff);
    a.branch_link(image::leave());
    let (code, mut listing) = a.finish();
    listing.truncate(counted);
    assert!(code.len() <= CODE_BYTES, "a block outgrew its slot");
    Block {
        record,
        code,
        listing,
    }
}

impl Generator {
    /// Chooses registers, data and stack: two low registers point into the data, SP into the stack.
    fn start(&mut self) -> Vec<u32> {
        let mut record: Vec<u32> = (0..image::RECORD_WORDS).map(|_| self.dice.word()).collect();
        for _ in 0..2 {
            let register = self.low();
            let address = self.data_address(4);
            record[usize::from(register)] = address;
            self.known[usize::from(register)] = Some(address);
        }
        let sp = self.record + STACK + EXIT_STACK + 4 * (4 + self.dice.below(12));
        record[14] = sp;
        self.known[13] = Some(sp);
        record[15] &= 0xf000_0000;
        record
    }

    /// One unit: an instruction with what it needs before it, or at depth 0 a shape of several.
    pub(super) fn unit(&mut self, depth: u32) {
        match self.dice.below(if depth == 0 { 40 } else { 24 }) {
            0..=13 => self.arithmetic(),
            14..=15 => self.high(),
            16..=22 => self.memory(),
            23 => self.system(),
            24..=27 => self.stack(),
            28..=33 => self.branch_if(),
            34..=35 => self.branch(),
            36 => self.branch_back(),
            37 => self.branch_by_register(),
            38 => self.call(),
            _ => self.system(),
        }
    }

    /// A low register.
    pub(super) fn low(&mut self) -> u16 {
        self.dice.below(8) as u16
    }

    /// A low register other than this one.
    pub(super) fn low_but(&mut self, other: u16) -> u16 {
        (other + 1 + self.dice.below(7) as u16) % 8
    }

    /// A random address in the data, aligned to `size`.
    pub(super) fn data_address(&mut self, size: u32) -> u32 {
        self.record + DATA + self.dice.below((STACK - DATA) / size) * size
    }

    /// The end of the data.
    pub(super) fn data_end(&self) -> u32 {
        self.record + STACK
    }

    /// Lowest and highest SP.
    pub(super) fn stack_bounds(&self) -> (u32, u32) {
        (self.record + STACK + EXIT_STACK, self.record + CODE)
    }

    /// SP now.
    pub(super) fn sp(&self) -> u32 {
        self.known[13].unwrap_or(self.record + STACK + EXIT_STACK)
    }

    /// The register now holds what the program made of it.
    pub(super) fn forget(&mut self, register: u16) {
        self.known[usize::from(register)] = None;
    }

    /// `ldr register, =value`.
    pub(super) fn load(&mut self, register: u16, value: u32) -> usize {
        self.known[usize::from(register)] = Some(value);
        self.a.literal(register, value)
    }

    /// A low register that holds an address in the data with `room` bytes behind it, aligned to `size`; loaded if there is none.
    pub(super) fn pointer(&mut self, size: u32, room: u32) -> (u16, u32) {
        let (low, high) = (self.record + DATA, self.data_end() - room);
        let fits = |value: u32| (low..=high).contains(&value) && value.is_multiple_of(size);
        let first = self.low();
        for k in 0..8 {
            let register = (first + k) % 8;
            if let Some(value) = self.known[usize::from(register)].filter(|v| fits(*v)) {
                return (register, value);
            }
        }
        let address = loop {
            let address = self.data_address(size);
            if fits(address) {
                break address;
            }
        };
        self.load(first, address);
        (first, address)
    }

    /// Units that may or may not run: afterwards only what both ways agree on is known.
    pub(super) fn perhaps(&mut self, units: u32) {
        let before = self.known;
        for _ in 0..units {
            self.unit(1);
        }
        for (now, before) in self.known.iter_mut().zip(before) {
            if *now != before {
                *now = None;
            }
        }
    }

    /// Undefined halfwords, which must be jumped over.
    pub(super) fn junk(&mut self) {
        for _ in 0..1 + self.dice.below(3) {
            let low = self.dice.below(256) as u16;
            self.a.put(Class::Branch, 0xde00 | low);
        }
    }
}
