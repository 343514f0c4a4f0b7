"""A reference parser of CSBee and AERO lines, written from the documents alone and pinned to their vectors (`--self-test`).

usage: csv_client.py csbee|aero [FILE]

Reads lines from a file or standard input; prints one JSON line a message: {"line": "#A", "ICAO": "4D240E", "LAT": 53.47939, ...}. Integers and
degrees are numbers, hexadecimal fields and SQUAWK text as sent; an empty field is null. A line that is none of the protocol, or whose checksum is
wrong, is {"invalid": reason, "text": line}.
"""

import json
import re
import sys

INTEGER = r"-?(0|[1-9]\d*)"
COUNT = r"(0|[1-9]\d*)"
DEGREES = r"-?(0|[1-9]\d*)\.\d{5}"
HEX = r"(0|[1-9A-F][0-9A-F]*)"

# Name, pattern, and how it is read, for each field of each line.
ICAO = ("ICAO", r"[0-9A-F]{6}", str)
CALL = ("CALL", r"[A-Z0-9 ]{1,8}", str)
SQUAWK = ("SQUAWK", r"[0-7]{4}", str)
LAT = ("LAT", DEGREES, float)
LON = ("LON", DEGREES, float)


def integer(name):
    return (name, INTEGER, int)


def count(name):
    return (name, COUNT, int)


def hexadecimal(name):
    return (name, HEX, str)


PER_CENT = r"(0|[1-9]\d*)\.\d"

CSBEE = {
    "#A": [
        ICAO, hexadecimal("FLAGS"), CALL, SQUAWK, count("ECAT"), LAT, LON, integer("ALT_BARO"), integer("ALT_GEO"), count("TRACK"), count("VELH"),
        integer("VELV"), integer("SIGS"), integer("SIGQ"), count("ACFPS"), count("SFPS"), hexadecimal("SYSINFO"),
    ],
    "#S": [count("DPS"), count("ACFPS"), count("SFPS"), count("TSCAL"), count("UPTIME")],
}
AERO = {
    "#A": [
        ICAO, hexadecimal("FLAGS"), CALL, SQUAWK, LAT, LON, integer("ALT_BARO"), count("TRACK"), count("VELH"), integer("VELV"), integer("SIGS"),
        integer("SIGQ"), count("FPS"), hexadecimal("NICNAC"), integer("ALT_GEO"), count("ECAT"),
    ],
    "#S": [("CPL", PER_CENT, float), count("UPT")],
    "#AS": [count("FPSS"), count("FPSAC"), count("CALIB")],
}
# The OEM TT-SF1's statistics have the same start and more fields.
SF1 = [("CPU", PER_CENT, float), ("RES1", "", str), ("RES2", "", str), count("FPSS"), count("FPSAC"), count("TSCAL")]


def crc(data):
    """The documents' function."""
    value = 0xFFFF
    for byte in data:
        x = (value >> 8) ^ byte
        x ^= x >> 4
        value = ((value << 8) ^ (x << 12) ^ (x << 5) ^ x) & 0xFFFF
    return (value & 0xFF) << 8 | value >> 8


def read(line, protocol):
    """One line with its end; raises ValueError."""
    if not line.endswith(b"\r\n"):
        raise ValueError("no CR LF at its end")
    body, _, sum_ = line[:-2].rpartition(b",")
    covered = body + b"," if protocol == "csbee" else body
    if not re.fullmatch(rb"[0-9A-F]{4}", sum_) or crc(covered) != int(sum_, 16):
        raise ValueError("the checksum is wrong")
    start, _, rest = body.decode("ascii").partition(":")
    values = rest.split(",")
    fields = {"csbee": CSBEE, "aero": AERO}[protocol].get(start)
    if protocol == "aero" and start == "#S" and len(values) == len(SF1):
        fields = SF1
    if fields is None or len(values) != len(fields):
        raise ValueError(f"{start} with {len(values)} fields")
    told = {"line": start}
    for (name, pattern, read_as), value in zip(fields, values):
        if value and not re.fullmatch(pattern, value):
            raise ValueError(f"{name} is {value!r}")
        told[name] = read_as(value) if value else None
    return told


def messages(data, protocol):
    for line in data.splitlines(keepends=True):
        try:
            yield read(line, protocol)
        except (ValueError, UnicodeDecodeError) as reason:
            yield {"invalid": str(reason), "text": line.decode("latin-1")}


def self_test():
    assert crc(b"123456789") == 0xB129
    vector = b"#A:4D240E,3F00,,7273,53.47939,14.55892,28550,23,510,1408,-71,5,9,938,28850,,A9FE\r\n"
    told = read(vector, "aero")
    assert told["ICAO"] == "4D240E" and told["LAT"] == 53.47939 and told["NICNAC"] == "938", told
    assert told["CALL"] is None and told["ECAT"] is None and told["ALT_GEO"] == 28850, told
    for wrong in (vector.replace(b"A9FE", b"A9FF"), vector.replace(b"4D", b"4E"), vector[:-1], b"\r\n", b"#A:,A9FE\r\n"):
        try:
            read(wrong, "aero")
        except ValueError:
            continue
        raise AssertionError(f"{wrong} was taken")


def main():
    self_test()
    if sys.argv[1] == "--self-test":
        return
    stream = open(sys.argv[2], "rb") if len(sys.argv) > 2 else sys.stdin.buffer
    for told in messages(stream.read(), sys.argv[1]):
        print(json.dumps(told))


if __name__ == "__main__":
    main()
