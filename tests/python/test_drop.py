"""PyBullet's cube of 1 kg and 1 m falls onto the ground, lands and lies."""

import math

import pytest

# Gravity of PyBullet's tutorials, and that of the weight which the contact's spring is made for: with x the depth over
# the penetration, F = K x (1 + x³) is 9.81 N at x = 1/2. Under 9.8 N, by Newton's method from there:
GRAVITY = 9.8
REFERENCE_GRAVITY = 9.81
PENETRATION = 1e-4
SHARE = 0.5 - (1 - GRAVITY / REFERENCE_GRAVITY) * 0.5 * (1 + 0.5**3) / (1 + 4 * 0.5**3)
REST = 0.5 - PENETRATION * SHARE

SETTINGS = f"""
[world]
gravity = [0, 0, -{GRAVITY}]
[initial]
xyz = [0, 0, 2]
"""


@pytest.fixture
def cube(pybullet_data, export, load):
    return load(export(pybullet_data / "cube.urdf", SETTINGS))


def test_it_hits_the_ground_with_the_speed_of_free_fall(cube):
    expected = -math.sqrt(2 * GRAVITY * (2 - 0.5))
    assert expected == pytest.approx(-5.422, abs=1e-3)
    fall = math.sqrt(2 * (2 - 0.5) / GRAVITY)
    # One step ends 0.1 ms before touch-down: 1 mm/s short of the impact speed.
    cube.run(fall - 1e-4)
    assert cube["contact.baseLink.active"] == 0
    assert cube["base.linear_velocity.z"] == pytest.approx(expected, rel=5e-3)
    # And the fall itself is exact, not merely within the gate.
    assert cube["base.linear_velocity.z"] == pytest.approx(-GRAVITY * cube.time, abs=1e-9)
    assert cube["base.position.z"] == pytest.approx(2 - GRAVITY * cube.time**2 / 2, abs=1e-9)


def test_no_sample_at_240_hz_is_faster_than_the_impact_and_one_is_nearly_as_fast(cube):
    lowest = 0.0
    for _ in range(240):
        cube.step(1 / 240)
        lowest = min(lowest, cube["base.linear_velocity.z"])
    # The last sample before touch-down lies up to 1/240 s before it; the contact adds less than 1 mm of fall.
    impact = -math.sqrt(2 * GRAVITY * 1.5)
    assert impact * (1 + 1e-3) <= lowest <= impact + GRAVITY / 240


def test_it_rests_at_its_static_penetration_and_stays_there(cube):
    cube.run(3)
    rest = cube.vector("base.position")
    assert rest[2] == pytest.approx(REST, abs=1e-9)
    assert cube["contact.baseLink.force.z"] == pytest.approx(GRAVITY, abs=1e-4)
    cube.run(60)
    drift = math.dist(rest, cube.vector("base.position"))
    assert drift < 1e-9
    assert cube.tilt < 1e-9
