"""Compares what the real clients understood of the image's ports with the truth beside them.

usage: judge.py FOLDER [TABLE]

FOLDER holds what `cargo xtask bench clients` recorded (tests/src/live_clients.rs lists the files). A message about an aircraft must agree in all its fields
with the tracker's values at one instant of the last WINDOW_MS before its last byte came. A field that is absent or marked unknown must be unknown to the tracker.
Frames must come out of each raw protocol in the order in which CONSOLE told them, none missing. The last line is `result: clients=… fields_compared=…
mismatches=…`; the exit code is 1 where anything disagrees. TABLE gets the same lines.
"""

import bisect
import json
import re
import sys
from collections import Counter, defaultdict
from pathlib import Path

# A report waits at most so long between its making and its last byte: 2 KiB at 3 Mbaud and a turn of the loop.
WINDOW_MS = 40
# Messages shown of each client that disagree.
SHOWN = 3


class Near:
    """A number rounded somewhere on its way."""

    def __init__(self, value, tolerance, round_at=None):
        self.value, self.tolerance, self.round_at = value, tolerance, round_at

    def agrees(self, other):
        if self.value is None or other is None:
            return self.value is None and other is None
        apart = abs(self.value - other)
        if self.round_at:
            apart = min(apart % self.round_at, self.round_at - apart % self.round_at)
        return apart <= self.tolerance

    def __repr__(self):
        return f"{self.value}±{self.tolerance}"


def agrees(expected, told):
    return expected.agrees(told) if isinstance(expected, Near) else expected == told


def scaled(value, factor):
    return None if value is None else value * factor


def text(value):
    return (value or "").strip() or None


def bit(value, number):
    return value >> number & 1


def emitter(category):
    """003's table, which MAVLink and GDL90 share."""
    if category is None:
        return 0
    type_code, ca = category
    table = {4: {1: 1, 2: 2, 3: 3, 4: 4, 5: 5, 6: 6, 7: 7}, 3: {1: 9, 2: 10, 3: 11, 4: 12, 6: 14, 7: 15}, 2: {1: 17, 3: 18, 4: 19, 5: 20, 6: 21}}
    return table.get(type_code, {}).get(ca, 0)


def updates(flags, first, v):
    names = ["baro", "gnss", "position", "track", "speed", "rate"]
    told = {f"FLAGS {name} updated": bit(flags, first + n) for n, name in enumerate(names)}
    wanted = {f"FLAGS {name} updated": int(v["updated"][name]) for name in names}
    # Near a second's end a frame may count on either side.
    return ({}, {}) if v["slack"] else (wanted, told)


def quality(name, field, v):
    if field is None:
        return {name: None if v["nic"] in (None, 0) and v["nacp"] in (None, 0) else "known"}, {name: None}
    value = int(field, 16)
    wanted = {f"{name} NIC": v["nic"] or 0, f"{name} NACp": v["nacp"] or 0}
    return wanted, {f"{name} NIC": value & 0xF, f"{name} NACp": value >> 8 & 0xF}


def line(message, v):
    """What CSBee and AERO share."""
    wanted = {
        "ICAO": f"{v['icao']:06X}",
        "CALL": text(v["callsign"]),
        "LAT": Near(scaled(v["lat_e7"], 1e-7), 6e-6),
        "LON": Near(scaled(v["lon_e7"], 1e-7), 6e-6),
        "ALT_BARO": v["baro_ft"],
        "ALT_GEO": v["gnss_ft"],
        "TRACK": Near(scaled(v["track_cdeg"], 0.01), 0.501, 360),
        "VELH": Near(scaled(v["speed_8"], 0.125), 0.501),
        "VELV": v["rate_fpm"],
    }
    told = {name: text(message[name]) if name == "CALL" else message[name] for name in wanted}
    return wanted, told


def csbee(message, v):
    wanted, told = line(message, v)
    flags = int(message["FLAGS"], 16)
    wanted |= {
        "SQUAWK": v["squawk"],
        "SFPS": Near(v["mode_s"], v["slack"]),
        "FLAGS airborne": int(v["on_ground"] is False),
        "FLAGS position valid": int(v["lat_e7"] is not None),
        "FLAGS military": int(v["military"]),
        "FLAGS ident": int(v["ident"]),
        "FLAGS alert": int(v["alert"]),
        "FLAGS resolution advisory": int(v["ra"]),
    }
    told |= {
        "SQUAWK": message["SQUAWK"],
        "SFPS": message["SFPS"],
        "FLAGS airborne": bit(flags, 0),
        "FLAGS position valid": bit(flags, 1),
        "FLAGS military": bit(flags, 2),
        "FLAGS ident": bit(flags, 10),
        "FLAGS alert": bit(flags, 11),
        "FLAGS resolution advisory": bit(flags, 12),
    }
    for more, given in (updates(flags, 17, v), quality("SYSINFO", message["SYSINFO"], v)):
        wanted |= more
        told |= given
    return wanted, told


def aero(message, v):
    wanted, told = line(message, v)
    flags = int(message["FLAGS"], 16)
    wanted |= {
        "SQUAWK": v["squawk"],
        "FPS": Near(v["mode_s"], v["slack"]),
        "ECAT": emitter(v["category"]),
        "FLAGS on the ground": int(v["on_ground"] is True),
    }
    told |= {
        "SQUAWK": message["SQUAWK"],
        "FPS": message["FPS"],
        "ECAT": message["ECAT"] or 0,
        "FLAGS on the ground": bit(flags, 0),
    }
    more, given = quality("NICNAC", message["NICNAC"], v)
    return wanted | more, told | given


def preferred(v):
    """Barometric first: feet, and whether geometric."""
    if v["baro_ft"] is not None:
        return v["baro_ft"], 0
    return (v["gnss_ft"], 1) if v["gnss_ft"] is not None else (None, 0)


def mavlink(message, v):
    flags = message["flags"]

    def valid(number, value):
        return value if flags >> number & 1 else None

    feet, is_geometric = preferred(v)
    wanted = {
        "ICAO_address": v["icao"],
        "lat": v["lat_e7"],
        "lon": v["lon_e7"],
        "altitude": Near(scaled(feet, 304.8), 1),
        "altitude_type": is_geometric,
        "heading": v["track_cdeg"],
        "hor_velocity": Near(scaled(v["speed_8"], 51.4444 / 8), 1),
        "ver_velocity": Near(scaled(v["rate_fpm"], 0.508), 1),
        "callsign": text(v["callsign"]),
        "squawk": None if v["squawk"] is None else int(v["squawk"]),
        "emitter_type": emitter(v["category"]),
        "tslc": Near(v["silent_ms"] / 1000, 1.1),
    }
    told = {
        "ICAO_address": message["ICAO_address"],
        "lat": valid(0, message["lat"]),
        "lon": valid(0, message["lon"]),
        "altitude": valid(1, message["altitude"]),
        "altitude_type": message["altitude_type"],
        "heading": valid(2, message["heading"]),
        "hor_velocity": valid(3, message["hor_velocity"]),
        "ver_velocity": valid(7, message["ver_velocity"]),
        "callsign": text(valid(4, message["callsign"])),
        "squawk": valid(5, message["squawk"]),
        "emitter_type": message["emitter_type"],
        "tslc": message["tslc"],
    }
    return wanted, told


def gdl90(message, v):
    feet, _ = preferred(v)
    wanted = {
        "address": v["icao"],
        "latitude": Near(scaled(v["lat_e7"], 1e-7), 2.2e-5),
        "longitude": Near(scaled(v["lon_e7"], 1e-7), 2.2e-5),
        "altitude_ft": Near(feet, 13),
        "airborne": int(v["on_ground"] is not True),
        "nic": v["nic"] or 0,
        "nac_p": v["nacp"] or 0,
        "speed_kt": Near(scaled(v["speed_8"], 0.125), 0.501),
        "rate_fpm": Near(v["rate_fpm"], 32.5),
        "emitter": emitter(v["category"]),
        "callsign": text(v["callsign"]),
    }
    told = {name: message[name] for name in wanted}
    told["callsign"] = text(message["callsign"])
    if message["direction"] == "true track":
        wanted["angle"] = Near(scaled(v["track_cdeg"], 0.01), 0.71, 360)
        told["angle"] = message["angle"]
    else:
        wanted["track"], told["track"] = v["track_cdeg"], None
    return wanted, told


def asterix(message, v):
    is_baro = v["rate_baro"] is True
    code = v["squawk"]
    wanted = {
        "080": v["icao"],
        "131/LAT": Near(scaled(v["lat_e7"], 1e-7), 3e-7),
        "131/LON": Near(scaled(v["lon_e7"], 1e-7), 3e-7),
        "145": Near(scaled(v["baro_ft"], 0.01), 0.126),
        "140": Near(v["gnss_ft"], 3.2),
        "160/GS": Near(scaled(v["speed_8"], 0.125 / 3600), 3.1e-5),
        "160/TA": Near(scaled(v["track_cdeg"], 0.01), 0.0056, 360),
        "155/BVR": Near(v["rate_fpm"] if is_baro else None, 3.2),
        "157/GVR": Near(v["rate_fpm"] if v["rate_baro"] is False else None, 3.2),
        "170": text(v["callsign"]),
        "070/MODE3A": None if code is None else int(code, 8),
        "151/TAS": v["tas_kt"],
        "230": Near(scaled(v["roll_cdeg"], 0.01), 0.006),
    }
    # Ground speed and track go out together.
    if v["speed_8"] is None or v["track_cdeg"] is None:
        wanted["160/GS"] = wanted["160/TA"] = None
    told = {name: message.get(name) for name in wanted}
    told["170"] = text(told["170"])
    if told["070/MODE3A"] is not None:
        told["070/MODE3A"] = int(str(told["070/MODE3A"]), 8)
    return wanted, told


def asterix_second(message, v):
    """asterix-decoder names fewer items, and rounds some more."""
    wanted, told = asterix(message, v)
    for name in ("155/BVR", "157/GVR", "230", "151/TAS", "160/GS", "160/TA"):
        if told[name] is None:
            wanted.pop(name)
            told.pop(name)
    return wanted, told


def json_aircraft(message, v):
    one = message["adsb"][0]
    wanted = {
        "icao": f"{v['icao']:06X}",
        "lat": Near(scaled(v["lat_e7"], 1e-7), 6e-6),
        "lon": Near(scaled(v["lon_e7"], 1e-7), 6e-6),
        "altBaro": v["baro_ft"],
        "geoAlt": v["gnss_ft"],
        "track": Near(scaled(v["track_cdeg"], 0.01), 0.011, 360),
        "velH": Near(scaled(v["speed_8"], 0.125), 0.501),
        "velV": v["rate_fpm"],
        "call": text(v["callsign"]),
        "squawk": v["squawk"],
        "ias": v["ias_kt"],
        "tas": v["tas_kt"],
        "nav_altitude_mcp": v["mcp_ft"],
        "nav_altitude_fms": v["fms_ft"],
        "nic": v["nic"] or None,
    }
    told = {name: one.get(name) for name in wanted}
    told["call"] = text(told["call"])
    return wanted, told


def lines(data):
    return [found.end() for found in re.finditer(b"\n", data)]


def mavlink_ends(data):
    ends, at = [], 0
    while at < len(data):
        at += {0xFE: 8, 0xFD: 12}[data[at]] + data[at + 1]
        ends.append(at)
    return ends


def asterix_ends(data):
    ends, at = [], 0
    while at < len(data):
        at += data[at + 1] << 8 | data[at + 2]
        ends.append(at)
    return ends


def gdl90_ends(data):
    flags = [n for n, byte in enumerate(data) if byte == 0x7E]
    return [flag + 1 for flag in flags[1::2]]


# Client, part, message ends, whether a message is about an aircraft, comparison, and where it names the address.
AIRCRAFT = [
    ("csbee", "csbee", lines, lambda m: m.get("line") == "#A", csbee, lambda m: int(m["ICAO"], 16)),
    ("aero", "csv", lines, lambda m: m.get("line") == "#A", aero, lambda m: int(m["ICAO"], 16)),
    ("pymavlink-1", "mavlink1", mavlink_ends, lambda m: m["message"] == "ADSB_VEHICLE", mavlink, lambda m: m["ICAO_address"]),
    ("pymavlink-2", "mavlink2", mavlink_ends, lambda m: m["message"] == "ADSB_VEHICLE", mavlink, lambda m: m["ICAO_address"]),
    ("gdl90", "gdl90", gdl90_ends, lambda m: m.get("message") == "traffic", gdl90, lambda m: m["address"]),
    ("libasterix", "asterix", asterix_ends, lambda m: m["category"] == 21, asterix, lambda m: m["080"]),
    ("asterix-decoder", "asterix", asterix_ends, lambda m: m["category"] == 21, asterix_second, lambda m: m["080"]),
    ("jsonschema", "json", lines, lambda m: "adsb" in m, json_aircraft, lambda m: int(m["adsb"][0]["icao"], 16)),
]


class Truth:
    def __init__(self, path):
        self.times, self.values = defaultdict(list), defaultdict(list)
        with open(path, encoding="ascii") as file:
            for row in map(json.loads, file):
                self.times[row["icao"]].append(row["ms"])
                self.values[row["icao"]].append(row)

    def during(self, icao, begin_ms, end_ms):
        """Values in force at some instant from begin to end."""
        times = self.times.get(icao, [])
        first = max(bisect.bisect_right(times, begin_ms) - 1, 0)
        last = bisect.bisect_right(times, end_ms)
        return self.values.get(icao, [])[first:last]


class Row:
    def __init__(self, client):
        self.client, self.messages, self.fields, self.wrong, self.notes = client, 0, 0, 0, []

    def note(self, what):
        self.wrong += 1
        if len(self.notes) < SHOWN:
            self.notes.append(what)


def understood(folder, client):
    return [json.loads(row) for row in (folder / f"{client}.jsonl").read_text().splitlines()]


def is_odd(message):
    return "invalid" in message or message.get("message") == "BAD_DATA"


def judge_aircraft(folder, truth, client, part, ends_of, is_aircraft, compare, address):
    row, data = Row(client), (folder / f"{part}.bin").read_bytes()
    times = [tuple(map(int, entry.split())) for entry in (folder / f"{part}.times").read_text().splitlines()]
    messages, ends = understood(folder, client), ends_of(data)
    if len(messages) != len(ends) or (ends and ends[-1] != len(data)):
        row.note(f"{len(messages)} messages understood of {len(ends)} in {len(data)} bytes")
        return row
    row.messages = len(messages)
    for message, end in zip(messages, ends):
        if is_odd(message):
            row.note(f"not understood: {message}")
            continue
        if not is_aircraft(message):
            continue
        at_ms = times[bisect.bisect_left(times, (end, 0))][1]
        best = None
        for values in truth.during(address(message), at_ms - WINDOW_MS, at_ms):
            wanted, told = compare(message, values)
            wrong = [f"{name}: {told[name]!r}, wanted {wanted[name]!r}" for name in wanted if not agrees(wanted[name], told[name])]
            if best is None or len(wrong) < len(best[1]):
                best = (len(wanted), wrong)
        if best is None:
            row.note(f"{address(message):06X} at {at_ms} ms: not tracked")
            continue
        row.fields += best[0]
        for wrong in best[1]:
            row.note(f"{address(message):06X} at {at_ms} ms: {wrong}")
    if not row.fields:
        row.note("no aircraft in it")
    return row


def crc(frame):
    """CRC-24 over all but the last three bytes, and these added: 0 for a frame without address in its parity."""
    data = bytes.fromhex(frame)
    value = 0
    for byte in data[:-3]:
        value ^= byte << 16
        for _ in range(8):
            value <<= 1
            if value & 0x1000000:
                value ^= 0x1FFF409
    return (value ^ int.from_bytes(data[-3:], "big")) & 0xFFFFFF


def taken_by_dump1090(frames):
    """Those that it must send on: a parity of 0, or an address that such a frame has told before. Of an address that it hears once it sends nothing."""
    known, taken, heard = set(), [], Counter()
    for frame in frames:
        format_ = int(frame[:2], 16) >> 3
        rest = crc(frame)
        if format_ in (11, 17, 18) and rest == 0:
            address = int(frame[2:8], 16)
            known.add(address)
        elif format_ in (0, 4, 5, 16, 20, 21) and rest in known:
            address = rest
        else:
            continue
        heard[address] += 1
        taken.append((address, frame))
    return [frame for address, frame in taken if heard[address] > 1]


def judge_frames(folder, client, sent):
    row, got = Row(client), [m["frame"] for m in understood(folder, client)]
    row.messages = len(got)
    left = Counter(got)
    for frame in taken_by_dump1090(sent):
        row.fields += 1
        if left[frame] == 0:
            row.note(f"{frame} did not arrive")
        left[frame] -= 1
    for frame in (Counter(got) - Counter(sent)).elements():
        row.note(f"{frame} was not sent")
    return row


def beast(data):
    """Frames of a Beast stream, between whatever else stands in it."""
    frames, at = [], 0
    sizes = {0x31: 2, 0x32: 7, 0x33: 14}
    while at + 1 < len(data):
        if data[at] != 0x1A or data[at + 1] not in sizes:
            at += 1
            continue
        body, wanted = bytearray(), 7 + sizes[data[at + 1]]
        at += 2
        while at < len(data) and len(body) < wanted:
            at += 2 if data[at] == 0x1A else 1
            body.append(data[at - 1])
        frames.append(bytes(body[7:]).hex().upper())
    return frames


def hex_lines(pattern):
    def read(data):
        rows = data.decode("ascii").splitlines()
        found = [re.fullmatch(pattern, row) for row in rows]
        return [match.group(1) if match else f"odd line {row!r}" for match, row in zip(found, rows)]

    return read


def json_frames(data):
    messages = map(json.loads, data.decode("ascii").splitlines())
    return [message["raw"][0][0] for message in messages if "raw" in message]


def judge_order(folder, part, read, all_frames):
    """What a raw protocol told is a part of what CONSOLE told, without a gap."""
    row, told = Row(f"{part} in order"), read((folder / f"{part}.bin").read_bytes())
    row.messages = row.fields = len(told)
    starts = [n for n, frame in enumerate(all_frames) if told and frame == told[0]]
    if not any(all_frames[n : n + len(told)] == told for n in starts):
        row.note(f"{len(told)} frames, not as CONSOLE told them")
    return row


def judge_seconds(folder):
    """What goes out once a second beside the aircraft."""
    row = Row("once a second")
    kinds = {
        "csbee": lambda m: m.get("line") == "#S",
        "aero": lambda m: m.get("line") == "#AS",
        "pymavlink-1": lambda m: m["message"] == "HEARTBEAT",
        "pymavlink-2": lambda m: m["message"] == "MESSAGE_INTERVAL" and m["message_id"] == 246 and m["interval_us"] == 1_000_000,
        "gdl90": lambda m: m.get("message") == "heartbeat",
        "libasterix": lambda m: m["category"] == 23,
        "jsonschema": lambda m: "status" in m and "gnss" not in m,
    }
    for client, is_it in kinds.items():
        row.fields += 1
        count = sum(map(is_it, understood(folder, client)))
        row.messages += count
        if count == 0:
            row.note(f"{client}: none")
    return row


def main():
    folder = Path(sys.argv[1])
    truth = Truth(folder / "truth.jsonl")
    all_frames = [row.split()[1] for row in (folder / "frames.txt").read_text().splitlines()]
    rows = [judge_aircraft(folder, truth, *entry) for entry in AIRCRAFT]
    hexd = hex_lines(r"\*([0-9A-F]{14}|[0-9A-F]{28});")
    rows.append(judge_frames(folder, "dump1090-raw", hexd((folder / "hexd.bin").read_bytes())))
    rows.append(judge_frames(folder, "dump1090-beast", beast((folder / "console.bin").read_bytes())))
    rows.append(judge_order(folder, "hexd", hexd, all_frames))
    rows.append(judge_order(folder, "raw", hex_lines(r"\*([0-9A-F]{14}|[0-9A-F]{28});\((?:-?\d*),(?:\d*),[0-9A-F]*,[0-9A-F]*\)"), all_frames))
    rows.append(judge_order(folder, "json", json_frames, all_frames))
    rows.append(judge_order(folder, "beast", beast, all_frames))
    rows.append(judge_seconds(folder))
    out = [f"{'client':<18}{'messages':>10}{'fields':>10}{'mismatches':>12}"]
    for row in rows:
        out.append(f"{row.client:<18}{row.messages:>10}{row.fields:>10}{row.wrong:>12}")
        out += [f"  {note}" for note in row.notes]
    fields, wrong = sum(r.fields for r in rows), sum(r.wrong for r in rows)
    clients = sum(1 for r in rows if (folder / f"{r.client}.jsonl").exists())
    out.append(f"result: clients={clients} fields_compared={fields} mismatches={wrong}")
    print("\n".join(out))
    if len(sys.argv) > 2:
        Path(sys.argv[2]).write_text("\n".join(out) + "\n", encoding="utf-8")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
