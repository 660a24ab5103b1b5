"""A controller at 500 Hz that looks ahead: it tries three commands from a saved state, goes back, and takes the best.

The rover drives to a point. At each instant the model of the rover, which is the simulation itself, says where each
of three commands would lead in 0.06 s; the state is restored after each look.

Needs urdf2fmu. `python controller.py ../rover.urdf`
"""

import sys
import time

import numpy as np

import urdf2fmu

PERIOD = 1 / 500
"""s"""
AHEAD = 0.06
"""s"""
GOAL = np.array([0.5, 0.2])
"""m"""
START = {"solver.step_size": 0.005}
"""Steps of 5 ms: every look takes the same time, as a controller in real time needs."""
COMMANDS = {"ahead": (6.0, 6.0), "left": (-3.0, 3.0), "right": (3.0, -3.0)}
"""rad/s, of the left and the right wheels"""


def command(robot, left, right):
    """Sets the wheels' speeds."""
    robot["cmd.left_*_wheel_joint.velocity"] = left
    robot["cmd.right_*_wheel_joint.velocity"] = right


def distance(robot):
    """From the goal, m, with a price on heading elsewhere."""
    x, y = GOAL - robot["base.position"][:2]
    angle = np.arctan2(y, x) - robot["base.rpy.yaw"]
    return np.hypot(x, y) * (2.0 - np.cos(angle))


def best(robot):
    """The command that leads nearest to the goal within the time ahead."""
    state, found = robot.save(), {}
    for name, speeds in COMMANDS.items():
        command(robot, *speeds)
        robot.step(AHEAD)
        found[name] = distance(robot)
        robot.restore(state)
    return min(found, key=found.get)


def main():
    with urdf2fmu.Simulation(sys.argv[1], start_values=START) as robot:
        taken, times = [], []
        while np.hypot(*(GOAL - robot["base.position"][:2])) > 0.1 and robot.time < 10:
            began = time.process_time()
            taken.append(best(robot))
            command(robot, *COMMANDS[taken[-1]])
            robot.step(PERIOD)
            times.append(time.process_time() - began)
        counts = ", ".join(f"{taken.count(name)} {name}" for name in COMMANDS)
        x, y = robot["base.position"][:2]
        print(f"at x = {x:.3f} m, y = {y:.3f} m after {robot.time:.2f} s; commands: {counts}")
        middle, most = 1e6 * np.percentile(times, [50, 99])
        print(f"processor time of a period of {1e6 * PERIOD:.0f} us: median {middle:.0f} us, of 99 in 100 at most "
              f"{most:.0f} us", file=sys.stderr)


if __name__ == "__main__":
    main()
