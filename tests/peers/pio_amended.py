"""One instruction as the peer executes it, and the same with the peer's deviations from the datasheet put right, each by its name.

The peer stays the executor: an amendment changes what it is given (a rotated pin word, another opcode with the same meaning) or redoes
one effect. With no amendment named, `Step.amended` gives what `Step.plain` gives. Names and reasons: `pio_accepted.txt`.
"""

from collections import deque
from dataclasses import dataclass, replace

from pioemu import ShiftRegister, State, emulate

from pio_programs import PADS

PAD_MASK = (1 << PADS) - 1
FIFO_DEPTH = 4
NOP = 0xA042
"""`mov y, y`."""


def written(word, base, count, value, wrap):
    """`word` with `count` bits from `base` replaced; beyond bit 31 they go on at bit 0 or are lost."""
    for n in range(count):
        pin = base + n
        if pin < 32 or wrap:
            bit = 1 << pin % 32
            word = word & ~bit | (bit if value >> n & 1 else 0)
    return word


def rotated(value, by):
    return (value >> by | value << (32 - by)) & 0xFFFFFFFF if by else value


def never(_opcode, _state):
    return False


@dataclass
class Step:
    """The instruction at the program counter of `before`."""

    program: object
    before: State
    inputs: int
    latch: int
    """Output levels as the state machine last set them, also of pins that are inputs now."""

    def __post_init__(self):
        p = self.program
        self.opcode = p.memory[self.before.program_counter]
        field, delay_bits = self.opcode >> 8 & 31, 5 - p.side_bits
        self.delay = field & ((1 << delay_bits) - 1)
        side = field >> delay_bits
        # The peer knows no enable bit: an instruction whose bit is clear is given to it as one without side-set.
        self.side_count = p.side_bits - p.side_opt if p.side_bits else 0
        if p.side_opt and p.side_bits and not side >> self.side_count:
            self.side_count = 0
        self.side = side & ((1 << self.side_count) - 1)

    def run(self, opcode, before, side=False, inputs=None):
        """The peer executes one instruction, whose delay and side-set fields are replaced by this step's."""
        p = self.program
        count = self.side_count if side else 0
        field = (self.side << (5 - count) if side else 0) | self.delay
        memory = [0] * 32
        memory[before.program_counter] = opcode & 0xE0FF | field << 8
        inputs = self.inputs if inputs is None else inputs

        def source(_clock: int) -> int:
            return inputs

        _, after = next(
            emulate(
                memory,
                stop_when=never,
                initial_state=before,
                input_source=source,
                auto_pull=p.autopull,
                auto_push=p.autopush,
                pull_threshold=p.pull_threshold,
                push_threshold=p.push_threshold,
                shift_isr_right=p.in_right,
                shift_osr_right=p.out_right,
                out_base=p.out_base,
                out_count=p.out_count,
                set_base=p.set_base,
                set_count=p.set_count,
                side_set_base=p.side_base,
                side_set_count=count,
                jmp_pin=p.jmp_pin,
                wrap_target=p.wrap_target,
                wrap_top=p.wrap_top,
            )
        )
        return replace(
            after, pin_values=after.pin_values & PAD_MASK, pin_directions=after.pin_directions & PAD_MASK
        )

    def in_doubt(self):
        """Whether the peer could be wrong here by one of the named deviations; only then is the amended result asked for."""
        p, kind, what = self.program, self.opcode >> 13, self.opcode >> 5 & 7
        return (
            p.autopull
            or (p.autopush and kind == 2)
            or (kind == 0 and what == 7)
            or (kind == 4 and self.opcode & 0x40 != 0)
            or (kind == 5 and (what == 0 or self.opcode >> 3 & 3 == 2))
            or (kind in (3, 7) and what == 4)
            or (kind in (1, 2, 5) and p.in_base != 0)
            or max(p.out_base + p.out_count, p.set_base + p.set_count, p.side_base + self.side_count) > 32
        )

    def plain(self):
        """What the peer does."""
        return self.run(self.opcode, self.before, side=True)

    def amended(self, names):
        """What the peer does with the named deviations put right; also the names that apply to this instruction at all."""
        applicable = set()

        def on(name, condition=True):
            if condition:
                applicable.add(name)
            return condition and name in names

        p, before, opcode = self.program, self.before, self.opcode
        kind, what = opcode >> 13, opcode >> 5 & 7
        isr, osr = before.input_shift_register, before.output_shift_register
        level = before.pin_values & before.pin_directions | self.inputs & ~before.pin_directions
        levels = self.latch if on("pin-latch") else level
        directions = before.pin_directions

        def reading(opcode):
            """An instruction that reads the pins from the IN base on."""
            if not on("in-base", p.in_base != 0):
                return self.run(opcode, before)
            pins = rotated(level, p.in_base)
            after = self.run(opcode, replace(before, pin_values=0, pin_directions=0), inputs=pins)
            return replace(after, pin_values=before.pin_values, pin_directions=before.pin_directions)

        if kind == 0 and what == 7 and on("osre-threshold"):
            empty = osr.counter >= p.pull_threshold
            after = self.run(opcode, replace(before, output_shift_register=ShiftRegister(0, 32 * empty)))
            after = replace(after, output_shift_register=osr)
        elif kind == 1 and what & 3 == 1:
            after = reading(opcode)
        elif kind == 2 and on(
            "autopush-full",
            p.autopush
            and isr.counter + (opcode & 31 or 32) >= p.push_threshold
            and len(before.receive_fifo) >= FIFO_DEPTH,
        ):
            after = replace(before, clock=before.clock + 1)
        elif kind == 2 and what == 0:
            after = reading(opcode)
        elif kind == 3 and what in (0, 4):
            # `out x` shifts the same bits; X is put back.
            after = self.run(3 << 13 | 1 << 5 | opcode & 31, before)
            stalled = p.autopull and osr.counter >= p.pull_threshold
            if not stalled:
                wrap = on("pin-wrap", p.out_base + p.out_count > 32)
                if what == 0:
                    levels = written(levels, p.out_base, p.out_count, after.x_register, wrap)
                else:
                    directions = written(directions, p.out_base, p.out_count, after.x_register, wrap)
            after = replace(after, x_register=before.x_register)
        elif kind == 4 and opcode & 0x80 and on("pull-full", p.autopull and osr.counter == 0):
            after = self.run(NOP, before)
        elif kind == 4 and opcode & 0x40 and on("if-threshold"):
            if opcode & 0x80:
                met = osr.counter >= p.pull_threshold
            else:
                met = isr.counter >= p.push_threshold
            after = self.run(opcode & ~0x40 if met else NOP, before)
        elif kind == 5:
            value = reading(5 << 13 | 1 << 5 | opcode & 0x1F).x_register
            if on("mov-reverse", opcode >> 3 & 3 == 2):
                value = int(f"{value:032b}"[::-1], 2)
            if what == 0:
                base, count = 0, 32
                if on("mov-pins-mapping", (p.out_base, p.out_count) != (0, 32)):
                    base, count = p.out_base, p.out_count
                levels = written(levels, base, count, value, on("pin-wrap", base + count > 32))
                after = self.run(NOP, before)
            else:
                after = self.run(5 << 13 | what << 5 | 2, replace(before, y_register=value))
                if what != 2:
                    after = replace(after, y_register=before.y_register)
        elif kind == 7 and what in (0, 4):
            after = self.run(NOP, before)
            wrap = on("pin-wrap", p.set_base + p.set_count > 32)
            if what == 0:
                levels = written(levels, p.set_base, p.set_count, opcode & 31, wrap)
            else:
                directions = written(directions, p.set_base, p.set_count, opcode & 31, wrap)
        else:
            after = self.run(opcode, before)
        wrap = on("pin-wrap", p.side_base + self.side_count > 32)
        levels = written(levels, p.side_base, self.side_count, self.side, wrap)
        after = replace(after, pin_values=levels & PAD_MASK, pin_directions=directions & PAD_MASK)
        if kind != 3:
            after = background_pull(p, after, on)
        return after, applicable


def background_pull(program, state, on):
    """A cycle without OUT refills an empty OSR when autopull is on (datasheet 3.5.4.2)."""
    empty = state.output_shift_register.counter >= program.pull_threshold
    if on("autopull-background", program.autopull and empty and bool(state.transmit_fifo)):
        words = deque(state.transmit_fifo)
        return replace(state, output_shift_register=ShiftRegister(words.popleft(), 0), transmit_fifo=words)
    return state
