"""What a flooded, slow or hostile network costs the tick: a served control under each load, its ticks beside it. A load that
did nothing, a tick that needed more than half its time, memory without bound, a client that is not served after the load and
a control that has failed are faults.

flood.py PROGRAM SECONDS [WORDS]

Only loads whose names have WORDS in them, if they are given. PROGRAM is a release build, with the feature opcua for the loads of OPC UA. Each load takes SECONDS, at least 15; those that
wait for a limit of the control take longer. Python needs cryptography for the brokers in TLS.
"""

import base64
import datetime
import json
import os
import re
import socket
import ssl
import struct
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec

program, LEAST_SECONDS = sys.argv[1], int(sys.argv[2])
AGENT, WEB, BROKER, OPCUA = 17878, 18083, 18899, 14840
# A tick is 2 ms; its time is bounded at half of that in 999 of 1000.
LONGEST_TICK_US, MOST_MB = 1000, 160
NODE = "kt830-gc-000001"
data = Path(tempfile.mkdtemp())
faults = []


class Load:
    """Something that is done again and again until an end, by a number of threads; what was done is counted."""

    def __init__(self, act, threads=4, least=50, longer=0):
        self.act, self.threads, self.least, self.seconds = act, threads, least, max(LEAST_SECONDS, longer)
        self.done, self.refused = 0, 0

    def run(self, end):
        while time.monotonic() < end:
            try:
                self.act(end, self)
            except (OSError, ValueError):
                # Refused or closed by the control.
                self.refused += 1
                time.sleep(0.001)

    def begin(self, end):
        started = [threading.Thread(target=self.run, args=(end,)) for _ in range(self.threads)]
        [thread.start() for thread in started]
        return started


def connect(port):
    return socket.create_connection(("127.0.0.1", port), timeout=1)


def connect_once(port):
    for _ in range(200):
        try:
            return connect(port)
        except OSError:
            time.sleep(0.05)
    sys.exit(f"port {port}: nobody listens")


def reader(end, load):
    stream = connect(AGENT)
    while time.monotonic() < end:
        stream.sendall(b"* PING\n")
        if not stream.recv(65536):
            raise ConnectionError
        load.done += 1


def no_reader(end, load):
    """Pings, so that it keeps its place, and reads nothing."""
    stream = connect(AGENT)
    while time.monotonic() < end:
        stream.sendall(b"* PING\n" * 100)
        load.done += 1
        time.sleep(0.01)


def mute(end, load):
    """Says nothing until it is given up."""
    stream = connect(AGENT)
    while time.monotonic() < end:
        try:
            if not stream.recv(65536):
                load.done += 1
                return
        except TimeoutError:
            pass


def connection(end, load):
    connect(AGENT).close()
    load.done += 1


def sends(port, *pieces):
    def act(end, load):
        stream = connect(port)
        for piece in pieces:
            stream.sendall(piece)
            load.done += 1
        while stream.recv(65536):
            pass
    return act


def get(path):
    def act(end, load):
        stream = connect(WEB)
        stream.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
        answer = stream.recv(65536)
        while stream.recv(65536):
            pass
        if not answer.startswith(b"HTTP/1.1 "):
            raise ConnectionError
        load.done += 1
    return act


def handshake(end, load):
    ssl._create_unverified_context().wrap_socket(connect(WEB)).close()
    load.done += 1


def password(end, load):
    stream = ssl._create_unverified_context().wrap_socket(connect(WEB))
    word = base64.b64encode(f"viewer:guess {load.done}".encode()).decode()
    stream.sendall(f"GET / HTTP/1.1\r\nHost: grinder\r\nAuthorization: Basic {word}\r\n\r\n".encode())
    if not stream.recv(1024).startswith(b"HTTP/1.1 401"):
        raise ConnectionError
    load.done += 1


def broker(serve, context=None):
    """A broker of a kind of its own: it takes the connection and then does this."""
    def act(end, load):
        with socket.create_server(("127.0.0.1", BROKER)) as listener:
            listener.settimeout(0.5)
            while time.monotonic() < end:
                try:
                    stream, _ = listener.accept()
                    stream.settimeout(5)
                    stream = context.wrap_socket(stream, server_side=True) if context else stream
                    stream.recv(4096)
                    stream.sendall(b"\x20\x02\x00\x00")
                    serve(stream, end, load)
                except ssl.SSLError:
                    # The control does not take this certificate.
                    load.done += 1
                except OSError:
                    load.refused += 1
    return act


def takes_everything(stream, end, load):
    stream.settimeout(0.5)
    while time.monotonic() < end:
        try:
            told = stream.recv(65536)
        except TimeoutError:
            continue
        if not told:
            raise ConnectionError
        load.done += 1
        # Every ping is answered.
        if told.endswith(b"\xc0\x00"):
            stream.sendall(b"\xd0\x00")


def reads_nothing(stream, end, load):
    load.done += 1
    time.sleep(max(0, min(25, end - time.monotonic())))


def drops(stream, end, load):
    """What a broker does to the client before when another one of the same name comes."""
    stream.close()
    load.done += 1


def packet(topic, payload):
    body = struct.pack(">H", len(topic)) + topic + payload
    size, length = b"", len(body)
    while True:
        length, low = divmod(length, 128)
        size += bytes([low | (0x80 if length else 0)])
        if not length:
            return b"\x30" + size + body


def floods_orders(stream, end, load):
    topic = f"kt830/KT-830/{NODE}/order".encode()
    while time.monotonic() < end:
        orders = b"".join(
            packet(topic, b'{"order":%d,"program":1002,"parts":50}' % (1 + (load.done + at) % 99_000)) for at in range(100))
        stream.sendall(orders)
        load.done += 100


def sends_huge_strings(stream, end, load):
    topic = f"kt830/KT-830/{NODE}/order".encode()
    while time.monotonic() < end:
        stream.sendall(packet(topic, b'{"order":1,"program":"' + b"x" * 60_000 + b'"}'))
        load.done += 1


def sends_garbage(stream, end, load):
    while time.monotonic() < end:
        stream.sendall(os.urandom(65536))
        load.done += 1


def opcua_garbage(end, load):
    address = f"opc.tcp://localhost:{OPCUA}/".encode()
    hello = struct.pack("<6I", 0, 65536, 65536, 0, 0, len(address)) + address
    stream = connect(OPCUA)
    stream.sendall(b"HELF" + struct.pack("<I", 8 + len(hello)) + hello)
    stream.sendall(b"OPNF" + struct.pack("<I", 60_000) + os.urandom(59_992))
    load.done += 1
    while stream.recv(65536):
        pass


def certificates():
    """A broker's certificate of an authority that the control is told to trust, and one of the same name of another one."""
    plain, contexts = serialization.NoEncryption(), []

    def made(name, issuer, key, issuer_key, is_authority):
        named = lambda text: x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, text)])
        now = datetime.datetime.now(datetime.timezone.utc)
        builder = x509.CertificateBuilder(
            named(issuer), named(name), key.public_key(), x509.random_serial_number(), now - datetime.timedelta(days=1),
            now + datetime.timedelta(days=1))
        builder = builder.add_extension(x509.BasicConstraints(is_authority, None), True)
        builder = builder.add_extension(x509.SubjectAlternativeName([x509.DNSName(name)]), False)
        return builder.sign(issuer_key, hashes.SHA256()).public_bytes(serialization.Encoding.PEM)

    for authority in ("ca", "stranger"):
        keys = [ec.generate_private_key(ec.SECP256R1()) for _ in range(2)]
        (data / f"{authority}.pem").write_bytes(made(authority, authority, keys[0], keys[0], True))
        (data / f"{authority}.broker.pem").write_bytes(made("localhost", authority, keys[1], keys[0], False))
        secret = keys[1].private_bytes(serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, plain)
        (data / f"{authority}.broker.key").write_bytes(secret)
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(data / f"{authority}.broker.pem", data / f"{authority}.broker.key")
        contexts.append(context)
    return contexts


trusted, stranger = certificates()
LOADS = {
    "nobody": None,
    "eight agents": Load(reader, 8),
    "agents that read nothing": Load(no_reader),
    # They are given up after 60 s.
    "agents that say nothing": Load(mute, least=4, longer=75),
    "connections without end": Load(connection),
    "garbage": Load(sends(AGENT, *[b"\x00\xff|" * 4096] * 50)),
    "huge strings": Load(sends(AGENT, b"* PING\n* ORDER " + b"x" * 1_000_000, b"* OPCUA " + b"[" * 1_000_000)),
    "state, as fast as it goes": Load(get("/state.json")),
    "pictures, as fast as they go": Load(get("/screen.png")),
    "metrics, as fast as they go": Load(get("/metrics")),
    "requests of 1 MB": Load(sends(WEB, b"GET /" + b"x" * 1_000_000)),
    "TLS, handshakes without end": Load(handshake),
    "TLS, wrong passwords without end": Load(password, least=10),
    "MQTT, a broker that takes everything": Load(broker(takes_everything), 1, least=10),
    "MQTT, no broker": None,
    # It is given up when a ping, 10 s after the connection, is not answered for 10 s.
    "MQTT, a broker that reads nothing": Load(broker(reads_nothing), 1, least=2, longer=50),
    "MQTT, a broker that drops the connection": Load(broker(drops), 1, least=4, longer=40),
    "MQTT, a broker that floods orders": Load(broker(floods_orders), 1),
    "MQTT, huge strings": Load(broker(sends_huge_strings), 1, least=4),
    "MQTT, a broker that sends garbage": Load(broker(sends_garbage), 1, least=4),
    "MQTTS, a broker that takes everything": Load(broker(takes_everything, trusted), 1, least=10),
    "MQTTS, a broker with a wrong certificate": Load(broker(takes_everything, stranger), 1, least=4, longer=40),
    "OPC UA, connections without end": Load(lambda end, load: (connect(OPCUA).close(), setattr(load, "done", load.done + 1))),
    "OPC UA, malformed packets": Load(opcua_garbage),
}


def served(name, seconds):
    tls = f', tls: Some((ca: "ca.pem"))' if "MQTTS" in name else ""
    host = "localhost" if tls else "127.0.0.1"
    (data / "mqtt.ron").write_text(f'(broker: "{host}:{BROKER}"{tls})')
    params = [f"P480={AGENT}", f"P482=1", f"P483={WEB}", f"P484={int('MQTT' in name)}", "P485=1", f"P486={int(name.startswith('TLS'))}"]
    words = [word for param in params for word in ("--param", param)]
    return subprocess.Popen(
        [program, "serve", "assets/stories/first_part.story", "--data", data, *words, "--seconds", str(seconds)],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)


def is_served(name):
    """Whether an agent that comes now is answered within two seconds, and so is a browser of this computer."""
    for _ in range(40):
        try:
            agent = connect(AGENT)
            agent.sendall(b"* PING\n")
            heard = b""
            while b"* PONG" not in heard and (more := agent.recv(65536)):
                heard += more
            if b"* PONG" in heard and (name.startswith("TLS") or json.loads(state_of_machine())["machine"] == NODE):
                return True
        except (OSError, ValueError):
            pass
        time.sleep(0.05)
    return False


def state_of_machine():
    stream = connect(WEB)
    stream.sendall(b"GET /state.json HTTP/1.1\r\nHost: localhost\r\n\r\n")
    heard = b""
    while more := stream.recv(65536):
        heard += more
    return heard.partition(b"\r\n\r\n")[2]


def kilobytes(process):
    return int(re.search(r"VmRSS:\s+(\d+)", Path(f"/proc/{process.pid}/status").read_text()).group(1))


def row(name, load):
    seconds = load.seconds if load else LEAST_SECONDS
    control, others = served(name, seconds), []
    connect_once(AGENT).close()
    if name.startswith("OPC UA"):
        words = ["opcua", "serve", "--control", f"127.0.0.1:{AGENT}", "--listen", f"127.0.0.1:{OPCUA}", "--data", data]
        others.append(subprocess.Popen([program, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
        connect_once(OPCUA).close()
    end = time.monotonic() + seconds - 6
    threads = load.begin(end) if load else []
    time.sleep(max(0, end - time.monotonic() - 0.5))
    memory = [kilobytes(process) // 1024 for process in (control, *others)]
    alive = all(process.poll() is None for process in (control, *others))
    [thread.join() for thread in threads]
    wrong = [] if is_served(name) else ["a client is not served after it"]
    [process.kill() for process in others]
    told = control.communicate()[0].strip()
    times = [int(number) for number in re.findall(r"(\d+) µs", told)]
    done, least = (load.done, load.least) if load else (0, 0)
    wrong += [
        words for words, holds in (
            (f"{done} acts, not {least}", done >= least),
            ("a process has ended", alive and control.returncode == 0 and len(times) == 4),
            ("a tick needs too long", len(times) == 4 and times[2] <= LONGEST_TICK_US),
            (f"more than {MOST_MB} MB", max(memory) <= MOST_MB),
        ) if not holds
    ]
    faults.extend(f"{name}: {words}" for words in wrong)
    ticks = " | ".join(f"{number} µs" for number in times)
    acts = f"{load.done} ({load.refused} refused)" if load else ""
    print(f"| {name} | {acts} | {ticks} | {' + '.join(map(str, memory))} MB |" + "".join(f" FAILED: {words}" for words in wrong), flush=True)


has_opcua = subprocess.run([program, "opcua", "status", "--data", data], capture_output=True).returncode != 2
subprocess.run([program, "web-access", "localhost", "--data", data], input="correct horse\n", text=True, check=True)
print("| load | acts | 50 % | 99 % | 99.9 % | longest | memory |\n|---|---|---|---|---|---|---|")
for name, load in LOADS.items():
    if len(sys.argv) > 3 and sys.argv[3] not in name:
        continue
    if name.startswith("OPC UA") and not has_opcua:
        faults.append(f"{name}: the program has no OPC UA; nothing was tested")
        continue
    row(name, load)
print(f"{len(faults)} faults: {faults}")
sys.exit(1 if faults else 0)
