"""An SRDF beside the URDF: its states, passive joints and pairs of links, with those of example-robot-data."""

import json
import re
import xml.etree.ElementTree as xml
import zipfile

import pytest

from robot import Robot

PAIRS = [
    ("go1_description/urdf/go1.urdf", "go1_description/srdf/go1.srdf", "standing"),
    ("hyq_description/robots/hyq_no_sensors.urdf", "hyq_description/srdf/hyq.srdf", "standing"),
    ("panda_description/urdf/panda.urdf", "panda_description/srdf/panda.srdf", "default"),
    ("talos_data/robots/talos_reduced.urdf", "talos_data/srdf/talos.srdf", "half_sitting"),
    ("tiago_description/robots/tiago.urdf", "talos_data/srdf/talos.srdf", "half_sitting"),
]


@pytest.mark.parametrize("urdf, srdf, state", PAIRS[:4])
def test_a_robot_starts_in_the_state_of_its_srdf(urdf, srdf, state, example_robots, command, tmp_path):
    fmu = tmp_path / "robot.fmu"
    done = command("export", example_robots / urdf, "--srdf", example_robots / srdf, "--initial-state", state, "-o", fmu,
                   "--no-documentation")
    assert done.returncode == 0, done.stderr
    assert any(name.endswith(".srdf") for name in zipfile.ZipFile(fmu).namelist())
    given = {}
    for group in xml.parse(example_robots / srdf).getroot().findall("group_state"):
        if group.get("name") == state:
            given |= {joint.get("name"): joint.get("value") for joint in group.findall("joint")}
    robot = Robot(fmu)
    try:
        robot.initialize({})
        said = json.loads(command("info", "--json", fmu).stdout)["joints"]
        compared = 0
        for joint in said:
            if joint["name"] not in given or joint["q_index"] is None:
                continue
            position = float(given[joint["name"]])
            if joint["lower"] is not None:
                position = min(max(position, joint["lower"]), joint["upper"])
            name = re.sub("[^A-Za-z0-9_]", "_", joint["name"])
            assert robot[f"joint.{name}.position"] == pytest.approx(position, abs=1e-12), name
            compared += 1
        assert compared >= 7
    finally:
        robot.free()


@pytest.mark.parametrize("urdf, srdf, state", PAIRS)
def test_pairs_of_links_are_held_against_the_robot(urdf, srdf, state, example_robots, command):
    """Counted by Python's XML reader; the last SRDF is that of another robot."""
    done = command("check", "--json", example_robots / urdf, "--srdf", example_robots / srdf)
    findings = json.loads(done.stdout)["findings"]
    links = {link.get("name") for link in xml.parse(example_robots / urdf).getroot().findall("link")}
    named = [(pair.get("link1"), pair.get("link2"))
             for pair in xml.parse(example_robots / srdf).getroot().findall("disable_collisions")]
    good = {frozenset(pair) for pair in named if set(pair) <= links}
    note = next(finding["message"] for finding in findings if "pairs of links" in finding["message"])
    assert note.startswith(f"{len(good)} pairs")
    unknown = {name for pair in named for name in pair} - links
    told = {re.search("names link '([^']*)'", finding["message"]).group(1) for finding in findings
            if finding["code"] == "R102" and "names link" in finding["message"]}
    # Of a pair the second is told, too.
    assert told == unknown
    assert all(finding["line"] for finding in findings if finding["code"].startswith("R"))


def test_a_state_that_is_not_there_is_an_error_that_names_those_there_are(example_robots, command):
    urdf, srdf, _ = PAIRS[0]
    done = command("check", example_robots / urdf, "--srdf", example_robots / srdf, "--initial-state", "standin")
    assert done.returncode == 1
    assert "error[R104]: there is no state 'standin'" in done.stderr
    assert "standing" in done.stderr
    # Without an SRDF there is nothing to look in.
    assert command("check", example_robots / urdf, "--initial-state", "standing").returncode == 2
