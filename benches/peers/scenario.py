"""The drive that every simulator is timed on: PyBullet's R2D2 settles, turns on the spot, drives forward.

Wheels at 10 rad/s (`tests/python/test_r2d2.py` says what physics expects of it), friction 0.5 between wheel and
ground, wheel inertia from the shapes. One step is 1/240 s, for everyone.
"""

import math
import xml.etree.ElementTree as xml
from dataclasses import dataclass

STEP = 1 / 240
GRAVITY = 9.8
FRICTION = 0.5
START_HEIGHT = 0.470
WHEELS = ["right_front_wheel_joint", "right_back_wheel_joint", "left_front_wheel_joint", "left_back_wheel_joint"]
# Number of steps, right wheels, left wheels (rad/s), most effort (N·m).
PHASES = [(240, 0.0, 0.0, 100.0), (240, -10.0, 10.0, 50.0), (500, -10.0, -10.0, 10.0)]
STEPS = sum(steps for steps, *_ in PHASES)


@dataclass
class Result:
    """Where a run ended; yaw (rad) of the turn, way (m) of the drive forward, height (m) at the end."""

    yaw: float
    forward: float
    z: float


class Meter:
    """Collects poses at the phases' ends; the heading is unwrapped assuming less than π per phase."""

    def __init__(self):
        self.poses = []

    def add(self, x, y, z, yaw):
        """The base's position, m, and heading, rad."""
        self.poses.append((x, y, z, yaw))

    def result(self):
        """After the last phase."""
        settled, turned, end = self.poses
        return Result(math.remainder(turned[3] - settled[3], 2 * math.pi), math.dist(turned[:2], end[:2]), end[2])


def yaw_of(w, x, y, z):
    """Heading of a quaternion, rad."""
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def solid_inertia(geometry, mass):
    """Principal inertia of a full solid about its centre; None for a mesh."""
    shape = geometry[0]
    if shape.tag == "box":
        a, b, c = map(float, shape.get("size").split())
        return [mass / 12 * (b * b + c * c), mass / 12 * (a * a + c * c), mass / 12 * (a * a + b * b)]
    if shape.tag == "cylinder":
        r, length = float(shape.get("radius")), float(shape.get("length"))
        across = mass / 12 * (3 * r * r + length * length)
        return [across, across, mass / 2 * r * r]
    if shape.tag == "sphere":
        return [0.4 * mass * float(shape.get("radius")) ** 2] * 3
    return None


def with_inertia_from_shapes(urdf):
    """The URDF's text with each primitive link's inertia replaced; every link of r2d2 has one shape."""
    tree = xml.parse(urdf).getroot()
    for link in tree.findall("link"):
        inertial, collision = link.find("inertial"), link.find("collision")
        if inertial is None or collision is None:
            continue
        mass = float(inertial.find("mass").get("value"))
        principal = solid_inertia(collision.find("geometry"), mass)
        if principal is None:  # the finger tips, 50 g: a 5 cm box is near enough
            principal = [mass * 0.05**2 / 6] * 3
        origin = inertial.find("origin")
        if origin is not None:
            inertial.remove(origin)
        if collision.find("origin") is not None:
            inertial.append(collision.find("origin"))
        inertia = inertial.find("inertia")
        inertia.attrib = dict(zip(("ixx", "iyy", "izz"), map(repr, principal))) | dict.fromkeys(("ixy", "ixz", "iyz"), "0")
    return tree
