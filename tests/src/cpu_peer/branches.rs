//! Units that change the PC. What is jumped over is undefined instructions, unless the branch is conditional.

use super::class::Class;
use super::generator::Generator;

impl Generator {
    /// A conditional branch forward over a few units.
    pub(super) fn branch_if(&mut self) {
        let condition = self.dice.below(14) as u16;
        if self.dice.one_in(2) {
            // Flags that differ in every way.
            let (rd, rm) = (self.low(), self.low());
            self.a.put(Class::Compare, 0x4280 | rm << 3 | rd);
        }
        let at = self.a.here();
        self.a.branch_if(condition, at + 4);
        let units = 1 + self.dice.below(3);
        self.perhaps(units);
        let target = self.a.here();
        self.a.patch(at, |a| a.branch_if(condition, target));
    }

    /// `b` or `bl` forward.
    pub(super) fn branch(&mut self) {
        let at = self.a.here();
        let link = self.dice.one_in(2);
        if link {
            self.a.branch_link(at + 4);
            self.forget(14);
        } else {
            self.a.branch(at + 4);
        }
        self.junk();
        let target = self.a.here();
        self.a.patch(at, |a| {
            if link {
                a.branch_link(target);
            } else {
                a.branch(target);
            }
        });
    }

    /// Forward, back, and forward again: `b 2f; 1: …; b 3f; 2: b or bl 1b; 3:`.
    pub(super) fn branch_back(&mut self) {
        let first = self.a.here();
        self.a.branch(first + 4);
        let back_to = self.a.here();
        // The `bl` runs before the unit.
        self.forget(14);
        self.unit(1);
        let over = self.a.here();
        self.a.branch(over + 4);
        let second = self.a.here();
        if self.dice.one_in(2) {
            self.a.branch_link(back_to);
            self.forget(14);
        } else {
            self.a.branch(back_to);
        }
        let end = self.a.here();
        self.a.patch(first, |a| a.branch(second));
        self.a.patch(over, |a| a.branch(end));
    }

    /// bx, blx, mov pc, add pc, pop {pc}.
    pub(super) fn branch_by_register(&mut self) {
        let low = self.low();
        let literal = self.load(low, 0);
        self.forget(low);
        let target = match self.dice.below(5) {
            form @ (0 | 1) => {
                let mut register = low;
                if self.dice.one_in(2) {
                    register = 8 + self.dice.below(5) as u16;
                    self.a.put(
                        Class::High,
                        0x4600 | (register & 8) << 4 | low << 3 | register & 7,
                    );
                    self.forget(register);
                }
                let link = form as u16;
                self.a
                    .put(Class::BranchRegister, 0x4700 | link << 7 | register << 3);
                if link == 1 {
                    self.forget(14);
                }
                self.junk();
                self.a.here() | 1
            }
            2 => {
                // Bit 0 does not matter here.
                self.a.put(Class::WritePc, 0x4687 | low << 3);
                self.junk();
                self.a.here() | self.dice.below(2)
            }
            3 => {
                let pc = self.a.here() + 4;
                self.a.put(Class::WritePc, 0x4487 | low << 3);
                self.junk();
                (self.a.here() - pc) | self.dice.below(2)
            }
            _ => {
                // The lowest SP leaves no room for a push.
                if self.sp() == self.stack_bounds().0 {
                    self.a.put(Class::Stack, 0xb001);
                    self.known[13] = Some(self.sp() + 4);
                }
                self.a.put(Class::Push, 0xb400 | 1 << low);
                self.a.put(Class::PopPc, 0xbd00);
                self.junk();
                self.a.here() | 1
            }
        };
        self.a.set_literal(literal, target);
    }

    /// A subroutine: `bl 1f; …; b 2f; 1: push {…, lr}; …; pop {…, pc}; 2:`.
    pub(super) fn call(&mut self) {
        let room = (self.sp() - self.stack_bounds().0) / 4;
        if room < 3 {
            return;
        }
        let (saved, restored) = (1 << self.low(), 1 << self.low());
        let at = self.a.here();
        self.a.branch_link(at + 4);
        self.forget(14);
        let over = self.a.here();
        self.a.branch(over + 4);
        let entry = self.a.here();
        self.a.put(Class::Push, 0xb500 | saved);
        let sp = self.sp();
        self.known[13] = Some(sp - 8);
        // Nothing that could store over the return address.
        self.arithmetic();
        self.high();
        self.a.put(Class::PopPc, 0xbd00 | restored);
        self.known[13] = Some(sp);
        self.forget_list(restored);
        let end = self.a.here();
        self.a.patch(at, |a| a.branch_link(entry));
        self.a.patch(over, |a| a.branch(end));
    }
}
