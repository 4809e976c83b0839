"""A frequency inverter on Modbus TCP, by pymodbus: the station of `modbus.rs`.

Registers 0 and 1: controlword (bit 0 runs) and speed, written by the control. Registers 10 and 11: statusword and speed,
read by it; the speed follows while it runs. A line `status N` on standard input sets the statusword; every change of the
controlword or the speed is a line on standard output.
"""

import asyncio
import sys

from pymodbus.server import StartAsyncTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

CONTROL, SPEED, STATUS, ACTUAL = 0, 1, 10, 11
status, told = 0, None


async def act(_function, start, _address, _count, registers, written):
    """Before each answer: the registers of the inverter follow."""
    global told
    registers[STATUS - start] = status
    registers[ACTUAL - start] = registers[SPEED - start] if registers[CONTROL - start] & 1 else 0
    now = tuple(written[:2]) if written else (registers[CONTROL - start], registers[SPEED - start])
    if now != told:
        told = now
        print(f"control {now[0]} speed {now[1]}", flush=True)


def take_line():
    """A command, or the end."""
    global status
    words = sys.stdin.readline().split()
    if not words:
        asyncio.get_running_loop().remove_reader(sys.stdin)
        return
    status = int(words[1])


async def main(port):
    """Serves until the process is ended."""
    asyncio.get_running_loop().add_reader(sys.stdin, take_line)
    registers = SimData(0, count=16, values=0, datatype=DataType.REGISTERS)
    await StartAsyncTcpServer(SimDevice(1, [registers], action=act), address=("127.0.0.1", port))


asyncio.run(main(int(sys.argv[1])))
