"""Broken files, broken FMUs and broken calls: a clear error each, and the host process lives."""

import math
import re

import pytest

# Lines where the error may point end with the comment HERE.
LINK = '<link name="{}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'


def joint(name, parent, child, kind="continuous"):
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/></joint>'


def robot(*parts):
    return "\n".join(['<?xml version="1.0"?>', '<robot name="broken">', *parts, "</robot>"])


HERE = " <!-- HERE -->"
A, B, C = (LINK.format(name) for name in "abc")
BROKEN = {
    "not XML": ("this is not XML" + HERE + "\n", []),
    "cut off": (f'<robot name="broken">\n{A}\n<link name="b">{HERE}\n', []),
    "not a robot": (f'<?xml version="1.0"?>\n<sdf version="1.7">{HERE}\n</sdf>', ["robot"]),
    "no links": (f'<?xml version="1.0"?>\n<robot name="broken">{HERE}\n</robot>', ["link"]),
    "two roots": (robot(A + HERE, B + HERE), ["root"]),
    "a cycle": (robot(A + HERE, B + HERE, joint("ab", "a", "b") + HERE, joint("ba", "b", "a") + HERE), []),
    "a cycle beside a root": (robot(A, B + HERE, C + HERE, joint("bc", "b", "c") + HERE, joint("cb", "c", "b") + HERE),
                              []),
    "two parents": (robot(A, B, C + HERE, joint("ab", "a", "b"), joint("ac", "a", "c") + HERE,
                          joint("bc", "b", "c") + HERE), ["c"]),
    "duplicate link": (robot(A + HERE, B, A + HERE, joint("ab", "a", "b")), ["a"]),
    "duplicate joint": (robot(A, B, C, joint("j", "a", "b") + HERE, joint("j", "a", "c") + HERE), ["j"]),
    "NaN": (robot(A.replace('mass value="1"', 'mass value="NaN"') + HERE), ["NaN"]),
    "a comma": (robot(A.replace('mass value="1"', 'mass value="1,0"') + HERE), ["1,0"]),
    "a comma in a vector": (robot(A, B, joint("ab", "a", "b").replace("</joint>", '<axis xyz="1,0,0"/></joint>')
                                  + HERE), ["1,0,0"]),
    "infinite": (robot(A.replace('ixx="1"', 'ixx="1e999"') + HERE), ["1e999"]),
    "negative mass": (robot(A.replace('mass value="1"', 'mass value="-1"') + HERE), ["mass"]),
    "zero axis": (robot(A, B, joint("ab", "a", "b").replace("</joint>", '<axis xyz="0 0 0"/></joint>') + HERE),
                  ["axis"]),
    "unknown parent": (robot(A, B, joint("ab", "base", "b") + HERE), ["base"]),
    "unknown child": (robot(A, B, joint("ab", "a", "c") + HERE), ["c"]),
    "unknown joint type": (robot(A, B, joint("ab", "a", "b", "hinge") + HERE), ["hinge"]),
    "missing mesh": (robot(A.replace("</link>", '<collision><geometry><mesh filename="gone.stl"/></geometry>'
                                     "</collision></link>") + HERE), ["gone.stl"]),
    "missing package": (robot(A.replace("</link>", '<collision><geometry><mesh filename="package://nowhere/gone.stl"/>'
                                        "</geometry></collision></link>") + HERE), ["nowhere", "--package-path"]),
}


@pytest.mark.parametrize("kind", BROKEN)
def test_a_broken_urdf_is_an_error_with_its_place(kind, command, tmp_path):
    text, words = BROKEN[kind]
    urdf, fmu = tmp_path / "broken.urdf", tmp_path / "broken.fmu"
    urdf.write_text(text)
    done = command("export", urdf, "-o", fmu)
    print(done.stderr)
    assert done.returncode == 1
    assert not fmu.exists()
    assert "error" in done.stderr
    assert "panicked" not in done.stderr
    places = [int(line) for line in re.findall(r"broken\.urdf:(\d+)", done.stderr)]
    here = [number for number, line in enumerate(text.splitlines(), 1) if line.endswith("<!-- HERE -->")]
    assert places and set(places) & set(here), f"points to lines {places}, not to one of {here}"
    for word in words:
        assert word in done.stderr


def test_no_such_file_is_an_error(command, tmp_path):
    done = command("export", tmp_path / "gone.urdf", "-o", tmp_path / "gone.fmu")
    assert done.returncode in (1, 2)
    assert "gone.urdf" in done.stderr and "panicked" not in done.stderr


def test_an_unknown_setting_is_an_error_that_names_the_nearest(command, pybullet_data, tmp_path):
    config = tmp_path / "robot.toml"
    config.write_text("[solver]\ntolerence = 1e-3\n")
    done = command("export", pybullet_data / "r2d2.urdf", "-o", tmp_path / "r.fmu", "-c", config)
    assert done.returncode in (1, 2)
    assert "tolerence" in done.stderr and "tolerance" in done.stderr


@pytest.fixture
def fmu(pybullet_data, export):
    return export(pybullet_data / "r2d2.urdf")


def lives(robot):
    """The instance can be reset and used again."""
    robot.slave.reset()
    robot.time = 0.0
    robot.initialize({})
    robot.run(0.05)
    assert robot.finite()


def refused(fmu, capfd, **options):
    """An FMU that does not instantiate; what it logged."""
    from robot import Robot

    messages = []
    with pytest.raises(Exception, match="instantiate"):
        Robot(fmu, messages=messages, **options)
    assert [message for message in messages if message[0] >= 3], messages
    assert "panicked" not in capfd.readouterr().err
    return " ".join(message[2] for message in messages)


def test_a_wrong_guid_is_refused_and_said(fmu, load, capfd):
    guid = "{00000000-0000-0000-0000-000000000000}"
    text = refused(fmu, capfd, guid=guid)
    assert "guid" in text.lower() and guid in text
    load(fmu).run(0.05)


def test_missing_resources_are_refused_and_said(fmu, load, capfd):
    assert "model.json" in refused(fmu, capfd, without_resources=True)
    load(fmu).run(0.05)


@pytest.mark.parametrize("h", [-1 / 240, 0.0, math.nan, math.inf, -math.inf])
def test_a_step_that_does_not_go_forward_is_an_error(h, fmu, load):
    robot = load(fmu)
    robot.run(0.05)
    robot.messages.clear()
    with pytest.raises(Exception, match="fmi2DoStep failed with status 3"):
        robot.slave.doStep(robot.time, h)
    assert [message for message in robot.messages if message[0] == 3], robot.messages
    lives(robot)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("name", ["cmd.right_front_wheel_joint.velocity", "world.gravity.z"])
def test_a_value_that_is_not_finite_is_an_error_and_nothing_is_set(name, value, fmu, load):
    robot = load(fmu)
    good = "cmd.left_front_wheel_joint.velocity"
    references = [robot.variables[each].valueReference for each in (good, name)]
    before = [robot[good], robot[name]]
    state = robot.slave.getFMUstate()
    with pytest.raises(Exception, match="fmi2SetReal failed with status 3"):
        robot.slave.setReal(references, [5.0, value])
    assert name in " ".join(message[2] for message in robot.messages)
    robot.slave.setFMUstate(state)
    assert [robot[good], robot[name]] == before
    robot.run(0.05)
    assert robot.finite()
    lives(robot)


def test_a_negative_effort_limit_is_an_error(fmu, load):
    robot = load(fmu)
    with pytest.raises(Exception, match="fmi2SetReal failed with status 3"):
        robot["cmd.right_front_wheel_joint.max_effort"] = -1.0
    lives(robot)


def test_an_unknown_value_reference_is_an_error(fmu, load):
    robot = load(fmu)
    with pytest.raises(Exception, match="fmi2GetReal failed with status 3"):
        robot.slave.getReal([4_000_000_000])
    lives(robot)


def test_an_output_cannot_be_set(fmu, load):
    robot = load(fmu)
    with pytest.raises(Exception, match="fmi2SetReal failed with status 3"):
        robot["base.position.x"] = 1.0
    lives(robot)


def test_a_step_before_initialisation_is_an_error(fmu):
    from robot import Robot

    robot = Robot(fmu)
    with pytest.raises(Exception, match="fmi2DoStep failed with status 3"):
        robot.step(0.01)
    lives(robot)
    robot.free()
