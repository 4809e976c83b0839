"""What a flooded, slow or hostile network costs the tick: a served control under each load, its ticks beside it.

flood.py PROGRAM SECONDS
"""

import base64
import os
import socket
import ssl
import struct
import subprocess
import sys
import tempfile
import threading
import time

program, seconds = sys.argv[1], int(sys.argv[2])
AGENT, WEB, BROKER = 17878, 18083, 18899
data = tempfile.mkdtemp()


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


def handshakes(end):
    context = ssl._create_unverified_context()
    until(end, lambda: context.wrap_socket(connect(WEB)).close())


def passwords(end):
    context, count = ssl._create_unverified_context(), 0

    def act():
        nonlocal count
        count += 1
        stream = context.wrap_socket(connect(WEB))
        word = base64.b64encode(f"viewer:guess {count}".encode()).decode()
        stream.sendall(f"GET / HTTP/1.1\r\nHost: grinder\r\nAuthorization: Basic {word}\r\n\r\n".encode())
        stream.recv(1024)
    until(end, act)


def broker(serve):
    """A broker of a kind of its own: it takes the connection and then does this."""
    def run(end):
        listener = socket.create_server(("127.0.0.1", BROKER))
        listener.settimeout(0.5)

        def act():
            stream, _ = listener.accept()
            stream.settimeout(0.5)
            stream.recv(4096)
            stream.sendall(b"\x20\x02\x00\x00")
            serve(stream, end)
        until(end, act)
        listener.close()
    return run


def takes_everything(stream, end):
    def act():
        told = stream.recv(65536)
        if not told:
            raise ConnectionError
        # Every ping is answered.
        if b"\xc0\x00" in told:
            stream.sendall(b"\xd0\x00")
    until(end, act)


def reads_nothing(stream, end):
    time.sleep(max(0, end - time.monotonic()))


def floods_orders(stream, end):
    topic, number = b"kt830/KT-830/kt830-gc-000000/order", 0

    def act():
        nonlocal number
        for _ in range(100):
            number += 1
            body = struct.pack(">H", len(topic)) + topic + b'{"order":%d,"program":1002,"parts":50}' % (number % 100_000)
            length = len(body)
            stream.sendall(bytes([0x30, length % 128 | 0x80 if length > 127 else length]) + (bytes([length // 128]) if length > 127 else b"") + body)
    while time.monotonic() < end:
        act()


def sends_garbage(stream, end):
    while time.monotonic() < end:
        stream.sendall(os.urandom(65536))


LOADS = {
    "nobody": [],
    "eight agents": [reader] * 8,
    "agents that do not read": [no_reader] * 4,
    "connections without end": [connections] * 4,
    "garbage": [garbage] * 4,
    "state, as fast as it goes": [lambda end: until(end, get("/state.json"))] * 4,
    "pictures, as fast as they go": [lambda end: until(end, get("/screen.png"))] * 4,
    "metrics, as fast as they go": [lambda end: until(end, get("/metrics"))] * 4,
    "TLS, handshakes without end": [handshakes] * 4,
    "TLS, wrong passwords without end": [passwords] * 4,
    "MQTT, a broker that takes everything": [broker(takes_everything)],
    "MQTT, no broker": [lambda end: None],
    "MQTT, a broker that reads nothing": [broker(reads_nothing)],
    "MQTT, a broker that floods orders": [broker(floods_orders)],
    "MQTT, a broker that sends garbage": [broker(sends_garbage)],
}
with open(f"{data}/mqtt.ron", "w") as settings:
    settings.write(f'(broker: "127.0.0.1:{BROKER}")')
subprocess.run([program, "web-access", "localhost", "--data", data], input="correct horse\n", text=True, check=True)

for name, loads in LOADS.items():
    params = [f"P480={AGENT}", f"P483={WEB}", f"P484={int('MQTT' in name)}", "P485=1", f"P486={int('TLS' in name)}"]
    words = [word for param in params for word in ("--param", param)]
    served = subprocess.Popen(
        [program, "serve", "assets/stories/first_part.story", "--data", data, *words, "--seconds", str(seconds)],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    connect_once(AGENT).close()
    end = time.monotonic() + seconds - 3
    threads = [threading.Thread(target=load, args=(end,)) for load in loads]
    [thread.start() for thread in threads]
    time.sleep(max(0, end - time.monotonic() - 0.5))
    with open(f"/proc/{served.pid}/status") as status:
        memory = next(line.split()[1] for line in status if line.startswith("VmRSS"))
    print(f"| {name} | {served.communicate()[0].strip().removeprefix('ticks: ')} | {int(memory) // 1024} MB |", flush=True)
    [thread.join() for thread in threads]
