"""Fingers for the touch screen of the Xorg driver "inputtest" (man inputtestdrv): taps, drags and pinches on a display
without any hardware."""

import socket
import struct
import time

# Numbers of the protocol of the driver, and of the touch events of XInput 2.
CLIENT_VERSION, WAIT_FOR_SYNC, TOUCH = 0, 1, 6
BEGIN, UPDATE, END = 18, 19, 20
VALUATORS = 64
# Both axes of the touch screen go from 0 to this.
AXIS = 0xFFFF
# Time between two events of a moving finger, s.
STEP = 0.016


class Screen:
    """The touch screen; every finger has a number of its own from its first touch to its lifting."""

    def __init__(self, path, width=1024, height=768):
        self.size = (width, height)
        self.places = {}
        self.stream = socket.socket(socket.AF_UNIX)
        self.stream.connect(path)
        self._send(CLIENT_VERSION, struct.pack("=HH", 1, 0))
        self._receive(12)

    def _send(self, kind, body=b""):
        self.stream.sendall(struct.pack("=II", 8 + len(body), kind) + body)

    def _receive(self, size):
        while size:
            got = self.stream.recv(size)
            if not got:
                raise ConnectionError("the driver has closed the socket")
            size -= len(got)

    def _touch(self, finger, kind, x, y):
        places = [x / self.size[0] * AXIS, y / self.size[1] * AXIS] + [0.0] * (VALUATORS - 2)
        # The first two valuators are told, without values before acceleration. The C structs align doubles to 8 bytes.
        told = struct.pack("=I8s4x64d64d", 0, bytes([3]), *places, *[0.0] * VALUATORS)
        self._send(TOUCH, struct.pack("=II", finger, kind) + told)
        # Until the server has processed it.
        self._send(WAIT_FOR_SYNC)
        self._receive(8)

    def down(self, finger, x, y):
        self.places[finger] = (x, y)
        self._touch(finger, BEGIN, x, y)

    def move(self, finger, x, y):
        self.places[finger] = (x, y)
        self._touch(finger, UPDATE, x, y)

    def up(self, finger):
        self._touch(finger, END, *self.places.pop(finger))

    def glide(self, ways, seconds=0.4):
        """Moves fingers that are down evenly: the place where each ends."""
        begun = {finger: self.places[finger] for finger in ways}
        steps = max(1, round(seconds / STEP))
        for step in range(1, steps + 1):
            for finger, (x, y) in ways.items():
                from_x, from_y = begun[finger]
                self.move(finger, from_x + (x - from_x) * step / steps, from_y + (y - from_y) * step / steps)
            time.sleep(STEP)

    def tap(self, x, y, seconds=0.12, finger=1):
        self.down(finger, x, y)
        time.sleep(seconds)
        self.up(finger)

    def drag(self, start, end, seconds=0.3, finger=1):
        self.down(finger, *start)
        time.sleep(0.05)
        self.glide({finger: end}, seconds)
        self.up(finger)

    def pinch(self, centre, before, after, seconds=0.6):
        """Two fingers side by side, `before` pixels apart, end `after` pixels apart."""
        (x, y), near, far = centre, before / 2, after / 2
        self.down(1, x - near, y)
        self.down(2, x + near, y)
        time.sleep(0.1)
        self.glide({1: (x - far, y), 2: (x + far, y)}, seconds)
        time.sleep(0.1)
        self.up(2)
        self.up(1)
