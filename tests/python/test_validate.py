"""FMPy's own validation finds nothing to complain about in the FMUs of robots that nobody here wrote."""

import math
import subprocess
import sys
import zipfile

import fmpy
import pytest

PYBULLET = ["r2d2.urdf", "cube.urdf", "kuka_iiwa/model.urdf", "franka_panda/panda.urdf", "a1/a1.urdf",
            "husky/husky.urdf"]
EXAMPLES = ["anymal_b_simple_description/robots/anymal.urdf", "anymal_c_simple_description/urdf/anymal.urdf",
            "g1_description/urdf/g1_29dof_rev_1_0.urdf", "g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf"]


def problems(fmu):
    """FMPy's exit code is the number of problems."""
    done = subprocess.run([sys.executable, "-m", "fmpy", "validate", str(fmu)], capture_output=True, text=True,
                          check=False)
    return done.returncode, done.stdout + done.stderr


def runs(robot):
    """A robot left alone for 0.1 s."""
    robot.run(0.1)
    assert robot.finite()
    assert not [message for message in robot.messages if message[0] >= 2], robot.messages


@pytest.mark.parametrize("urdf", PYBULLET)
def test_a_robot_of_pybullet_is_valid_and_runs(urdf, pybullet_data, export, load):
    fmu = export(pybullet_data / urdf)
    count, report = problems(fmu)
    assert count == 0, report
    runs(load(fmu))


@pytest.mark.parametrize("urdf", EXAMPLES)
def test_a_robot_of_example_robot_data_is_valid_and_runs(urdf, example_robots, export, load):
    fmu = export(example_robots / urdf)
    count, report = problems(fmu)
    assert count == 0, report
    runs(load(fmu))


def test_flat_names_are_valid_and_have_no_structure(pybullet_data, export, load):
    fmu = export(pybullet_data / "r2d2.urdf", "", "--naming", "flat")
    count, report = problems(fmu)
    assert count == 0, report
    robot = load(fmu)
    assert robot.description.variableNamingConvention == "flat"
    assert not [name for name in robot.variables if "." in name]
    assert "cmd_right_front_wheel_joint_velocity" in robot.variables


def test_r2d2_has_the_promised_variables(pybullet_data, export, load):
    robot = load(export(pybullet_data / "r2d2.urdf"))
    inputs = [name for name, variable in robot.variables.items() if variable.causality == "input"]
    assert len(inputs) == 16
    velocity = robot.variables["cmd.right_front_wheel_joint.velocity"]
    assert (float(velocity.start), float(velocity.min), float(velocity.max)) == (0, -100, 100)
    assert float(robot.variables["cmd.right_front_wheel_joint.max_effort"].start) == 100
    assert len([name for name in robot.variables if name.startswith("base.")]) == 16
    positions = [name for name in robot.variables if name.startswith("joint.") and name.endswith(".position")]
    assert len(positions) == 8


def test_the_same_export_gives_the_same_bytes(pybullet_data, command, tmp_path):
    files = []
    for name in ["a.fmu", "b.fmu"]:
        done = command("export", pybullet_data / "r2d2.urdf", "-o", tmp_path / name)
        assert done.returncode == 0, done.stderr
        files.append((tmp_path / name).read_bytes())
    assert files[0] == files[1]


def test_the_fmu_carries_its_library_and_its_sources(pybullet_data, export):
    with zipfile.ZipFile(export(pybullet_data / "r2d2.urdf")) as archive:
        names = archive.namelist()
    assert "modelDescription.xml" in names
    assert [name for name in names if name.startswith("binaries/")]
    assert "resources/model.json" in names
    assert [name for name in names if name.startswith("resources/source/") and name.endswith("r2d2.urdf")]


@pytest.mark.parametrize("with_defaults", [False, True])
def test_fmpy_simulates_it_in_one_call(with_defaults, pybullet_data, export):
    # As FMPy's users do; with_defaults sets every parameter and input to the start that the XML promises.
    result = fmpy.simulate_fmu(str(export(pybullet_data / "r2d2.urdf")), stop_time=1.0, output_interval=0.05,
                               apply_default_start_values=with_defaults, output=["base.position.z"])
    assert len(result) == 21
    heights = [row["base.position.z"] for row in result]
    assert all(math.isfinite(height) for height in heights)
    assert max(heights) - min(heights) < 1e-3
