"""A scene: a robot, where it starts, what it is commanded. Every simulator gets the same one.

`Scene.urdf` is text that all of them read: no meshes, no visuals, no transmissions. Commands are rows of targets, held
for `1 / rate` s each; samples are taken after each row.
"""

import itertools
import xml.etree.ElementTree as xml
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

G = 9.81


@dataclass
class Actuator:
    """A commanded joint: kind `pd` (a position, with gains kp and kd), `velocity` or `effort`."""

    joint: str
    kind: str
    limit: float
    kp: float = 0.0
    kd: float = 0.0


@dataclass
class Scene:
    """What is simulated. Poses and velocities are those of the root link's origin, in world axes."""

    name: str
    urdf: str
    end: float
    floating: bool = True
    ground: bool = True
    friction: float = 0.5
    restitution: float = 0.0
    gravity: float = G
    position: tuple = (0.0, 0.0, 0.0)
    rpy: tuple = (0.0, 0.0, 0.0)
    velocity: tuple = (0.0, 0.0, 0.0)
    spin: tuple = (0.0, 0.0, 0.0)
    joints: dict = field(default_factory=dict)
    joint_velocities: dict = field(default_factory=dict)
    actuators: list = field(default_factory=list)
    rate: int = 60
    command: object = None  # time in s -> one target per actuator
    penetration: float = 1e-4  # m, what a static load sinks in: ours and Drake's
    servo: float = 100.0  # N·m·s/rad, gain of velocity motors where there is no better one: MuJoCo, Drake
    saturates: bool = False  # whether such a servo meets its limit
    impact: float = 0.0  # m/s, of the first impact: what Drake has to know for a restitution

    @property
    def count(self):
        """Number of rows."""
        return round(self.end * self.rate)

    def rows(self):
        """Targets, a row a period."""
        if not self.actuators:
            return np.zeros((self.count, 0))
        return np.array([self.command(i / self.rate) for i in range(self.count)], dtype=float)

    def joint_names(self):
        """The moving joints, in the order of the file."""
        return [j.get("name") for j in xml.fromstring(self.urdf).findall("joint") if j.get("type") != "fixed"]

    def links(self):
        """Name and mass of the links."""
        for link in xml.fromstring(self.urdf).findall("link"):
            mass = link.find("inertial/mass")
            yield link.get("name"), 0.0 if mass is None else float(mass.get("value"))

    def root(self):
        """Name of the link that hangs on no joint."""
        tree = xml.fromstring(self.urdf)
        children = {j.find("child").get("link") for j in tree.findall("joint")}
        return next(l.get("name") for l in tree.findall("link") if l.get("name") not in children)

    def mass(self):
        """kg"""
        return sum(mass for _, mass in self.links())


def rotation(rpy):
    """Matrix of roll, pitch, yaw as URDF means them."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    return np.array([
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ])


def quaternion(rpy):
    """(w, x, y, z) of roll, pitch, yaw."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(np.array(rpy) / 2), np.sin(np.array(rpy) / 2)
    return np.array([cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy,
                     cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy])


def strip(path, keep=("box", "sphere", "cylinder"), frictionless=True):
    """The text of a URDF without visuals, meshes and what is no link or joint."""
    tree = xml.parse(path).getroot()
    for element in list(tree):
        if element.tag not in ("link", "joint"):
            tree.remove(element)
    for link in tree.findall("link"):
        for element in list(link):
            if element.tag == "inertial":
                continue
            if element.tag == "collision" and element.find("geometry")[0].tag in keep:
                continue
            link.remove(element)
    if frictionless:  # PyBullet and Drake ignore it
        for dynamics in tree.iter("dynamics"):
            dynamics.attrib.pop("friction", None)
    for joint in tree.findall("joint"):
        for element in list(joint):
            if element.tag == "mimic" and joint.get("type") == "fixed":
                joint.remove(element)
            elif element.tag not in ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic"):
                joint.remove(element)
    return tree


def add_sphere(tree, link, xyz, radius):
    """One more collision sphere on a link."""
    element = next(l for l in tree.findall("link") if l.get("name") == link)
    collision = xml.SubElement(element, "collision")
    xml.SubElement(collision, "origin", {"xyz": " ".join(map(repr, map(float, xyz))), "rpy": "0 0 0"})
    xml.SubElement(xml.SubElement(collision, "geometry"), "sphere", {"radius": repr(radius)})


def text(tree):
    """Of an element."""
    return xml.tostring(tree, encoding="unicode")


def data(*path):
    """A file of pybullet_data."""
    import pybullet_data

    return Path(pybullet_data.getDataPath()).joinpath(*path)


def robot_data(*path):
    """A file of example-robot-data."""
    import cmeel_pth  # noqa: F401  (its folder is the root of site-packages)

    return Path(cmeel_pth.__file__).parent.joinpath("cmeel.prefix/share/example-robot-data/robots", *path)


def iiwa_free(end=2.0):
    """KUKA's arm hanging from the ceiling and swinging, with the file's damping, without a motor; no limit is hit."""
    tree = strip(data("kuka_iiwa/model.urdf"), keep=())
    names = [f"lbr_iiwa_joint_{i}" for i in range(1, 8)]
    return Scene("iiwa, free", text(tree), end, floating=False, ground=False, gravity=-G,
                 joints=dict(zip(names, (0.0, 0.6, 0.0, -1.2, 0.0, 0.8, 0.0))))


def panda_free(end=2.0):
    """Franka's arm hanging from the ceiling and swinging, without a motor; its fingers are fixed, its joints have no
    limits: it would lie on that of joint 4 most of the time."""
    tree = strip(data("franka_panda/panda.urdf"), keep=())
    for joint in tree.findall("joint"):
        if joint.get("type") == "prismatic":
            joint.set("type", "fixed")
        elif joint.get("type") == "revolute":
            joint.set("type", "continuous")
    names = [f"panda_joint{i}" for i in range(1, 8)]
    return Scene("panda, free", text(tree), end, floating=False, ground=False, gravity=-G,
                 joints=dict(zip(names, (0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785))))


LEGS = ("FR", "FL", "RR", "RL")


def a1(name, end, command, kind="pd", **options):
    """Unitree's quadruped under joint gains (`kind` velocity: under velocity motors), on its four feet."""
    tree = strip(data("a1/a1.urdf"))
    # The feet alone touch: what hides inside the legs costs collision tests and changes nothing.
    for link in tree.findall("link"):
        if not link.get("name").endswith("_toe"):
            for collision in link.findall("collision"):
                link.remove(collision)
    actuators, joints = [], {}
    for leg, (part, angle) in itertools.product(LEGS, (("hip", 0.0), ("upper", 0.8), ("lower", -1.6))):
        joint = f"{leg}_{part}_joint"
        actuators.append(Actuator(joint, kind, 33.5, kp=100.0, kd=2.0))
        joints[joint] = angle
    return Scene(name, text(tree), end, friction=0.8, joints=joints, actuators=actuators, command=command, **options)


STAND = np.tile([0.0, 0.8, -1.6], 4)


def a1_standing(end=2.0):
    """It takes its weight and stands."""
    return a1("quadruped standing", end, lambda t: STAND, position=(0, 0, 0.30))


def march(t):
    """Targets of the quadruped that lifts diagonal legs in turn, 2.5 Hz."""
    target = STAND.reshape(4, 3).copy()
    for leg, phase in enumerate((0.0, 0.5, 0.5, 0.0)):
        lift = max(0.0, np.sin(2 * np.pi * (2.5 * t + phase)))
        target[leg, 1:] += (0.25 * lift, -0.5 * lift)
    return target.ravel()


def a1_marching(end=2.0):
    """Targets renewed at 60 Hz."""
    return a1("quadruped marching", end, march, position=(0, 0, 0.30))


def r2d2_robot(name, end, speeds, file_inertia=False, **options):
    """PyBullet's R2D2, of which only the wheels move; the inertia of its links is that of their shapes unless
    `file_inertia`. `speeds`: time in s -> speeds of the right and the left wheels, rad/s."""
    from scenario import with_inertia_from_shapes

    path = data("r2d2.urdf")
    tree = xml.parse(path).getroot() if file_inertia else with_inertia_from_shapes(path)
    for element in list(tree):
        if element.tag == "material":
            tree.remove(element)
    for link in tree.findall("link"):
        for element in list(link):
            if element.tag == "visual":
                link.remove(element)
            elif element.tag == "collision" and element.find("geometry")[0].tag == "mesh":
                link.remove(element)
    for joint in tree.findall("joint"):
        if "wheel" not in joint.get("name"):
            joint.set("type", "fixed")
    names = [j.get("name") for j in tree.findall("joint") if j.get("type") != "fixed"]
    actuators = [Actuator(name, "velocity", 50.0) for name in names]

    def command(t):
        right, left = speeds(t)
        return [right if name.startswith("right") else left for name in names]
    return Scene(name, text(tree), end, gravity=9.8, position=(0, 0, 0.470), actuators=actuators, command=command,
                 **options)


def r2d2(end=2.0, w=10.0):
    """0.5 s to settle, then a turn on the spot."""
    def speeds(t):
        turn = 0.0 if t < 0.5 - 1e-9 else w
        return -turn, turn
    # The highest gain that the jump of the command does not saturate: above it, explicit limits make wheels chatter.
    return r2d2_robot("R2D2 turning", end, speeds, servo=50.0 / w)


def humanoid(name, end, kp, kd, spheres=False, sway=None, **options):
    """PAL's Talos with eight spheres under each foot; `spheres`: on head, hands, elbows, knees and trunk, too.
    `sway`: time in s, number of the joint -> what is added to its target, rad; none: the posture is held."""
    tree = strip(robot_data("talos_data/robots/talos_reduced.urdf"), keep=())
    for side in ("left", "right"):
        for x, y in itertools.product((-0.10, -0.033, 0.033, 0.10), (-0.06, 0.06)):
            add_sphere(tree, f"leg_{side}_6_link", (x, y, -0.097), 0.01)
    if spheres:
        add_sphere(tree, "head_2_link", (0, 0, 0.1), 0.12)
        add_sphere(tree, "torso_2_link", (0, 0, 0.1), 0.18)
        add_sphere(tree, "base_link", (0, 0, 0), 0.15)
        for side in ("left", "right"):
            add_sphere(tree, f"arm_{side}_7_link", (0, 0, 0), 0.06)
            add_sphere(tree, f"arm_{side}_4_link", (0, 0, 0), 0.06)
            add_sphere(tree, f"leg_{side}_4_link", (0, 0, 0), 0.07)
    actuators, joints = [], {}
    for joint in tree.findall("joint"):
        if joint.get("type") == "fixed":
            continue
        joint_name, limit = joint.get("name"), joint.find("limit")
        joints[joint_name] = 0.0
        for part, angle in (("leg_left_3", -0.4), ("leg_right_3", -0.4), ("leg_left_4", 0.8), ("leg_right_4", 0.8),
                            ("leg_left_5", -0.4), ("leg_right_5", -0.4), ("arm_left_2", 0.4), ("arm_right_2", -0.4),
                            ("arm_left_4", -0.6), ("arm_right_4", -0.6)):
            if joint_name.startswith(part):
                joints[joint_name] = angle
        if "gripper" in joint_name:
            joints[joint_name] = 0.5 * (float(limit.get("lower")) + float(limit.get("upper")))
        if kp > 0:
            actuators.append(Actuator(joint_name, "pd", float(limit.get("effort")), kp=kp, kd=kd))
    targets = np.array([joints[a.joint] for a in actuators])
    places = np.arange(len(targets))
    command = (lambda t: targets + sway(t, places)) if sway else (lambda t: targets)
    return Scene(name, text(tree), end, friction=0.8, joints=joints, actuators=actuators, command=command, **options)


def humanoid_standing(end=2.0):
    """On sixteen foot points."""
    return humanoid("humanoid standing", end, 4000.0, 60.0, position=(0, 0, 1.03))


def humanoid_falling(end=1.5):
    """Stiff gains let go: it collapses."""
    return humanoid("humanoid falling", end, 0.0, 0.0, spheres=True, position=(0, 0, 1.03), velocity=(0.3, 0, 0))
