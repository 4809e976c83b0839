"""Touches the window of the control and measures what it does: check.py SOCKET PORT WINDOW [FOLDER].

SOCKET is that of the touch screen, PORT that of the view for browsers, which tells the state of the machine, WINDOW the
window. Pictures are kept in FOLDER. The control is in JOG on the page of the drawing, homed, 1024 x 768 pixels large."""

import collections
import ctypes
import json
import os
import subprocess
import sys
import time
import urllib.request

import touch

WIDTH, HEIGHT = 1024, 768
# Places on the screen of a cylindrical grinder.
X_PLUS, X_MINUS, Z_MINUS = (837, 498), (837, 594), (788, 546)
FEED_PLUS, COOLANT, HOLD, EMERGENCY_STOP = (866, 401), (924, 192), (890, 717), (978, 709)
DIAGNOSIS, GRAPHIC = (259, 743), (361, 743)
EMPTY, TITLE = (300, 150), (300, 68)
DRAWING, PANEL, HEAD = (14, 88, 544, 518), (762, 0, WIDTH, HEIGHT), (0, 0, 240, 46)
# The bars of the lit soft keys: first that of the open page, then F1 to F5.
BARS = [(x, 762) for x in (54, 156, 259, 361, 465, 567)]
# Longest time from lifting a finger until the axis stands, s, under software OpenGL: the core alone waits 0.2 s for a screen.
STOPS_WITHIN = 0.5
FLASHES = 10

path, port, window, folder = (sys.argv + [""])[1:5]
screen = touch.Screen(path, WIDTH, HEIGHT)
failures = 0


def run(*command):
    subprocess.run(command, check=True, stderr=subprocess.DEVNULL)


def items():
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/state.json", timeout=5) as answer:
        return json.load(answer)["items"]


def x():
    return items()["x_machine"]


def picture(name):
    """The screen: three bytes a pixel."""
    if folder:
        run("import", "-window", "root", os.path.join(folder, name + ".png"))
    shot = subprocess.run(["import", "-window", "root", "-depth", "8", "rgb:-"], check=True, capture_output=True)
    return shot.stdout


def pixel(shot, x, y):
    at = 3 * (y * WIDTH + x)
    return shot[at:at + 3]


def part(shot, box):
    left, top, right, bottom = box
    return [[pixel(shot, x, y) for x in range(left, right)] for y in range(top, bottom)]


def workpiece_width(shot):
    """Width of the workpiece in the drawing: its colour is the most frequent one after that of the background."""
    rows = part(shot, DRAWING)
    colour = collections.Counter(pixel for row in rows for pixel in row).most_common(2)[1][0]
    return max(row.count(colour) for row in rows)


def lit_soft_key(shot):
    lit = pixel(shot, *BARS[0])
    return [at for at in range(1, len(BARS)) if pixel(shot, *BARS[at]) == lit]


def check(good, words):
    global failures
    failures += not good
    print(f"  {'ok    ' if good else 'FAILED'} {words}", flush=True)


def wait_for(condition, seconds=30):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            sys.exit("tests/touch: the control is not ready")
        time.sleep(0.2)


def moves():
    before = x()
    time.sleep(0.2)
    return abs(x() - before) > 0.01


def stand_still():
    """Time and way until X stands; none if it has not stopped within the time of a jog that runs on."""
    begun, start = time.monotonic(), x()
    last, since = start, begun
    while time.monotonic() < begun + 2:
        time.sleep(0.02)
        now = x()
        if abs(now - last) > 1e-3:
            last, since = now, time.monotonic()
        elif time.monotonic() > since + 0.3:
            return since - begun, abs(last - start)
    return None


def stops(words):
    stood = stand_still()
    good = stood is not None and stood[0] <= STOPS_WITHIN
    check(good, f"{words}: " + (f"X stands after {1000 * stood[0]:.0f} ms, {stood[1]:.2f} mm" if stood else "X RUNS ON"))
    if stood is None:
        screen.tap(*EMPTY)
        time.sleep(0.6)


def jog_key():
    """The key that moves X towards the middle of its way."""
    return X_PLUS if x() < -60 else X_MINUS


def press_jog():
    screen.down(1, *jog_key())
    time.sleep(0.3)
    if not moves():
        check(False, "X moves under the finger")


def tapped(place, finger=1):
    screen.tap(*place, finger=finger)
    time.sleep(0.6)


class Cover:
    """A window over another one, such as that of a message."""

    def __init__(self, left, top, width, height):
        self.x11 = ctypes.CDLL("libX11.so.6")
        self.x11.XOpenDisplay.restype = ctypes.c_void_p
        self.x11.XDefaultRootWindow.restype = self.x11.XCreateSimpleWindow.restype = ctypes.c_ulong
        self.display = ctypes.c_void_p(self.x11.XOpenDisplay(None))
        root, black = ctypes.c_ulong(self.x11.XDefaultRootWindow(self.display)), ctypes.c_ulong(0)
        self.window = ctypes.c_ulong(
            self.x11.XCreateSimpleWindow(self.display, root, left, top, width, height, 0, black, black))

    def show(self):
        self.x11.XMapRaised(self.display, self.window)
        self.x11.XSync(self.display, 0)

    def hide(self):
        self.x11.XUnmapWindow(self.display, self.window)
        self.x11.XSync(self.display, 0)


def check_pinch():
    print("Two fingers over the drawing")
    before, state = picture("drawing"), items()
    centre = (267, 445)
    widths = [workpiece_width(before)]
    for name, start, end in (("apart", 110, 220), ("together", 220, 110)):
        screen.pinch(centre, start, end)
        time.sleep(0.5)
        shot = picture("pinch-" + name)
        widths.append(workpiece_width(shot))
        ratio = widths[-1] / widths[-2]
        check(abs(ratio / (end / start) - 1) < 0.1,
              f"{name} by {end / start:.2f}: the workpiece is {widths[-2]} px, then {widths[-1]} px wide ({ratio:.2f})")
        check(part(shot, PANEL) == part(before, PANEL) and lit_soft_key(shot) == lit_soft_key(before) and items() == state,
              "no key has been pressed: panel, page and state are as before")


def check_one_finger():
    print("One finger")
    before = picture("before-tap")
    check(lit_soft_key(before) == [3], f"soft key F3 is lit: {lit_soft_key(before)}")
    tapped(DIAGNOSIS)
    shot = picture("tap")
    check(lit_soft_key(shot) == [2] and part(shot, HEAD) != part(before, HEAD),
          f"tap on soft key F2: the title has changed, F2 is lit: {lit_soft_key(shot)}")
    screen.drag((550, 300), (250, 310), 0.25)
    time.sleep(0.6)
    shot = picture("swipe")
    check(lit_soft_key(shot) == [3] and part(shot, HEAD) == part(before, HEAD),
          f"swipe to the left: the next page, F3 is lit: {lit_soft_key(shot)}")
    on = items()["coolant"]
    tapped(COOLANT)
    now = items()["coolant"]
    check(now != on, f"tap on the key of the coolant: {on}, then {now}")
    tapped(COOLANT)


def check_jog():
    print("A finger on a jog key")
    press_jog()
    screen.up(1)
    stops("lifted")

    press_jog()
    before = items()["feed_override"]
    tapped(FEED_PLUS, finger=2)
    print(f"         second finger taps FEED +: feed override {before} %, then {items()['feed_override']} %")
    check(moves(), "second finger lifted: the first one still moves X")
    screen.up(1)
    stops("then the first one lifted")

    press_jog()
    screen.down(2, *EMPTY)
    time.sleep(0.3)
    screen.up(1)
    stops("first finger lifted, the second one stays on the page")
    screen.glide({2: jog_key()})
    time.sleep(0.4)
    check(not moves(), "the second one glides onto a jog key: X stands")
    screen.up(2)

    press_jog()
    screen.down(2, *Z_MINUS)
    time.sleep(0.3)
    screen.up(1)
    stops("second finger on Z-, first one lifted")
    check(items()["z_state"] == "STOPPED", "and Z stands")
    screen.up(2)

    press_jog()
    screen.glide({1: EMPTY})
    stops("the finger glides off the key")
    screen.glide({1: jog_key()})
    time.sleep(0.4)
    check(not moves(), "and back onto it: X stands until the next touch")
    screen.up(1)


def check_lost_touch():
    global screen
    print("A finger on a jog key, and the screen or the window is lost")
    press_jog()
    run("xinput", "disable", "finger")
    stops("the touch is cancelled: the touch screen is switched off")
    run("xinput", "enable", "finger")
    time.sleep(0.5)
    screen = touch.Screen(path, WIDTH, HEIGHT)
    for words, lose, regain in (
        ("the window loses the focus", ("windowfocus", "0"), ("windowfocus", window)),
        ("the window disappears", ("windowunmap", window), ("windowmap", window)),
    ):
        press_jog()
        run("xdotool", *lose)
        stops(words)
        run("xdotool", *regain)
        time.sleep(0.6)
        check(not moves(), "it is back, the finger still on the key: X stands until the next touch")
        screen.up(1)
        run("xdotool", "windowfocus", window)
        time.sleep(0.4)


def check_covered():
    print("A window comes over the finger, which is lifted there")
    message = Cover(740, 450, 280, 190)
    stopped = 0
    for flash in range(FLASHES):
        press_jog()
        message.show()
        time.sleep(0.002 * flash)
        screen.up(1)
        time.sleep(0.002)
        message.hide()
        time.sleep(0.4)
        if moves():
            picture("runs-on")
            tapped(EMPTY)
        else:
            stopped += 1
    check(stopped == FLASHES, f"for some milliseconds: X has stopped {stopped} of {FLASHES} times")

    whole = Cover(0, 0, WIDTH, HEIGHT)
    press_jog()
    whole.show()
    time.sleep(0.5)
    screen.up(1)
    time.sleep(0.3)
    whole.hide()
    time.sleep(0.6)
    check(not moves(), "for a second: X stands")
    before = items()["feed_override"]
    tapped(FEED_PLUS)
    now = items()["feed_override"]
    check(now != before, f"the first tap after it, on FEED +: {before} %, then {now} %")
    tapped(EMPTY)


def check_stop_keys():
    print("A finger rests on the page")
    screen.down(1, *EMPTY)
    time.sleep(0.3)
    tapped(EMERGENCY_STOP, finger=2)
    state = items()["estop"]
    check(state == "TRIGGERED", f"a second one taps E-STOP: {state}")
    screen.up(1)
    time.sleep(0.3)
    if state != "TRIGGERED":
        tapped(EMERGENCY_STOP)
        state = items()["estop"]
        check(state == "TRIGGERED", f"E-STOP alone: {state}")


wait_for(lambda: items()["mode"] == "MANUAL" and lit_soft_key(picture("start")) == [3])
# From here the story stands still, and what says so is on the screen.
tapped(TITLE)
time.sleep(2)
check_pinch()
check_one_finger()
check_jog()
check_lost_touch()
check_covered()
check_stop_keys()
print(f"tests/touch: {failures} FAILED" if failures else "tests/touch: all good")
sys.exit(1 if failures else 0)
