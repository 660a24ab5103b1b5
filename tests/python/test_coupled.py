"""A controller exported by PythonFMU and our robot under one master that tries, rolls back and repeats steps."""

import shutil
import subprocess
import sys
from pathlib import Path

import fmpy
import pytest
from fmpy.fmi2 import FMU2Slave

from robot import Robot

CONTROLLER = Path(__file__).resolve().parent / "importers" / "distance_controller.py"
WHEELS = [f"cmd.{side}_{end}_wheel_joint.velocity" for side in ("left", "right") for end in ("front", "rear")]


@pytest.fixture
def controller(tmp_path):
    """An instance of the controller's FMU, initialised."""
    source = shutil.copy(CONTROLLER, tmp_path)
    done = subprocess.run([sys.executable, "-m", "pythonfmu", "build", "-f", source, "-d", tmp_path],
                          capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    folder = fmpy.extract(str(tmp_path / "DistanceController.fmu"), unzipdir=str(tmp_path / "controller"))
    description = fmpy.read_model_description(folder)
    slave = FMU2Slave(guid=description.guid, unzipDirectory=folder, instanceName="controller",
                      modelIdentifier=description.coSimulation.modelIdentifier)
    slave.instantiate()
    slave.setupExperiment()
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    yield slave, {v.name: v.valueReference for v in description.modelVariables}
    slave.terminate()
    slave.freeInstance()


def outputs(robot: Robot):
    """Bits of every real output."""
    names = [v for v in robot.variables.values() if v.causality == "output" and v.type == "Real"]
    return [value.hex() for value in robot.slave.getReal([v.valueReference for v in names])]


def set_speed(robot: Robot, speed: float):
    robot.slave.setReal([robot.variables[name].valueReference for name in WHEELS], [speed] * 4)


def test_a_coupled_robot_moves_as_it_does_alone_with_the_same_inputs(controller, export, load, examples):
    slave, reference = controller
    fmu = export(examples / "rover.urdf")
    robot = load(fmu)
    steps, bits, rolled_back = [], [], 0
    time, step, speed = 0.0, 1 / 32, 0.0
    while time < 4.0:
        before = robot.slave.getFMUstate()
        # Try the whole step with the last speed; if the robot moves far, go back and take half of it.
        start = robot["base.position.x"]
        set_speed(robot, speed)
        robot.slave.doStep(time, step)
        if abs(robot["base.position.x"] - start) > 0.006 and step > 1 / 64:
            robot.slave.setFMUstate(before)
            rolled_back += 1
            step /= 2
            robot.slave.freeFMUstate(before)
            continue
        # What the controller says to the trial's end replaces the guess: back, and the step again.
        slave.setReal([reference["position"]], [robot["base.position.x"]])
        slave.doStep(time, step)
        speed = slave.getReal([reference["speed"]])[0]
        robot.slave.setFMUstate(before)
        robot.slave.freeFMUstate(before)
        set_speed(robot, speed)
        robot.slave.doStep(time, step)
        steps.append((time, step, speed))
        bits.append(outputs(robot))
        time, step = time + step, 1 / 32
    # It has arrived, after driving fast enough to be rolled back.
    assert robot["base.position.x"] == pytest.approx(0.5, abs=0.02) and rolled_back > 5
    assert max(speed for _, _, speed in steps) > 4

    alone = load(fmu)
    for (time, step, speed), expected in zip(steps, bits):
        set_speed(alone, speed)
        alone.slave.doStep(time, step)
        assert outputs(alone) == expected, f"at {time} s"
