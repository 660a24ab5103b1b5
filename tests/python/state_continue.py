"""Continues a saved state in a process of its own.

Usage: python state_continue.py FMU STATE OUT: loads FMU, reads the serialised state from STATE, takes the steps of
`test_state.drive` and writes the outputs to OUT.
"""

import sys
from pathlib import Path

from robot import Robot
from test_state import TIME, bits, drive

if __name__ == "__main__":
    fmu, saved, out = map(Path, sys.argv[1:])
    robot = Robot(fmu).initialize({})
    state = robot.slave.deSerializeFMUstate(saved.read_bytes())
    robot.slave.setFMUstate(state)
    robot.slave.freeFMUstate(state)
    robot.time = TIME
    drive(robot)
    out.write_bytes(bits(robot))
    robot.free()
