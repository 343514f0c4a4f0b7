"""What dump1090-mutability (Debian) understands of Beast or raw text: every frame that it takes and sends on.

usage: dump1090_client.py beast|raw [FILE]

Reads bytes from a file or standard input, gives them to a dump1090-mutability on a free port of this machine, and prints each frame that comes out
of its raw output as one JSON line: {"frame": "8D4CA7E8..."}. It forwards frames whose parity it accepts, repairs none here, and (--net-verbatim)
does not wait for an aircraft's second frame.
"""

import json
import subprocess
import sys
import threading
import time

from loopback import connected, free_port

INPUT = {"beast": "--net-bi-port", "raw": "--net-ri-port"}
ALL_PORTS = ["--net-ri-port", "--net-ro-port", "--net-bi-port", "--net-bo-port", "--net-sbs-port", "--net-http-port"]
# Seconds of silence after which all has come.
SILENCE = 3.0


def frames(data, form):
    ports = {INPUT[form]: free_port(), "--net-ro-port": free_port()}
    command = ["dump1090-mutability", "--net-only", "--no-fix", "--net-verbatim", "--net-bind-address", "127.0.0.1", "--net-ro-interval", "0", "--net-ro-size", "0"]
    for name in ALL_PORTS:
        command += [name, str(ports.get(name, 0))]
    program = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        out = connected(ports["--net-ro-port"])
        out.settimeout(SILENCE)
        into = connected(ports[INPUT[form]])
        # Both connections are accepted before anything is sent.
        time.sleep(0.5)
        threading.Thread(target=into.sendall, args=(data,), daemon=True).start()
        received = b""
        try:
            while piece := out.recv(1 << 16):
                received += piece
        except TimeoutError:
            pass
    finally:
        program.terminate()
        program.wait()
    for line in received.split():
        # Between frames it sends frames of zeros as a sign of life.
        if line.strip(b"*;").strip(b"0"):
            yield {"frame": line.strip(b"*;").decode("ascii").upper()}


def main():
    stream = open(sys.argv[2], "rb") if len(sys.argv) > 2 else sys.stdin.buffer
    for told in frames(stream.read(), sys.argv[1]):
        print(json.dumps(told))


if __name__ == "__main__":
    main()
