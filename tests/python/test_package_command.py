"""The Python package and what the command beneath it says: warnings, findings, options, globs, pages and tables."""

import re
import subprocess
import sys
import types
import warnings
import zipfile
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))
import urdf2fmu  # noqa: E402
from urdf2fmu import Error, Simulation, _runs  # noqa: E402

BROKEN = '<robot name="r"><link name="a"/><link name="a"/></robot>'
HEAVY = """<robot name="r"><link name="a"><inertial><mass value="1"/></inertial><collision><geometry>
<box size="1 1 1"/></geometry></collision></link></robot>"""
ROWS = {"sensor": [{"type": "ray", "name": "lidar", "link": "base_link", "rays": 3, "rows": 2, "fov": 1.0,
                    "vertical_fov": 0.2}]}


@pytest.fixture(scope="module")
def rover(examples, tmp_path_factory):
    """The FMU of the example rover."""
    place = tmp_path_factory.mktemp("commanded") / "rover.fmu"
    return urdf2fmu.export(examples / "rover.urdf", place, no_documentation=True)


def test_what_the_command_warns_of_is_a_python_warning_at_the_line_of_the_caller(tmp_path):
    """It was dropped where the command succeeded."""
    robot = tmp_path / "heavy.urdf"
    robot.write_text(HEAVY)
    for call in (lambda: urdf2fmu.export(robot), lambda: urdf2fmu.info(robot),
                 lambda: urdf2fmu.simulate(robot, stop_time=0.01), lambda: urdf2fmu.show(robot, stop_time=0.01),
                 lambda: Simulation(robot).close()):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            call()
        assert len(told) == 1, [str(one.message) for one in told]
        assert told[0].category is RuntimeWarning and told[0].filename == __file__
        text = str(told[0].message)
        assert text.startswith("U063: link 'a'") and "heavy.urdf:1:" in text, text
    # Findings are the answer of check, and no warning beside it.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert [f["code"] for f in urdf2fmu.check(robot) if f["severity"] == "warning"] == ["U063"]
    # The FMU is there, although the warning has been made an error.
    fmu = tmp_path / "heavy.fmu"
    fmu.unlink()
    with warnings.catch_warnings(), pytest.raises(RuntimeWarning, match="U063"):
        warnings.simplefilter("error")
        urdf2fmu.export(robot)
    assert zipfile.is_zipfile(fmu)


def test_warnings_of_an_fmu_that_the_command_simulates_are_python_warnings(rover):
    with pytest.warns(RuntimeWarning, match="inside the ground") as told:
        urdf2fmu.simulate(rover, stop_time=0.01, start_values={"initial.base.position.z": 0.1})
    assert [one.filename for one in told] == [__file__]


@pytest.mark.parametrize("options", [{}, {"reference_run": True}, {"platform": "linux64"}, {"no_documentation": True}])
def test_every_call_that_refuses_a_robot_gives_its_findings(options, tmp_path):
    """But for a plain export there were none."""
    robot = tmp_path / "broken.urdf"
    robot.write_text(BROKEN)
    for function in (urdf2fmu.export, urdf2fmu.info, urdf2fmu.simulate, urdf2fmu.show, Simulation):
        with pytest.raises(Error) as raised:
            function(robot, **options)
        assert raised.value.exit_code == 1
        assert [finding["code"] for finding in raised.value.findings] == ["U014"], function
    assert "U014" in [finding["code"] for finding in urdf2fmu.check(robot, **options)]


def test_options_of_export_are_options_of_check_and_info(examples):
    robot = examples / "rover.urdf"
    carried = urdf2fmu.info(robot)["platforms"]
    options = {"platform": carried[0], "no_documentation": True, "reference_run": True}
    assert not [f for f in urdf2fmu.check(robot, **options) if f["severity"] == "error"]
    assert urdf2fmu.info(robot, **options)["platforms"] == carried[:1]
    for function in (urdf2fmu.check, urdf2fmu.info, urdf2fmu.export):
        with pytest.raises(Error, match="'windows' is no platform .did you mean 'win64'"):
            function(robot, platform="windows")


def test_brackets_of_a_glob_are_those_of_names(examples, tmp_path):
    """They were sets of letters, so that `ray[1,*]` meant nothing."""
    fmu = urdf2fmu.export(examples / "rover.urdf", tmp_path / "rays.fmu", config=ROWS, no_documentation=True)
    first = [f"sensor.lidar.ray[1,{column}]" for column in (1, 2, 3)]
    second = [f"sensor.lidar.ray[{row},2]" for row in (1, 2)]
    with Simulation(fmu) as robot:
        assert robot.names("*.ray[1,*]") == first and robot.names("*.ray[?,2]") == second
        assert robot["sensor.lidar.ray[1,*]"].tolist() == [robot[name] for name in first]
        assert robot.names("base.position.[xyz]") == [] and "base.position.[xyz]" not in robot
    table = urdf2fmu.simulate(fmu, stop_time=0.01, output=["sensor.lidar.ray[1,*]", "*.ray[?,2]"])
    assert table.dtype.names == ("time", *first, second[1])
    # As the command has it.
    assert table.dtype == urdf2fmu.simulate(fmu, stop_time=0.01,
                                            output_variable=["sensor.lidar.ray[1,*]", "*.ray[?,2]"]).dtype


def test_a_page_takes_inputs_and_start_values(rover):
    options = {"start_values": {"initial.base.position": [1.0, 2.0, 0.5]},
               "input": {"time": [0.0], "cmd.head_joint.velocity": [0.5]}}
    assert urdf2fmu.show(rover, stop_time=0.05, **options).html != urdf2fmu.show(rover, stop_time=0.05).html
    table = urdf2fmu.simulate(rover, stop_time=0.05, **options)
    for more in options.items():
        with pytest.raises(Error, match="and a result is given"):
            urdf2fmu.show(rover, table, **dict([more]))
    with pytest.raises(Error, match="the table of inputs, names, column 2: there is no"):
        urdf2fmu.show(rover, stop_time=0.05, input={"time": [0], "nothing": [0]})


def test_all_options_of_the_command_simulate_are_those_of_a_robot_too(examples):
    """Each goes to the export or to the simulation; `output_variable` went to the wrong one."""
    def options(name):
        said = subprocess.run([urdf2fmu.command(), name, "--help"], capture_output=True, text=True, check=True).stdout
        return set(re.findall(r"^ +(?:-\w, )?--([a-z-]+)", said, re.M)) - {"help"}

    own = {option.replace("-", "_") for option in options("simulate") - options("export")}
    # Start values are given as a dict.
    assert own - {"start_value"} == set(_runs._OF_SIMULATE)
    table = urdf2fmu.simulate(examples / "rover.urdf", stop_time=0.01, output_variable=["energy.*"])
    assert table.dtype.names == ("time", "energy.kinetic", "energy.potential")


class Frame:
    """What is used of a pandas DataFrame, by its documentation: columns, an index with a name, `to_records`."""

    def __init__(self, columns, index, name):
        self.columns, self.index = columns, types.SimpleNamespace(name=name, values=index)

    def to_records(self, index):
        columns = {**({self.index.name or "index": self.index.values} if index else {}), **self.columns}
        return np.rec.fromarrays([np.asarray(values) for values in columns.values()], names=list(columns))


def test_the_index_of_a_frame_may_be_the_time(rover):
    drive = {"cmd.head_joint.velocity": [0.0, 0.5]}
    expected = urdf2fmu.simulate(rover, stop_time=0.1, input={"time": [0.0, 0.1], **drive})
    for frame in (Frame(drive, [0.0, 0.1], "time"), Frame({"time": [0.0, 0.1], **drive}, [0, 1], None)):
        assert np.array_equal(urdf2fmu.simulate(rover, stop_time=0.1, input=frame), expected)
    with pytest.raises(Error, match="time"):
        urdf2fmu.simulate(rover, stop_time=0.1, input=Frame(drive, [0.0, 0.1], None))
