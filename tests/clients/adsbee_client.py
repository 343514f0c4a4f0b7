"""The PyPI package `adsbee` against CONSOLE: its own class on a pseudo-terminal whose other end is standard input and output.

What it found goes to standard error, a JSON line a step. Its waits of some milliseconds last until the device has spoken and is silent again: the twin may be slower
than a device.
"""

import json
import os
import pty
import sys
import threading
import time
import tty

import adsbee.at as at

# Seconds: a reply comes at the latest after the first, and is over after the second without a byte.
REPLY_S, SILENCE_S = 30, 1
sleep = time.sleep
heard = threading.Event()


def wait(seconds):
    if seconds >= 0.1:
        sleep(seconds)
    elif heard.wait(REPLY_S):
        while heard.is_set():
            heard.clear()
            heard.wait(SILENCE_S)


at.time.sleep = wait


def copy(source, target):
    while piece := os.read(source, 4096):
        os.write(target, piece)
        if source == 0:
            heard.set()


def tell(step, found):
    print(json.dumps({"step": step, "found": found}), file=sys.stderr, flush=True)


def main():
    device, port = pty.openpty()
    tty.setraw(port)
    for ends in [(0, device), (device, 1)]:
        threading.Thread(target=copy, args=ends, daemon=True).start()
    with at.ADSBeeAT(os.ttyname(port), serial_timeout_sec=30) as client:
        client.silence_console()
        tell("protocol", client.send_cmd("AT+PROTOCOL?\r\n"))
        tell("info", client.read_device_info())
        tell("save", client.send_cmd("AT+SETTINGS=SAVE\r\n", wait_for_ok_or_error=True))
        tell("dump", client.send_cmd("AT+SETTINGS?DUMP\r\n", wait_for_ok_or_error=True)[-1:])
        tell("help", client.send_cmd("AT+HELP\r\n", delay=0.05)[-1:])
        try:
            client.ota_get_flash_partition()
            tell("ota", "no error")
        except Exception as error:
            tell("ota", str(error).startswith("ERROR response"))


# Its progress is printed where the bytes for the device go.
at.print = lambda *arguments, **options: None
main()
