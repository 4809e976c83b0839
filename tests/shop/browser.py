"""The view for browsers in a real one: Chromium, headless. On this computer without a password, then as another computer sees
it, in TLS and with the password of the viewers. What is shown is what the story has made, and how old it is when it is shown.

browser.py PROGRAM

Needs chromium, and Python with websocket-client. KT830_PICTURES names a folder that keeps the pictures.
"""

import base64
import http.client
import json
import os
import shutil
import socket
import ssl
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from pathlib import Path

import websocket

program = sys.argv[1]
PORT = int(os.environ.get("KT830_PORT", "8090"))
STORY = ["tests/shop/alarm.story", "--programs", "tests/shop/programs"]
PASSWORD = "correct horse"
chromium = shutil.which("chromium") or shutil.which("chromium-browser")
if not chromium:
    sys.exit("tests/shop: there is no chromium; nothing was tested")
work = Path(tempfile.mkdtemp())
pictures = Path(os.environ.get("KT830_PICTURES", work))
faults = []


def check(holds, what):
    print(("ok    " if holds else "FAIL  ") + what, flush=True)
    if not holds:
        faults.append(what)


class Page:
    """A page in Chromium, by its protocol for developers."""

    def __init__(self, url, phone):
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        self.browser = subprocess.Popen(
            [chromium, "--headless", "--no-sandbox", "--disable-gpu", "--lang=en", "--ignore-certificate-errors",
             "--remote-allow-origins=*", f"--remote-debugging-port={port}", f"--user-data-dir={tempfile.mkdtemp(dir=work)}",
             f"--window-size={'412,1500' if phone else '1280,900'}", "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for _ in range(200):
            try:
                tabs = json.load(urllib.request.urlopen(f"http://127.0.0.1:{port}/json"))
                tab = next(tab for tab in tabs if tab["type"] == "page")
                break
            except (OSError, StopIteration):
                time.sleep(0.1)
        self.socket, self.number = websocket.create_connection(tab["webSocketDebuggerUrl"], timeout=20), 0
        self.ask("Page.navigate", url=url)

    def ask(self, method, **params):
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": params}))
        while True:
            told = json.loads(self.socket.recv())
            if told.get("id") == self.number:
                return told.get("result", {})

    def value(self, script):
        return self.ask("Runtime.evaluate", expression=script, returnByValue=True).get("result", {}).get("value")

    def text(self, id):
        return self.value(f'document.getElementById("{id}")?.innerText') or ""

    def until(self, script, longest=40):
        end = time.monotonic() + longest
        while time.monotonic() < end:
            if self.value(script):
                return True
            time.sleep(0.1)
        return False

    def picture(self, name):
        (pictures / name).write_bytes(base64.b64decode(self.ask("Page.captureScreenshot")["data"]))

    def close(self):
        self.socket.close()
        self.browser.terminate()
        self.browser.wait()


def serve(*params):
    words = [word for param in params for word in ("--param", param)]
    words += ["--param", "P482=123", "--param", f"P483={PORT}", "--data", work / "data"]
    served = subprocess.Popen([program, "serve", *STORY, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    for _ in range(200):
        try:
            socket.create_connection(("127.0.0.1", PORT), timeout=1).close()
            return served
        except OSError:
            time.sleep(0.1)
    sys.exit("the control does not listen")


def status(url, password=None, context=None):
    """Status of an answer and what came with it; 0 where there is none."""
    request = urllib.request.Request(url)
    if password:
        request.add_header("Authorization", "Basic " + base64.b64encode(f"viewer:{password}".encode()).decode())
    try:
        with urllib.request.urlopen(request, timeout=10, context=context) as answer:
            return answer.status, dict(answer.headers), answer.read()
    except urllib.error.HTTPError as error:
        return error.code, dict(error.headers), b""
    except (OSError, http.client.HTTPException):
        return 0, {}, b""


def shows_the_story(page, parts):
    """The parts, the place of the axis, the alarm with its remedy, the picture of the screen."""
    check(page.until('document.body.innerText.includes("kt830-gc-000123")'), "the machine is named")
    check(page.until('document.getElementById("program").innerText.includes("O3005")'), "its program is shown")
    x = '[...document.querySelectorAll("dt.axis")].find((name) => name.innerText == "X")?.nextSibling.innerText'
    check(page.until(f'{x} == "-61.500"'), f"X stands at -61.500: {page.value(x)}")
    check(page.until('document.getElementById("size").innerText == "39.9985 (39.995 … 40.000)"'),
          f"size and limits of the part: {page.text('size')}")
    check(page.value('document.querySelectorAll("#trend circle").length') == parts, "each part is a point of the trend")
    check(page.until('document.getElementById("alarms").innerText.includes("193")'), f"the alarm: {page.text('alarms')!r}")
    check(page.value('document.getElementById("alarms").innerText.split("\\n").length') >= 2, "with what to do")
    check(page.until('document.getElementById("screen").naturalWidth == 1024'), "the picture of the screen")


served = serve()
print("on this computer")
page = Page(f"http://localhost:{PORT}/", phone=True)
shows_the_story(page, 1)
page.picture("phone.png")
page.value('window.ages = []; new MutationObserver(() => ages.push(Number(document.getElementById("time").dataset.age)))'
           '.observe(document.getElementById("time"), { attributes: true }); 1')
time.sleep(60)
ages = sorted(page.value("ages") or [])
check(len(ages) > 40, f"the page shows {len(ages)} states in 60 s")
at = lambda share: ages[int(share * (len(ages) - 1))]
if ages:
    print(f"from the tick until the page shows it 50 % {at(0.5)} ms, 99 % {at(0.99)} ms, longest {ages[-1]} ms")
    check(at(0.99) < 500, "in time")
answer = status(f"http://localhost:{PORT}/")
check("frame-ancestors 'none'" in answer[1].get("Content-Security-Policy", ""), "nobody else's page frames it")
served.kill()
served.wait()
check(page.until('document.getElementById("state").dataset.state == "lost"'), "a control that ends is no longer shown as if it went on")
page.picture("lost.png")
page.close()

print("from another computer")
subprocess.run([program, "web-access", "localhost", "--data", work / "data"], input=PASSWORD + "\n", text=True, check=True)
served = serve("P486=1")
url = f"https://localhost:{PORT}"
trusting = ssl.create_default_context(cafile=work / "data" / "web.pem")
check(status(url + "/", context=trusting)[0] == 401, "not without the password")
check(status(url + "/", "wrong", trusting)[0] == 401, "nor with a wrong one")
told = status(url + "/state.json", PASSWORD, trusting)
check(told[0] == 200 and json.loads(told[2])["machine"] == "kt830-gc-000123", "with the password, the certificate checked")
check(status(f"http://localhost:{PORT}/state.json", PASSWORD)[0] == 0, "not without TLS")
page = Page(f"https://viewer:{PASSWORD.replace(' ', '%20')}@localhost:{PORT}/", phone=False)
shows_the_story(page, 2)
page.picture("desk.png")
page.close()
served.kill()
served.wait()
print(f"{len(faults)} faults")
sys.exit(1 if faults else 0)
