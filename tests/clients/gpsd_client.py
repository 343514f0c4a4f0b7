"""What gpsd (Debian) understands of a port that passes NMEA on: a fix with time and place.

Reads bytes from a file or standard input, gives them to a gpsd of its own as a TCP source on this machine, and prints each of its reports of a fix (TPV) as one JSON
line, as gpsd tells it: {"class": "TPV", "mode": 3, "time": "2026-01-01T12:00:03.000Z", "lat": 43.6, ...}. Other lines may stand between the sentences.
"""

import json
import os
import socket
import subprocess
import sys

from loopback import START, connected, free_port

# Seconds of silence after which all has been told.
SILENCE = 2.0
WATCH = b'?WATCH={"enable":true,"json":true};\n'


def fixes(data):
    source = socket.create_server(("127.0.0.1", 0))
    source.settimeout(START)
    port, sender = free_port(), source.getsockname()[1]
    # Debian keeps it beside the daemons.
    path = os.environ.get("PATH", "") + ":/usr/sbin"
    command = ["gpsd", "-N", "-n", "-b", "-S", str(port), f"tcp://127.0.0.1:{sender}"]
    program = subprocess.Popen(command, env={**os.environ, "PATH": path}, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        device, _ = source.accept()
        client = connected(port)
        client.settimeout(START)
        client.sendall(WATCH)
        told = b""
        # When it has confirmed that, it reads.
        while b'"WATCH"' not in told:
            told += client.recv(1 << 16)
        device.sendall(data)
        client.settimeout(SILENCE)
        try:
            while piece := client.recv(1 << 16):
                told += piece
        except TimeoutError:
            pass
    finally:
        program.terminate()
        program.wait()
    return [message for message in map(json.loads, told.splitlines()) if message["class"] == "TPV"]


def main():
    stream = open(sys.argv[1], "rb") if len(sys.argv) > 1 else sys.stdin.buffer
    for told in fixes(stream.read()):
        print(json.dumps(told))


if __name__ == "__main__":
    main()
