//! Units that load and store.

use super::class::Class;
use super::generator::Generator;

impl Generator {
    /// Any load or store that leaves SP alone.
    pub(super) fn memory(&mut self) {
        match self.dice.below(8) {
            0..=2 => self.immediate_offset(),
            3..=4 => self.register_offset(),
            5 => self.stack_relative(),
            6 => self.multiple(),
            _ => {
                let (rt, value) = (self.low(), self.dice.word());
                self.load(rt, value);
            }
        }
    }

    fn immediate_offset(&mut self) {
        // Bytes of the access and the first opcode: str, strb, strh; with bit 11 the load.
        let (size, opcode) = [(4, 0x6000), (1, 0x7000), (2, 0x8000)][self.dice.below(3) as usize];
        let (rn, base) = self.pointer(size, size);
        let most = ((self.data_end() - size - base) / size).min(31);
        let imm5 = self.dice.below(most + 1) as u16;
        let rt = self.low();
        let is_load = self.dice.one_in(2);
        let opcode = opcode | u16::from(is_load) << 11 | imm5 << 6 | rn << 3 | rt;
        if is_load {
            self.a.put(Class::Load, opcode);
            self.forget(rt);
        } else {
            self.a.put(Class::Store, opcode);
        }
    }

    fn register_offset(&mut self) {
        // str, strh, strb, ldrsb, ldr, ldrh, ldrb, ldrsh.
        const SIZE: [u32; 8] = [4, 2, 1, 1, 4, 2, 1, 2];
        let op = self.dice.below(8) as u16;
        let size = SIZE[usize::from(op)];
        // Base and offset may each be odd; their sum is aligned.
        let (rn, base) = self.pointer(1, 1);
        let rm = self.low_but(rn);
        let offset = self.data_address(size).wrapping_sub(base);
        if offset < 256 {
            self.a
                .put(Class::Immediate, 0x2000 | rm << 8 | offset as u16);
            self.known[usize::from(rm)] = Some(offset);
        } else {
            self.load(rm, offset);
        }
        let rt = self.low();
        let opcode = 0x5000 | op << 9 | rm << 6 | rn << 3 | rt;
        if op < 3 {
            self.a.put(Class::StoreRegister, opcode);
        } else {
            self.a.put(Class::LoadRegister, opcode);
            self.forget(rt);
        }
    }

    fn stack_relative(&mut self) {
        let words = (self.stack_bounds().1 - self.sp()) / 4;
        if words == 0 {
            return;
        }
        let (rt, imm8) = (self.low(), self.dice.below(words) as u16);
        let is_load = self.dice.one_in(2);
        let opcode = 0x9000 | u16::from(is_load) << 11 | rt << 8 | imm8;
        self.a.put(Class::StackLoadStore, opcode);
        if is_load {
            self.forget(rt);
        }
    }

    fn multiple(&mut self) {
        let is_load = self.dice.one_in(2);
        let mut list = self.list();
        let (rn, base) = self.pointer(4, 32);
        // A stored base is what it was only as the lowest of the list.
        if !is_load && list.trailing_zeros() < u32::from(rn) {
            list &= !(1 << rn);
        }
        let opcode = 0xc000 | u16::from(is_load) << 11 | rn << 8 | list;
        let class = if is_load { Class::Ldm } else { Class::Stm };
        self.a.put(class, opcode);
        self.known[usize::from(rn)] = Some(base + 4 * list.count_ones());
        if is_load {
            self.forget_list(list);
        }
    }

    /// push, pop, add and sub of SP, mov and add to SP.
    pub(super) fn stack(&mut self) {
        let (low, high) = self.stack_bounds();
        let (down, up) = ((self.sp() - low) / 4, (high - self.sp()) / 4);
        let list = self.list();
        let count = list.count_ones();
        match self.dice.below(6) {
            0 | 1 => {
                let lr = u16::from(count < down && self.dice.one_in(2));
                if count + u32::from(lr) <= down {
                    self.a.put(Class::Push, 0xb400 | lr << 8 | list);
                    self.move_sp(-4 * (count + u32::from(lr)) as i32);
                }
            }
            2 | 3 => {
                if count <= up {
                    self.a.put(Class::Pop, 0xbc00 | list);
                    self.forget_list(list);
                    self.move_sp(4 * count as i32);
                }
            }
            4 => {
                let by = self.dice.below(up + 1);
                self.a.put(Class::Stack, 0xb000 | by as u16);
                self.move_sp(4 * by as i32);
                let by = self.dice.below(down + 1);
                self.a.put(Class::Stack, 0xb080 | by as u16);
                self.move_sp(-4 * by as i32);
            }
            _ => {
                let register = self.low();
                let target = low + 4 * self.dice.below(down + up + 1);
                if self.dice.one_in(2) {
                    self.load(register, target);
                    self.a.put(Class::High, 0x4685 | register << 3); // mov sp, register
                } else {
                    self.load(register, target.wrapping_sub(self.sp()));
                    self.a.put(Class::High, 0x4485 | register << 3); // add sp, register
                }
                self.known[13] = Some(target);
            }
        }
    }

    fn move_sp(&mut self, by: i32) {
        self.known[13] = Some(self.sp().wrapping_add_signed(by));
    }

    /// A list of at least one low register.
    fn list(&mut self) -> u16 {
        let few = self.dice.below(256) & self.dice.below(256);
        match few {
            0 => 1 << self.low(),
            few => few as u16,
        }
    }

    pub(super) fn forget_list(&mut self, list: u16) {
        for register in (0..8).filter(|r| list & 1 << r != 0) {
            self.forget(register);
        }
    }
}
