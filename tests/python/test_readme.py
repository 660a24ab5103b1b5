"""The README's script is the example's, and what it says is printed is printed."""

import csv
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?")


def blocks(language=""):
    """The contents of the README's code blocks in a language."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    fenced = re.findall(r"^```(\w*)\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL)
    return [content for of, content in fenced if of == language]


def test_script_is_the_example():
    assert blocks("python") == [(ROOT / "examples/drive_rover.py").read_text(encoding="utf-8")]


def test_the_table_of_inputs_drives_the_rover_to_the_same_place(tmp_path):
    [shown] = [block for block in blocks() if "drive_rover.py" in block]
    [line] = [line for block in blocks() for line in block.splitlines() if "drive_rover.csv" in line]
    command, *arguments = shlex.split(line)
    assert command == "urdf2fmu"
    subprocess.run([os.environ["URDF2FMU"], "export", ROOT / "examples/rover.urdf", "-o", tmp_path / "rover.fmu"],
                   check=True, capture_output=True)
    arguments = [ROOT / argument if argument.startswith("examples/") else argument for argument in arguments]
    subprocess.run([os.environ["URDF2FMU"], *arguments, "--output-file", "out.csv"], check=True, capture_output=True,
                   cwd=tmp_path)
    assert (tmp_path / "drive.html").exists()
    with open(tmp_path / "out.csv", encoding="utf-8", newline="") as file:
        *_, last = csv.DictReader(file)
    there = [float(last[f"base.{name}"]) for name in ("position.x", "position.y", "position.z", "rpy.yaw")]
    _, *printed = [float(number) for number in NUMBER.findall(shown.splitlines()[-1])]
    assert there == pytest.approx(printed, abs=5e-3)


def test_rover_drives_as_the_readme_prints(tmp_path):
    [shown] = [block for block in blocks() if "drive_rover.py" in block]
    fmu = tmp_path / "rover.fmu"
    subprocess.run([os.environ["URDF2FMU"], "export", ROOT / "examples/rover.urdf", "-o", fmu], check=True, capture_output=True)
    done = subprocess.run([sys.executable, ROOT / "examples/drive_rover.py", fmu], check=True, capture_output=True, text=True)
    expected, printed = shown.splitlines()[1:], done.stdout.splitlines()
    assert [NUMBER.sub("#", line) for line in printed] == [NUMBER.sub("#", line) for line in expected]
    numbers = [[float(x) for line in lines for x in NUMBER.findall(line)] for lines in (printed, expected)]
    # Changes below what error control promises over four seconds (1e-3 per step) need no new README.
    assert numbers[0] == pytest.approx(numbers[1], abs=5e-3)
