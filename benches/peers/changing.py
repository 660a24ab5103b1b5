"""Scenes under commands that are set anew at every communication step, each with its twin under constant ones.

Every maker takes the rate of the commands (1/s) and whether they change. `HANDS` and `light_legs` are the robots that
are stiff because their links are light.
"""

import itertools
import xml.etree.ElementTree as xml

import numpy as np

import scene as scenes
from scene import Actuator, Scene, a1, data, humanoid, r2d2_robot, robot_data, strip, text


def r2d2(rate, changes, way, friction=0.5, file_inertia=False):
    """Wheels at 10 (1 + 0.2 sin 12 t) rad/s from rest on; straight: it rolls at 0.35 m/s already, where it would fall
    over backwards from rest."""
    turning = way == "turning"

    def speeds(t):
        w = 10.0 * (1 + 0.2 * np.sin(12 * t)) if changes else 10.0
        return -w, w if turning else -w
    name = f"R2D2 {way}, μ {friction:g}, inertia of the {'file' if file_inertia else 'shapes'}"
    scene = r2d2_robot(name, 2.0, speeds, file_inertia, friction=friction, servo=5.0, rate=rate)
    if not turning:
        scene.velocity = (0.0, 0.35, 0.0)
        scene.joint_velocities = {a.joint: -10.0 for a in scene.actuators}
    return scene


def quadruped_velocities(rate, changes):
    """All joints under velocity motors at 0.3 sin(12 t + i) rad/s."""
    places = np.arange(12)
    return a1("quadruped, velocities", 2.0, lambda t: 0.3 * np.sin(12 * t + places) if changes else np.zeros(12),
              "velocity", position=(0, 0, 0.30), rate=rate)


def quadruped_marching(rate, changes):
    """It marches; its twin stands."""
    return a1("quadruped marching", 2.0, scenes.march if changes else lambda t: scenes.STAND, position=(0, 0, 0.30),
              rate=rate)


def humanoid_swaying(rate, changes, kp=4000.0, kd=60.0):
    """0.2 sin(6 t + i) rad are added to the targets of its posture. The first ones are a jump: with stiff gains motors
    reach their limits, and it hops."""
    sway = (lambda t, i: 0.2 * np.sin(6 * t + i)) if changes else None
    return humanoid(f"humanoid swaying, gains {kp:g}, {kd:g}", 0.5, kp, kd, sway=sway, position=(0, 0, 1.03), rate=rate)


def humanoid_soft(rate, changes):
    """It sinks to its knees."""
    return humanoid_swaying(rate, changes, 100.0, 5.0)


def slider(name, parent, child, xyz, axis, effort=1e4):
    """URDF text of a sliding joint."""
    return (f'<joint name="{name}" type="prismatic"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{xyz}"/><axis xyz="{axis}"/>'
            f'<limit lower="-1" upper="1" effort="{effort:g}" velocity="100"/></joint>')


def block(name, mass, inertia, collision=""):
    """URDF text of a link."""
    x, y, z = inertia
    return (f'<link name="{name}"><inertial><mass value="{mass}"/>'
            f'<inertia ixx="{x}" iyy="{y}" izz="{z}" ixy="0" ixz="0" iyz="0"/></inertial>{collision}</link>')


def light_legs(rate, changes):
    """60 kg on four legs of 20 g that slide up and down, with feet of 2 g that slide along x: pd gains of 3000 N/m
    and 30 N·s/m, targets that sway by 1 cm at 6 rad/s, legs in turn, feet together."""
    foot = '<collision><geometry><sphere radius="0.02"/></geometry></collision>'
    parts, actuators = [block("body", 60.0, (1.0, 2.0, 2.6))], []
    for i, (x, y) in enumerate(itertools.product((0.25, -0.25), (0.15, -0.15))):
        parts += [block(f"leg{i}", 0.02, (1e-4, 1e-4, 1e-6)), block(f"foot{i}", 0.002, (4e-7,) * 3, foot),
                  slider(f"hip{i}", "body", f"leg{i}", f"{x} {y} -0.3", "0 0 1"),
                  slider(f"ankle{i}", f"leg{i}", f"foot{i}", "0 0 -0.1", "1 0 0")]
        actuators += [Actuator(f"{part}{i}", "pd", 1e4, kp=3000.0, kd=30.0) for part in ("hip", "ankle")]
    phases = np.array([i if i % 2 == 0 else 0.0 for i in range(8)])
    return Scene("light legs", f'<robot name="light_legs">{"".join(parts)}</robot>', 2.0, friction=0.8,
                 position=(0, 0, 0.42), actuators=actuators, rate=rate,
                 command=lambda t: 0.01 * np.sin(6 * t + phases) if changes else np.zeros(8))


def hand(name, path, root, rate, changes):
    """What hangs on the link `root`, without damping and motors, on a slide along x that shakes it by 2 cm at 5 Hz; its
    twin is on a slide that stands. Fingers start at ±5 rad/s in the middle of their ranges."""
    tree = strip(path, keep=())
    kept, joints = {root}, []
    remaining = tree.findall("joint")
    while found := [j for j in remaining if j.find("parent").get("link") in kept]:
        kept |= {j.find("child").get("link") for j in found}
        joints += found
        remaining = [j for j in remaining if j not in found]
    for element in list(tree):
        if element.get("name") not in kept and element not in joints:
            tree.remove(element)
    middle = {}
    for joint in joints:
        for dynamics in joint.findall("dynamics"):
            joint.remove(dynamics)
        if joint.get("type") == "revolute":
            limit = joint.find("limit")
            middle[joint.get("name")] = 0.5 * (float(limit.get("lower")) + float(limit.get("upper")))
    tree.append(xml.fromstring('<link name="wall"/>'))
    tree.append(xml.fromstring(slider("slide", "wall", root, "0 0 0", "1 0 0")))
    speeds = {joint: 5.0 * (-1) ** i for i, joint in enumerate(middle)}
    return Scene(name, text(tree), 2.0, floating=False, ground=False, joints=middle, joint_velocities=speeds,
                 actuators=[Actuator("slide", "velocity", 1e4)], rate=rate,
                 command=lambda t: [0.2 * np.pi * np.cos(10 * np.pi * t) if changes else 0.0])


def g1_hand(rate, changes):
    """Of Unitree's humanoid: three fingers of seven joints."""
    path = robot_data("g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf")
    return hand("hand of G1, loose", path, "left_hand_palm_link", rate, changes)


def allegro_hand(rate, changes):
    """Wonik's hand: four fingers of sixteen joints."""
    path = robot_data("allegro_hand_description/urdf/allegro_left_hand.urdf")
    return hand("Allegro hand, loose", path, "palm_link", rate, changes)


def variants():
    """Every maker, with its arguments."""
    def drive(*args):
        return lambda rate, changes: r2d2(rate, changes, *args)
    yield from (drive(*args) for args in itertools.product(("turning",), (0.5, 1.0), (False, True)))
    yield from (drive("straight", 0.5, inertia) for inertia in (False, True))
    yield from (quadruped_velocities, quadruped_marching, humanoid_swaying, humanoid_soft)
    yield from (light_legs, g1_hand, allegro_hand)
