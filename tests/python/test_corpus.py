"""Thirty of other people's robots: exported, loaded, stepped a hundred times, and nothing of the file lost.

All of them are judged by `tests/corpus/corpus.py`, see `docs/corpus.md`. What a file says is counted by Python's own
XML reader (`tests/corpus/independent.py`).
"""

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "corpus"))
import newcomer
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


def test_a_newcomer_does_what_is_said_and_loads_in_the_second_run(tmp_path):
    # Each fault is mended by another kind of remedy; what is expected follows from the faults alone.
    inertial = ('<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>')
    ball = '<collision><geometry><sphere radius="0.1"/></geometry></collision>'
    mesh = '<collision><geometry><mesh filename="{}"/></geometry></collision>'
    robot = ('<robot name="r" xmlns:xacro="http://wiki.ros.org/xacro"><link name="base">{}</link><link name="tip">{}'
             '</link><joint name="j" type="continuous"><parent link="{}"/><child link="tip"/></joint>{}</robot>')
    use = '<material name="$(find elsewhere)"/>'
    files = {
        "sound.urdf": (robot.format(inertial, inertial, "base", ""), ("loads", 1)),
        "light.urdf": (robot.format("", ball, "base", ""), ("loads", 2)),
        "misspelt.urdf": (robot.format(inertial, inertial, "bose", ""), ("loads", 2)),
        "lost.urdf": (robot.format(mesh.format("a.stl"), mesh.format("b.obj") + inertial, "base", ""), ("loads", 2)),
        "argument.xacro": (robot.format(inertial, "$(arg inner)", "base", ""), ("lacks", 1)),
        "package.xacro": (robot.format(inertial, inertial, "base", use), ("loads", 2)),
        "nowhere.xacro": (robot.format(inertial, inertial, "base", use.replace("elsewhere", "no")), ("lacks", 1)),
        "part.xacro": ('<robot xmlns:xacro="http://wiki.ros.org/xacro"><xacro:macro name="m" params=""><link/>'
                       '</xacro:macro></robot>', ("part", 1)),
    }
    for name, (text, _) in files.items():
        # Each in a package of its own, and far from the one that some lack.
        package = tmp_path / "a" / "home" / "of" / "robots" / name.replace(".", "_")
        package.mkdir(parents=True)
        (package / name).write_text(text)
    (tmp_path / "others" / "deep" / "e").mkdir(parents=True)
    (tmp_path / "others" / "deep" / "e" / "package.xml").write_text("<package><name>elsewhere</name></package>")
    roots = [tmp_path / "a" / "home" / "of" / "robots", tmp_path / "others"]
    known = newcomer.firsts(roots)
    for name, (_, expected) in files.items():
        file = roots[0] / name.replace(".", "_") / name
        told = newcomer.judge(os.environ["URDF2FMU"], file, roots[0], known)
        assert (told["fate"], told["runs"]) == expected, f"{name}: {told}"
        assert not told.get("wrong"), told


def test_the_scripts_that_documents_name_start():
    # A script's folder comes first where Python looks for modules, so that a script named as one of Python's own hides
    # that from all others of the folder.
    scripts = sorted((Path(__file__).resolve().parents[1] / "corpus").glob("*.py"))
    for script in scripts:
        assert script.stem not in sys.stdlib_module_names, script
    for script in ("public.py", "xacro.py", "newcomer.py"):
        done = subprocess.run([sys.executable, scripts[0].with_name(script)], capture_output=True, text=True, check=False)
        assert "not enough values to unpack" in done.stderr
