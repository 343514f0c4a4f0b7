#!/usr/bin/env python3
"""What `squitter decode --json` prints of two recorded logs, field by field beside pyModeS, an independent decoder.

    log ─┬─► squitter decode --json ─► names, values ─┐
         └─► pyModeS decode()        ─► names, values ─┴─► same | accepted (a line of mode_s_accepted.txt) | unexplained

Every frame of both logs is compared, and of it every field that pyModeS prints. Fields that ours has and pyModeS lacks are not judged here.
Of a Comm-B reply the register is compared first (which of both found one), and where ours found one, its fields beside pyModeS's decoder of
that very register. pyModeS is a decoder with a stream's memory here (PipeDecoder), as ours is.

A difference passes only by a line of the accepted list, which names the rule in RULES below that recognises it, its count and its reason;
a difference without a rule, or a count that moved, ends the program with 1.

Truth: where the aircraft also sends ADS-B, a register that says something else than it has been guessed wrong, whoever guessed it. The
program counts that for ours and for pyModeS.

Last line: result: frames=... fields=... accepted=... unexplained=0
"""

import argparse
import collections
import json
import subprocess
import sys

from pyModeS import Message, PipeDecoder
from pyModeS.decoder.bds import (bds10, bds17, bds20, bds30, bds40, bds44,
                                 bds45, bds50, bds60)

# pyModeS's decoder of each register.
REGISTERS = {
    "1,0": bds10.decode_bds10, "1,7": bds17.decode_bds17, "2,0": bds20.decode_bds20,
    "3,0": bds30.decode_bds30, "4,0": bds40.decode_bds40, "4,4": bds44.decode_bds44,
    "4,5": bds45.decode_bds45, "5,0": bds50.decode_bds50, "6,0": bds60.decode_bds60,
}
# Fields that are not of the frame alone, and texts for people, which each program words in its own way.
NOT_COMPARED = {"icao_verified", "latitude", "longitude", "bds_candidates", "flight_status_text", "capability_text", "wake_vortex", "error", "raw_msg"}
# Ours are hundredths of a degree, rounded; CORDIC adds as much again.
ANGLES = {"track", "heading", "selected_heading", "true_track", "magnetic_heading", "wind_direction"}
ANGLE_ROOM = 0.0151
# How near ADS-B must be in time to judge a register, seconds, and in value.
JUDGED_WITHIN_S = 5.0
TRUTH_ROOM = {"groundspeed": 30.0, "true_track": 15.0, "magnetic_heading": 45.0, "selected_altitude": 65.0}
# Time given to the frames of the log without times, as the Rust test gives it: 5 ms each.
STEP_S = 0.005
BEAST_HEAD_DIGITS = 18


def frames_of(name, path):
    """Seconds and hexadecimal digits."""
    with open(path, encoding="ascii") as lines:
        if name == "long_flight":
            first = None
            for line in lines:
                seconds, beast = line.strip().split(",")
                first = float(seconds) if first is None else first
                yield float(seconds) - first, beast[BEAST_HEAD_DIGITS:]
        else:
            for number, line in enumerate(lines):
                yield number * STEP_S, line.strip().strip("*;")


def kind_of(bits, length):
    """DF, type code, subtype, register: what a sample must cover."""
    df = bits >> (length - 5)
    if df in (17, 18):
        me = bits >> 24 & (1 << 56) - 1
        return df, me >> 51, me >> 48 & 7
    return (min(df, 24),)


def same(name, ours, theirs):
    if ours == theirs:
        return True
    numbers = (int, float)
    if isinstance(ours, numbers) and isinstance(theirs, numbers):
        away = abs(ours - theirs)
        if name in ANGLES:
            return min(away, 360 - away) <= ANGLE_ROOM
        return away <= 1e-6
    return False


class Rules:
    """What a difference must look like to be accepted by the line of that name. Each gets the frame's bits, field and values."""

    @staticmethod
    def broken(d):
        return d.mine["crc"] == "broken" and d.df == 11 and d.ours is None

    @staticmethod
    def tisb_velocity(d):
        return d.df == 18 and d.typecode == 19 and d.cf in (2, 5) and d.name in ("nac_v", "geo_minus_baro")

    @staticmethod
    def imf(d):
        return d.df == 18 and d.cf in (2, 5, 6) and d.name == "nic_b" and d.theirs == 1 and d.ours == 0

    @staticmethod
    def speed_truncated(d):
        return d.name == "groundspeed" and d.typecode == 19 and d.ours is not None and d.ours - 1 == d.theirs

    @staticmethod
    def metres_of_gnss(d):
        return d.name == "altitude" and d.typecode in (20, 21, 22)

    @staticmethod
    def source_without_rate(d):
        return d.name == "vr_source" and d.ours is None and d.full.get("vertical_rate") is None

    @staticmethod
    def callsign_character(d):
        return d.name == "callsign" and d.ours is None and ("#" in d.theirs or d.theirs == "")

    @staticmethod
    def cross_link_of_df16(d):
        return d.name == "cross_link_capability" and d.df == 16 and d.ours is None

    @staticmethod
    def register_ours_ambiguous(d):
        return d.name == "bds" and d.df in (20, 21) and d.ours is None and "bds_candidates" in d.mine

    @staticmethod
    def register_ours_struck_out(d):
        return d.name == "bds" and d.df in (20, 21) and d.ours is None and "bds_candidates" not in d.mine

    @staticmethod
    def register_theirs_none(d):
        return d.name == "bds" and d.df in (20, 21) and d.theirs is None

    @staticmethod
    def register_otherwise(d):
        return d.name == "bds" and d.df in (20, 21) and d.ours is not None and d.theirs is not None


Difference = collections.namedtuple("Difference", "hexa df cf typecode name ours theirs mine full")


class Ledger:
    def __init__(self, accepted):
        self.accepted = accepted
        self.counts = collections.Counter()
        self.unexplained = collections.defaultdict(list)
        self.fields = self.frames = 0

    def note(self, difference):
        for rule in self.accepted:
            if getattr(Rules, rule)(difference):
                self.counts[rule] += 1
                return
        self.unexplained[(difference.df, difference.typecode, difference.name)].append(difference)


class Truth:
    """The last ADS-B of each aircraft, and how often a register agreed with it."""

    def __init__(self):
        self.last = {}
        self.judged = collections.defaultdict(collections.Counter)

    def hear(self, seconds, mine):
        if mine["df"] in (17, 18) and mine["crc"] == "exact":
            if "groundspeed" in mine and "track" in mine:
                self.last[mine["icao"], "velocity"] = (seconds, mine)
            if mine.get("subtype") == 1 and mine.get("typecode") == 29:
                self.last[mine["icao"], "selected"] = (seconds, mine)

    def verdict(self, seconds, icao, bds, values):
        """Whether ADS-B of the last seconds agrees with a register; None where it says nothing."""
        what = "selected" if bds == "4,0" else "velocity"
        at, told = self.last.get((icao, what), (None, None))
        if at is None or not 0 <= seconds - at <= JUDGED_WITHIN_S:
            return None

        def near(value, other, room, angle=False):
            away = abs(value - other)
            return (min(away, 360 - away) if angle else away) <= room

        verdicts = []
        if bds == "5,0":
            if values.get("groundspeed") is not None:
                verdicts.append(near(values["groundspeed"], told["groundspeed"], TRUTH_ROOM["groundspeed"]))
            if values.get("true_track") is not None:
                verdicts.append(near(values["true_track"], told["track"], TRUTH_ROOM["true_track"], True))
        elif bds == "6,0" and values.get("magnetic_heading") is not None:
            verdicts.append(near(values["magnetic_heading"], told["track"], TRUTH_ROOM["magnetic_heading"], True))
        elif bds == "4,0":
            for name in ("selected_altitude_mcp", "selected_altitude_fms"):
                if values.get(name) is not None and told.get("selected_altitude") is not None:
                    verdicts.append(near(values[name], told["selected_altitude"], TRUTH_ROOM["selected_altitude"]))
            # One of both altitudes is the one that ADS-B tells.
            verdicts = [any(verdicts)] if verdicts else []
        return all(verdicts) if verdicts else None

    def judge(self, who, seconds, icao, bds, values):
        verdict = self.verdict(seconds, icao, bds, values)
        if verdict is not None:
            self.judged[who, bds]["right" if verdict else "wrong"] += 1
        return verdict


def decoded(squitter, frames):
    """What `squitter decode --json` prints, an object a frame."""
    text = "".join(f"{seconds:.6f},{hexa}\n" for seconds, hexa in frames)
    done = subprocess.run([squitter, "decode", "--json"], input=text, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"mode_s_peer: {squitter} decode ended with {done.returncode}: {done.stderr[:500]}")
    lines = done.stdout.splitlines()
    if len(lines) != len(frames):
        sys.exit(f"mode_s_peer: {len(lines)} objects of {len(frames)} frames")
    return map(json.loads, lines)


def comm_b(seconds, mine, streamed, payload, truth, registers):
    """What pyModeS says of a Comm-B reply, the register's fields by its decoder of the register that ours found."""
    ours, guessed = mine.get("bds"), streamed.get("bds")
    theirs = {key: streamed[key] for key in ("df", "icao", "altitude", "squawk") if key in streamed}
    theirs["bds"] = guessed
    if ours is not None:
        values = REGISTERS[ours](payload)
        truth.judge("ours", seconds, mine["icao"], ours, values)
        theirs.update(values)
    if guessed is not None:
        is_right = truth.judge("pyModeS", seconds, mine["icao"], guessed, REGISTERS[guessed](payload))
        if is_right and ours is None:
            truth.judged["missed by ours", guessed]["right"] += 1
    registers[(ours, guessed)] += 1
    return theirs


def compare_frame(ledger, hexa, mine, theirs):
    bits, length = int(hexa, 16), 4 * len(hexa)
    df = mine["df"]
    typecode = bits >> 75 & 31 if df in (17, 18) and length == 112 else None
    cf = bits >> (length - 8) & 7
    for key, value in theirs.items():
        if key in NOT_COMPARED or (key == "crc_valid" and df not in (17, 18)):
            continue
        ledger.fields += 1
        if not same(key, mine.get(key), value):
            ledger.note(Difference(hexa, df, cf, typecode, key, mine.get(key), value, mine, theirs))


def compare_log(name, path, squitter, ledger, show):
    frames = list(frames_of(name, path))
    pipe, truth = PipeDecoder(), Truth()
    kinds, registers = collections.Counter(), collections.Counter()
    for (seconds, hexa), mine in zip(frames, decoded(squitter, frames)):
        kinds[kind_of(int(hexa, 16), 4 * len(hexa))] += 1
        ledger.frames += 1
        # pyModeS knows no DF24.
        if mine["df"] >= 24:
            continue
        truth.hear(seconds, mine)
        # The stream's decoder withholds fields that its memory doubts; of the frame alone all are wanted.
        streamed = pipe.decode(hexa, timestamp=seconds)
        if mine["df"] in (20, 21):
            payload = int(hexa, 16) >> 24 & (1 << 56) - 1
            theirs = comm_b(seconds, mine, streamed, payload, truth, registers)
        else:
            theirs = Message(hexa).decode()
        compare_frame(ledger, hexa, mine, theirs)
    print(f"{name}: {len(frames)} frames of {len(kinds)} kinds")
    if show:
        for (ours, guessed), count in sorted(registers.items(), key=lambda row: -row[1]):
            print(f"    register ours {ours}, pyModeS {guessed}: {count}")
    for who, bds in sorted(truth.judged):
        counts = truth.judged[who, bds]
        print(f"    {who:14} {bds}: agrees with ADS-B {counts['right']}, contradicts it {counts['wrong']}")


def save(path):
    """From now on what is printed goes to the file, too."""
    class Both:
        def __init__(self, *files):
            self.files = files

        def write(self, text):
            for file in self.files:
                file.write(text)

        def flush(self):
            for file in self.files:
                file.flush()

    sys.stdout = Both(sys.stdout, open(path, "w", encoding="utf-8"))


def read_accepted(path):
    accepted = {}
    with open(path, encoding="utf-8") as lines:
        for number, line in enumerate(lines, 1):
            line = line.strip()
            if not line or line.startswith("#"):
                continue
            rule, count, reason = (part.strip() for part in line.split("|", 2))
            if not hasattr(Rules, rule) or not reason:
                sys.exit(f"mode_s_peer: {path}:{number}: no such rule, or no reason: {line}")
            accepted[rule] = (int(count), reason)
    return accepted


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--squitter", required=True)
    arguments.add_argument("--log", action="append", required=True, metavar="NAME=PATH")
    arguments.add_argument("--accepted", required=True)
    arguments.add_argument("--show", action="store_true", help="print which registers both found")
    arguments.add_argument("--save", help="write the table there")
    options = arguments.parse_args()
    if options.save:
        save(options.save)
    accepted = read_accepted(options.accepted)
    ledger = Ledger(accepted)
    for log in options.log:
        name, path = log.split("=", 1)
        compare_log(name, path, options.squitter, ledger, options.show)
    moved = []
    for rule, (count, reason) in accepted.items():
        print(f"{ledger.counts[rule]:8} {rule}: {reason}")
        if ledger.counts[rule] != count:
            moved.append(f"{rule}: {ledger.counts[rule]}, the list says {count}")
    unexplained = sum(map(len, ledger.unexplained.values()))
    for (df, typecode, name), differences in sorted(ledger.unexplained.items(), key=str):
        print(f"unexplained: {len(differences)} DF{df} TC{typecode} {name}")
        for d in differences[:3]:
            print(f"    ours {d.ours!r}, pyModeS {d.theirs!r} in {d.hexa}")
    for line in moved:
        print(f"moved: {line}")
    total = sum(ledger.counts.values())
    print(f"result: frames={ledger.frames} fields={ledger.fields} accepted={total} unexplained={unexplained}")
    sys.exit(1 if unexplained or moved else 0)


if __name__ == "__main__":
    main()
