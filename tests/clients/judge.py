"""Compares what the real clients understood of the image's ports with the truth beside them.

usage: judge.py FOLDER [TABLE]

FOLDER holds what `cargo xtask bench clients` recorded (tests/src/live_clients.rs lists the files). A message about an aircraft must agree in all its fields
with the tracker's values at one instant of the last WINDOW_MS before its last byte came. A field that is absent or marked unknown must be unknown to the tracker.
What tells the time or the receiver's own place must agree with the scene. A client that has not read is named.
Frames must come out of each raw protocol in the order in which CONSOLE told them, none missing. The last line is `result: clients=… fields_compared=…
mismatches=…`; the exit code is 1 where anything disagrees. TABLE gets the same lines.
"""

import bisect
import json
import re
import sys
import time
from collections import Counter, defaultdict
from functools import partial
from pathlib import Path

from judge_fields import AIRCRAFT, DAY_S, TIME_S, Near, agrees, asterix_ends, gdl90_ends, lines

# A report waits at most so long between its making and its last byte: 2 KiB at 3 Mbaud and a turn of the loop.
WINDOW_MS = 40
# Messages shown of each client that disagree.
SHOWN = 3


class Missing(Exception):
    """A client has not read."""


class Scene:
    """Time and place as they were."""

    def __init__(self, path):
        self.place = json.loads(path.read_text())

    def second_of_day(self, ms):
        return (self.place["unix_ms"] + ms) / 1000 % DAY_S


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
    path = folder / f"{client}.jsonl"
    if not path.exists():
        raise Missing(client)
    return [json.loads(row) for row in path.read_text().splitlines()]


def is_odd(message):
    return "invalid" in message or message.get("message") == "BAD_DATA"


def arrivals(folder, part):
    """Bytes so far, and the millisecond of the last of them."""
    return [tuple(map(int, entry.split())) for entry in (folder / f"{part}.times").read_text().splitlines()]


def judge_aircraft(folder, truth, scene, client, part, ends_of, is_aircraft, compare, address):
    row, data = Row(client), (folder / f"{part}.bin").read_bytes()
    times = arrivals(folder, part)
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
            now = {"second_of_day": scene.second_of_day(at_ms), "values_second_of_day": scene.second_of_day(values["ms"])}
            wanted, told = compare(message, values | now)
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


def judge_fix(folder, scene):
    """gpsd's fixes: all seconds of the sentences that passed, no others, each in its time and place."""
    row, data = Row("gpsd"), (folder / "nmea.bin").read_bytes()
    times, place = arrivals(folder, "nmea"), scene.place
    seconds = []
    for found in re.finditer(rb"\$GNRMC,[^\r]*\r\n", data):
        at_ms = times[bisect.bisect_left(times, (found.end(), 0))][1]
        # It is of the second that has begun last.
        seconds.append(int(scene.second_of_day(at_ms)))
    fixes = [m for m in understood(folder, "gpsd") if m["mode"] == 3]
    row.messages = len(fixes)
    if not seconds:
        row.note("no RMC in it")
    for second in seconds:
        row.fields += 1
        stamp = f"T{second // 3600:02}:{second // 60 % 60:02}:{second % 60:02}.000Z"
        if not any(fix["time"].endswith(stamp) for fix in fixes):
            row.note(f"no fix of {stamp}")
    day = int(place["unix_ms"] // 1000 // DAY_S)
    for fix in fixes:
        height = place["height_cm"] / 100
        wanted = {
            "date": time.strftime("%Y-%m-%d", time.gmtime(day * DAY_S)),
            "second": True,
            # NMEA has five decimals of a minute, and heights in tenths of a metre.
            "lat": Near(place["lat_e7"] * 1e-7, 1e-7),
            "lon": Near(place["lon_e7"] * 1e-7, 1e-7),
            "altMSL": Near(height, 0.051),
            "altHAE": Near(height + place["geoid_cm"] / 100, 0.11),
        }
        clock = [int(part) for part in fix["time"][11:19].split(":")]
        told = {**fix, "date": fix["time"][:10], "second": clock[0] * 3600 + clock[1] * 60 + clock[2] in seconds}
        compare(row, "fix", wanted, told)
    return row


def judge_adsbee(folder):
    """What the ADSBee's own client found on CONSOLE is what stands there when its questions are typed; what is not there is an error to it."""
    row = Row("adsbee")
    typed = (folder / "adsbee.txt").read_text(encoding="ascii").splitlines()
    steps = {step["step"]: step["found"] for step in understood(folder, "adsbee")}
    row.messages = len(steps)
    compare(row, "adsbee", {"protocol": [line for line in typed if line.startswith("+PROTOCOL=")]}, steps)
    compare(row, "adsbee", {"save": ["OK"], "dump": ["OK"], "help": ["OK"], "ota": True}, steps)
    for name, label in {
        "part_code": "Part Code",
        "rp2040_firmware_version": "RP2040 Firmware Version",
        "esp32_firmware_version": "ESP32 Firmware Version",
        "mac_address": "ESP32 Base MAC Address",
    }.items():
        told = [line.partition(": ")[2] for line in typed if line.strip().startswith(label + ": ")]
        compare(row, "adsbee DEVICE_INFO", {name: told[0] if told else ""}, steps.get("info", {}))
    return row


def judge_receiver(folder, scene):
    """What GDL90, CAT023 and JSON say of the receiver itself, once the time is known."""
    row, place = Row("time and place"), scene.place
    latitude, longitude = place["lat_e7"] * 1e-7, place["lon_e7"] * 1e-7
    height_m = (place["height_cm"] + place["geoid_cm"]) / 100

    def at(part, ends_of, client):
        data, times = (folder / f"{part}.bin").read_bytes(), arrivals(folder, part)
        for message, end in zip(understood(folder, client), ends_of(data)):
            yield message, scene.second_of_day(times[bisect.bisect_left(times, (end, 0))][1])

    for client in ("gdl90", "gdl90-crate"):
        for message, now in at("gdl90", gdl90_ends, client):
            if message.get("message") == "heartbeat":
                wanted = {"gps_valid": 1, "utc_ok": 1, "seconds": Near(now - 0.5, 0.5 + TIME_S, DAY_S)}
            elif message.get("message") == "ownship":
                # As for traffic; the crate's degrees are of 24 bits of precision.
                wanted = {"latitude": Near(latitude, 4.4e-5), "longitude": Near(longitude, 4.4e-5)}
            elif message.get("message") == "ownship altitude":
                wanted = {"altitude_ft": Near(height_m / 0.3048, 5)}
            else:
                continue
            row.messages += 1
            compare(row, f"{client} {message['message']}", wanted, message)
    for client in ("libasterix", "asterix-decoder", "tshark"):
        for message, now in at("asterix", asterix_ends, client):
            if message["category"] == 23:
                row.messages += 1
                compare(row, f"{client} CAT023", {"070": Near(now, TIME_S, DAY_S), "100/TSV": 0}, message)
    for message, now in at("json", lines, "jsonschema"):
        if "adsb" in message:
            # The pulse has been there for long.
            compare(row, "JSON adsb", {"has a stamp": True}, {"has a stamp": "ts24h" in message["adsb"][0]})
        if "gnss" in message:
            row.messages += 1
            wanted = {"ts": Near(now * 1000, TIME_S * 1000, DAY_S * 1000)}
            compare(row, "JSON gnss", wanted, message)
            wanted = {"lat": Near(latitude, 6e-6), "lon": Near(longitude, 6e-6)}
            compare(row, "JSON gnss", wanted, message["gnss"])
    return row


def compare(row, what, wanted, told):
    for name, value in wanted.items():
        row.fields += 1
        if not agrees(value, told.get(name)):
            row.note(f"{what}: {name} {told.get(name)!r}, wanted {value!r}")


def judge_seconds(folder):
    """What goes out once a second beside the aircraft."""
    row = Row("once a second")
    kinds = {
        "csbee": lambda m: m.get("line") == "#S",
        "aero": lambda m: m.get("line") == "#AS",
        "pymavlink-1": lambda m: m["message"] == "HEARTBEAT",
        "pymavlink-2": lambda m: m["message"] == "MESSAGE_INTERVAL" and m["message_id"] == 246 and m["interval_us"] == 1_000_000,
        "gdl90": lambda m: m.get("message") == "heartbeat",
        "gdl90-crate": lambda m: m.get("message") == "heartbeat",
        "libasterix": lambda m: m["category"] == 23,
        "asterix-decoder": lambda m: m["category"] == 23,
        "tshark": lambda m: m["category"] == 23,
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
    truth, scene = Truth(folder / "truth.jsonl"), Scene(folder / "scene.json")
    all_frames = [row.split()[1] for row in (folder / "frames.txt").read_text().splitlines()]
    hexd = hex_lines(r"\*([0-9A-F]{14}|[0-9A-F]{28});")
    raw = hex_lines(r"\*([0-9A-F]{14}|[0-9A-F]{28});\((?:-?\d*),(?:\d*),[0-9A-F]*,[0-9A-F]*\)")
    judges = [partial(judge_aircraft, folder, truth, scene, *entry) for entry in AIRCRAFT]
    judges += [
        lambda: judge_frames(folder, "dump1090-raw", hexd((folder / "hexd.bin").read_bytes())),
        lambda: judge_frames(folder, "dump1090-beast", beast((folder / "console.bin").read_bytes())),
        lambda: judge_fix(folder, scene),
        lambda: judge_adsbee(folder),
        lambda: judge_receiver(folder, scene),
        lambda: judge_order(folder, "hexd", hexd, all_frames),
        lambda: judge_order(folder, "raw", raw, all_frames),
        lambda: judge_order(folder, "json", json_frames, all_frames),
        lambda: judge_order(folder, "beast", beast, all_frames),
        lambda: judge_seconds(folder),
    ]
    rows, missing = [], set()
    for judge in judges:
        try:
            rows.append(judge())
        except Missing as client:
            missing.add(str(client))
    out = [f"{'client':<18}{'messages':>10}{'fields':>10}{'mismatches':>12}"]
    for row in rows:
        out.append(f"{row.client:<18}{row.messages:>10}{row.fields:>10}{row.wrong:>12}")
        out += [f"  {note}" for note in row.notes]
    fields, wrong = sum(r.fields for r in rows), sum(r.wrong for r in rows)
    clients = sum(1 for r in rows if (folder / f"{r.client}.jsonl").exists())
    if missing:
        out.append(f"missing: {', '.join(sorted(missing))}")
    out.append(f"result: clients={clients} fields_compared={fields} mismatches={wrong}")
    print("\n".join(out))
    if len(sys.argv) > 2:
        Path(sys.argv[2]).write_text("\n".join(out) + "\n", encoding="utf-8")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
