"""PyBullet's KUKA iiwa swings without damping and without torque: nothing may take or give energy."""

import math

import pytest

# Hung from a ceiling, because standing up the arm falls into its limits at once: joints 2, 4 and 6 end at 120°,
# so straight down is out of its reach on a floor. Most swings turn the joints along the arm (3, 5, 7) into their limits
# within 10 s, for gravity does not hold them; this start was searched for one that does not.
SETTINGS = """
[robot]
base = "fixed"
[solver]
tolerance = 1e-8
[world]
ground = { type = "none" }
[initial]
rpy = [3.141592653589793, 0, 0]
joints = { lbr_iiwa_joint_2 = 0.34, lbr_iiwa_joint_4 = -0.13, lbr_iiwa_joint_6 = -0.25, lbr_iiwa_joint_7 = -0.26 }
[[actuator]]
joint = "*"
mode = "effort"
[joint."*"]
damping = 0
friction = 0
"""
JOINTS = [f"lbr_iiwa_joint_{number}" for number in range(1, 8)]
LIMITS = [2.96705972839, 2.09439510239, 2.96705972839, 2.09439510239, 2.96705972839, 2.09439510239, 3.05432619099]


def test_the_energy_of_a_freely_swinging_iiwa_is_conserved(pybullet_data, export, load):
    robot = load(export(pybullet_data / "kuka_iiwa/model.urdf", SETTINGS))
    start = robot["energy.kinetic"] + robot["energy.potential"]
    most_kinetic, worst, nearest = 0.0, 0.0, math.inf
    for _ in range(1000):
        robot.step(0.01)
        most_kinetic = max(most_kinetic, robot["energy.kinetic"])
        worst = max(worst, abs(robot["energy.kinetic"] + robot["energy.potential"] - start))
        for joint, limit in zip(JOINTS, LIMITS):
            nearest = min(nearest, limit - abs(robot[f"joint.{joint}.position"]))
            assert robot[f"joint.{joint}.effort"] == 0
    print(f"kinetic energy up to {most_kinetic} J, total off by {worst} J, {nearest} rad to the nearest limit")
    assert nearest > 0.5
    assert most_kinetic > 1.0
    # Relative to the energy that moves, not to a potential whose zero is anybody's choice.
    assert worst < 1e-6 * most_kinetic


def test_damping_takes_energy(pybullet_data, export, load):
    # The counter-check: with the file's own damping (0.5 N·m·s/rad) the same swing loses most of its energy.
    settings = SETTINGS.replace("damping = 0\n", "damping = 0.5\n")
    robot = load(export(pybullet_data / "kuka_iiwa/model.urdf", settings))
    energy = [robot["energy.kinetic"] + robot["energy.potential"]]
    for _ in range(100):
        robot.step(0.1)
        energy.append(robot["energy.kinetic"] + robot["energy.potential"])
    assert all(after < before + 1e-9 for before, after in zip(energy, energy[1:]))
    assert energy[0] - energy[-1] == pytest.approx(energy[0] - min(energy), rel=1e-9)
    assert energy[0] - energy[-1] > 1.0
