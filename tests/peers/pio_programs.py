"""Random PIO programs with their surroundings, the same for the same seed.

A program is a full instruction memory, one state machine's settings, its registers at the start, and events (input levels, words for the
TX FIFO, words taken from the RX FIFO) by cycle. Only what the peer knows is drawn: one state machine, no IRQ, no STATUS, no EXEC, no
side-set of directions, no joined FIFOs, divider 1. Encodings: RP2040 datasheet 3.4, register fields 3.7.
"""

import random
from dataclasses import dataclass, field

CYCLES = 160
PADS = 30
"""Pads that the chip has; bits 30 and 31 of a pin word reach nothing."""

JMP_CONDITIONS = ["always", "!x", "x--", "!y", "y--", "x!=y", "pin", "!osre"]
IN_SOURCES = {0: "pins", 1: "x", 2: "y", 3: "null", 6: "isr", 7: "osr"}
OUT_DESTINATIONS = {0: "pins", 1: "x", 2: "y", 3: "null", 4: "pindirs", 5: "pc", 6: "isr"}
MOV_DESTINATIONS = {0: "pins", 1: "x", 2: "y", 5: "pc", 6: "isr", 7: "osr"}
MOV_SOURCES = {0: "pins", 1: "x", 2: "y", 3: "null", 6: "isr", 7: "osr"}
SET_DESTINATIONS = {0: "pins", 1: "x", 2: "y", 4: "pindirs"}
WEIGHTS = {"jmp": 5, "wait": 2, "in": 5, "out": 5, "push": 2, "pull": 3, "mov": 5, "set": 3}


@dataclass
class Program:
    memory: list
    side_bits: int = 0
    """Bits of the side-set field, its enable bit included."""
    side_opt: bool = False
    side_base: int = 0
    out_base: int = 0
    out_count: int = 32
    set_base: int = 0
    set_count: int = 5
    in_base: int = 0
    jmp_pin: int = 0
    wrap_target: int = 0
    wrap_top: int = 31
    autopush: bool = False
    autopull: bool = False
    push_threshold: int = 32
    pull_threshold: int = 32
    in_right: bool = True
    out_right: bool = True
    x: int = 0
    y: int = 0
    levels: int = 0
    enables: int = 0
    events: list = field(default_factory=list)
    """(cycle, "i" levels | "t" word | "r" 0), by cycle."""

    def line(self):
        """The program as the twin's side reads it."""
        execctrl = self.side_opt << 30 | self.jmp_pin << 24 | self.wrap_top << 12 | self.wrap_target << 7
        shiftctrl = (
            (self.pull_threshold & 31) << 25
            | (self.push_threshold & 31) << 20
            | self.out_right << 19
            | self.in_right << 18
            | self.autopull << 17
            | self.autopush << 16
        )
        pinctrl = (
            self.side_bits << 29
            | self.set_count << 26
            | self.out_count << 20
            | self.in_base << 15
            | self.side_base << 10
            | self.set_base << 5
            | self.out_base
        )
        words = self.memory + [execctrl, shiftctrl, pinctrl, self.wrap_target]
        words += [self.x, self.y, self.levels, self.enables, CYCLES]
        return " ".join([f"{w:x}" for w in words] + [f"{c:x}{kind}{value:x}" for c, kind, value in self.events])


def mnemonic(opcode):
    """The instruction's row in the table."""
    a = opcode >> 5 & 7
    match opcode >> 13:
        case 0:
            return f"jmp {JMP_CONDITIONS[a]}"
        case 1:
            return f"wait {['gpio', 'pin'][a & 3]}"
        case 2:
            return f"in {IN_SOURCES[a]}"
        case 3:
            return f"out {OUT_DESTINATIONS[a]}"
        case 4:
            condition = ("" if opcode & 0x40 == 0 else " iffull" if opcode & 0x80 == 0 else " ifempty")
            return ("pull" if opcode & 0x80 else "push") + condition + ("" if opcode & 0x20 else " noblock")
        case 5:
            return f"mov {MOV_DESTINATIONS[a]}{['', ' !', ' ::'][opcode >> 3 & 3]}"
        case _:
            return f"set {SET_DESTINATIONS[a]}"


def word(rng):
    """A register or FIFO word: small, all over, or close to the ends."""
    return rng.choice([rng.randrange(8), rng.getrandbits(32), rng.getrandbits(32), 0xFFFFFFFF - rng.randrange(3)])


def bits(rng):
    """A bit count as IN and OUT encode it (0 is 32), small ones more often so that shift counts stay between their ends."""
    return rng.randrange(1, 9) if rng.random() < 0.5 else rng.randrange(32)


def field_of(rng, loose):
    """Base and count of a group of pins; loose groups may wrap past pin 31."""
    base = rng.randrange(24, 32) if loose else rng.randrange(PADS)
    return base, (rng.randrange(33) if loose else rng.randrange(PADS - base + 1))


def instruction(rng, p):
    """Eight low bits and the opcode; delay and side-set come later."""
    kind = rng.choices(list(WEIGHTS), list(WEIGHTS.values()))[0]
    pick = lambda table: rng.choice(list(table))
    match kind:
        case "jmp":
            inside = rng.randrange(p.wrap_target, p.wrap_top + 1)
            return rng.randrange(8) << 5 | (inside if rng.random() < 0.8 else rng.randrange(32))
        case "wait":
            return 1 << 13 | rng.randrange(2) << 7 | rng.randrange(2) << 5 | rng.randrange(PADS)
        case "in":
            return 2 << 13 | pick(IN_SOURCES) << 5 | bits(rng)
        case "out":
            return 3 << 13 | pick(OUT_DESTINATIONS) << 5 | bits(rng)
        case "push":
            return 4 << 13 | rng.randrange(4) << 5
        case "pull":
            return 4 << 13 | 0x80 | rng.randrange(4) << 5
        case "mov":
            return 5 << 13 | pick(MOV_DESTINATIONS) << 5 | rng.randrange(3) << 3 | pick(MOV_SOURCES)
        case _:
            return 7 << 13 | pick(SET_DESTINATIONS) << 5 | rng.randrange(32)


def program(seed, index):
    """Program number `index` of a seed."""
    rng = random.Random(f"{seed}/{index}")
    p = Program(memory=[])
    p.wrap_target = rng.randrange(32)
    # The peer cannot express a wrap from address 0.
    p.wrap_top = max(1, min(31, p.wrap_target + rng.randrange(12)))
    if rng.random() < 0.6:
        p.side_bits = rng.randrange(1, 6)
        p.side_opt = rng.random() < 0.4
    loose = rng.random() < 0.1
    if rng.random() < 0.5 or loose:
        p.out_base, p.out_count = field_of(rng, loose)
    p.set_base, p.set_count = field_of(rng, loose)
    p.set_count = min(5, p.set_count)
    p.side_base = rng.randrange(24, 32) if loose else rng.randrange(PADS - 5)
    p.in_base = rng.randrange(32) if rng.random() < 0.2 else 0
    p.jmp_pin = rng.randrange(PADS)
    p.autopush, p.autopull = rng.random() < 0.3, rng.random() < 0.3
    p.push_threshold = rng.randrange(1, 33) if rng.random() < 0.5 else 32
    p.pull_threshold = rng.randrange(1, 33) if rng.random() < 0.5 else 32
    p.in_right, p.out_right = rng.random() < 0.5, rng.random() < 0.5
    p.x, p.y, p.levels = word(rng), word(rng), rng.getrandbits(PADS)
    p.enables = rng.choice([0, (1 << PADS) - 1, rng.getrandbits(PADS)])
    for address in range(32):
        opcode = instruction(rng, p)
        if address == 31 and p.wrap_top != 31:
            # The peer's counter does not go from 31 to 0 by itself.
            opcode = p.wrap_target
        delay_bits = 5 - p.side_bits
        delay = rng.randrange(1 << delay_bits) if rng.random() < 0.3 else 0
        side = rng.randrange(1 << p.side_bits)
        p.memory.append(opcode | (side << delay_bits | delay) << 8)
    for cycle in range(CYCLES):
        if cycle == 0 or rng.random() < 0.3:
            p.events.append((cycle, "i", rng.getrandbits(PADS)))
        for _ in range(rng.randrange(5) if cycle == 0 else rng.random() < 0.25):
            p.events.append((cycle, "t", word(rng)))
        if rng.random() < 0.25:
            p.events.append((cycle, "r", 0))
    return p
