"""Files in xacro that are left to the xacro program: the program itself, 2.1.1 of the Python package index.

By itself it finds no package where ROS is not installed; with the index that urdf2fmu makes for it, it does.
"""

import os
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

MACROS = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="body" params="name mass">
    <link name="${name}">
      <visual><geometry><mesh filename="file://$(find arm_meshes)/base.stl"/></geometry></visual>
      <inertial><mass value="${mass}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    </link>
  </xacro:macro>
</robot>
"""

# Python's `lambda` is known to xacro alone, as the second test says.
ROBOT = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:include filename="$(find arm_description)/urdf/macros.xacro"/>
  <xacro:arg name="mass" default="2"/>
  <xacro:property name="mass" value="$(arg mass)"/>
  <xacro:body name="base" mass="${(lambda x: 3 * x)(mass)}"/>
</robot>
"""

# Environment variables by which ROS tells its packages.
ROS = ("AMENT_PREFIX_PATH", "ROS_PACKAGE_PATH", "PYTHONPATH")


@pytest.fixture(scope="module")
def xacro() -> Path:
    """The program in this environment."""
    found = shutil.which("xacro", path=Path(sys.executable).parent)
    assert found, "requirements.txt has it"
    return Path(found)


@pytest.fixture(scope="module")
def robot(tmp_path_factory) -> Path:
    """A robot of one package, whose mesh is in another one."""
    folder = tmp_path_factory.mktemp("workspace")
    for name in ("arm_description", "arm_meshes"):
        (folder / name).mkdir()
        (folder / name / "package.xml").write_text(f"<package><name>{name}</name></package>")
    urdf = folder / "arm_description" / "urdf"
    urdf.mkdir()
    (urdf / "macros.xacro").write_text(MACROS)
    (urdf / "arm.urdf.xacro").write_text(ROBOT)
    return urdf / "arm.urdf.xacro"


def run(path, *words):
    """Runs a program without ROS, with programs of one folder alone."""
    environment = {name: value for name, value in os.environ.items() if name not in ROS} | {"PATH": str(path)}
    return subprocess.run([str(word) for word in words], env=environment, capture_output=True, text=True, timeout=60,
                          check=False)


def test_packages_are_found_by_the_real_program(xacro, robot):
    alone = run(xacro.parent, xacro, robot)
    assert alone.returncode != 0 and "ament_index_python" in alone.stderr, alone
    done = run(xacro.parent, os.environ["URDF2FMU"], "expand", robot)
    assert done.returncode == 0, done.stderr
    # What the program writes above its result, without the path of the file.
    assert "<!-- expanded by xacro -->" in done.stdout, done
    root = ET.fromstring(done.stdout)
    # Three times the default of the argument.
    assert [mass.get("value") for mass in root.iter("mass")] == ["6"]
    [mesh] = root.iter("mesh")
    folder = Path(mesh.get("filename").removeprefix("file://")).parent
    assert folder.samefile(robot.parents[2] / "arm_meshes")
    # An argument goes on to the program, and so does the place of a package that an option names.
    other = robot.parents[2] / "meshes_v2"
    other.mkdir()
    done = run(xacro.parent, os.environ["URDF2FMU"], "expand", robot, "mass:=5", "--package", f"arm_meshes={other}")
    assert done.returncode == 0, done.stderr
    root = ET.fromstring(done.stdout)
    assert [mass.get("value") for mass in root.iter("mass")] == ["15"]
    [mesh] = root.iter("mesh")
    assert Path(mesh.get("filename").removeprefix("file://")).parent.samefile(other)


def test_without_the_program_it_is_named(robot):
    done = run("", os.environ["URDF2FMU"], "expand", robot)
    assert done.returncode == 1 and "'lambda'" in done.stderr and "pip install xacro" in done.stderr, done
