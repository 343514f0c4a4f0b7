"""Compares the twin's PIO with the package rp2040-pio-emulator, cycle by cycle, on random programs.

    python pio_peer.py --trace <pio_trace binary> --csv <file> [--programs N] [--seed S] [--save <file>]

Both sides start from the same state and see the same events. After every cycle they must agree on the program counter, X, Y, both shift
registers with their counts, remaining delay, levels of driven pins, directions and both FIFOs. A cycle in which they differ is accepted
only if it is what the peer does once deviations listed in `pio_accepted.txt` are put right (`pio_amended.py`), and the twin agrees with
that result in everything; the smallest such set of deviations is booked. The peer then goes on from the twin's state. Anything else is
unexplained: it is printed and the run fails. So is agreement with a peer that is known to be wrong there. A listed deviation that a
long run never needs fails it too.
"""

import argparse
import subprocess
import sys
from collections import Counter, deque
from dataclasses import replace
from itertools import combinations
from pathlib import Path

from pioemu import ShiftRegister, State

from pio_amended import FIFO_DEPTH, PAD_MASK, Step, background_pull
from pio_programs import CYCLES, mnemonic, program

BATCH = 250
"""Programs a run of the twin's side."""
LONG_RUN = 2000
"""Programs from which every accepted difference must have shown itself."""
SHOWN = 10
"""Unexplained differences that are printed in full."""
FIELDS = "pc x y isr isr_count osr osr_count delay levels enables tx rx".split()


def accepted_table():
    """Name of each accepted deviation and the instructions at which it may show."""
    table = {}
    for line in (Path(__file__).parent / "pio_accepted.txt").read_text().splitlines():
        if line.strip() and not line.startswith("#"):
            name, instructions, _reason, _section = (part.strip() for part in line.split("|"))
            table[name] = tuple(part.strip() for part in instructions.split(","))
    return table


def fits(table, name, row):
    """Whether the table accepts the deviation at this row."""
    return any(what == "any" or row == what or row.startswith(what + " ") for what in table.get(name, ()))


def twin_traces(binary, programs):
    """State lines of the twin, a list a program."""
    text = "".join(p.line() + "\n" for p in programs)
    done = subprocess.run([binary], input=text, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"the twin's side failed: {done.stderr}")
    lines = done.stdout.splitlines()
    if len(lines) != len(programs) * (CYCLES + 1):
        sys.exit(f"the twin's side gave {len(lines)} lines")
    for n in range(len(programs)):
        yield [parsed(line) for line in lines[n * (CYCLES + 1) : (n + 1) * (CYCLES + 1)]]


def parsed(line):
    words = line.split()
    fifo = lambda text: () if text == "-" else tuple(int(w, 16) for w in text.split(","))
    return tuple(int(w, 16) for w in words[:10]) + (fifo(words[10]), fifo(words[11]))


def comparable(view):
    """Levels of pins that are not driven are nobody's business."""
    enables = view[9] & PAD_MASK
    return view[:8] + (view[8] & enables, enables) + view[10:]


def view_of(state, cycle):
    """The peer's state after `cycle` in the twin's form."""
    isr, osr = state.input_shift_register, state.output_shift_register
    return (
        state.program_counter,
        state.x_register,
        state.y_register,
        isr.contents,
        isr.counter,
        osr.contents,
        osr.counter,
        state.clock - cycle - 1,
        state.pin_values,
        state.pin_directions,
        tuple(state.transmit_fifo),
        tuple(state.receive_fifo),
    )


def state_of(view, cycle):
    """A peer's state after `cycle` from the twin's."""
    pc, x, y, isr, isr_count, osr, osr_count, delay, levels, enables, tx, rx = view
    return State(
        clock=cycle + 1 + delay,
        program_counter=pc,
        pin_directions=enables & PAD_MASK,
        pin_values=levels & PAD_MASK,
        transmit_fifo=deque(tx),
        receive_fifo=deque(rx),
        input_shift_register=ShiftRegister(isr, isr_count),
        output_shift_register=ShiftRegister(osr, osr_count),
        x_register=x,
        y_register=y,
    )


def with_event(state, kind, value):
    """The FIFOs after a word came from or went to the system."""
    if kind == "t" and len(state.transmit_fifo) < FIFO_DEPTH:
        return replace(state, transmit_fifo=deque([*state.transmit_fifo, value]))
    if kind == "r" and state.receive_fifo:
        return replace(state, receive_fifo=deque(list(state.receive_fifo)[1:]))
    return state


def explanation(attempt, plain, wanted, cycle):
    """The smallest set of deviations that gives the twin's view; None if none does."""
    same, applicable = attempt(frozenset())
    if comparable(view_of(same, cycle)) != comparable(view_of(plain, cycle)):
        # The detour itself must not change anything.
        return None
    # Putting one right can make another apply.
    _, more = attempt(frozenset(applicable))
    names = sorted(applicable | more)
    for size in range(1, len(names) + 1):
        for chosen in combinations(names, size):
            after, _ = attempt(frozenset(chosen))
            if comparable(view_of(after, cycle)) == wanted:
                return chosen
    return None


class Ledger:
    def __init__(self):
        self.table = accepted_table()
        self.rows = {}
        self.deviations = Counter()
        self.programs = Counter()
        self.shown = 0
        self.text = []

    def line(self, text=""):
        """Prints a line of the report."""
        print(text)
        self.text.append(text.rstrip())

    def book(self, row, outcome):
        self.rows.setdefault(row, Counter())[outcome] += 1

    def show(self, index, cycle, row, before, wanted, got):
        self.shown += 1
        if self.shown > SHOWN:
            return
        print(f"unexplained: program {index}, cycle {cycle}, {row}")
        for name, b, w, g in zip(FIELDS, before, wanted, got):
            text = lambda v: [f"{x:x}" for x in v] if isinstance(v, tuple) else f"{v:x}"
            mark = "" if w == g else "   <--"
            print(f"  {name:<9} before {text(b)} twin {text(w)} expected {text(g)}{mark}")

    def compare(self, index, p, trace):
        """Compares one program and books its outcome."""
        start = (p.wrap_target, p.x, p.y, 0, 0, trace[0][5], 32, 0, p.levels, p.enables, (), ())
        if trace[0] != start:
            self.show(index, -1, "start", start, trace[0], start)
            self.programs["unexplained"] += 1
            return
        state, inputs, outcome = state_of(start, -1), 0, "agreed"
        events = deque(p.events)
        for cycle in range(CYCLES):
            while events and events[0][0] == cycle:
                _, kind, value = events.popleft()
                inputs = value if kind == "i" else inputs
                state = with_event(state, kind, value)
            before, wanted = view_of(state, cycle - 1), comparable(trace[cycle + 1])
            if state.clock > cycle:
                row = "(delay)"
                got = state
                doubt = True
                attempt = lambda names: delayed(p, state, names)
            else:
                row = mnemonic(p.memory[state.program_counter])
                step = Step(p, state, inputs, trace[cycle][8])
                got = step.plain()
                doubt = step.in_doubt()
                attempt = step.amended
            right = comparable(view_of(attempt(self.table)[0] if doubt else got, cycle))
            if comparable(view_of(got, cycle)) == wanted == right:
                self.book(row, "agreed")
                state = got
                continue
            names = explanation(attempt, got, wanted, cycle) if wanted == right else None
            if names is None or not all(fits(self.table, name, row) for name in names):
                self.book(row, "unexplained")
                row = f"{row}, would need {names}" if names else row
                self.show(index, cycle, row, before, wanted, right)
                outcome = "unexplained"
                break
            self.book(row, "accepted")
            self.deviations.update(names)
            outcome = "accepted"
            state = state_of(trace[cycle + 1], cycle)
        self.programs[outcome] += 1

    def finish(self, csv, seed):
        """Table, CSV and result line; the number of reasons to fail."""
        outcomes = ("agreed", "accepted", "unexplained")
        lines = ["kind,name,agreed,accepted,unexplained"]
        self.line(f"{'cycles of':<22}{'agreed':>10}{'accepted':>10}{'unexplained':>13}")
        for row, counts in sorted(self.rows.items()):
            self.line(f"{row:<22}{counts['agreed']:>10}{counts['accepted']:>10}{counts['unexplained']:>13}")
            lines.append(f'instruction,"{row}",' + ",".join(str(counts[o]) for o in outcomes))
        total = sum(self.rows.values(), Counter())
        self.line(f"{'all':<22}{total['agreed']:>10}{total['accepted']:>10}{total['unexplained']:>13}")
        self.line()
        self.line(f"{'accepted difference':<22}{'cycles':>10}   (reasons: tests/peers/pio_accepted.txt)")
        for name in sorted(self.table):
            self.line(f"{name:<22}{self.deviations[name]:>10}")
            lines.append(f"difference,{name},0,{self.deviations[name]},0")
        Path(csv).parent.mkdir(parents=True, exist_ok=True)
        Path(csv).write_text("\n".join(lines) + "\n")
        compared = sum(self.programs.values())
        stale = [n for n in sorted(self.table) if not self.deviations[n]] if compared >= LONG_RUN else []
        for name in stale:
            self.line(f"accepted but never needed: {name}")
        counts = " ".join(f"{o}={self.programs[o]}" for o in outcomes)
        self.line(f"result: compared={compared} {counts} cycles={sum(total.values())} seed={seed}")
        return self.programs["unexplained"] + len(stale)


def delayed(p, state, names):
    """A delay cycle: nothing but the refill of the OSR."""
    applicable = set()

    def on(name, condition=True):
        if condition:
            applicable.add(name)
        return condition and name in names

    return background_pull(p, state, on), applicable


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--trace", required=True)
    arguments.add_argument("--csv", required=True)
    arguments.add_argument("--programs", type=int, default=2000)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--save", help="write the report to this file")
    options = arguments.parse_args()
    ledger = Ledger()
    for first in range(0, options.programs, BATCH):
        indices = range(first, min(first + BATCH, options.programs))
        programs = [program(options.seed, index) for index in indices]
        for index, p, trace in zip(indices, programs, twin_traces(options.trace, programs)):
            ledger.compare(index, p, trace)
    failures = ledger.finish(options.csv, options.seed)
    if options.save:
        Path(options.save).write_text("\n".join(ledger.text) + "\n")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
