"""Closed loops against Pinocchio's constrained dynamics: accelerations and forces of a delta robot and an excavator.

Both machines are driven by efforts until they move fast. At forty moments Pinocchio gets their positions, velocities
and efforts, and solves the same constraints: points of two links that stay together (`CONTACT_3D`). Those of the
excavator are hinges here, which is the same for a machine in one plane; what they carry along their own axes is not
determined by statics, and not compared.
"""

import math

import numpy as np
import pinocchio as pin
import pytest

ARM, ROD, PLATFORM, BASE = 0.3, 0.7, 0.06, 0.2
# The rods' angle from the vertical where all joints are at zero.
LEAN = math.asin((BASE + ARM - PLATFORM) / ROD)


def link(name, mass, center, inertia):
    x, y, z = inertia
    return (f'<link name="{name}"><inertial><origin xyz="{center}"/><mass value="{mass}"/>'
            f'<inertia ixx="{x}" ixy="0" ixz="0" iyy="{y}" iyz="0" izz="{z}"/></inertial></link>\n')


def hinge(name, parent, child, xyz, rpy, axis):
    return (f'<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/></joint>\n')


def delta():
    """A delta robot whose six rods have mass: its URDF, and loops (links and points) that hold five of them.

    The platform hangs on the first rod by three axes; each rod hangs on its arm by two. 18 joints, 15 rows.
    """
    parts, loops = ['<robot name="heavy_delta"><link name="base"/>\n'], []
    cross, lying = 0.02, [4e-6, 4e-6, 4e-6]
    for arm in range(3):
        yaw = 2 * math.pi / 3 * arm
        out, side = np.array([math.cos(yaw), math.sin(yaw)]), np.array([-math.sin(yaw), math.cos(yaw)])
        parts.append(link(f"arm_{arm}", 0.4, "0.15 0 0", [1e-4, 3.1e-3, 3.2e-3]))
        x, y = (BASE * out).tolist()
        parts.append(hinge(f"shoulder_{arm}", "base", f"arm_{arm}", f"{x} {y} 0", f"0 0 {yaw}", "0 1 0"))
        for rod, offset in ("a", 0.04), ("b", -0.04):
            name = f"{arm}{rod}"
            parts += [link(f"cross_{name}", cross, "0 0 0", lying),
                      link(f"rod_{name}", 0.1, "0 0 -0.35", [4.1e-3, 4.1e-3, 2e-5]),
                      hinge(f"swing_{name}", f"arm_{arm}", f"cross_{name}", f"{ARM} {offset} 0", f"0 {LEAN} 0",
                            "0 1 0"),
                      hinge(f"tilt_{name}", f"cross_{name}", f"rod_{name}", "0 0 0", "0 0 0", "1 0 0")]
            x, y = (PLATFORM * out + offset * side).tolist()
            if (arm, rod) == (0, "a"):
                # The ball at its end; the platform's frame is then parallel to the base's.
                parts += [link("ball_1", cross, "0 0 0", lying), link("ball_2", cross, "0 0 0", lying),
                          link("platform", 0.3, f"{0.01 - x} {-y} -0.02", [4e-4, 5e-4, 7e-4]),
                          hinge("ball_x", "rod_0a", "ball_1", f"0 0 {-ROD}", f"0 {-LEAN} 0", "1 0 0"),
                          hinge("ball_y", "ball_1", "ball_2", "0 0 0", "0 0 0", "0 1 0"),
                          hinge("ball_z", "ball_2", "platform", "0 0 0", "0 0 0", "0 0 1")]
                held = np.array([x, y])
            else:
                end = np.array([x, y]) - held
                loops.append((f"end_{name}", [f"rod_{name}", "platform"], [[0, 0, -ROD], [*end.tolist(), 0]]))
    return "".join(parts) + "</robot>\n", loops


EXCAVATOR = [("boom_pin", ["boom_rod", "boom"], [[0, 0, 0], [1.0, 0, 0.25]]),
             ("stick_pin", ["stick_rod", "stick"], [[0, 0, 0], [-0.35, 0, 0.12]]),
             ("rocker_pin", ["bucket_rod", "rocker"], [[0, 0, 0], [0.3, 0, 0]]),
             ("pusher_pin", ["pusher", "rocker"], [[0.305975, 0, 0], [0.3, 0, 0]])]


def settings(kind, loops, driven):
    text = ['solver.tolerance = 1e-6\nrobot.base = "fixed"\nworld.ground = { type = "none" }\n'
            '[outputs]\nloops = ["*"]\n[[actuator]]\njoint = "*"\nmode = "none"\n']
    text += [f'[[actuator]]\njoint = "{joint}"\nmode = "effort"\n' for joint in driven]
    axes = "axes = [[0, 1, 0], [0, 1, 0]]\n" if kind == "hinge" else ""
    for name, links, origins in loops:
        loop = f'[[loop]]\nname = "{name}"\ntype = "{kind}"\nlinks = {links}\norigins = {origins}\n{axes}'
        text.append(loop.replace("'", '"'))
    return "\n".join(text)


class Reference:
    """The same machine in Pinocchio."""

    def __init__(self, urdf, loops):
        self.model = pin.buildModelFromUrdf(str(urdf))
        self.model.gravity.linear = np.array([0, 0, -9.81])
        self.data = self.model.createData()
        self.joints = list(self.model.names)[1:]
        self.constraints = pin.StdVec_RigidConstraintModel()
        self.loops = loops
        for _, links, points in loops:
            joints, places = [], []
            for name, point in zip(links, points):
                frame = self.model.frames[self.model.getFrameId(name, pin.FrameType.BODY)]
                joints.append(frame.parentJoint)
                places.append(frame.placement * pin.SE3(np.eye(3), np.array(point, dtype=float)))
            together = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, self.model, joints[0], places[0], joints[1],
                                                places[1], pin.ReferenceFrame.LOCAL)
            self.constraints.append(together)
        self.held = pin.StdVec_RigidConstraintData()
        for constraint in self.constraints:
            self.held.append(constraint.createData())
        pin.initConstraintDynamics(self.model, self.data, self.constraints, self.held)

    def solve(self, positions, velocities, efforts):
        """Accelerations, and what each loop does to the first of its links, world axes."""
        model = self.model
        q, v, tau = pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
        for name in self.joints:
            joint = model.joints[model.getJointId(name)]
            angle = positions[name]
            q[joint.idx_q:joint.idx_q + joint.nq] = [math.cos(angle), math.sin(angle)] if joint.nq == 2 else [angle]
            v[joint.idx_v], tau[joint.idx_v] = velocities[name], efforts.get(name, 0.0)
        # Redundant rows (across the plane of the excavator) share their force with the least sum of squares.
        proximal = pin.ProximalSettings(1e-14, 1e-9, 100)
        found = pin.constraintDynamics(model, self.data, q, v, tau, self.constraints, self.held, proximal)
        speeds = {name: found[model.joints[model.getJointId(name)].idx_v] for name in self.joints}
        forces = {}
        for (name, *_), held in zip(self.loops, self.held):
            forces[name] = held.oMc1.rotation @ held.contact_force.linear
        return speeds, forces


@pytest.mark.parametrize("machine", ["delta", "excavator"])
def test_accelerations_and_forces_are_those_of_pinocchio(machine, export, load, examples, tmp_path):
    if machine == "delta":
        text, loops = delta()
        urdf = tmp_path / "heavy_delta.urdf"
        urdf.write_text(text)
        kind, driven = "ball", {f"shoulder_{arm}": (2.0 * arm - 1.0, 3.0 + arm) for arm in range(3)}
    else:
        urdf, loops, kind = examples / "worlds" / "excavator.urdf", EXCAVATOR, "hinge"
        driven = {"boom_cylinder": (35000, 9000), "stick_cylinder": (-4000, 6000), "bucket_cylinder": (1000, 4000),
                  "swing": (3000, 4000)}
    robot = load(export(urdf, settings(kind, loops, driven)), tolerance=1e-6)
    reference = Reference(urdf, loops)
    worst, fastest = [0.0, 0.0], 0.0
    for k in range(40):
        efforts = {joint: mean + swing * math.sin(0.6 * k + i)
                   for i, (joint, (mean, swing)) in enumerate(driven.items())}
        for joint, effort in efforts.items():
            robot[f"cmd.{joint}.effort"] = effort
        robot.step(0.01)
        state = [{name: robot[f"joint.{name}.{what}"] for name in reference.joints}
                 for what in ("position", "velocity", "acceleration")]
        found, forces = reference.solve(*state[:2], efforts)
        size = max(abs(a) for a in found.values())
        largest = max(np.linalg.norm(force) for force in forces.values())
        worst[0] = max(worst[0], max(abs(state[2][name] - a) for name, a in found.items()) / size)
        for name, force in forces.items():
            off = np.array([robot[f"loop.{name}.force.{axis}"] for axis in "xyz"]) - force
            if machine == "excavator":
                yaw = state[0]["swing"]
                axis = np.array([-math.sin(yaw), math.cos(yaw), 0.0])
                off -= axis * (axis @ off)
            worst[1] = max(worst[1], np.linalg.norm(off) / largest)
        fastest = max(fastest, max(abs(speed) for speed in state[1].values()))
    assert fastest > 1.0
    assert worst[0] < 1e-9 and worst[1] < 1e-9, worst


# Joints of a two-finger gripper with a stroke of 85 mm, as its public description has them: name, parent, child,
# origin, yaw, and by how much of the driven one the others turn.
FINGERS = [("finger", "palm", "left_knuckle", "0 -0.0306011 0.054904", math.pi, None),
           ("left_inner", "left_knuckle", "left_tip", "0 0.0376 0.043", 0, -1),
           ("left_bar", "palm", "left_crank", "0 -0.0127 0.06142", math.pi, 1),
           ("right_knuckle_joint", "palm", "right_knuckle", "0 0.0306011 0.054904", 0, 1),
           ("right_inner", "right_knuckle", "right_tip", "0 0.0376 0.043", 0, -1),
           ("right_bar", "palm", "right_crank", "0 0.0127 0.06142", 0, 1)]


def gripper(follows):
    """The gripper with joints that mimic the driven one, or without."""
    parts = ['<robot name="two_fingers"><link name="palm"/>\n']
    for name, parent, child, xyz, yaw, ratio in FINGERS:
        parts.append(link(child, 0.02, "0.0003 0.016 0.01", [3e-6, 2e-6, 2.5e-6]))
        joint = hinge(name, parent, child, xyz, f"0 0 {yaw}", "1 0 0")
        if follows and ratio:
            joint = joint.replace("</joint>", f'<mimic joint="finger" multiplier="{ratio}"/></joint>')
        parts.append(joint)
    return "".join(parts) + "</robot>\n"


def test_a_gripper_with_its_linkage_moves_as_with_joints_that_mimic(export, load, tmp_path):
    # The bar is parallel to the knuckle: both turn alike, and the tip keeps its direction.
    apart, knuckle = [0.0179011, 0.006516], [0.0376, 0.043]
    text = ('[[loop]]\ntype = "gear"\njoints = ["finger", "right_knuckle_joint"]\nratio = 1\n')
    for side in "left", "right":
        # The bar's bearing, seen from the knuckle's, whose y axis points outwards on both sides.
        text += (f'[[loop]]\ntype = "ball"\nlinks = ["{side}_tip", "{side}_crank"]\n'
                 f'origins = [[0, {-apart[0]}, {apart[1]}], [0, {knuckle[0]}, {knuckle[1]}]]\n')
    runs = []
    for follows in True, False:
        urdf = tmp_path / f"two_fingers_{follows}.urdf"
        urdf.write_text(gripper(follows))
        config = settings("ball", [], {"finger": ()}) + ("" if follows else text)
        robot = load(export(urdf, config), tolerance=1e-8)
        seen = []
        for k in range(40):
            # With 0.05 N.m it turns back 0.07 rad beyond where the bars are in line, and is off by 1e-3 there.
            robot["cmd.finger.effort"] = 0.03 * math.sin(0.4 * k)
            robot.step(0.005)
            seen.append([robot[f"joint.{name}.{what}"] for name, *_ in FINGERS for what in ("position", "velocity")])
        runs.append(np.array(seen))
    assert abs(runs[0]).max() > 1
    off = abs(runs[1] - runs[0])
    assert off.max() < 1e-6 * abs(runs[0]).max()


def rods(names):
    """A robot of rods of 1 m and 1 kg that turn about y, each at the end of the one before."""
    parts = [f'<robot name="{names[0]}_arm"><link name="{names[0]}_base"/>\n']
    for parent, name in zip([f"{names[0]}_base", *names], names):
        parts.append(link(name, 1.0, "0.5 0 0", [1e-3, 1 / 12, 1 / 12]))
        parts.append(hinge(f"{name}_joint", parent, name, "1 0 0" if parent in names else "0 0 0", "0 0 0", "0 -1 0"))
    return "".join(parts) + "</robot>\n"


def test_a_loop_may_join_two_robots(export, load, tmp_path):
    """Crank and coupler are one robot, the rocker is another one: together they are the four-bar of one robot."""
    start = 'initial.joints = { crank_joint = 1.57 }\nsolver.tolerance = 1e-7\nrobot.base = "fixed"\n'
    world = 'world.ground = { type = "none" }\n[[actuator]]\njoint = "*"\nmode = "none"\n'
    ball = '[[loop]]\nname = "pin"\ntype = "ball"\nlinks = ["coupler", "%s"]\norigins = [[1, 0, 0], [1, 0, 0]]\n'
    outputs = '[outputs]\nloops = ["pin"]\n'
    whole, first, second = (tmp_path / f"{name}.urdf" for name in ("whole", "first", "second"))
    first.write_text(rods(["crank", "coupler"]))
    second.write_text(rods(["rocker"]))
    links = rods(["rocker"])
    begin = links.index('<link name="rocker">')
    rocker = links[begin:].replace("rocker_base", "crank_base")
    rocker = rocker.replace('<origin xyz="0 0 0" rpy', '<origin xyz="1.2 0 0" rpy')
    whole.write_text(rods(["crank", "coupler"]).replace("</robot>\n", rocker))
    (tmp_path / "second.toml").write_text('robot.base = "fixed"\n[[actuator]]\njoint = "*"\nmode = "none"\n')
    others = (f'[[world.robot]]\nname = "other"\nurdf = "{second}"\nconfig = "{tmp_path / "second.toml"}"\n'
              "xyz = [1.2, 0, 0]\n")
    runs = []
    for urdf, config, prefix in ((whole, start + world + ball % "rocker" + outputs, ""),
                                 (first, start + world + ball % "other.rocker" + outputs + others, "other.")):
        robot = load(export(urdf, config), tolerance=1e-7)
        names = ["joint.crank_joint", "joint.coupler_joint", f"{prefix}joint.rocker_joint"]
        seen = []
        for _ in range(100):
            robot.step(0.01)
            seen.append([robot[f"{name}.position"] for name in names] + [robot["loop.pin.gap"]])
        runs.append(np.array(seen))
    assert abs(runs[0][:, 0] - 1.57).max() > 0.5
    off = abs(runs[0] - runs[1])
    assert off[:, :3].max() < 1e-5
    assert max(run[:, 3].max() for run in runs) < 1e-12
