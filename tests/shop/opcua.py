"""The OPC UA server of a control against a client that was not written here (asyncua): who is let in and who is not, the
machine by OPC 40501-1, values in time, alarms as events that come and go, and what a client sees of a control that ends.

opcua.py PROGRAM SECONDS

Needs a build with the feature opcua, and Python with asyncua 2.1.
"""

import asyncio
import datetime
import logging
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from asyncua import Client, ua
from asyncua.crypto.cert_gen import setup_self_signed_certificate
from cryptography.x509.oid import ExtendedKeyUsageOID

program, seconds = sys.argv[1], float(sys.argv[2])
ADAPTER = int(os.environ.get("KT830_PORT", "7879"))
PORT = int(os.environ.get("KT830_OPCUA_PORT", "4841"))
URL = f"opc.tcp://localhost:{PORT}/"
NAMES = {
    "di": "http://opcfoundation.org/UA/DI/",
    "machinery": "http://opcfoundation.org/UA/Machinery/",
    "tool": "http://opcfoundation.org/UA/MachineTool/",
    "own": "urn:kt830:machine",
}
STORY = """kind gc
key hydraulic
wait 4 s
home all
mode auto
load O1002
key cycle-start
wait 6 s
input emergency-stop on
wait 1 s
input emergency-stop off
wait 1 s
key reset
wait 1 s
"""
# An alarm of each condition, raised and repaired.
ALARMS = """kind gc
param P333 51
param P334 52
wait 1 s
key hydraulic
wait 4 s
home all
mode auto
load O3001
key cycle-start
wait 0.5 s
key reset
load O3002
key cycle-start
wait 0.5 s
key reset
load O3003
key cycle-start
wait 0.5 s
key reset
fault drive-x
wait 0.5 s
fault drive-x off
key reset
home all
mode auto
load O3004
key cycle-start
wait 1 s
fault coolant-missing
wait 4 s
fault coolant-missing off
key reset
fault lubrication-missing
wait 6 s
fault lubrication-missing off
wait 0.5 s
key reset
fault pressure-loss
wait 2 s
fault pressure-loss off
wait 3 s
key reset
fault bus-silent 50
wait 1 s
key reset
input emergency-stop on
wait 0.5 s
input emergency-stop off
wait 0.5 s
key reset
wait 1 s
"""
PROGRAMS = {"O3001": "M98 P9999", "O3002": "G10 P1 X9999", "O3003": "#5801=99999", "O3004": "M08\nG04 X60"}
CONDITIONS = {
    "system", "communications", "logic", "motion", "drives", "spindle", "hydraulic", "coolant", "lubrication"
}
logging.disable(logging.WARNING)
work = Path(tempfile.mkdtemp())
(work / "story").write_text(STORY)
(work / "alarms").write_text(ALARMS)
(work / "programs").mkdir()
for name, text in PROGRAMS.items():
    (work / "programs" / f"{name}.NC").write_text(text + "\nM30\n")
data = ["--data", str(work / "data")]
faults = []


def check(holds, what):
    print(("ok    " if holds else "FAIL  ") + what, flush=True)
    if not holds:
        faults.append(what)


def kt830(*words, text=None):
    return subprocess.run([program, *words], input=text, text=True, capture_output=True)


def start_control(story="story", more=()):
    words = ["serve", str(work / story), *more, "--param", f"P480={ADAPTER}", "--param", "P482=123", "--param", "P485=1", *data]
    return subprocess.Popen([program, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


async def client_of(user="planner", secret="correct horse", key="client"):
    client = Client(URL, timeout=5)
    client.application_uri = "urn:test:kt830:client"
    await setup_self_signed_certificate(
        work / f"{key}.pem", work / f"{key}.der", client.application_uri, "test",
        [ExtendedKeyUsageOID.CLIENT_AUTH], {"commonName": key},
    )
    await client.set_security_string(f"Basic256Sha256,SignAndEncrypt,{work}/{key}.der,{work}/{key}.pem")
    if user:
        client.set_user(user)
        client.set_password(secret)
    return client


async def refused(client):
    """Why a client is not let in; empty if it is."""
    try:
        async with client:
            return ""
    except ua.UaStatusCodeError as error:
        return type(error).__name__
    except (ConnectionError, TimeoutError, asyncio.TimeoutError):
        return "closed"


async def denied(what):
    """The status of a service that is refused; empty if it is done."""
    try:
        await what
        return ""
    except ua.UaStatusCodeError as error:
        return type(error).__name__
    except ConnectionError:
        return "closed"


async def wait_until(holds, longest=20.0):
    for _ in range(int(longest * 20)):
        if holds():
            return True
        await asyncio.sleep(0.05)
    return False


class Listener:
    """What a subscription tells."""

    def __init__(self):
        self.values, self.delays, self.events, self.bad = {}, [], [], set()

    def datachange_notification(self, node, value, data):
        told = data.monitored_item.Value
        name = str(node.nodeid.Identifier)
        self.values.setdefault(name, []).append(value)
        if not told.StatusCode.is_good():
            self.bad.add(name)
        elif told.SourceTimestamp:
            now = datetime.datetime.now(datetime.timezone.utc)
            source = told.SourceTimestamp
            source = source if source.tzinfo else source.replace(tzinfo=datetime.timezone.utc)
            self.delays.append((now - source).total_seconds() * 1000)

    def event_notification(self, event):
        self.events.append(event)

    def status_change_notification(self, status):
        pass


async def look(machine, number):
    """The machine by its specification."""
    async def value(*path):
        node = await machine.get_child([f"{number[space]}:{name}" for space, name in path])
        return await node.read_value()

    check(await value(("di", "Identification"), ("di", "SerialNumber")) == "000123", "serial number")
    check("cylindrical" in (await value(("di", "Identification"), ("di", "Model"))).Text, "model")
    uri = await value(("di", "Identification"), ("di", "ProductInstanceUri"))
    check(uri == "urn:kt830:kt830-gc-000123", f"product instance {uri}")
    mode = await value(("tool", "Monitoring"), ("tool", "MachineTool"), ("tool", "OperationMode"))
    check(mode in (0, 1, 5), f"operation mode {mode}")
    override = await machine.get_child([f"{number['tool']}:{name}" for name in ("Monitoring", "Channel1", "FeedOverride")])
    check(await override.read_value() == 100.0, "feed override 100")
    limits = await (await override.get_child("0:EURange")).read_value()
    check((limits.Low, limits.High) == (0.0, 150.0), "range of the feed override")
    units = await (await override.get_child("0:EngineeringUnits")).read_value()
    check(units.UnitId == 20529, "percent by UN/CEFACT")
    program_name = ""
    for _ in range(50):
        try:
            program_name = await value(("tool", "Production"), ("tool", "ActiveProgram"), ("tool", "Name"))
            break
        except ua.UaStatusCodeError as error:
            check(error.code == ua.StatusCodes.BadNoData, "no program yet")
            await asyncio.sleep(2)
    check("1002" in program_name, f"program {program_name}")
    path = [("tool", "Production"), ("tool", "ActiveProgram"), ("tool", "State")]
    state = [f"{number[space]}:{name}" for space, name in path] + ["0:CurrentState"]
    state = await machine.get_child(state)
    check((await state.read_value()).Text in ("Initializing", "Running", "Ended", "Interrupted", "Aborted"), "program state")
    diameter = await value(("tool", "Equipment"), ("tool", "Tools"), ("tool", "Wheel"), ("own", "Diameter"))
    check(diameter == 600.0, f"wheel diameter {diameter}")
    items = await machine.get_child([f"{number['own']}:DataItems"])
    check(len(await items.get_children()) > 35, "data items")


async def read_job(plan, number):
    job = await plan.get_child([f"{number['own']}:701", f"{number['own']}:OrderState"])
    return await job.read_value()


async def orders(client, machine, number):
    """Orders are proposed by the method, and stand in the production plan."""
    plan = await machine.get_child([f"{number['tool']}:Production", f"{number['tool']}:ProductionPlan"])
    method = await plan.get_child(f"{number['own']}:ProposeOrder")

    async def propose(order, name, parts, values=None):
        values = values or {}
        words = [
            ua.Variant(order, ua.VariantType.UInt32), ua.Variant(name, ua.VariantType.String),
            ua.Variant(parts, ua.VariantType.UInt32),
            ua.Variant(list(values), ua.VariantType.String, is_array=True),
            ua.Variant(list(values.values()), ua.VariantType.Double, is_array=True),
        ]
        begun = time.monotonic()
        answer = await plan.call_method(method, *words)
        print(f"answer to order {order} after {(time.monotonic() - begun) * 1000:.0f} ms: {answer}")
        return answer

    answer = await propose(701, "O1002", 50, {"#521": 38.02, "#532": 0.01})
    check(answer[0] is True, f"an order is proposed: {answer}")
    for name, parts, values, why in (
        ("O1999", 50, {}, "no such program"), ("O1002", 0, {}, "1 to 999999"), ("O1002", 5, {"#899": 1.0}, "does not show"),
        ("O1002", 5, {"X": 1.0}, "not a variable"),
    ):
        answer = await propose(702, name, parts, values)
        check(answer[0] is False and why in answer[1], f"refused: {answer}")
    why = await denied(propose(703, "O" + "1" * 2000, 5))
    check(why == "BadInvalidArgument", f"a long order: {why}")
    why = await denied(plan.call_method(method, ua.Variant("M03", ua.VariantType.String)))
    check(why.startswith("Bad"), f"other arguments: {why}")
    job = None
    for _ in range(50):
        await asyncio.sleep(0.1)
        try:
            job = await plan.get_child(f"{number['own']}:701")
            break
        except ua.UaStatusCodeError:
            pass
    check(job is not None, "the order is a job of the plan")
    read = lambda *path: job.get_child([f"{number[space]}:{name}" if space else f"0:{name}" for space, name in path])
    found = [await (await read(("tool", name))).read_value() for name in ("Identifier", "RunsPlanned", "RunsCompleted")]
    check(found == ["701", 50, 0], f"job {found}")
    found = [await (await read(("own", name))).read_value() for name in ("OrderState", "Values")]
    check(found == ["proposed", ["#521=38.02", "#532=0.01"]], f"proposed {found}")
    state = await (await read(("tool", "State"), ("", "CurrentState"))).read_value()
    check(state.Text == "Initializing", f"state {state.Text}")
    program = await (await read(("tool", "ProductionPrograms"), ("own", "Program"), ("tool", "Name"))).read_value()
    check(program == "O1002", f"program {program}")
    async with await client_of(user="viewer") as viewer:
        call = viewer.get_node(plan.nodeid).call_method(
            method.nodeid, *[ua.Variant(0, ua.VariantType.UInt32), ua.Variant("O1002"), ua.Variant(5, ua.VariantType.UInt32),
                             ua.Variant([], ua.VariantType.String, is_array=True),
                             ua.Variant([], ua.VariantType.Double, is_array=True)])
        why = await denied(call)
        check(why == "BadUserAccessDenied", f"a viewer proposes nothing: {why}")


async def many_subscriptions(server):
    """The library keeps what was subscribed to: the server begins anew before it is too much."""
    def memory():
        lines = Path(f"/proc/{server.pid}/status").read_text().splitlines()
        return int(next(line.split()[1] for line in lines if line.startswith("VmRSS"))) // 1024

    # The first round is for what is loaded once.
    before, rounds = 0, 0
    for _ in range(4):
        try:
            async with await client_of() as client:
                for _ in range(120):
                    subscription = await client.create_subscription(100, Listener())
                    await subscription.subscribe_data_change(client.nodes.server_state)
                    await subscription.delete()
                    rounds += 1
                await asyncio.sleep(8)
                await client.nodes.server_state.read_value()
        except (ua.UaError, ConnectionError, TimeoutError, asyncio.TimeoutError):
            await asyncio.sleep(3)
        before = before or memory()
    check(rounds >= 300, f"{rounds} subscriptions")
    check(memory() - before < 40, f"memory {before} MB, after them {memory()} MB")
    check(await refused(await client_of()) == "", "a client is let in after them")


async def main():
    control = start_control()
    added = kt830("opcua", "add-user", "--orders", "planner", *data, text="correct horse\n")
    check(added.returncode == 0, "a user is added")
    kt830("opcua", "add-user", "viewer", *data, text="correct horse\n")
    words = ["opcua", "serve", "--control", f"127.0.0.1:{ADAPTER}", "--listen", f"127.0.0.1:{PORT}", *data]
    server = subprocess.Popen([program, *words], stdout=subprocess.DEVNULL)
    try:
        for _ in range(100):
            await asyncio.sleep(0.2)
            try:
                endpoints = await Client(URL).connect_and_get_server_endpoints()
                break
            except Exception:
                endpoints = []
        policies = {endpoint.SecurityPolicyUri.rsplit("#")[-1] for endpoint in endpoints}
        check(policies == {"Basic256Sha256", "Aes256_Sha256_RsaPss"}, f"policies {sorted(policies)}")
        tokens = {token.TokenType for endpoint in endpoints for token in endpoint.UserIdentityTokens}
        check(tokens == {ua.UserTokenType.UserName}, "users with passwords alone")
        why = await refused(Client(URL))
        check(why == "closed", f"not without encryption: {why}")
        why = await refused(await client_of())
        check(why == "BadCertificateUntrusted", f"not with an unknown certificate: {why}")
        told = kt830("opcua", "status", *data).stdout
        thumbprint = next((line.split()[1] for line in told.splitlines() if line.startswith("refused")), "")
        check(kt830("opcua", "trust", thumbprint, *data).returncode == 0, f"the certificate {thumbprint} is trusted")
        why = await refused(await client_of(user=None))
        check(why == "BadIdentityTokenInvalid", f"not without a user: {why}")
        for wrong in ({"secret": "wrong"}, {"user": "nobody"}):
            why = await refused(await client_of(**wrong))
            check(why == "BadUserAccessDenied", f"not with {wrong}: {why}")
        async with await client_of() as client:
            number = {name: await client.get_namespace_index(uri) for name, uri in NAMES.items()}
            machines = await client.nodes.objects.get_child(f"{number['machinery']}:Machines")
            machine = (await machines.get_children())[0]
            check((await machine.read_type_definition()).Identifier == 13, "the machine is a MachineToolType")
            await look(machine, number)
            override = await machine.get_child([f"{number['tool']}:{name}" for name in ("Monitoring", "Channel1", "FeedOverride")])
            listener = Listener()
            subscription = await client.create_subscription(100, listener)
            items = await machine.get_child([f"{number['own']}:DataItems"])
            nodes = await items.get_children()
            await subscription.subscribe_data_change(nodes, queuesize=10)
            messages = await machine.get_child([f"{number['tool']}:Notification", f"{number['tool']}:Messages"])
            alert = client.get_node(ua.NodeId(39, number["tool"]))
            await subscription.subscribe_events(messages, queuesize=100)
            # The server's library compares no types in a filter but with the operator OfType; asyncua uses InList.
            chosen = {"queuesize": 100, "where_clause_generation": False}
            await subscription.subscribe_events(client.nodes.server, alert, **chosen)
            await asyncio.sleep(seconds)
            executions = {value for name, values in listener.values.items() if name.endswith("/execution") for value in values}
            check({"ACTIVE", "STOPPED"} <= executions, f"executions {sorted(map(str, executions))}")
            active = [event for event in listener.events if getattr(event, "ErrorCode", None) is not None]
            states = {(event.ErrorCode, getattr(event, "ActiveState/Id", None)) for event in active}
            check(len({state for _, state in states}) == 2, f"alarms come and go: {sorted(map(str, states))}")
            severities = {event.Severity for event in active if event.ErrorCode == "0"}
            check(severities == {800}, f"severity of a fault {severities}")
            plain = [event for event in listener.events if event not in active]
            check(any(event.Severity >= 334 for event in plain), f"{len(plain)} events of the machine")
            delays = sorted(listener.delays[len(nodes):])
            at = lambda share: delays[min(len(delays) - 1, int(len(delays) * share))]
            print(f"values {len(delays)}, delay 50 % {at(0.5):.0f} ms, 99 % {at(0.99):.0f} ms, longest {delays[-1]:.0f} ms")
            check(at(0.5) < 400 and at(0.99) < 2000, "values in time")
            why = await denied(override.write_value(ua.Variant(50.0, ua.VariantType.Double)))
            check(why in ("BadNotWritable", "BadUserAccessDenied", "BadServiceUnsupported"), f"nothing is written: {why}")
            await orders(client, machine, number)
            call = client.nodes.server.call_method("0:GetMonitoredItems", ua.Variant(1, ua.VariantType.UInt32))
            why = await denied(call)
            check(why == "BadUserAccessDenied", f"nothing is called: {why}")
            listener.bad.clear()
            control.send_signal(signal.SIGKILL)
            control.wait()
            check(await wait_until(lambda: any(name.endswith("/execution") for name in listener.bad)), "a control that ends")
            control = start_control("alarms", ["--programs", str(work / "programs")])
            count = len(listener.delays)
            check(await wait_until(lambda: len(listener.delays) > count + 20), "a control that comes back")
            plan = await machine.get_child([f"{number['tool']}:Production", f"{number['tool']}:ProductionPlan"])
            for _ in range(100):
                state = await denied(read_job(plan, number))
                if state == "":
                    break
                await asyncio.sleep(0.1)
            check(state == "", f"its order is a job again {state}")
            async with await client_of() as again:
                value = await read_job(again.get_node(plan.nodeid), number)
                check(value == "proposed", f"and of another client {value}")
            told = lambda active: {
                event.ConditionName.split()[0] for event in listener.events
                if getattr(event, "ErrorCode", None) and getattr(event, "ActiveState/Id") is active
            }
            await wait_until(lambda: told(True) >= CONDITIONS and told(False) >= CONDITIONS, 60)
            check(told(True) >= CONDITIONS, f"alarms of each condition come; missing {sorted(CONDITIONS - told(True))}")
            check(told(False) >= CONDITIONS, f"and go; missing {sorted(CONDITIONS - told(False))}")
            states = [getattr(event, "ActiveState/Id", None) for event in listener.events if getattr(event, "ErrorCode", None)]
            check(states.count(True) - states.count(False) in (0, 1), f"as many alarms come as go: {states}")
            check(kt830("opcua", "remove-user", "planner", *data).returncode == 0, "a user is removed")
            await asyncio.sleep(4)
            why = await denied(override.read_value())
            check(why != "", f"a user that was removed reads no more: {why}")
            kt830("opcua", "add-user", "planner", *data, text="correct horse\n")
        await many_subscriptions(server)
        check(server.poll() is None, "the server runs")
    finally:
        control.kill()
        server.kill()
        print(f"{len(faults)} faults")
    sys.exit(1 if faults else 0)


asyncio.run(main())
