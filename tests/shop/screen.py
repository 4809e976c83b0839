"""What a flooded network costs the screen: the time from a touch until the page has changed, in a real window, without and with
loads on all ports.

screen.py PROGRAM

Needs Xvfb, xdotool, and Python with mss; PROGRAM is a release build.
"""

import os
import random
import socket
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import mss

program = sys.argv[1]
AGENT, WEB, BROKER, DISPLAY = 17879, 18084, 18898, ":79"
KEYS = 40
# Places of two soft keys of the first row.
SOFT_KEYS = ["156", "260"]
# A screen that needs longer than this is noticed.
LONGEST_MS = 500
data = Path(tempfile.mkdtemp())
(data / "mqtt.ron").write_text(f'(broker: "127.0.0.1:{BROKER}")')
environment = os.environ | {"DISPLAY": DISPLAY, "LIBGL_ALWAYS_SOFTWARE": "1"}


def connect(port):
    return socket.create_connection(("127.0.0.1", port), timeout=1)


def ask(path):
    stream = connect(WEB)
    stream.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
    while stream.recv(65536):
        pass


def garbage():
    stream = connect(AGENT)
    for _ in range(20):
        stream.sendall(random.randbytes(16384))


def broker():
    """Takes the connection and sends garbage until it is given up."""
    with socket.create_server(("127.0.0.1", BROKER)) as listener:
        listener.settimeout(1)
        stream, _ = listener.accept()
        stream.recv(4096)
        stream.sendall(b"\x20\x02\x00\x00")
        while True:
            stream.sendall(random.randbytes(65536))


LOADS = {
    "state": lambda: ask("/state.json"), "pictures": lambda: ask("/screen.png"), "connections": lambda: connect(AGENT).close(),
    "garbage": garbage, "a broker that sends garbage": broker,
}


def flood(name, over, counts):
    while not over.is_set():
        try:
            LOADS[name]()
            counts[name] += 1
        except OSError:
            # The control has closed it: what was sent has come.
            counts[name] += name in ("garbage", "a broker that sends garbage")
        time.sleep(0)


def answers(screen):
    """Milliseconds from each touch until the title of the page is another one."""
    head, times = {"left": 0, "top": 50, "width": 300, "height": 40}, []
    for at in range(KEYS):
        before = screen.grab(head).raw
        begun = time.monotonic()
        touch = ["xdotool", "mousemove", SOFT_KEYS[at % 2], "741", "click", "1"]
        subprocess.run(touch, env=environment, check=True)
        while screen.grab(head).raw == before:
            if time.monotonic() > begun + 5:
                sys.exit("the window does not answer")
            time.sleep(0.001)
        times.append(1000 * (time.monotonic() - begun))
        time.sleep(0.2)
    return sorted(times)


display = subprocess.Popen(["Xvfb", DISPLAY, "-screen", "0", "1024x768x24"], stderr=subprocess.DEVNULL)
time.sleep(1)
params = [f"P480={AGENT}", "P482=1", f"P483={WEB}", "P484=1"]
words = [word for param in params for word in ("--param", param)]
window = subprocess.Popen(
    [program, "--kind", "gc", "--data", data, "--lang", "en", *words], env=environment, stderr=subprocess.DEVNULL)
longest = {}
try:
    time.sleep(8)
    with mss.MSS(display=DISPLAY) as screen:
        for name in ("nobody", "all ports flooded"):
            over, counts = threading.Event(), dict.fromkeys(LOADS if name != "nobody" else (), 0)
            threads = [threading.Thread(target=flood, args=(load, over, counts)) for load in counts]
            [thread.start() for thread in threads]
            times = answers(screen)
            over.set()
            [thread.join() for thread in threads]
            longest[name] = times[-1] if all(counts.values()) else float("inf")
            print(f"| {name} | {counts} | {times[KEYS // 2]:.0f} ms | {times[-2]:.0f} ms | {times[-1]:.0f} ms |", flush=True)
finally:
    window.kill()
    display.kill()
sys.exit(0 if all(time <= LONGEST_MS for time in longest.values()) else 1)
