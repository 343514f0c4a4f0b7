"""A stream of ASTERIX data blocks, cut by their lengths: what the scripts of its clients share."""

import json
import sys


def blocks(data):
    """One data block after the other: a category, a length of two octets with these three in it, records."""
    at = 0
    while at < len(data):
        length = int.from_bytes(data[at + 1 : at + 3], "big")
        if length < 3 or at + length > len(data):
            raise ValueError(f"a data block of {length} octets, {len(data) - at} are left")
        yield data[at : at + length]
        at += length


def tell(records):
    """The records of the file that the command line names, or of standard input, a line of JSON each."""
    stream = open(sys.argv[1], "rb") if len(sys.argv) > 1 else sys.stdin.buffer
    for told in records(stream.read()):
        print(json.dumps(told))
