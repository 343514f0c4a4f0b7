"""A reference parser of GDL90, written from the specification (560-1058-00 Rev A) and ForeFlight's extension, pinned to their examples (`--self-test`).

Reads bytes from a file or standard input; prints one JSON line a message: {"message": "traffic", "address": 11224393, "latitude": 44.9, ...} with
null for what the specification marks unknown, {"invalid": reason, "bytes": hex} for what is no message.
"""

import json
import sys

FLAG, ESCAPE = 0x7E, 0x7D


def table():
    entries = []
    for index in range(256):
        crc = index << 8
        for _ in range(8):
            crc = (crc << 1) ^ (0x1021 if crc & 0x8000 else 0)
        entries.append(crc & 0xFFFF)
    return entries


TABLE = table()


def fcs(data):
    crc = 0
    for byte in data:
        crc = TABLE[crc >> 8] ^ (crc << 8 & 0xFFFF) ^ byte
    return crc


def signed(value, bits):
    return value - (1 << bits) if value >> (bits - 1) else value


def report(data):
    """Reports 10 and 20, section 3.5.1."""
    if len(data) != 28:
        raise ValueError(f"{len(data)} bytes, not 28")
    altitude = data[11] << 4 | data[12] >> 4
    misc = data[12] & 0xF
    speed = data[14] << 4 | data[15] >> 4
    rate = (data[15] & 0xF) << 8 | data[16]
    if data[27] & 0xF:
        raise ValueError("the spare bits are not 0")
    return {
        "alert": data[1] >> 4,
        "address_type": data[1] & 0xF,
        "address": int.from_bytes(data[2:5], "big"),
        "latitude": signed(int.from_bytes(data[5:8], "big"), 24) * 180 / 2**23,
        "longitude": signed(int.from_bytes(data[8:11], "big"), 24) * 180 / 2**23,
        "altitude_ft": None if altitude == 0xFFF else altitude * 25 - 1000,
        "airborne": misc >> 3 & 1,
        "extrapolated": misc >> 2 & 1,
        "direction": [None, "true track", "magnetic heading", "true heading"][misc & 3],
        "nic": data[13] >> 4,
        "nac_p": data[13] & 0xF,
        "speed_kt": None if speed == 0xFFF else speed,
        "rate_fpm": None if rate == 0x800 else signed(rate, 12) * 64,
        "angle": data[17] * 360 / 256,
        "emitter": data[18],
        "callsign": data[19:27].decode("ascii"),
        "emergency": data[27] >> 4,
    }


def heartbeat(data):
    if len(data) != 7:
        raise ValueError(f"{len(data)} bytes, not 7")
    return {
        "gps_valid": data[1] >> 7,
        "initialized": data[1] & 1,
        "other_status": data[1] & 0x7E | (data[2] & 0x7E) << 8,
        "utc_ok": data[2] & 1,
        "seconds": data[3] | data[4] << 8 | data[2] >> 7 << 16,
        "uplinks": data[5] >> 3,
        "receptions": (data[5] & 3) << 8 | data[6],
    }


def ownship_altitude(data):
    if len(data) != 5:
        raise ValueError(f"{len(data)} bytes, not 5")
    merit = (data[3] & 0x7F) << 8 | data[4]
    return {
        "altitude_ft": signed(int.from_bytes(data[1:3], "big"), 16) * 5,
        "warning": data[3] >> 7,
        "merit_m": None if merit == 0x7FFF else merit,
    }


def foreflight(data):
    if len(data) != 39 or data[1] != 0 or data[2] != 1:
        raise ValueError("not ForeFlight's ID message, version 1")
    return {
        "serial": data[3:11].hex(),
        "name": data[11:19].rstrip(b"\0").decode("utf-8"),
        "long_name": data[19:35].rstrip(b"\0").decode("utf-8"),
        "capabilities": int.from_bytes(data[35:39], "big"),
    }


KINDS = {
    0: ("heartbeat", heartbeat),
    10: ("ownship", report),
    11: ("ownship altitude", ownship_altitude),
    20: ("traffic", report),
    0x65: ("foreflight", foreflight),
}


def read(inside):
    """What stands between two flags; raises ValueError."""
    data, rest = bytearray(), iter(inside)
    for byte in rest:
        if byte == ESCAPE:
            byte = next(rest, 0xFF) ^ 0x20
            if byte not in (FLAG, ESCAPE):
                raise ValueError("an escape of something else")
        data.append(byte)
    if len(data) < 3 or fcs(data[:-2]) != data[-2] | data[-1] << 8:
        raise ValueError("the frame check sequence is wrong")
    data = bytes(data[:-2])
    if data[0] not in KINDS:
        raise ValueError(f"message {data[0]}")
    name, fields = KINDS[data[0]]
    return {"message": name, **fields(data)}


def messages(data):
    pieces = data.split(bytes([FLAG]))
    # Two flags a message: what stands between messages is nothing.
    for number, inside in enumerate(pieces):
        is_between = number % 2 == 0
        if is_between and not inside:
            continue
        try:
            if is_between:
                raise ValueError("bytes between messages")
            yield read(inside)
        except ValueError as reason:
            yield {"invalid": str(reason), "bytes": inside.hex()}


def self_test():
    heart = bytes.fromhex("7E008141DBD00802B38B7E")
    told = list(messages(heart))
    assert len(told) == 1 and told[0]["gps_valid"] == 1 and told[0]["seconds"] == 0xD0DB and told[0]["receptions"] == 2, told
    traffic = bytes.fromhex("1400AB45491FEF15A889780F09A907B0012001" + "4E38323556202020" + "00")
    assert fcs(traffic) == 0xD657
    told = read(traffic + b"\x57\xD6")
    assert told["altitude_ft"] == 5000 and told["speed_kt"] == 123 and told["rate_fpm"] == 64 and told["callsign"] == "N825V   ", told
    assert abs(told["latitude"] - 44.90708) < 3e-5 and abs(told["longitude"] + 122.99488) < 3e-5 and told["angle"] == 45, told
    assert told["nic"] == 10 and told["nac_p"] == 9 and told["emitter"] == 1, told
    assert "invalid" in list(messages(heart.replace(b"\x41", b"\x42")))[0]


def main():
    self_test()
    if sys.argv[1:] == ["--self-test"]:
        return
    stream = open(sys.argv[1], "rb") if len(sys.argv) > 1 else sys.stdin.buffer
    for told in messages(stream.read()):
        print(json.dumps(told))


if __name__ == "__main__":
    main()
