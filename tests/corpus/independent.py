"""What a URDF says, by Python's own XML reader: what no reader may lose.

Usage: python independent.py < NAMES > JSON, one file name per line in, `{name: counts}` out
"""

import json
import math
import sys
import xml.etree.ElementTree as xml
from pathlib import Path


def number(text) -> float | None:
    """A number, or none."""
    try:
        return float(text)
    except (TypeError, ValueError):
        return None


def numbers(text, default) -> list[float]:
    """Some numbers, or the default."""
    try:
        found = [float(word) for word in (text or "").split()]
    except ValueError:
        return default
    return found if len(found) == len(default) else default


def times(a, b) -> list[list[float]]:
    """Product of two matrices."""
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def rotation(rpy) -> list[list[float]]:
    """Matrix of roll, pitch, yaw about fixed axes."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(angle), math.sin(angle)) for angle in rpy)
    return [[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr]]


def pose(element) -> tuple:
    """Rotation and place of an element's `<origin>`."""
    origin = None if element is None else element.find("origin")
    given = {} if origin is None else origin.attrib
    zero = [0.0, 0.0, 0.0]
    return rotation(numbers(given.get("rpy"), zero)), numbers(given.get("xyz"), zero)


def inertial(link) -> tuple | None:
    """Mass, centre and inertia about it in the link's axes of its `<inertial>`; none without."""
    element = link.find("inertial")
    if element is None:
        return None
    mass = element.find("mass")
    inertia = element.find("inertia")
    given = {} if inertia is None else inertia.attrib
    xx, xy, xz, yy, yz, zz = (number(given.get(name)) or 0.0 for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    R, place = pose(element)
    turned = times(times(R, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), [list(row) for row in zip(*R)])
    return (None if mass is None else number(mass.get("value"))) or 0.0, place, turned


def root(urdf):
    """The `<robot>` element.

    Two files of pybullet_data have a line end before the XML declaration, or something after the end: no fault of what
    stands between.
    """
    text = Path(urdf).read_bytes().strip()
    end = text.rfind(b"</robot>")
    robot = xml.fromstring(text[:end + len(b"</robot>")] if end >= 0 else text)
    # Some files name a namespace for all of their tags (xmlns="…"): it says nothing.
    own = robot.tag[:robot.tag.find("}") + 1]
    for element in robot.iter():
        if own and isinstance(element.tag, str) and element.tag.startswith(own):
            element.tag = element.tag[len(own):]
    return robot


def counts(urdf) -> dict:
    """Names of links and joints, by link collision shapes, masses above zero, every `<inertial>`; `fault` where it is
    not XML."""
    try:
        robot = root(urdf)
    except (xml.ParseError, UnicodeDecodeError, ValueError) as error:
        return {"fault": str(error)}
    links, joints = robot.findall("link"), robot.findall("joint")
    # What a density weighs is no number of the file.
    dense = {link.get("name") for link in links
             if link.find("inertial/density") is not None and link.find("inertial/mass") is None}
    inertials = {link.get("name"): found for link in links
                 if link.get("name") not in dense and (found := inertial(link)) is not None}
    return {
        "links": [link.get("name") for link in links],
        "joints": {joint.get("name"): joint.get("type") for joint in joints},
        # Tags of other programs are no shapes.
        "colliders": {link.get("name"): len(shapes) for link in links
                      if (shapes := [shape for shape in link.findall("collision/geometry/*") if "}" not in shape.tag])},
        "masses": {name: found[0] for name, found in inertials.items() if found[0] > 0},
        "inertials": inertials,
        "dense": sorted(dense),
        "tree": {joint.get("name"): (joint.find("parent").get("link"), joint.find("child").get("link"), *pose(joint))
                 for joint in joints if joint.find("parent") is not None and joint.find("child") is not None},
    }


if __name__ == "__main__":
    json.dump({name: counts(name) for name in sys.stdin.read().splitlines() if name}, sys.stdout)
