"""Reads what is sent to a u-blox with pyubx2.

Frames on standard input; one JSON line each: {"message": "CFG-RATE", "fields": {...}, "taken": hex, "refused": hex}, the last two the answers that a receiver would give.
"""

import json
import sys

from pyubx2 import ERR_RAISE, GET, SET, UBX_PROTOCOL, UBXMessage, UBXReader


def answer(name, parsed):
    message = UBXMessage("ACK", name, GET, clsID=parsed.msg_cls[0], msgID=parsed.msg_id[0])
    return message.serialize().hex()


reader = UBXReader(sys.stdin.buffer, msgmode=SET, protfilter=UBX_PROTOCOL, quitonerror=ERR_RAISE)
for raw, parsed in reader:
    fields = {name: value for name, value in vars(parsed).items() if not name.startswith("_")}
    fields = {name: value.hex() if isinstance(value, bytes) else value for name, value in fields.items()}
    line = {
        "message": parsed.identity,
        "bytes": raw.hex(),
        "fields": fields,
        "taken": answer("ACK-ACK", parsed),
        "refused": answer("ACK-NAK", parsed),
    }
    print(json.dumps(line))
