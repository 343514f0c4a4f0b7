"""What a client's message about an aircraft must tell beside the tracker's values: a comparison a protocol, for `judge.py`.

Each takes the message as the client understood it and the values of `truth.jsonl`, and gives two dictionaries with the same names: what is wanted, what was told.
Where each message of a stream ends stands here too, and which client reads what (AIRCRAFT).
"""

import re

# The device works out the time of day for messages every 50 ms; fields of the tracker have ages in steps of 4 ms, ASTERIX times of 8 ms.
TIME_S, AGE_S = 0.06, 0.03
DAY_S = 86_400


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


def gdl90_crate(message, v):
    """It does not separate all fields, and says nothing of an angle's kind."""
    read = {**message, "direction": "true track", "airborne": None}
    wanted, told = gdl90(read, v)
    wanted.pop("airborne"), told.pop("airborne")
    # Its degrees are of 24 bits of precision.
    for name in ("latitude", "longitude"):
        wanted[name].tolerance *= 2
    if v["track_cdeg"] is None:
        wanted.pop("angle"), told.pop("angle")
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
    # Times go out when the time of day is known.
    if "077" in message:
        wanted["077"] = Near(v["second_of_day"], TIME_S, DAY_S)
        wanted["073"] = heard_at(v, v["lat_e7"], v["position_age_ms"])
        wanted["075"] = heard_at(v, v["speed_8"], v["speed_age_ms"])
    told = {name: message.get(name) for name in wanted}
    told["170"] = text(told["170"])
    if told["070/MODE3A"] is not None:
        told["070/MODE3A"] = int(str(told["070/MODE3A"]), 8)
    return wanted, told


def heard_at(v, value, age_ms):
    return Near(None if value is None else v["values_second_of_day"] - age_ms / 1000, AGE_S + 1 / 128, DAY_S)


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
    if "ts" in message:
        wanted["ts"], told["ts"] = Near(v["second_of_day"], TIME_S, DAY_S), message["ts"] / 1000
    if "ts24h" in one:
        # The last frame's, to the nanosecond; the truth knows it to four milliseconds.
        wanted["ts24h"] = Near(v["values_second_of_day"] - v["silent_ms"] / 1000, AGE_S, DAY_S)
        told["ts24h"] = one["ts24h"] / 1e9
        wanted["ts1s"], told["ts1s"] = one["ts24h"] % 10**9, one["ts1s"]
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
    ("gdl90-crate", "gdl90", gdl90_ends, lambda m: m.get("message") == "traffic", gdl90_crate, lambda m: m["address"]),
    ("libasterix", "asterix", asterix_ends, lambda m: m["category"] == 21, asterix, lambda m: m["080"]),
    ("asterix-decoder", "asterix", asterix_ends, lambda m: m["category"] == 21, asterix_second, lambda m: m["080"]),
    ("tshark", "asterix", asterix_ends, lambda m: m["category"] == 21, asterix, lambda m: m["080"]),
    ("jsonschema", "json", lines, lambda m: "adsb" in m, json_aircraft, lambda m: int(m["adsb"][0]["icao"], 16)),
]
