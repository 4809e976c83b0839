"""A fleet of controls against a broker and a decoder that were not written here: every control is born, its messages are
numbered without a gap, alarms are raised and cleared, and every finished part arrives, also over restarts of the broker.

sparkplug.py PROGRAM MACHINES SECONDS RESTARTS

Needs mosquitto, and Python with pysparkplug, which brings paho-mqtt 1.6.
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
GROUP = "hall 2"
work = Path(tempfile.mkdtemp())
(work / "mosquitto.conf").write_text(
    f"listener {PORT} 127.0.0.1\nallow_anonymous true\npersistence true\npersistence_location {work}/\n"
    "autosave_interval 1\nmax_queued_messages 0\nuser root\n"
)


def start_broker():
    command = ["mosquitto", "-c", str(work / "mosquitto.conf")]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


class Listener:
    """What an application sees."""

    def __init__(self):
        self.lock = threading.Lock()
        self.births, self.sequence, self.gaps, self.unsure = {}, {}, [], set()
        self.deaths, self.historical, self.bytes, self.messages = 0, 0, 0, 0
        self.raised, self.cleared = set(), set()
        self.parts = defaultdict(list)
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
                    told = json.loads(message.payload)
                    self.parts[told["machine"]].append(told["part"])
                else:
                    self.sparkplug(message, now)
            # Whatever is wrong is a fault of the control.
            except Exception as fault:
                self.faults.append(f"{message.topic}: {fault!r}")

    def sparkplug(self, message, now):
        _, group, kind, node = message.topic.split("/")
        assert group == GROUP, message.topic
        if kind == "NBIRTH":
            birth = pysparkplug.NBirth.decode(message.payload)
            assert birth.seq == 0, birth.seq
            self.births[node], self.sequence[node] = birth, 0
            self.unsure.discard(node)
        elif kind == "NDATA" and node in self.births:
            data = pysparkplug.NData.decode(message.payload, birth=self.births[node])
            if node in self.sequence and data.seq != (self.sequence[node] + 1) % 256:
                self.gaps.append((node, self.sequence[node], data.seq))
            self.sequence[node] = data.seq
            for metric in data.metrics:
                self.historical += bool(metric.is_historical)
                if metric.name.startswith("c_") and not metric.name.endswith(("_number", "_text")):
                    (self.cleared if metric.value == "NORMAL" else self.raised).add(metric.name)
            if not any(metric.is_historical for metric in data.metrics):
                self.delays.append(1000 * now - data.timestamp)
        elif kind == "NDEATH":
            death = pysparkplug.NDeath.decode(message.payload)
            born = next((metric.value for metric in self.births[node].metrics if metric.name == "bdSeq"), None)
            # A death of an earlier connection may come after the birth of the next one.
            assert node in self.unsure or (born - death.bd_seq_metric.value) % 256 <= 1, (node, born, death)
            self.deaths += 1


def failed(words):
    print(f"  FAILED: {words}")
    sys.exit(1)


broker = start_broker()
time.sleep(1)
listener = Listener()
fleet = subprocess.Popen(
    [program, "fleet", "assets/stories/first_part.story", "--broker", f"127.0.0.1:{PORT}", "--group", GROUP]
    + ["--machines", str(machines), "--seconds", str(seconds)],
    stdout=subprocess.PIPE,
    text=True,
)
memory = 0
begun = time.monotonic()
for restart in range(restarts):
    time.sleep(max(0, begun + seconds * (restart + 1) / (restarts + 1) - time.monotonic()))
    broker.send_signal(signal.SIGTERM)
    broker.wait()
    time.sleep(5)
    broker = start_broker()
while fleet.poll() is None:
    try:
        memory = int(re.search(r"VmRSS:\s+(\d+)", Path(f"/proc/{fleet.pid}/status").read_text()).group(1))
    except (OSError, AttributeError):
        pass
    time.sleep(1)
told = dict(line.rsplit(": ", 1) for line in fleet.stdout.read().splitlines())
time.sleep(3)
listener.client.disconnect()
listener.client.loop_stop()
broker.terminate()

used = resource.getrusage(resource.RUSAGE_CHILDREN)
if fleet.returncode:
    failed(f"the fleet ended with {fleet.returncode}: {told}")
if len(listener.births) != machines:
    failed(f"{len(listener.births)} of {machines} machines were born")
if listener.faults:
    failed(f"{len(listener.faults)} messages: {listener.faults[:3]}")
if listener.gaps:
    failed(f"messages are missing: {listener.gaps[:5]}")
for machine, parts in listener.parts.items():
    if sorted(set(parts)) != list(range(1, max(parts) + 1)):
        failed(f"{machine}: parts {parts}")
unique = sum(len(set(parts)) for parts in listener.parts.values())
repeated = sum(len(parts) for parts in listener.parts.values()) - unique
if unique != int(told["parts"]):
    failed(f"{unique} of {told['parts']} parts")
if listener.raised - listener.cleared or "c_drives" not in listener.raised:
    failed(f"raised {listener.raised}, cleared {listener.cleared}")
delays = sorted(listener.delays)
at = lambda share: round(delays[int(share * (len(delays) - 1))], 1)
print(f"  {machines} machines, {seconds} s, broker restarted {restarts} times: {told}")
print(f"  {unique} parts, none missing, {repeated} told twice (same number); {listener.deaths} deaths, "
      f"{listener.historical} changes told later; conditions raised and cleared: {sorted(listener.raised)}")
print(f"  {listener.messages} messages, {listener.bytes} bytes; delay of data: 50 % {at(0.5)} ms, 99 % {at(0.99)} ms, "
      f"longest {delays[-1]:.1f} ms")
print(f"  per machine: {1000 * (used.ru_utime + used.ru_stime) / machines / seconds / 10:.2f} % of a core (broker "
      f"included), {memory / machines:.0f} kB")
