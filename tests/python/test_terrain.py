"""Robots on slopes: how steep they climb follows from friction, where they tip from their masses."""

import math

import numpy as np
import pinocchio
import pytest

G = 9.81
HUSKY = [f"{end}_{side}_wheel" for end in ("front", "rear") for side in ("left", "right")]
R2D2 = [f"{side}_{end}_wheel_joint" for end in ("front", "back") for side in ("left", "right")]


def about(axis, angle):
    """Rotation about the axis x, y or z (0, 1, 2)."""
    a, b = [(1, 2), (2, 0), (0, 1)][axis]
    turn = np.eye(3)
    turn[a, a] = turn[b, b] = math.cos(angle)
    turn[b, a], turn[a, b] = math.sin(angle), -math.sin(angle)
    return turn


def settings(slope, heading, friction):
    """A slope up along x; the robot stands on it and looks up where its heading, rad, turns it there."""
    turn = about(1, -slope) @ about(2, heading)
    rpy = [math.atan2(turn[2, 1], turn[2, 2]), -math.asin(turn[2, 0]), math.atan2(turn[1, 0], turn[0, 0])]
    return f"""
[robot]
inertia = "collision"
[initial]
xyz = [0, 0]
rpy = [{", ".join(f"{angle:.15f}" for angle in rpy)}]
[[world.terrain]]
name = "slope"
type = "plane"
rpy = [0, {-slope:.15f}, 0]
friction = {friction}
[link."*"]
friction = {friction}
"""


@pytest.mark.parametrize("name, wheels, heading, speed, friction", [
    ("husky/husky.urdf", HUSKY, 0, 0.5, 0.3),
    ("husky/husky.urdf", HUSKY, 0, 0.5, 0.8),
    # R2D2 looks along y. With much more friction it tips before, see below.
    ("r2d2.urdf", R2D2, -math.pi / 2, -2.0, 0.3),
])
def test_a_robot_climbs_to_the_angle_of_friction(pybullet_data, export, load, name, wheels, heading, speed, friction):
    limit = math.atan(friction)
    for beyond in (-0.1, 0.1):
        slope = limit + math.radians(beyond)
        robot = load(export(pybullet_data / name, settings(slope, heading, friction)), tolerance=1e-4)
        for wheel in wheels:
            robot[f"cmd.{wheel}.velocity"] = speed
            robot[f"cmd.{wheel}.max_effort"] = 100
        up = np.array([math.cos(slope), 0, math.sin(slope)])
        begin = up @ robot.vector("base.position")
        seconds = 8
        for _ in range(240 * seconds):
            robot.step(1 / 240)
        way = up @ robot.vector("base.position") - begin
        # Wheels that slip push with all friction that there is.
        pushed = G * (friction * math.cos(slope) - math.sin(slope))
        if beyond > 0:
            assert way == pytest.approx(pushed * seconds**2 / 2, rel=0.1)
        else:
            assert way > 0.4


def test_r2d2_tips_where_its_centre_of_mass_is_over_its_back_wheels(pybullet_data, export, load):
    model = pinocchio.buildModelFromUrdf(str(pybullet_data / "r2d2.urdf"), pinocchio.JointModelFreeFlyer())
    data = model.createData()
    pose = pinocchio.neutral(model)
    center = pinocchio.centerOfMass(model, data, pose)
    pinocchio.forwardKinematics(model, data, pose)
    wheel = data.oMi[model.getJointId("left_back_wheel_joint")].translation
    radius = 0.035  # m, as the file has it
    expected = math.degrees(math.atan2(center[1] - wheel[1], center[2] - (wheel[2] - radius)))
    assert expected == pytest.approx(20.06, abs=0.01)
    # One degree less, and gravity turns slowly on.
    slope = math.radians(expected - 1)
    robot = load(export(pybullet_data / "r2d2.urdf", settings(slope, -math.pi / 2, 0.8)))
    rate, step = 0.05, 0.02  # °/s, s

    def tilt():
        roll, pitch, yaw = robot.vector("base.rpy", ("roll", "pitch", "yaw"))
        return np.array(about(2, yaw) @ about(1, pitch) @ about(0, roll))[:, 2]

    for _ in range(50):
        robot.step(step)
    upright, angle = tilt(), 0.0
    while math.acos(min(1.0, tilt() @ upright)) < math.radians(1):
        angle += rate * step
        assert angle < 3
        robot["world.gravity.x"] = -G * math.sin(math.radians(angle))
        robot["world.gravity.z"] = -G * math.cos(math.radians(angle))
        robot.step(step)
    # Until it has tipped by a degree gravity turns by a few hundredths.
    assert expected - 1 + angle == pytest.approx(expected + 0.05, abs=0.05)
