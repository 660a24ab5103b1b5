"""Thirty of other people's robots: exported, loaded, stepped a hundred times, and nothing of the file lost.

All of them are judged by `tests/corpus/corpus.py`, see `docs/corpus.md`. What a file says is counted by Python's own
XML reader (`tests/corpus/independent.py`).
"""

import json
import math
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "corpus"))
import ours
from independent import counts

SAMPLE = 30
RANDOM = 5
STEPS = 100
STEP = 1 / 240


def evenly(files, count):
    """So many of them, from the first on."""
    return [files[k * len(files) // count] for k in range(count)]


@pytest.fixture
def sample(pybullet_data, example_robots):
    """Every so many-th file; few of the thousand that differ by a shape only."""
    files = sorted(pybullet_data.rglob("*.urdf")) + sorted(example_robots.rglob("*.urdf"))
    random = [file for file in files if "random_urdfs" in file.parts]
    return evenly([file for file in files if file not in set(random)], SAMPLE - RANDOM) + evenly(random, RANDOM)


@pytest.mark.parametrize("number", range(SAMPLE))
def test_a_sample_of_the_corpus_loads_steps_and_loses_nothing(number, sample, command, tmp_path):
    from robot import Robot

    urdf = sample[number]
    fmu = tmp_path / "robot.fmu"
    done = command("export", "--no-documentation", urdf, "-o", fmu)
    findings = json.loads(command("check", "--json", urdf).stdout)["findings"]
    if done.returncode != 0:
        # A fault of the file, then, and said where.
        errors = [finding for finding in findings if finding["severity"] == "error"]
        assert errors and all(finding["line"] for finding in errors), f"{urdf}: {done.stderr}"
        return

    robot = json.loads(command("info", "--json", fmu).stdout)
    lost, _replaced = ours.lost(counts(urdf), ours.contents(robot, findings))
    assert not lost, f"{urdf}: {lost}"

    robot = Robot(fmu)
    try:
        robot.initialize({})
        outputs = [v.valueReference for v in robot.description.modelVariables
                   if v.causality == "output" and v.type == "Real"]
        for k in range(STEPS):
            robot.slave.doStep(currentCommunicationPoint=k * STEP, communicationStepSize=STEP)
            assert all(map(math.isfinite, robot.slave.getReal(outputs))), f"{urdf}: step {k + 1}"
    finally:
        robot.free()


def test_the_scripts_that_documents_name_start():
    # A script's folder comes first where Python looks for modules, so that a script named as one of Python's own hides
    # that from all others of the folder.
    scripts = sorted((Path(__file__).resolve().parents[1] / "corpus").glob("*.py"))
    for script in scripts:
        assert script.stem not in sys.stdlib_module_names, script
    for script in ("public.py", "xacro.py"):
        done = subprocess.run([sys.executable, scripts[0].with_name(script)], capture_output=True, text=True, check=False)
        assert "not enough values to unpack" in done.stderr
