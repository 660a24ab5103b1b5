"""A saved state continues bit for bit: in the same instance, in another one, in a new process."""

import random
import struct
import subprocess
import sys
from pathlib import Path

import pytest

TIME = 0.7
WHEELS = [f"{side}_{end}_wheel_joint" for side in ("right", "left") for end in ("front", "back")]


def drive(robot, steps=150):
    """Steps of random length with random commands, the same at each call."""
    generator = random.Random(1)
    for _ in range(steps):
        for wheel in WHEELS:
            robot[f"cmd.{wheel}.velocity"] = generator.uniform(-10, 10)
        if generator.random() < 0.1:
            robot["world.ground.friction"] = generator.uniform(0.3, 0.9)
        robot.step(generator.uniform(1e-4, 0.01))


def bits(robot):
    """Every output, as bytes: equal only if bit for bit equal."""
    return b"".join(struct.pack("<d", value) for value in robot.outputs().values())


@pytest.fixture(scope="module")
def fmu(pybullet_data, export):
    return export(pybullet_data / "r2d2.urdf", '[robot]\ninertia = "collision"\n')


@pytest.fixture
def turning(fmu, load):
    """A robot in the middle of a skidding turn, with commands and a parameter that are not the defaults."""
    robot = load(fmu)
    for wheel in WHEELS:
        robot[f"cmd.{wheel}.velocity"] = -9.0 if wheel.startswith("right") else 8.0
        robot[f"cmd.{wheel}.max_effort"] = 42.0
    robot["link.right_front_wheel.friction"] = 0.35
    robot.run(TIME, 1 / 333)
    robot.time = TIME
    assert abs(robot["base.angular_velocity.z"]) > 0.1
    return robot


def test_in_the_same_instance(turning):
    state = turning.slave.getFMUstate()
    at_save = bits(turning)
    drive(turning)
    first = bits(turning)
    assert first != at_save
    turning.slave.setFMUstate(state)
    turning.time = TIME
    assert bits(turning) == at_save
    drive(turning)
    assert bits(turning) == first
    # A state may be used more than once, and outlives a reset.
    turning.slave.reset()
    turning.time = 0.0
    turning.initialize({})
    turning.slave.setFMUstate(state)
    turning.time = TIME
    drive(turning)
    assert bits(turning) == first
    turning.slave.freeFMUstate(state)


def test_saving_does_not_disturb(fmu, load, turning):
    undisturbed = bits(turning)
    robot = load(fmu)
    for wheel in WHEELS:
        robot[f"cmd.{wheel}.velocity"] = -9.0 if wheel.startswith("right") else 8.0
        robot[f"cmd.{wheel}.max_effort"] = 42.0
    robot["link.right_front_wheel.friction"] = 0.35
    while TIME - robot.time > 1e-9:
        h = min(1 / 333, TIME - robot.time)
        state = robot.slave.getFMUstate()
        robot.slave.serializeFMUstate(state)
        robot.step(h)
        robot.slave.setFMUstate(state)
        robot.time -= h
        robot.outputs()
        robot.step(h)
        robot.slave.freeFMUstate(state)
    # The same steps, up to how run() cuts the last one.
    assert bits(robot) == undisturbed


def test_in_another_instance(turning, fmu, load):
    state = turning.slave.getFMUstate()
    data = turning.slave.serializeFMUstate(state)
    drive(turning)
    other = load(fmu)
    other.run(0.3)
    copy = other.slave.deSerializeFMUstate(data)
    other.slave.setFMUstate(copy)
    other.time = TIME
    drive(other)
    assert bits(other) == bits(turning)
    assert other["cmd.right_front_wheel_joint.max_effort"] == 42.0
    assert other["link.right_front_wheel.friction"] == 0.35


def test_in_a_new_process(turning, fmu, tmp_path):
    state = turning.slave.getFMUstate()
    saved, out = tmp_path / "state.bin", tmp_path / "out.bin"
    saved.write_bytes(turning.slave.serializeFMUstate(state))
    drive(turning)
    script = Path(__file__).with_name("state_continue.py")
    subprocess.run([sys.executable, "-B", str(script), str(fmu), str(saved), str(out)], check=True)
    assert out.read_bytes() == bits(turning)


def test_two_instances_do_not_meet(turning, fmu, load):
    expected = load(fmu)
    for _ in range(120):
        expected.step(1 / 240)
    other = load(fmu)
    for _ in range(120):
        turning.step(1 / 240)
        other.step(1 / 240)
    assert bits(other) == bits(expected)


@pytest.mark.parametrize("damage", [lambda data: data[:-1], lambda data: data[:20], lambda data: b"", lambda data:
                                    b"x" + data[1:], lambda data: data + b"\0"],
                         ids=["cut", "cut short", "empty", "other magic", "too long"])
def test_bytes_that_are_no_state_are_refused(damage, turning):
    state = turning.slave.getFMUstate()
    data = turning.slave.serializeFMUstate(state)
    before = bits(turning)
    with pytest.raises(Exception, match="fmi2DeSerializeFMUstate failed with status 3"):
        turning.slave.deSerializeFMUstate(damage(data))
    assert turning.messages
    # The instance itself is as it was.
    turning.slave.setFMUstate(state)
    assert bits(turning) == before
