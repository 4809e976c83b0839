"""What a flooded, slow or hostile network costs the tick: a served control under each load, its ticks beside it.

flood.py PROGRAM SECONDS
"""

import socket
import subprocess
import sys
import threading
import time

program, seconds = sys.argv[1], int(sys.argv[2])
AGENT, WEB = 17878, 18083


def connect(port):
    return socket.create_connection(("127.0.0.1", port), timeout=1)


def connect_once(port):
    for _ in range(200):
        try:
            return connect(port)
        except OSError:
            time.sleep(0.05)
    sys.exit(f"port {port}: nobody listens")


def until(end, act):
    while time.monotonic() < end:
        try:
            act()
        except OSError:
            pass


def reader(end):
    stream = connect_once(AGENT)
    stream.settimeout(0.5)

    def act():
        stream.sendall(b"* PING\n")
        stream.recv(65536)
    until(end, act)


def no_reader(end):
    streams = []
    until(end, lambda: (streams.append(connect(AGENT)), time.sleep(0.05)))


def connections(end):
    until(end, lambda: connect(AGENT).close())


def garbage(end):
    def act():
        stream = connect(AGENT)
        for _ in range(50):
            stream.sendall(b"\x00\xff|" * 4096)
    until(end, act)


def get(path):
    def act():
        stream = connect(WEB)
        stream.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
        while stream.recv(65536):
            pass
    return act


LOADS = {
    "nobody": [],
    "eight agents": [reader] * 8,
    "agents that do not read": [no_reader] * 4,
    "connections without end": [connections] * 4,
    "garbage": [garbage] * 4,
    "state, as fast as it goes": [lambda end: until(end, get("/state.json"))] * 4,
    "pictures, as fast as they go": [lambda end: until(end, get("/screen.png"))] * 4,
}

for name, loads in LOADS.items():
    served = subprocess.Popen(
        [program, "serve", "assets/stories/first_part.story", "--param", f"P480={AGENT}", "--param", f"P483={WEB}",
         "--seconds", str(seconds)], stdout=subprocess.PIPE, text=True)
    connect_once(AGENT).close()
    end = time.monotonic() + seconds - 3
    threads = [threading.Thread(target=load, args=(end,)) for load in loads]
    [thread.start() for thread in threads]
    time.sleep(max(0, end - time.monotonic() - 0.5))
    with open(f"/proc/{served.pid}/status") as status:
        memory = next(line.split()[1] for line in status if line.startswith("VmRSS"))
    print(f"| {name} | {served.communicate()[0].strip().removeprefix('ticks: ')} | {int(memory) // 1024} MB |", flush=True)
    [thread.join() for thread in threads]
