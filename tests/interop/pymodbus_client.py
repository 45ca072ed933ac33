#!/usr/bin/env python3
"""Reads registers with pymodbus, to try our simulated meters.

usage: pymodbus_client.py WHERE UNIT:FUNCTION:FIRST:COUNT...

WHERE is a tty, rtu+tcp://HOST:PORT or tcp://HOST:PORT. Prints a JSON array with what came of each
read: the registers, or the code of the exception, or null when there was no answer.
"""

import json
import sys

from pymodbus.client import ModbusSerialClient, ModbusTcpClient
from pymodbus.exceptions import ModbusException
from pymodbus.framer import FramerType

TIMEOUT = 0.5


def connect(where: str) -> ModbusSerialClient | ModbusTcpClient:
    scheme, separator, address = where.partition("://")
    if not separator:
        return ModbusSerialClient(where, framer=FramerType.RTU, baudrate=9600, timeout=TIMEOUT, retries=0)
    host, _, port = address.rpartition(":")
    framer = {"rtu+tcp": FramerType.RTU, "tcp": FramerType.SOCKET}[scheme]
    return ModbusTcpClient(host, port=int(port), framer=framer, timeout=TIMEOUT, retries=0)


def read(client: ModbusSerialClient | ModbusTcpClient, what: str) -> list[int] | int | None:
    unit, function, first, count = (int(number, 0) for number in what.split(":"))
    call = {3: client.read_holding_registers, 4: client.read_input_registers}[function]
    try:
        answer = call(first, count=count, device_id=unit)
    except ModbusException:
        return None
    return answer.exception_code if answer.isError() else answer.registers


def main() -> int:
    where, *reads = sys.argv[1:]
    client = connect(where)
    if not client.connect():
        print(f"cannot connect to {where}", file=sys.stderr)
        return 1
    print(json.dumps([read(client, what) for what in reads]))
    client.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
