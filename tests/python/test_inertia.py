"""Masses, centres of mass and inertias of twenty robots against Pinocchio.

Conventions: Pinocchio adds the links behind fixed joints to the body in front of them, in the frame of the joint that
moves it; here `urdf2fmu info` lists every link in its own frame, and the sums are made in this file. With a free-flying
root joint Pinocchio keeps the root's inertia, too. Mimic joints are bodies of their own in both.
"""

import json

import numpy as np
import pinocchio as pin
import pytest

# Relative to the largest moment about the joint; for the centres relative to their distance, or to 1 m where it is less.
TOLERANCE = 1e-12

ROBOTS = [
    "pybullet:r2d2.urdf", "pybullet:kuka_iiwa/model.urdf", "pybullet:franka_panda/panda.urdf", "pybullet:a1/a1.urdf",
    "pybullet:quadruped/spirit40.urdf", "pybullet:laikago/laikago_toes.urdf", "pybullet:quadruped/minitaur.urdf",
    "pybullet:quadruped/vision60.urdf", "pybullet:mini_cheetah/mini_cheetah.urdf", "pybullet:xarm/xarm6_robot.urdf",
    "pybullet:racecar/racecar.urdf", "pybullet:cartpole.urdf",
    "example:anymal_b_simple_description/robots/anymal.urdf", "example:anymal_c_simple_description/urdf/anymal.urdf",
    "example:g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf", "example:panda_description/urdf/panda.urdf",
    "example:tiago_description/robots/tiago.urdf", "example:ur_description/urdf/ur5_robot.urdf",
    "example:go2_description/urdf/go2.urdf", "example:solo_description/robots/solo12.urdf",
]


def bodies(told):
    """Joint that moves a body (none for the root) -> mass, centre, inertia about the centre, in that joint's frame."""
    parts = {}
    # Pose of each link in its body's frame; parents come before children.
    joint_of = {joint["link"]: joint for joint in told["joints"]}
    pose = {}
    for link in told["links"]:
        joint = joint_of.get(link["name"])
        if joint is None:
            pose[link["name"]] = (None, np.eye(3), np.zeros(3))
        elif joint["type"] == "fixed":
            body, R, p = pose[joint["parent"]]
            turn = pin.Quaternion(*np.roll(joint["origin_orientation_xyzw"], 1)).toRotationMatrix()
            pose[link["name"]] = (body, R @ turn, p + R @ np.array(joint["origin_position"]))
        else:
            pose[link["name"]] = (joint["name"], np.eye(3), np.zeros(3))
        body, R, p = pose[link["name"]]
        parts.setdefault(body, []).append(
            (link["mass"], p + R @ np.array(link["com"]), R @ np.array(link["inertia"]) @ R.T))
    whole = {}
    for body, list_ in parts.items():
        mass = sum(m for m, _, _ in list_)
        center = sum(m * c for m, c, _ in list_) / mass if mass else np.zeros(3)
        inertia = sum(I + m * ((d := c - center) @ d * np.eye(3) - np.outer(d, d)) for m, c, I in list_)
        whole[body] = (mass, center, inertia)
    return whole


@pytest.mark.parametrize("robot", ROBOTS)
def test_masses_and_inertias_agree_with_pinocchio(robot, pybullet_data, example_robots, command):
    where, name = robot.split(":")
    urdf = {"pybullet": pybullet_data, "example": example_robots}[where] / name
    done = command("info", "--json", urdf)
    assert done.returncode == 0, done.stderr
    ours = bodies(json.loads(done.stdout))
    model = pin.buildModelFromUrdf(str(urdf), pin.JointModelFreeFlyer())
    theirs = dict(zip([None, *list(model.names)[2:]], list(model.inertias)[1:], strict=True))
    assert set(ours) == set(theirs)
    for body, (mass, center, inertia) in ours.items():
        reference = theirs[body]
        assert mass == pytest.approx(reference.mass, rel=TOLERANCE), body
        if mass == 0:
            continue
        lever = np.abs(reference.lever).max()
        about = np.abs(reference.inertia).max() + mass * lever**2
        assert np.abs(center - reference.lever).max() <= TOLERANCE * max(lever, 1.0), body
        assert np.abs(inertia - reference.inertia).max() <= TOLERANCE * about, body
