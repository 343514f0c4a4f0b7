"""A third opinion on ASTERIX: what tshark (Debian) understands of a byte stream.

Reads bytes from a file or standard input; gives each data block to tshark as a UDP packet to port 8600 and prints one JSON line a record, with the keys of
`asterix_client.py`. tshark knows no edition 2.1 of CAT021: 2.4 is the nearest, whose items are the same but for a bit of 200 that 2.1 leaves spare
(ME), which must be 0 and is not told. Of CAT023 it has edition 1.2.
"""

import json
import re
import struct
import subprocess

import asterix_stream

EDITIONS = {"asterix.i021_version": "Version 2.4", "asterix.i023_version": "Version 1.2"}
PORT = 8600
# Link type of packets that begin with an IPv4 header.
LINK_IPV4 = 228
LOOPBACK = bytes([127, 0, 0, 1])
# An item's name with its category and, where there is more than one, its edition.
NAME = re.compile(r"asterix\.0\d\d(?:_V\d+_\d+)?_(\d{3}(?:_.+)?)")
# Frames that tshark may not add to what was sent.
MARKS = {"asterix.fspec", "asterix.FX"}


def packet(data):
    udp = struct.pack(">HHHH", PORT, PORT, 8 + len(data), 0) + data
    ip = struct.pack(">BBHHHBBH4s4s", 0x45, 0, 20 + len(udp), 0, 0, 64, 17, 0, LOOPBACK, LOOPBACK)
    return struct.pack("<IIII", 0, 0, 20 + len(udp), 20 + len(udp)) + ip + udp


def capture(data):
    head = struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, LINK_IPV4)
    return head + b"".join(map(packet, asterix_stream.blocks(data)))


def value(text):
    """Numbers as numbers, text as text."""
    if re.fullmatch(r"0x[0-9a-f]+", text):
        return int(text, 16)
    if re.fullmatch(r"-?\d+", text):
        return int(text)
    return float(text) if re.fullmatch(r"-?\d+\.\d+(?:e-?\d+)?", text) else text


def flatten(fields, into):
    for name, told in fields.items():
        found = NAME.fullmatch(name)
        if isinstance(told, dict):
            flatten(told, into)
        elif found and told != "":
            key = found.group(1).replace("_", "/", 1)
            key = key.removesuffix("/VALUE")
            # Text is text, even where it is all digits.
            into[key] = told if key == "170" else value(told)
        elif not found and name not in MARKS:
            raise ValueError(f"{name}: {told}")


def records(data):
    options = [option for name, edition in EDITIONS.items() for option in ("-o", f"{name}:{edition}")]
    command = ["tshark", "-n", "-r", "-", *options, "-d", f"udp.port=={PORT},asterix", "-T", "json", "-J", "asterix"]
    output = subprocess.run(command, input=capture(data), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True).stdout
    for one in json.loads(output):
        block = one["_source"]["layers"]["asterix"]
        told = {"category": int(block["asterix.category"])}
        flatten(block["asterix.message"], told)
        if told.pop("200/ME", 0) != 0:
            raise ValueError("a spare bit of item 200 is set")
        if "070/MODE3A" in told:
            # As four octal digits, like the others.
            told["070/MODE3A"] = f"{told['070/MODE3A']:04o}"
        if "150/AS" in told:
            # It leaves the unit, which depends on IM, to its reader.
            told["150/AS"] *= [2**-14, 0.001][told["150/IM"]]
        yield told


if __name__ == "__main__":
    asterix_stream.tell(records)
