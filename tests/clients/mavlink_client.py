"""What pymavlink understands of a byte stream, in either framing.

Reads bytes from a file or standard input; prints one JSON line a message: its fields by the names of MAVLink's `common.xml`, its name as
"message", and of the frame "version" (1 or 2), "sequence", "system", "component". Bytes that are no message are {"message": "BAD_DATA", "bytes": n}.
"""

import json
import sys

from pymavlink.dialects.v20 import common


def messages(data):
    parser = common.MAVLink(None)
    parser.robust_parsing = True
    for message in parser.parse_buffer(data) or []:
        told = {"message": message.get_type()}
        if told["message"] == "BAD_DATA":
            told["bytes"] = len(message.data)
            yield told
            continue
        raw = message.get_msgbuf()
        told["version"] = {0xFE: 1, 0xFD: 2}[raw[0]]
        told["sequence"] = message.get_seq()
        told["system"] = message.get_srcSystem()
        told["component"] = message.get_srcComponent()
        for name in message.get_fieldnames():
            told[name] = getattr(message, name)
        yield told


def main():
    stream = open(sys.argv[1], "rb") if len(sys.argv) > 1 else sys.stdin.buffer
    for told in messages(stream.read()):
        print(json.dumps(told))


if __name__ == "__main__":
    main()
