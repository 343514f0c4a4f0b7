//! Halfwords at an address, with a pool of literals behind them and a listing of what class each is.

use super::class::Class;

/// Code under construction.
pub struct Assembly {
    start: u32,
    code: Vec<u16>,
    literals: Vec<(usize, u32)>,
    /// Address and class of each instruction.
    pub listing: Vec<(u32, Class)>,
}

impl Assembly {
    /// Nothing yet, at this address.
    pub fn new(start: u32) -> Self {
        Self {
            start,
            code: Vec::new(),
            literals: Vec::new(),
            listing: Vec::new(),
        }
    }

    /// The address of the next instruction.
    pub fn here(&self) -> u32 {
        self.start + 2 * self.code.len() as u32
    }

    /// Bytes so far, with the pool and its alignment.
    pub fn bytes(&self) -> usize {
        2 * self.code.len() + 4 * self.literals.len() + 2
    }

    /// Adds an instruction.
    pub fn put(&mut self, class: Class, halfword: u16) {
        self.listing.push((self.here(), class));
        self.code.push(halfword);
    }

    /// Adds an instruction of two halfwords.
    pub fn put_wide(&mut self, class: Class, halfwords: [u16; 2]) {
        self.listing.push((self.here(), class));
        self.code.extend(halfwords);
    }

    /// Adds `ldr rt, =value` and returns the literal's number, for [`Assembly::set_literal`].
    pub fn literal(&mut self, rt: u16, value: u32) -> usize {
        self.literals.push((self.code.len(), value));
        self.put(Class::Literal, 0x4800 | rt << 8);
        self.literals.len() - 1
    }

    /// Gives a literal its value once the target is known.
    pub fn set_literal(&mut self, number: usize, value: u32) {
        self.literals[number].1 = value;
    }

    /// `b target`, at any address reached by 11 bits.
    pub fn branch(&mut self, target: u32) {
        let offset = target.wrapping_sub(self.here() + 4);
        self.put(Class::Branch, 0xe000 | (offset >> 1) as u16 & 0x7ff);
    }

    /// `b<cond> target`.
    pub fn branch_if(&mut self, condition: u16, target: u32) {
        let offset = target.wrapping_sub(self.here() + 4);
        self.put(
            Class::BranchIf,
            0xd000 | condition << 8 | (offset >> 1) as u16 & 0xff,
        );
    }

    /// `bl target`.
    pub fn branch_link(&mut self, target: u32) {
        let offset = target.wrapping_sub(self.here() + 4);
        let sign = offset >> 31;
        let j = |bit: u32| !(offset >> bit ^ sign) & 1;
        self.put_wide(
            Class::BranchLink,
            [
                (0xf000 | sign << 10 | offset >> 12 & 0x3ff) as u16,
                (0xd000 | j(23) << 13 | j(22) << 11 | offset >> 1 & 0x7ff) as u16,
            ],
        );
    }

    /// Writes what `emit` emits over the code at `at`, which was emitted as a placeholder of the same length.
    pub fn patch(&mut self, at: u32, emit: impl FnOnce(&mut Self)) {
        let mut patch = Self::new(at);
        emit(&mut patch);
        let index = ((at - self.start) / 2) as usize;
        self.code[index..index + patch.code.len()].copy_from_slice(&patch.code);
    }

    /// The bytes with their literals, and the listing.
    pub fn finish(mut self) -> (Vec<u8>, Vec<(u32, Class)>) {
        if !self.here().is_multiple_of(4) {
            self.code.push(0xde00);
        }
        for (index, value) in std::mem::take(&mut self.literals) {
            let base = (self.start + 2 * index as u32 + 4) & !3;
            let words = (self.here() - base) / 4;
            self.code[index] |= words as u16 & 0xff;
            self.code.extend([value as u16, (value >> 16) as u16]);
        }
        let bytes = self.code.iter().flat_map(|h| h.to_le_bytes()).collect();
        (bytes, self.listing)
    }
}
