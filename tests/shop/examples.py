"""The examples in docs/shop: their syntax, that every file is there which another one names, and that the columns of the
database are the fields of a part's result. With promtool the configuration of Prometheus, too.

Needs Python 3.11 with PyYAML, and mosquitto.
"""

import json
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

import yaml

root = Path(__file__).parents[2]
shop = root / "docs" / "shop"
faults = []


def check(holds, what):
    print(("ok    " if holds else "FAIL  ") + what)
    if not holds:
        faults.append(what)


compose = yaml.safe_load((shop / "compose.yaml").read_text())
volumes = set(compose["volumes"])
for name, service in compose["services"].items():
    check(re.fullmatch(r"[a-z0-9./-]+:v?[0-9][\w.-]*", service["image"]), f"{name}: an image with its version")
    for volume in service.get("volumes", []):
        source = volume.split(":")[0]
        there = (shop / source).exists() if source.startswith(".") else source in volumes
        check(there, f"{name}: {source}")
    for other in service.get("depends_on", {}):
        check(other in compose["services"], f"{name} needs {other}")

telegraf = tomllib.loads((shop / "telegraf.conf").read_text())
consumer = telegraf["inputs"]["mqtt_consumer"][0]
check(consumer["topics"] == ["kt830/+/+/part"] and consumer["persistent_session"], "results of parts, also later")
parsed = consumer["json_v2"][0]["object"][0]

source = (root / "src/gateway/mqtt/part_outbox.rs").read_text()
body = source[source.index("struct PartResultMessage") :].split("}")[0]
fields = dict(re.findall(r"^    (\w+): (.*),$", body, re.M))
table = (shop / "parts.sql").read_text()
columns = dict(re.findall(r'^    "?(\w+)"? (timestamptz|text|bigint|double precision|boolean)', table, re.M))
check(set(columns) - {"time"} == set(fields), f"columns are fields: {sorted(set(columns) ^ set(fields))}")
kinds = {"u64": "bigint", "u32": "bigint", "f64": "double precision", "bool": "boolean"}
for name, kind in fields.items():
    wanted = kinds.get(kind.removeprefix("Option<").removesuffix(">"), "text")
    check(columns.get(name) == wanted, f"{name} is {wanted}")
integers = {name for name, kind in columns.items() if kind == "bigint"}
check(set(parsed["fields"]) == integers, f"integers are read as such: {sorted(integers)}")
check(set(parsed["tags"]) <= set(columns), "tags are columns")

dashboard = json.loads((shop / "grafana/dashboards/kt830.json").read_text())
sources = yaml.safe_load((shop / "grafana/provisioning/datasources/kt830.yaml").read_text())["datasources"]
known = {source["uid"] for source in sources}
for panel in dashboard["panels"]:
    check(panel["datasource"]["uid"] in known and panel["targets"], f"panel {panel['title']}")
    for target in panel["targets"]:
        words = set(re.findall(r"\b[a-z_]+_mm\b|\bis_bad\b", target.get("rawSql", "")))
        check(words <= set(columns), f"columns {sorted(words)}")
check(yaml.safe_load((shop / "grafana/provisioning/dashboards/kt830.yaml").read_text())["providers"], "dashboards")

if shutil.which("mosquitto"):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        # The file as it is, but for the folder of the container and the port.
        text = (shop / "mosquitto.conf").read_text().replace("/mosquitto/data/", f"{folder}/").replace("listener 1883", "listener 18839")
        (folder / "mosquitto.conf").write_text(text + "user root\n")
        broker = subprocess.Popen(["mosquitto", "-c", str(folder / "mosquitto.conf")], stderr=subprocess.DEVNULL)
        time.sleep(1)
        try:
            with socket.create_connection(("127.0.0.1", 18839), timeout=2) as stream:
                stream.sendall(b"\x10\x0d\x00\x04MQTT\x04\x02\x00\x3c\x00\x01k")
                answer = stream.recv(4)
        except OSError as error:
            answer = str(error)
        check(answer == b"\x20\x02\x00\x00", f"mosquitto.conf: the broker takes a client: {answer}")
        broker.terminate()
        broker.wait()
else:
    check(False, "no mosquitto: mosquitto.conf was not tested")

prometheus = shop / "prometheus.yml"
check(yaml.safe_load(prometheus.read_text())["scrape_configs"][0]["job_name"] == "kt830", "prometheus.yml")
if shutil.which("promtool"):
    told = subprocess.run(["promtool", "check", "config", str(prometheus)], capture_output=True, text=True)
    check(told.returncode == 0, f"promtool: {told.stdout.strip()} {told.stderr.strip()}")
else:
    print("no promtool: prometheus.yml was read as YAML alone")
print(f"{len(faults)} faults")
sys.exit(1 if faults else 0)
