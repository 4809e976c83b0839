"""Validates device models against the schema, then listens to a control as an agent does: every line is put into a document
of MTConnectStreams, which is validated, too; the story must raise and clear every condition, and its part and the places of
its axes must be those that were told.

validate.py SCHEMA_FOLDER MODELS_FOLDER PORT SECONDS
"""

import socket
import sys
import time
import xml.etree.ElementTree as xml
from datetime import datetime, timezone
from pathlib import Path

import xmlschema

schema_folder, models_folder, port, seconds = Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4])
DEVICES = "{urn:mtconnect.org:MTConnectDevices:2.2}"


def schema(name):
    return xmlschema.XMLSchema11(schema_folder / f"MTConnect{name}_2.2.xsd", validation="lax")


def failed(words):
    print(f"  FAILED: {words}")
    sys.exit(1)


devices = schema("Devices")
for model in sorted(models_folder.glob("*.xml")):
    errors = list(devices.iter_errors(model.read_text()))
    if errors:
        failed(f"{model.name}: {errors[0].reason} at {errors[0].path}")
    print(f"  {model.name}: {len(list(xml.parse(model).iter(DEVICES + 'DataItem')))} data items, valid")

# Items of the served machine: category, type, subtype, component.
items = {}


def walk(component, path):
    for item in component.findall(f"{DEVICES}DataItems/{DEVICES}DataItem"):
        items[item.get("name")] = (item.attrib, path)
    for child in component.findall(f"{DEVICES}Components/*"):
        walk(child, (child.tag.removeprefix(DEVICES), child.get("name"), child.get("id")))


for device in xml.parse(models_folder / "gc.xml").iter(DEVICES + "Device"):
    walk(device, ("Device", device.get("name"), device.get("id")))


def element(kind):
    return "".join(word.capitalize() for word in kind.split("_")).replace("Mtconnect", "MTConnect")


def observation(fields, sequence):
    """The element of an observation, and its component."""
    moment, name, *rest = fields
    attributes, path = items[name]
    common = {"dataItemId": attributes["id"], "name": name, "timestamp": moment, "sequence": str(sequence)}
    if attributes.get("subType"):
        common["subType"] = attributes["subType"]
    if attributes["category"] == "CONDITION":
        level, code, _severity, _qualifier, text = rest
        node = xml.Element(level.capitalize(), common | {"type": attributes["type"]})
        if code:
            node.set("nativeCode", code)
        node.text = text or None
    else:
        node = xml.Element(element(attributes["type"]), common)
        node.text = rest[-1]
    return path, attributes["category"], node


streams = schema("Streams")
heard, latencies, levels, values, parts = 0, [], {}, {}, set()


def take(line):
    """Splits a line into observations and validates the document that they make."""
    global heard
    fields = line.split("|")
    kind = items[fields[1]][0]
    if kind["category"] == "CONDITION" or kind["type"] == "MESSAGE":
        groups = [fields]
    else:
        groups = [[fields[0], *fields[at:at + 2]] for at in range(1, len(fields), 2)]
    root = xml.Element("MTConnectStreams", {"xmlns": "urn:mtconnect.org:MTConnectStreams:2.2"})
    moment = groups[0][0]
    xml.SubElement(root, "Header", {
        "creationTime": moment, "sender": "test", "instanceId": "1", "version": "2.2", "deviceModelChangeTime": moment,
        "bufferSize": "1024", "nextSequence": "2", "firstSequence": "1", "lastSequence": "1"})
    device = xml.SubElement(xml.SubElement(root, "Streams"), "DeviceStream", {"name": "machine", "uuid": "machine"})
    by_component = {}
    for sequence, group in enumerate(groups, 1):
        component, category, node = observation(group, sequence)
        by_component.setdefault(component, {}).setdefault(category, []).append(node)
        heard += 1
        if category == "CONDITION":
            levels.setdefault(group[1], []).append((group[2], group[3]))
        else:
            values.setdefault(group[1], set()).add(group[2])
    for (component, name, ident), categories in by_component.items():
        stream = xml.SubElement(device, "ComponentStream", {"component": component, "componentId": ident})
        if name:
            stream.set("name", name)
        for category, box in (("SAMPLE", "Samples"), ("EVENT", "Events"), ("CONDITION", "Condition")):
            if category in categories:
                xml.SubElement(stream, box).extend(categories[category])
    errors = list(streams.iter_errors(xml.tostring(root, encoding="unicode")))
    if errors:
        failed(f"{line}: {errors[0].reason}")


def connect():
    for _ in range(100):
        try:
            return socket.create_connection(("127.0.0.1", port), timeout=2)
        except OSError:
            time.sleep(0.1)
    failed("the control does not listen")


agent = connect()
end, rest, ponged, lines, ping_at = time.monotonic() + seconds, b"", False, [], 0
agent.settimeout(1)
while time.monotonic() < end:
    if time.monotonic() >= ping_at:
        agent.sendall(b"* PING\n")
        ping_at = time.monotonic() + 10
    try:
        received = agent.recv(65536)
    except TimeoutError:
        continue
    if not received:
        failed("the control has ended the connection")
    now = datetime.now(timezone.utc)
    *whole, rest = (rest + received).split(b"\n")
    for line in map(bytes.decode, whole):
        if line.startswith("* PONG"):
            ponged = True
        else:
            if line.startswith("* "):
                continue  # who the machine is
            moment = datetime.fromisoformat(line.split("|")[0])
            latencies.append((now - moment).total_seconds() * 1000)
            lines.append(line)
for line in lines:
    take(line)
missing = set(items) - set(values) - set(levels)
if missing or not ponged:
    failed(f"never told: {sorted(missing)}, PONG {ponged}")
latencies.sort()
share = lambda part: latencies[int(part * (len(latencies) - 1))]
print(f"  {heard} observations in {len(lines)} lines, valid; from the tick until the line is received: "
      f"50 % {share(0.5):.1f} ms, 99 % {share(0.99):.1f} ms")
if share(0.99) > 200:
    failed("lines come late")
faults = {(name, code) for name, told in levels.items() for level, code in told if level == "FAULT"}
cleared = {(name, code) for name, told in levels.items() for level, code in told if level == "NORMAL" and code}
print(f"  faults {sorted(faults)}, cleared {sorted(cleared)}; execution {sorted(values['execution'])}; "
      f"parts {sorted(values['part_id'])}")
conditions = {name for name, (attributes, _) in items.items() if attributes["category"] == "CONDITION"}
if {name for name, _ in faults & cleared} != conditions:
    failed(f"not raised and cleared: {sorted(conditions - {name for name, _ in faults & cleared})}")
# What tests/shop/whole.story has made.
for name, true, tolerance in (
    ("x_work", -61.5, 0.002), ("z_work", -20.0, 0.002), ("part_size", 39.9985, 0), ("part_nominal", 40, 0),
    ("part_lower_limit", 39.995, 0), ("part_upper_limit", 40, 0),
):
    told = [float(value) for value in values[name] if value != "UNAVAILABLE"]
    if not any(abs(value - true) <= tolerance for value in told):
        failed(f"{name} is not {true}: {sorted(told)[-5:]}")
if not {"ACTIVE", "READY"} <= values["execution"]:
    failed("no program has run")
if not values["part_id"] - {"UNAVAILABLE"}:
    failed("no part was made")
print("all good")
