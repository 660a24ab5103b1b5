"""Counts what a URDF says, with Python's own XML reader: what no reader may lose.

Usage: python independent.py < NAMES > JSON, one file name per line in, `{name: counts}` out
"""

import json
import sys
import xml.etree.ElementTree as xml
from pathlib import Path


def number(text) -> float | None:
    """A number, or none."""
    try:
        return float(text)
    except (TypeError, ValueError):
        return None


def counts(urdf) -> dict:
    """Names of links and joints, collision shapes by link, masses by link; `fault` where it is not XML."""
    # Two files of pybullet_data have a line end before the XML declaration, or something after the end: no fault of
    # what stands between.
    text = Path(urdf).read_bytes().strip()
    end = text.rfind(b"</robot>")
    try:
        robot = xml.fromstring(text[:end + len(b"</robot>")] if end >= 0 else text)
    except (xml.ParseError, UnicodeDecodeError, ValueError) as error:
        return {"fault": str(error)}
    links = robot.findall("link")
    joints = robot.findall("joint")
    masses = {}
    for link in links:
        mass = link.find("inertial/mass")
        value = None if mass is None else number(mass.get("value"))
        if value is not None and value > 0:
            masses[link.get("name")] = value
    return {
        "links": [link.get("name") for link in links],
        "joints": {joint.get("name"): joint.get("type") for joint in joints},
        "colliders": {link.get("name"): len(link.findall("collision/geometry/*")) for link in links
                      if link.find("collision/geometry/*") is not None},
        "masses": masses,
    }


if __name__ == "__main__":
    json.dump({name: counts(name) for name in sys.stdin.read().splitlines() if name}, sys.stdout)
