"""A fleet of controls against a broker and a decoder that were not written here: every control is born, its messages are
numbered without a gap, every finished part arrives once, also over restarts of the broker; alarms of every condition and
values are those of a story; an order goes through a broker in TLS and comes back as a part; two controls of one number do no
harm.

sparkplug.py PROGRAM MACHINES SECONDS RESTARTS

Needs mosquitto, openssl, and Python with pysparkplug, which brings paho-mqtt 1.6.
"""

import json
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import defaultdict
from pathlib import Path

import paho.mqtt.client as mqtt
import pysparkplug

program, machines, seconds, restarts = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4])
PORT = int(os.environ.get("KT830_MQTT_PORT", "18831"))
TLS_PORT = PORT + 1
GROUP = "hall 2"
CONDITIONS = {
    "c_system", "c_communications", "c_logic", "c_motion", "c_drives", "c_spindle", "c_hydraulic", "c_coolant", "c_lubrication"
}
work = Path(tempfile.mkdtemp())
faults = []


def check(holds, what):
    print(("ok    " if holds else "FAIL  ") + what, flush=True)
    if not holds:
        faults.append(what)


def openssl(*words):
    subprocess.run(["openssl", *map(str, words)], check=True, capture_output=True)


def make_certificates():
    """An authority, and certificates of it for the broker and for a machine."""
    openssl("req", "-x509", "-newkey", "rsa:2048", "-nodes", "-keyout", work / "ca.key", "-out", work / "ca.pem",
            "-days", 2, "-subj", "/CN=shop", "-addext", "basicConstraints=critical,CA:TRUE")
    for name in ("broker", "machine"):
        openssl("req", "-newkey", "rsa:2048", "-nodes", "-keyout", work / f"{name}.key", "-out", work / f"{name}.csr",
                "-subj", f"/CN={name}")
        (work / "names").write_text("subjectAltName=DNS:localhost\n")
        openssl("x509", "-req", "-in", work / f"{name}.csr", "-CA", work / "ca.pem", "-CAkey", work / "ca.key", "-days", 2,
                "-extfile", work / "names", "-out", work / f"{name}.pem")


make_certificates()
(work / "mosquitto.conf").write_text(
    f"per_listener_settings false\nlistener {PORT} 127.0.0.1\nallow_anonymous true\npersistence true\n"
    f"persistence_location {work}/\nautosave_interval 1\nmax_queued_messages 0\nuser root\n"
    f"listener {TLS_PORT} 127.0.0.1\ncafile {work}/ca.pem\ncertfile {work}/broker.pem\nkeyfile {work}/broker.key\n"
    "require_certificate true\n"
)


def start_broker():
    command = ["mosquitto", "-c", str(work / "mosquitto.conf")]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


class Listener:
    """What an application sees."""

    def __init__(self):
        self.lock = threading.Lock()
        self.births, self.born, self.sequence, self.gaps, self.unsure = {}, defaultdict(int), {}, [], set()
        self.deaths, self.historical, self.bytes, self.messages = 0, 0, 0, 0
        self.raised, self.cleared, self.values = defaultdict(set), defaultdict(set), defaultdict(list)
        self.parts, self.results = defaultdict(list), []
        self.answers, self.orders = [], {}
        self.delays = []
        self.faults = []
        # Each part is remembered by the broker for this client, however often either is restarted.
        self.client = mqtt.Client("application", clean_session=False)
        self.client.on_message = self.on_message
        self.client.on_connect = self.on_connect
        self.client.reconnect_delay_set(1, 1)
        self.client.connect("127.0.0.1", PORT)
        self.client.loop_start()

    def on_connect(self, client, userdata, flags, code):
        client.subscribe([("spBv1.0/#", 0), ("kt830/#", 1)])
        # What was missed while it was away is not a gap; a machine may have been born meanwhile.
        with self.lock:
            self.sequence.clear()
            self.unsure = set(self.births)

    def on_message(self, client, userdata, message):
        now = time.time()
        with self.lock:
            self.messages += 1
            self.bytes += len(message.payload) + len(message.topic)
            try:
                if message.topic.startswith("kt830/"):
                    self.own(message)
                else:
                    self.sparkplug(message, now)
            # Whatever is wrong is a fault of the control.
            except Exception as fault:
                self.faults.append(f"{message.topic}: {fault!r}")

    def own(self, message):
        _, _, node, topic = message.topic.split("/", 3)
        told = json.loads(message.payload) if message.payload else None
        if topic == "part":
            assert told["machine"] == node, told
            self.parts[node].append(told["part"])
            self.results.append(told)
        elif topic == "order/answer":
            self.answers.append(told)
        elif topic == "orders":
            self.orders[node] = told

    def sparkplug(self, message, now):
        _, group, kind, node = message.topic.split("/")
        assert group == GROUP, message.topic
        if kind == "NBIRTH":
            birth = pysparkplug.NBirth.decode(message.payload)
            assert birth.seq == 0, birth.seq
            self.births[node], self.sequence[node] = birth, 0
            self.born[node] += 1
            self.unsure.discard(node)
            self.take(node, birth.metrics)
        elif kind == "NDATA" and node in self.births:
            data = pysparkplug.NData.decode(message.payload, birth=self.births[node])
            if node in self.sequence and data.seq != (self.sequence[node] + 1) % 256:
                self.gaps.append((node, self.sequence[node], data.seq))
            self.sequence[node] = data.seq
            self.take(node, data.metrics)
            if not any(metric.is_historical for metric in data.metrics):
                self.delays.append(1000 * now - data.timestamp)
        elif kind == "NDEATH":
            death = pysparkplug.NDeath.decode(message.payload)
            self.deaths += 1
            if node not in self.births:
                # Another one of its name came before it was born.
                return
            born = next((metric.value for metric in self.births[node].metrics if metric.name == "bdSeq"), None)
            # A death of an earlier connection may come after the birth of the next one.
            assert node in self.unsure or (born - death.bd_seq_metric.value) % 256 <= 1, (node, born, death)

    def take(self, node, metrics):
        for metric in metrics:
            self.historical += bool(metric.is_historical)
            self.values[node, metric.name].append(metric.value)
            if metric.name in CONDITIONS:
                (self.cleared if metric.value == "NORMAL" else self.raised)[node].add(metric.name)

    def wait(self, holds, longest):
        end = time.monotonic() + longest
        while time.monotonic() < end:
            with self.lock:
                if holds():
                    return True
            time.sleep(0.1)
        return False


def fleet(*words):
    command = [program, "fleet", *map(str, words), "--broker", f"127.0.0.1:{PORT}", "--group", GROUP]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def serve(data, number, *words):
    """A control of its own, with a broker in TLS that asks for the certificate of the machine."""
    data.mkdir(exist_ok=True)
    for name in ("ca.pem", "machine.pem", "machine.key"):
        (data / name).write_bytes((work / name).read_bytes())
    tls = 'Some((ca: "ca.pem", machine: Some(("machine.pem", "machine.key"))))'
    (data / "mqtt.ron").write_text(f'(broker: "localhost:{TLS_PORT}", group: "{GROUP}", tls: {tls})')
    params = ["--param", f"P482={number}", "--param", "P484=1", "--param", "P485=1"]
    log = (data / "said").open("w")
    return subprocess.Popen([program, "serve", *map(str, words), "--data", data, *params], stdout=log, stderr=log)


def scale():
    """Many machines, and a broker that is restarted: killed the first time, ended in good order the next ones."""
    global broker
    control = fleet("assets/stories/first_part.story", "--machines", machines, "--for", seconds)
    memory, begun = 0, time.monotonic()
    for restart in range(restarts):
        time.sleep(max(0, begun + seconds * (restart + 1) / (restarts + 1) - time.monotonic()))
        broker.send_signal(signal.SIGTERM if restart else signal.SIGKILL)
        broker.wait()
        time.sleep(5)
        broker = start_broker()
    while control.poll() is None:
        try:
            status = Path(f"/proc/{control.pid}/status").read_text()
            memory = max(memory, int(re.search(r"VmRSS:\s+(\d+)", status).group(1)))
        except (OSError, AttributeError):
            pass
        time.sleep(1)
    told = dict(line.rsplit(": ", 1) for line in control.stdout.read().splitlines())
    time.sleep(3)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    check(control.returncode == 0, f"the fleet: {told}")
    check(len(listener.births) == machines, f"{len(listener.births)} of {machines} machines were born")
    check(not listener.gaps, f"no message is missing: {listener.gaps[:5]}")
    for machine, parts in listener.parts.items():
        if sorted(set(parts)) != list(range(1, max(parts) + 1)):
            check(False, f"{machine}: parts {parts}")
    unique = sum(len(set(parts)) for parts in listener.parts.values())
    repeated = sum(len(parts) for parts in listener.parts.values()) - unique
    check(unique == int(told["parts"]) and unique >= machines, f"{unique} of {told['parts']} parts")
    check(repeated == 0, f"{repeated} parts were told twice")
    check(all(told["wheel_mm"] and told["cycle_s"] > 0 for told in listener.results), "each with its wheel and its time")
    delays = sorted(listener.delays)
    at = lambda share: round(delays[int(share * (len(delays) - 1))], 1)
    print(f"  {machines} machines, {seconds} s, broker restarted {restarts} times; {listener.deaths} deaths, "
          f"{listener.historical} changes told later")
    print(f"  {listener.messages} messages, {listener.bytes} bytes; from the tick to the client 50 % {at(0.5)} ms, "
          f"99 % {at(0.99)} ms, longest {delays[-1]:.1f} ms")
    print(f"  per machine: {1000 * (used.ru_utime + used.ru_stime) / machines / seconds / 10:.2f} % of a core (without the "
          f"last run of the broker), {memory / machines:.0f} kB")


def whole():
    """The values and alarms of a story, as an application sees them."""
    node = "kt830-gc-000001"
    listener.values.clear(), listener.raised.clear(), listener.cleared.clear(), listener.results.clear()
    control = fleet("tests/shop/whole.story", "--programs", "tests/shop/programs", "--machines", 1, "--for", 90)
    control.wait()
    time.sleep(1)
    for condition in sorted(CONDITIONS):
        check(condition in listener.raised[node] and condition in listener.cleared[node], f"{condition} comes and goes")
    for name, true, tolerance in (
        ("x_work", -61.5, 0.002), ("z_work", -20.0, 0.002), ("part_size", 39.9985, 1e-9), ("part_nominal", 40.0, 1e-9),
        ("part_lower_limit", 39.995, 1e-9), ("part_upper_limit", 40.0, 1e-9),
    ):
        told = [value for value in listener.values[node, name] if value is not None]
        check(any(abs(value - true) <= tolerance for value in told), f"{name} {true}: {told[-3:]}")
    result = next((told for told in listener.results if told["machine"] == node), {})
    found = [result.get(name) for name in ("size_mm", "nominal_mm", "min_mm", "max_mm", "verdict", "is_bad", "wheel_mm")]
    check(found == [39.9985, 40.0, 39.995, 40.0, "ok", False, 600.0], f"result {found}")


def order():
    """From the order to the part: proposed over TLS, accepted, its size taken over, ground."""
    node = "kt830-gc-000900"
    topic = f"kt830/{GROUP}/{node}/order"
    send = lambda text, retain=False: listener.client.publish(topic, text, qos=1, retain=retain)
    send(json.dumps({"order": 702, "program": 1002, "parts": 1}), retain=True)
    control = serve(work / "order", 900, "tests/shop/order.story")
    check(listener.wait(lambda: node in listener.births, 20), "a machine in TLS with its own certificate")
    refused = lambda: [answer for answer in listener.answers if not answer["proposed"]]
    check(listener.wait(refused, 10), f"an order that the broker had kept is refused: {listener.answers}")
    send("", retain=True)
    proposed = {"order": 701, "program": 1002, "parts": 1, "values": {"#521": 39.95}}
    send(json.dumps(proposed))
    taken = lambda: [answer for answer in listener.answers if answer["order"] == 701 and answer["proposed"]]
    check(listener.wait(taken, 10), f"another one is proposed: {listener.answers}")
    result = lambda: [told for told in listener.results if told["machine"] == node]
    check(listener.wait(result, 180), "the part arrives")
    told = (result() or [{}])[-1]
    check(told.get("order") == 701 and told.get("nominal_mm") == 39.95, f"of its order, to its size: {told}")
    closed = lambda: [o for o in listener.orders.get(node) or [] if o["order"] == 701 and o["good"] + o["bad"] == 1]
    check(listener.wait(closed, 20), f"the list of orders counts it: {listener.orders.get(node)}")
    control.kill()
    # The lost connection is told by the broker.
    control.wait()


def rebirth():
    """The command that asks for another birth."""
    metric = pysparkplug.Metric(timestamp=0, name="Node Control/Rebirth", datatype=pysparkplug.DataType.BOOLEAN, value=True)
    return pysparkplug.NCmd(timestamp=0, metrics=(metric,)).encode()


def twins():
    """Two controls of one number: the broker ends one after the other, neither fails, and neither fills the broker."""
    node = "kt830-gc-000901"
    controls = [serve(work / f"twin {at}", 901) for at in range(2)]
    begun = time.monotonic()
    time.sleep(60)
    born = listener.born[node]
    check(all(control.poll() is None for control in controls), "both go on")
    check(4 <= born <= 60, f"born {born} times in {time.monotonic() - begun:.0f} s")
    controls[0].kill()
    time.sleep(35)
    born, told = listener.born[node], len(listener.values[node, "bdSeq"])
    time.sleep(20)
    check(listener.born[node] == born and controls[1].poll() is None, f"alone it stays: born {listener.born[node] - born} times more")
    listener.client.publish(f"spBv1.0/{GROUP}/NCMD/{node}", rebirth(), qos=1)
    check(listener.wait(lambda: len(listener.values[node, "bdSeq"]) > told, 10), "and answers")
    controls[1].kill()
    [control.wait() for control in controls]


broker = start_broker()
time.sleep(1)
listener = Listener()
try:
    for run in (scale, whole, order, twins):
        print(run.__name__, flush=True)
        run()
    check(not listener.faults, f"{len(listener.faults)} wrong messages: {listener.faults[:3]}")
finally:
    listener.client.disconnect()
    listener.client.loop_stop()
    broker.terminate()
print(f"{len(faults)} faults")
sys.exit(1 if faults else 0)
