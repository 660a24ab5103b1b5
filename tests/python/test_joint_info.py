"""The tables of `urdf2fmu info` against PyBullet's getJointInfo, getDynamicsInfo and getLinkState, for 28 robots.

All 17 columns of every joint are compared. Where PyBullet's convention is another one, its number is turned into ours
by the rule that docs/pybullet.md gives; each rule stands in one function here.
"""

import json
import re
import xml.etree.ElementTree as xml

import numpy as np
import pytest

pybullet = pytest.importorskip("pybullet", reason="PyBullet has no wheel for this Python and platform")

ROBOTS = [
    "pybullet:r2d2.urdf", "pybullet:kuka_iiwa/model.urdf", "pybullet:franka_panda/panda.urdf", "pybullet:a1/a1.urdf",
    "pybullet:husky/husky.urdf", "pybullet:laikago/laikago_toes.urdf", "pybullet:quadruped/minitaur.urdf",
    "pybullet:quadruped/vision60.urdf", "pybullet:mini_cheetah/mini_cheetah.urdf", "pybullet:racecar/racecar.urdf",
    "pybullet:xarm/xarm6_with_gripper.urdf", "pybullet:humanoid/humanoid.urdf", "pybullet:cartpole.urdf",
    "pybullet:spherical_joint_limit.urdf", "pybullet:TwoJointRobot_w_fixedJoints.urdf",
    "example:anymal_b_simple_description/robots/anymal-kinova.urdf", "example:baxter_description/urdf/baxter.urdf",
    "example:double_pendulum_description/urdf/double_pendulum.urdf", "example:g1_description/urdf/g1_29dof_rev_1_0.urdf",
    "example:go2_description/urdf/go2.urdf", "example:hyq_description/robots/hyq_no_sensors.urdf",
    "example:icub_description/robots/icub_reduced.urdf", "example:kinova_description/robots/kinova.urdf",
    "example:pr2_description/urdf/pr2.urdf", "example:solo_description/robots/solo12.urdf",
    "example:talos_data/robots/talos_reduced.urdf", "example:tiago_description/robots/tiago.urdf",
    "example:ur_description/urdf/ur5_robot.urdf",
]
# PyBullet keeps positions in double precision and works out its frames from roll, pitch, yaw by another way.
LENGTH = dict(abs=1e-6, rel=1e-6)

TYPES = {pybullet.JOINT_REVOLUTE: {"revolute", "continuous"}, pybullet.JOINT_PRISMATIC: {"prismatic"},
         pybullet.JOINT_SPHERICAL: {"spherical"}, pybullet.JOINT_PLANAR: {"planar"}, pybullet.JOINT_FIXED: {"fixed"}}
# Places that a joint takes in q and v.
SIZES = {"revolute": (1, 1), "continuous": (1, 1), "prismatic": (1, 1), "spherical": (4, 3), "planar": (3, 3),
         "fixed": (0, 0)}


def matrix(quaternion):
    """Rotation of a quaternion x, y, z, w."""
    return np.array(pybullet.getMatrixFromQuaternion(quaternion)).reshape(3, 3)


def file_limits(urdf):
    """Joint -> (lower, upper, effort, velocity) of `<limit>`; PyBullet's 0, -1, 0, 0 where there is none."""
    text = urdf.read_text().strip()
    robot = xml.fromstring(text[:text.rfind("</robot>") + len("</robot>")])
    found = {}
    for joint in robot.findall("joint"):
        limit = joint.find("limit")
        given = {} if limit is None else limit.attrib
        found[joint.get("name")] = [float(given.get(name, default)) for name, default in
                                    (("lower", 0), ("upper", -1), ("effort", 0), ("velocity", 0))]
    return found


class Both:
    """A robot here and there."""

    def __init__(self, urdf, command):
        done = command("info", "--json", "--variables", urdf)
        assert done.returncode == 0, done.stderr
        told = json.loads(done.stdout)
        self.text = urdf.read_text()
        self.base = told["base"]
        self.joints = {joint["name"]: joint for joint in told["joints"]}
        self.links = {link["name"]: link for link in told["links"]}
        self.start = {v["name"]: v["start"] for v in told["variables"] if v["name"].startswith("initial.joint.")}
        self.limits = file_limits(urdf)
        self.robot = pybullet.loadURDF(str(urdf), useFixedBase=self.base == "fixed")
        count = pybullet.getNumJoints(self.robot)
        self.rows = [pybullet.getJointInfo(self.robot, joint) for joint in range(count)]
        # PyBullet's numbers of links are those of their joints; the base is -1.
        self.names = [pybullet.getBodyInfo(self.robot)[0].decode(), *(row[12].decode() for row in self.rows)]
        self.dynamics = {name: pybullet.getDynamicsInfo(self.robot, i - 1) for i, name in enumerate(self.names)}

    def inertial(self, link):
        """Axes and origin of a link's inertial frame in the link's."""
        return matrix(self.dynamics[link][4]), np.array(self.dynamics[link][3])

    def misread(self, joint):
        """Husky's IMU stands where an expression of xacro says, which PyBullet reads as zeros."""
        return joint == "imu_joint" and "$(optenv" in self.text


@pytest.fixture(scope="module")
def client():
    number = pybullet.connect(pybullet.DIRECT)
    yield
    pybullet.disconnect(number)


@pytest.fixture(scope="module", params=ROBOTS)
def both(request, client, pybullet_data, example_robots, command):
    where, name = request.param.split(":")
    pybullet.resetSimulation()
    return Both({"pybullet": pybullet_data, "example": example_robots}[where] / name, command)


def test_the_joint_table_is_that_of_pybullet(both):
    assert [row[1].decode() for row in both.rows] == list(both.joints)
    q, v = (7, 6) if both.base == "floating" else (0, 0)
    for (index, name, kind, their_q, their_v, flags, damping, friction, lower, upper, effort, velocity, link, axis,
         position, orientation, parent) in both.rows:
        name = name.decode()
        ours = both.joints[name]
        assert ours["index"] == index, name
        assert ours["type"] in TYPES[kind], name

        # Places count from the base's 7 and 6, here only if it floats; joints that mimic have none of their own.
        own = ours["type"] != "fixed" and ours["mimic"] is None
        assert (their_q >= 0) == (their_v >= 0) == (ours["type"] != "fixed"), name
        assert [ours["q_index"], ours["v_index"]] == ([q, v] if own else [None, None]), name
        if own:
            q, v = q + SIZES[ours["type"]][0], v + SIZES[ours["type"]][1]
            if both.base == "floating" and not any(joint["mimic"] for joint in both.joints.values()):
                assert (ours["q_index"], ours["v_index"]) == (their_q, their_v), name

        # Theirs says whether the joint turns or slides, ours whether it is commanded.
        turns = ours["type"] in ("revolute", "continuous", "prismatic")
        assert flags == turns, name
        assert ours["flags"] == (flags and own), name

        # Theirs are the file's, whether or not the joint can move or has limits.
        assert [lower, upper, effort, velocity] == pytest.approx(both.limits[name]), name
        moving = ours["type"] != "fixed"
        assert ours["damping"] == (pytest.approx(damping) if moving else 0), name
        assert ours["friction"] == (pytest.approx(friction) if moving else 0), name
        limited = ours["type"] in ("revolute", "prismatic") and lower <= upper
        assert [ours["lower"], ours["upper"]] == ([pytest.approx(lower), pytest.approx(upper)] if limited else [None, None]), name
        given = moving and ours["type"] != "spherical" and (effort != 0 or velocity != 0)
        assert [ours["max_effort"] or 0, ours["max_velocity"] or 0] == (
            [pytest.approx(effort), pytest.approx(velocity)] if given else [0, 0]), name

        assert ours["link"] == link.decode(), name
        assert ours["parent"] == both.names[parent + 1], name
        # The base is link 0 here and -1 there.
        assert ours["parent_index"] == parent + 1, name

        # Theirs is in the child's inertial frame, ours in the joint's, which is the child's at zero.
        R_CI, _ = both.inertial(ours["link"])
        if turns:
            assert list(ours["axis"]) == pytest.approx(list(R_CI @ axis), abs=1e-6), name
        if both.misread(name):
            continue
        # Theirs is from the parent's inertial frame to the child's, and turned the other way; ours is the file's.
        R_PI, p_PI = both.inertial(ours["parent"])
        p_PJ, R_PJ = np.array(ours["origin_position"]), matrix(ours["origin_orientation_xyzw"])
        assert list(R_PI.T @ (p_PJ - p_PI)) == pytest.approx(list(position), **LENGTH), name
        assert (R_PI.T @ R_PJ @ R_CI).T == pytest.approx(matrix(orientation), abs=1e-5), name


def test_masses_and_surfaces_of_links_are_those_of_pybullet(both):
    for name, (mass, friction, _, com, _, restitution, rolling, spinning, *_) in both.dynamics.items():
        ours = both.links[name]
        # PyBullet gives 1 kg to what has no <inertial>, and no mass to a base that cannot move.
        if ours["mass"] > 0 and not (both.base == "fixed" and name == both.names[0]):
            assert ours["mass"] == pytest.approx(mass, rel=1e-12), name
        if ours["mass"] > 0:
            assert ours["com"] == pytest.approx(list(com), abs=1e-12), name
        else:
            assert mass in (0, 1), name
        # 0.5 where the file has none; <gazebo> is not read there.
        if friction != 0.5:
            assert ours["friction"] == friction, name
        assert [ours["restitution"], ours["rolling_friction"], ours["spinning_friction"]] == [
            restitution, rolling, spinning], name


def test_poses_of_links_are_those_of_pybullet(both):
    """getLinkState at the joint positions that the robot starts with here, seen from the root link."""
    positions = {}
    for name in both.joints:
        plain = re.sub("[^A-Za-z0-9_]", "_", name)
        positions[name] = both.start.get(f"initial.joint.{plain}.position", 0.0)
    for name, joint in both.joints.items():
        if joint["mimic"]:
            follow = joint["mimic"]
            positions[name] = follow["multiplier"] * positions[follow["joint"]] + follow["offset"]
    for row in both.rows:
        if row[2] in (pybullet.JOINT_REVOLUTE, pybullet.JOINT_PRISMATIC):
            pybullet.resetJointState(both.robot, row[0], positions[row[1].decode()])
    root = both.names[0]
    # Theirs is the pose of the base's centre of mass.
    p, turn = pybullet.getBasePositionAndOrientation(both.robot)
    R_RI, p_RI = both.inertial(root)
    R_WR = matrix(turn) @ R_RI.T
    p_WR = np.array(p) - R_WR @ p_RI
    ours_R, ours_p = matrix(both.links[root]["orientation_xyzw"]), np.array(both.links[root]["position"])
    for index, name in enumerate(both.names[1:]):
        if both.misread(both.rows[index][1].decode()):
            continue
        com, _, _, _, frame, turn, *_ = pybullet.getLinkState(both.robot, index, computeForwardKinematics=True)
        place = ours_R.T @ (np.array(both.links[name]["position"]) - ours_p)
        there = R_WR.T @ (np.array(frame) - p_WR)
        assert list(place) == pytest.approx(list(there), abs=2e-5), name
        here = ours_R.T @ matrix(both.links[name]["orientation_xyzw"])
        assert here == pytest.approx(R_WR.T @ matrix(turn), abs=2e-5), name
        # The first column is the centre of mass there; here it is the frame, and `com` is the way from it.
        if both.links[name]["mass"] > 0:
            middle = place + here @ np.array(both.links[name]["com"])
            assert list(middle) == pytest.approx(list(R_WR.T @ (np.array(com) - p_WR)), abs=2e-5), name
