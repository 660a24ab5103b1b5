"""Contact outputs of robots that lie on the ground. Expected values: statics."""

import math

import numpy as np
import pytest
import scene

OUTPUTS = """
[outputs]
links = ["*"]
contact_points = true
"""


def turned(q, v):
    """A vector turned by a quaternion x, y, z, w."""
    u, w = np.array(q[:3]), q[3]
    return np.array(v) + 2 * np.cross(u, np.cross(u, v) + w * np.array(v))


def center_of_mass(robot, head):
    """Of the whole robot in the world, by the poses of its links; and its mass."""
    moment, mass = np.zeros(3), 0.0
    for link in head["links"]:
        name = f"link.{link['name']}"
        place = robot.vector(f"{name}.position")
        place += turned(robot.vector(f"{name}.orientation", "xyzw"), link["center_of_mass"])
        moment += link["mass"] * place
        mass += link["mass"]
    return moment / mass, mass


@pytest.mark.parametrize("name", ["r2d2", "humanoid"])
def test_forces_on_a_fallen_robot_carry_its_whole_weight_below_its_center(name, pybullet_data, examples, export, load):
    urdf = {"r2d2": pybullet_data / "r2d2.urdf",
            "humanoid": examples.parent / "tests/robots/humanoid.urdf"}[name]
    fmu = export(urdf, OUTPUTS)
    head, _ = scene.read(fmu)
    robot = load(fmu, {"initial.base.position.z": 1.2, "initial.base.rpy.roll": math.pi / 2})
    robot.run(15, 1 / 60)
    speeds = robot.vector("base.linear_velocity") + robot.vector("base.angular_velocity")
    assert max(map(abs, speeds)) < 1e-4, "it lies still"
    forces, points = np.zeros(3), np.zeros(3)
    touching = []
    for contact in head["contacts"]:
        link = head["links"][contact["link"]]["name"]
        force, point = ([robot[n] for n in contact[key]] for key in ("force", "point"))
        forces += force
        points += force[2] * np.array(point)
        if robot[contact["active"]]:
            touching.append(link)
            assert abs(point[2]) < 1e-3, "it touches the ground"
        else:
            assert np.allclose(force, 0, atol=1e-9)
            assert np.allclose(point, robot.vector(f"link.{link}.position"), atol=1e-12)
    center, mass = center_of_mass(robot, head)
    print(name, touching, forces, mass)
    assert len(touching) > 1
    assert forces == pytest.approx([0, 0, mass * 9.81], abs=1e-3 * mass * 9.81)
    # Friction acts at the height of the ground, where it has no moment about the points.
    assert points[:2] / forces[2] == pytest.approx(center[:2], abs=1e-3)


def test_without_being_asked_there_are_forces_of_all_shapes_and_no_points(pybullet_data, export):
    head, _ = scene.read(export(pybullet_data / "r2d2.urdf"))
    shaped = {drawn["link"] for drawn in head["collisions"]}
    assert {contact["link"] for contact in head["contacts"]} == shaped
    assert not any("point" in contact for contact in head["contacts"])
    assert not any(".point." in variable["name"] for variable in head["variables"])
