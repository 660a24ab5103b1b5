"""The discrete linear model of a robot: x[k+1] = A x[k] + B u[k] about a state, by central differences.

x holds positions and velocities of the joints, u the efforts; h is one fixed step of the solver. B is found from a
saved state, A from starts beside that state. Fixed steps (`solver.step_size`) are needed: with error control two runs
may choose other steps, and the difference then tells these steps and not the robot.

Needs urdf2fmu. `python linearise.py ../arm.urdf`
"""

import sys

import numpy as np

import urdf2fmu

H = 1 / 240
SMALL = 1e-4
"""Increment of efforts, N.m, positions, rad, and velocities, rad/s."""

SETTINGS = {"robot": {"base": "fixed"}, "solver": {"step_size": H}}


def state(robot, joints):
    """Positions, then velocities."""
    return np.array([robot[f"joint.{joint}.{what}"] for what in ("position", "velocity") for joint in joints])


def input_matrix(robot, joints):
    """B, from the present state, which is restored."""
    saved, columns = robot.save(), []
    for joint in joints:
        name, ends = f"cmd.{joint}.effort", []
        effort = robot[name]
        for sign in 1, -1:
            robot[name] = effort + sign * SMALL
            robot.step(H)
            ends.append(state(robot, joints))
            robot.restore(saved)
        columns.append((ends[0] - ends[1]) / (2 * SMALL))
    return np.array(columns).T


def state_matrix(robot, joints, at):
    """A, about the state `at`."""
    names = [f"initial.joint.{joint}.{what}" for what in ("position", "velocity") for joint in joints]
    columns = []
    for i in range(len(at)):
        ends = []
        for sign in 1, -1:
            start = at.copy()
            start[i] += sign * SMALL
            robot.reset(dict(zip(names, start)))
            robot.step(H)
            ends.append(state(robot, joints))
        columns.append((ends[0] - ends[1]) / (2 * SMALL))
    return np.array(columns).T


def linearise(robot_file):
    """A and B of an arm a little beside its zero position, that state, and the joints."""
    with urdf2fmu.Simulation(robot_file, config=SETTINGS, mode="effort") as robot:
        joints = [name.split(".")[1] for name in robot.names("cmd.*.effort")]
        at = np.concatenate([np.full(len(joints), 0.01), np.zeros(len(joints))])
        names = [f"initial.joint.{joint}.position" for joint in joints]
        robot.reset(dict(zip(names, at)))
        B = input_matrix(robot, joints)
        A = state_matrix(robot, joints, at)
        return A, B, at, joints


def main():
    A, B, _, joints = linearise(sys.argv[1])
    np.set_printoptions(precision=4, suppress=True, linewidth=160)
    print("joints", *joints)
    print(f"A: {A.shape[0]} x {A.shape[1]}, largest |eigenvalue| {abs(np.linalg.eigvals(A)).max():.4f}")
    print("B, velocities, rad/s for each N.m")
    print(B[len(joints):])


if __name__ == "__main__":
    main()
