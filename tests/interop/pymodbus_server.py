#!/usr/bin/env python3
"""A Modbus RTU server made of pymodbus, to read and write with our client.

Units 1 and 2, each with 300 holding and 300 input registers from address 0
and the values that `run` computes; pymodbus answers exception 02 beyond them.
Other units are not answered. Serves until it is killed.
"""

import argparse

from pymodbus.framer import FramerType
from pymodbus.pdu import ModbusPDU
from pymodbus.server import StartSerialServer
from pymodbus.simulator import DataType, SimData, SimDevice

REGISTERS = 300

# unit: (holding, input), each factor * address + offset
FORMULAS = {1: ((7, 3), (11, 5)), 2: ((13, 1001), (17, 2003))}


def block(factor: int, offset: int) -> list[SimData]:
    values = [(address * factor + offset) & 0xFFFF for address in range(REGISTERS)]
    return [SimData(0, values=values, datatype=DataType.REGISTERS)]


def device(unit: int) -> SimDevice:
    holding, inputs = FORMULAS[unit]
    no_bits = [SimData(0, values=[False] * 16, datatype=DataType.BITS)]
    return SimDevice(unit, simdata=(no_bits, list(no_bits), block(*holding), block(*inputs)))


def own_units_only(sending: bool, pdu: ModbusPDU) -> ModbusPDU | None:
    """Drops requests to other units: a unit that is not there is silent.

    `ignore_missing_devices` is meant for this, but with `SimDevice` pymodbus
    3.16.1 answers exception 04 all the same.
    """
    return pdu if sending or pdu.dev_id in FORMULAS else None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("device", help="the serial port to serve on")
    parser.add_argument("--baud", type=int, default=9600)
    parser.add_argument("--parity", choices=["none", "even", "odd"], default="none")
    arguments = parser.parse_args()
    StartSerialServer(
        [device(unit) for unit in FORMULAS],
        framer=FramerType.RTU,
        port=arguments.device,
        baudrate=arguments.baud,
        bytesize=8,
        parity={"none": "N", "even": "E", "odd": "O"}[arguments.parity],
        stopbits=1,
        trace_pdu=own_units_only,
    )


if __name__ == "__main__":
    main()
