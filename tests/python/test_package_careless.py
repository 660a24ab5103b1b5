"""The Python package in careless hands: wrong types, Ctrl-C, forks, threads that outlive Python, copies."""

import copy
import decimal
import fractions
import os
import pickle
import subprocess
import sys
import textwrap
import warnings
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))
import urdf2fmu  # noqa: E402
from urdf2fmu import Error, Simulation  # noqa: E402

WHEELS = "cmd.*_wheel_joint.velocity"
ROWS = {"sensor": [{"type": "ray", "name": "lidar", "link": "base_link", "rays": 3, "rows": 2, "fov": 1.0,
                    "vertical_fov": 0.2, "hits": True}]}


@pytest.fixture(scope="module", params=[2, 3])
def rover(request, examples, tmp_path_factory):
    """The FMU of the example rover, of FMI 2 and of FMI 3."""
    place = tmp_path_factory.mktemp("careless") / "rover.fmu"
    return urdf2fmu.export(examples / "rover.urdf", place, fmi=request.param, no_documentation=True)


def run_alone(code, *arguments):
    """A program of its own that uses the package: its exit code, and what it says."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "python")}
    return subprocess.run([sys.executable, "-X", "faulthandler", "-c", textwrap.dedent(code), *map(str, arguments)],
                          env=environment, capture_output=True, text=True, timeout=120, check=False)


def test_a_table_may_be_a_file_and_a_small_number_a_start_value(rover, tmp_path):
    """The name of a file was taken for a table without columns, and -1e-05 for an option of the command."""
    file = tmp_path / "drive.csv"
    file.write_text("time,cmd.head_joint.velocity\n0,0.5\n")
    options = {"stop_time": 0.1, "start_values": {"cmd.right_rear_wheel_joint.velocity": -1e-5}}
    of_file = urdf2fmu.simulate(rover, input=file, **options)
    of_dict = urdf2fmu.simulate(rover, input={"time": [0.0], "cmd.head_joint.velocity": [0.5]}, **options)
    assert of_file["joint.head_joint.velocity"][-1] > 0.1
    assert np.array_equal(of_file, of_dict)


def test_a_simulation_lists_its_names(rover):
    with Simulation(rover) as robot:
        assert list(robot) == robot.names() and "base.position" in robot
        with pytest.raises(Error, match="a pattern is a text, not 3"):
            robot.names(3)


@pytest.mark.skipif(sys.platform == "win32", reason="there is no timer that raises signals")
def test_after_ctrl_c_in_a_step_the_next_step_goes_on(rover):
    # Python raises it before the call of the C function or when the step is done.
    done = run_alone("""
        import signal, sys, urdf2fmu

        def interrupt(*_):
            raise KeyboardInterrupt

        signal.signal(signal.SIGALRM, interrupt)
        with urdf2fmu.Simulation(sys.argv[1]) as robot:
            for length in [100.0, 0.001] * 100:
                try:
                    signal.setitimer(signal.ITIMER_REAL, 0.002)
                    while True:
                        robot.step(length)
                except KeyboardInterrupt:
                    robot.step(0.01)
            print("goes on")
    """, rover)
    assert done.stdout == "goes on\n", done.stderr


def test_names_of_files_in_a_dict_count_from_the_current_folder(examples, tmp_path, monkeypatch):
    """They were looked for beside the temporary file that the dict is written to. The FMU holds no name of this
    machine and is the same each time, although that file is another one."""
    near, far = tmp_path / "near", tmp_path / "far"
    for folder in (near, far):
        folder.mkdir()
    (near / "cube.urdf").write_text((examples / "worlds/crate.urdf").read_text())
    (near / "table.csv").write_text("0,0\n0,0\n")
    (far / "rover.urdf").write_text((examples / "rover.urdf").read_text())
    monkeypatch.chdir(near)
    config = {"world": {"object": [{"urdf": "cube.urdf", "name": "cube", "xyz": [2, 0]}],
                        "terrain": [{"name": "hill", "type": "heightfield", "file": "table.csv", "xyz": [0, 5, 0],
                                     "size": [1, 1]}]}}
    fmus = [urdf2fmu.export(far / "rover.urdf", tmp_path / f"{n}.fmu", config=config, no_documentation=True) for n in "ab"]
    assert fmus[0].read_bytes() == fmus[1].read_bytes()
    with zipfile.ZipFile(fmus[0]) as archive:
        packed = [name for name in archive.namelist() if name.startswith("resources/source/")]
        settings = next(name for name in packed if name.endswith("settings.toml"))
        assert settings.rpartition("/")[0] + "/cube.urdf" in packed, packed
        assert str(tmp_path) not in archive.read(settings).decode()
    with Simulation(far / "rover.urdf", config=config) as robot:
        assert abs(robot["object.cube.position.x"] - 2) < 1e-9
    assert not [f for f in urdf2fmu.check(far / "rover.urdf", config=config) if f["severity"] == "error"]


def test_a_warning_that_is_made_an_error_leaves_the_time_right(rover):
    with Simulation(rover) as robot, Simulation(rover) as other, warnings.catch_warnings():
        warnings.simplefilter("error")
        robot.step(0.25)
        # A mistake of the caller that only warns: the step is done all the same.
        call = robot._call

        def warn(function, *arguments):
            call(function, *arguments)
            if function == "DoStep":
                raise RuntimeWarning("as warnings.warn raises it")

        robot._call = warn
        with pytest.raises(RuntimeWarning):
            robot.step(0.25)
        robot._call = call
        robot.step(0.25)
        for _ in range(3):
            other.step(0.25)
        assert robot.time == other.time == 0.75
        assert np.array_equal(robot["base.position"], other["base.position"])


def test_steps_of_any_kind_of_number_add_up_as_float64(rover):
    with Simulation(rover) as robot:
        for duration in (np.float32(0.1), np.array(0.25), np.int64(1), fractions.Fraction(1, 8), True):
            robot.step(duration)
        assert type(robot.time) is float
        assert robot.time == float(np.float32(0.1)) + 0.25 + 1 + 0.125 + 1


@pytest.mark.parametrize("duration", ["0.1", None, 1 + 0j, [0.1, 0.1], np.array([0.1]), 10**400, {}])
def test_a_step_that_is_no_number_is_refused_and_changes_nothing(rover, duration):
    with Simulation(rover) as robot:
        with pytest.raises(Error, match="^a step takes "):
            robot.step(duration)
        robot.step(0.1)
        assert robot.time == 0.1


@pytest.mark.parametrize("value", ["1", b"1", None, 1 + 2j, np.array(1 + 2j), 10**400, {}, object(), ["1"], [None] * 4,
                                   np.ma.array([1.0, 2.0, 3.0, 4.0], mask=[0, 1, 0, 0])])
def test_only_numbers_are_values(rover, value):
    with Simulation(rover) as robot:
        with pytest.raises(Error, match=r"^'cmd\.\*_wheel_joint\.velocity' takes numbers, not "):
            robot[WHEELS] = value
        with pytest.raises(Error, match="takes numbers"):
            urdf2fmu.simulate(rover, stop_time=0.1, input={"time": [0, 1], "cmd.head_joint.velocity": value})
        assert not robot[WHEELS].any()


def test_arrays_of_any_kind_and_stride_are_values(rover):
    with Simulation(rover) as robot:
        for value in (np.arange(8.0)[::2], np.arange(4, dtype=np.int8) * 2, np.array([0, 2, 4, 6], ">f4"),
                      np.array([0, 2, 4, 6], np.float16), [0, 2, 4, 6], range(0, 8, 2), np.arange(6.0, -1, -2)[::-1],
                      [fractions.Fraction(n) for n in (0, 2, 4, 6)], np.ma.array([0, 2, 4, 6])):
            robot[WHEELS] = 9
            robot[WHEELS] = value
            assert robot[WHEELS].tolist() == [0, 2, 4, 6], repr(value)


def test_a_simulation_is_not_copied(rover):
    # Two objects with one instance would call it after it is freed.
    with Simulation(rover) as robot:
        for how in (copy.copy, copy.deepcopy, pickle.dumps):
            with pytest.raises(TypeError, match=r"cannot be copied or pickled; what save\(\) gives can"):
                how(robot)


def test_names_are_texts_and_causalities_exist(rover):
    with Simulation(rover) as robot:
        for name in (3, None, ("base.position.x", "base.position.y")):
            with pytest.raises(Error, match="^a variable's name is a text, not "):
                robot[name]
        with pytest.raises(Error, match="there is no causality 'inputs'; there are input, output, parameter"):
            robot.names(causality="inputs")
        assert robot.names("nothing*") == []


def test_a_state_is_what_save_gave(rover):
    with Simulation(rover) as robot:
        state = robot.save()
        for wrong in (None, b"abc", state.data, (0.0, state.data), "state"):
            with pytest.raises(Error, match="^restore takes what save has given, not "):
                robot.restore(wrong)
        robot.step(0.1)
        robot.restore(state._replace(data=bytearray(state.data)))
        assert robot.time == 0.0


def test_a_restored_simulation_has_the_time_of_its_state(rover):
    with Simulation(rover) as robot:
        robot.step(0.1)
        state = robot.save()
        robot.step(0.1)
        robot.restore(state._replace(time=99.0))
        assert robot.time == state.time
        robot.step(0.1)
        for wrong in [{"time": None}, {"time": "0"}, {"data": "abc"}, {"data": None}]:
            before = robot.time
            with pytest.raises(Error, match="of a saved state"):
                robot.restore(state._replace(**wrong))
            assert robot.time == before
            robot.step(0.01)


def test_an_error_of_a_table_names_the_table_and_its_row(rover):
    wheel = "cmd.left_front_wheel_joint.velocity"
    for table, said in [({"time": [0, 1, 0.5], wheel: [0, 1, 2]}, "the table of inputs: row 2: time 0.5 s"),
                        ({"time": [0, np.nan], wheel: [0, 1]}, "the table of inputs: row 1, column 1"),
                        ({"time": [0, 1], "nothing": [0, 1]}, "the table of inputs, names, column 2: there is no")]:
        with pytest.raises(Error) as error:
            urdf2fmu.simulate(rover, stop_time=0.1, input=table)
        assert said in str(error.value) and ".csv" not in str(error.value), error.value


def test_outputs_have_stems_and_globs(rover):
    found = urdf2fmu.simulate(rover, stop_time=0.1, output=["base.position", "joint.*_wheel_joint.velocity"])
    assert found.dtype.names[:4] == ("time", "base.position.x", "base.position.y", "base.position.z")
    assert len(found.dtype.names) == 8
    with pytest.raises(Error, match="no output or input 'base.positoin'"):
        urdf2fmu.simulate(rover, stop_time=0.1, output="base.positoin")


def test_a_reset_that_is_refused_is_one_to_the_start_values_of_before(rover):
    with Simulation(rover, start_values={"initial.base.position.z": 1.0}) as robot:
        for wrong in ({"foo": 1}, {"initial.base.position.z": "x"}, {"initial.base.position": [0, 0]}):
            robot.step(0.1)
            with pytest.raises(Error):
                robot.reset(wrong)
            assert robot["base.position.z"] == 1.0 and robot.time == 0.0
            robot.step(0.1)
        for wrong in (5, [1]):
            with pytest.raises(Error, match="^start values are values by name, as a dict, not "):
                robot.reset(wrong)
        robot.reset()
        assert robot["base.position.z"] == 1.0


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_the_end_of_a_forked_process_leaves_the_parent_its_files(rover):
    done = run_alone("""
        import os, sys, urdf2fmu

        robot = urdf2fmu.Simulation(sys.argv[1])
        child = os.fork()
        robot.step(0.1)
        if child:
            os.waitpid(child, 0)
            # Reads the FMU's resources again.
            print(urdf2fmu.Simulation(sys.argv[1])["base.position"].shape)
    """, rover)
    assert (done.returncode, done.stdout) == (0, "(3,)\n"), done.stderr


@pytest.mark.parametrize("duration", [0.001, 1000.0])
def test_python_ends_while_a_thread_still_steps(rover, duration):
    done = run_alone("""
        import sys, threading, time, urdf2fmu

        robot = urdf2fmu.Simulation(sys.argv[1])

        def run():
            try:
                while True:
                    robot.step(float(sys.argv[2]))
            except urdf2fmu.Error as error:
                assert str(error) == "the simulation is closed", error

        threading.Thread(target=run, daemon=True).start()
        time.sleep(0.1)
    """, rover, duration)
    assert (done.returncode, done.stderr) == (0, "")


def test_rays_in_rows_have_a_stem_and_columns(examples, tmp_path):
    for fmi in (2, 3):
        fmu = urdf2fmu.export(examples / "rover.urdf", tmp_path / "rays.fmu", config=ROWS, fmi=fmi,
                              no_documentation=True)
        names = [f"sensor.lidar.ray[{row},{column}]" for row in (1, 2) for column in (1, 2, 3)]
        with Simulation(fmu) as robot:
            assert robot["sensor.lidar.ray"].tolist() == [robot[name] for name in names]
            assert robot["sensor.lidar.hit"].shape == (6,)
        table = urdf2fmu.simulate(fmu, stop_time=0.1, output=["sensor.lidar.ray*"])
        assert table.dtype.names == ("time", *names)
        if fmi == 2:
            other = fmpy.simulate_fmu(str(fmu), stop_time=0.1, output_interval=1 / 240, output=names)
            assert all(np.array_equal(table[name], other[name]) for name in names)


def test_numbers_and_arrays_of_numpy_are_settings_and_options(examples):
    robot = examples / "rover.urdf"
    config = {"robot": {"scale": np.float64(2.0), "self_collision": np.True_}, "initial": {"xyz": np.array([0, 0, 1.0])},
              "sensor": [{"type": "ray", "link": "base_link", "rays": np.int64(3), "fov": np.float32(1.0)}]}
    plain = {"robot": {"scale": 2.0, "self_collision": True}, "initial": {"xyz": [0, 0, 1.0]},
             "sensor": [{"type": "ray", "link": "base_link", "rays": 3, "fov": 1.0}]}
    assert urdf2fmu.info(robot, config=config) == urdf2fmu.info(robot, config=plain)
    crates = [f"{examples}/worlds/crate.urdf@{x},0" for x in (1, 2)]
    listed = urdf2fmu.info(robot, object=crates, fixed_base=True)
    assert urdf2fmu.info(robot, object=np.array(crates), fixed_base=np.True_) == listed
    assert urdf2fmu.info(robot, object=(crate for crate in crates), fixed_base=True, floating_base=np.False_) == listed


def test_one_output_may_be_a_text_and_the_table_may_be_kept(rover, tmp_path):
    kept = tmp_path / "kept.csv"
    table = urdf2fmu.simulate(rover, stop_time=0.1, output="base.position.x", output_file=kept, quiet=True)
    assert table.dtype.names == ("time", "base.position.x")
    assert len(kept.read_text().splitlines()) == len(table) + 1


def test_files_whose_names_look_like_options_or_are_empty(examples, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("-o.urdf").write_text((examples / "rover.urdf").read_text())
    assert urdf2fmu.info("-o.urdf")["robot"] == urdf2fmu.info(examples / "rover.urdf")["robot"]
    assert all(finding["severity"] != "error" for finding in urdf2fmu.check("-o.urdf"))
    assert len(urdf2fmu.simulate("-o.urdf", stop_time=0.01)) > 1
    for call in (urdf2fmu.check, urdf2fmu.info, urdf2fmu.simulate, urdf2fmu.Simulation, urdf2fmu.show):
        with pytest.raises(Error, match="the name of the robot's file is empty"):
            call("")


def test_what_the_fmu_warns_of_is_a_python_warning(rover):
    """Its functions return OK with it, and nothing was heard of it."""
    with pytest.warns(RuntimeWarning, match="is taken as 1e-6|inside the ground") as said:
        robot = Simulation(rover, tolerance=1e-9, start_values={"initial.base.position.z": 0.1})
    assert len(said) == 2, [str(one.message) for one in said]
    with robot:
        with pytest.warns(RuntimeWarning, match="outside its range"):
            robot["cmd.head_joint.velocity"] = 1e4
        with warnings.catch_warnings():
            # Once is enough.
            warnings.simplefilter("error")
            robot["cmd.head_joint.velocity"] = 2e4
            robot.step(0.01)


def test_a_joint_that_starts_beyond_its_limit_comes_back_slowly(tmp_path):
    """The FMU's warning says so: the spring of a limit is damped by 51 s a unit, 1/51 = 0.0196."""
    inertia = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    (tmp_path / "r.urdf").write_text(
        f'<robot name="r"><link name="world"/><link name="a">{inertia}</link><joint name="j" type="prismatic">'
        '<parent link="world"/><child link="a"/><limit lower="0" upper="1" effort="10" velocity="1"/></joint></robot>')
    start = {"initial.joint.j.position": 1.5, "cmd.j.max_effort": 0}
    with pytest.warns(RuntimeWarning, match="outside its range"):
        table = urdf2fmu.simulate(tmp_path / "r.urdf", stop_time=1, start_values=start)
    assert 0.018 < 1.5 - table["joint.j.position"][-1] < 0.02


def test_globs_of_start_values_mean_what_can_be_set(rover):
    values = {"*head_joint.velocity": 0.25}
    with Simulation(rover, start_values=values) as robot:
        assert robot["cmd.head_joint.velocity"] == robot["initial.joint.head_joint.velocity"] == 0.25
    table = urdf2fmu.simulate(rover, stop_time=0.01, start_values=values)
    assert table["joint.head_joint.velocity"][0] == 0.25


@pytest.mark.parametrize("name", ["-", "-o.fmu"])
def test_a_file_may_be_called_like_an_option(name, examples, rover, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = urdf2fmu.export(examples / "rover.urdf", name, no_documentation=True)
    assert made == Path(name) and zipfile.is_zipfile(tmp_path / name)
    table = urdf2fmu.simulate(rover, stop_time=0.01, output_file=name.replace("fmu", "csv"))
    assert len(table) > 1 and (tmp_path / name.replace("fmu", "csv")).read_text().startswith('"time"')


@pytest.mark.parametrize(("options", "said"), [
    ({"help": True}, "--help is for the command line"),
    ({"mode": {"a": 1}}, "mode takes one value or a list of them, and no dict"),
    ({"fixed_base": 1}, "--fixed-base"),
    ({"config": {"robot": {"base": {1, 2}}}}, "cannot be written as TOML: settings hold numbers"),
    ({"config": {"robot": {"base": "\ud800"}}}, "cannot be written as TOML"),
    ({"mode": "a\0b"}, "cannot be run with what it is given"),
    ({"output": 3}, "the name of a file is a text or a path, not 3"),
])
def test_wrong_options_are_errors_of_the_package(options, said, examples, tmp_path):
    options = {"output": tmp_path / "a.fmu", **options}
    with pytest.raises(Error, match=said):
        urdf2fmu.export(examples / "rover.urdf", **options)
    for wrong in (3, b"rover.urdf", None):
        for function in (urdf2fmu.export, urdf2fmu.check, urdf2fmu.info, urdf2fmu.simulate, Simulation):
            with pytest.raises(Error, match="the name of a file is a text or a path"):
                function(wrong)
    with pytest.raises(Error, match="--help is for the command line"):
        urdf2fmu.check(examples / "rover.urdf", help=True)


def test_fractions_and_decimals_are_numbers_in_settings_and_options(examples, tmp_path):
    step = {"solver": {"step_size": fractions.Fraction(1, 256)}}
    fmu = urdf2fmu.export(examples / "rover.urdf", tmp_path / "a.fmu", config=step, scale=decimal.Decimal("0.5"),
                          no_documentation=True)
    with Simulation(fmu) as robot:
        assert robot["solver.step_size"] == 1 / 256


def test_variables_and_time_are_read_only(rover):
    """The dict of an FMU was that of all simulations of it; a time that was set ended the simulation."""
    with Simulation(rover) as robot:
        with pytest.raises(TypeError):
            robot.variables["x"] = 1
        with pytest.raises(AttributeError):
            robot.variables.clear()
        robot.step(0.1)
        with pytest.raises(AttributeError):
            robot.time = 3.0
        robot.step(0.1)
        assert robot.time == pytest.approx(0.2, abs=1e-12)
    with Simulation(rover) as other:
        assert list(other.variables) == other.names()


def test_wrong_options_are_told_without_advice_for_a_shell(examples):
    with pytest.raises(Error) as raised:
        urdf2fmu.check(examples / "rover.urdf", foo=True)
    assert str(raised.value) == "error: unexpected argument '--foo' found"
    assert raised.value.exit_code == 2
    with pytest.raises(Error) as raised:
        urdf2fmu.check(examples / "rover.urdf", fixed_bas=True)
    assert str(raised.value).endswith("tip: a similar argument exists: '--fixed-base'")


def test_an_empty_list_of_outputs_is_told(rover):
    """It gave all of them."""
    with pytest.raises(Error, match="output is an empty list"):
        urdf2fmu.simulate(rover, output=[])


def test_a_robot_as_text_and_an_object_as_a_tuple_are_told_how_they_are_given(examples):
    """They were names of files that cannot be read: a whole URDF, and '1'."""
    with pytest.raises(Error, match="by the name of its file, not by its text"):
        urdf2fmu.check((examples / "rover.urdf").read_text())
    crate = examples / "worlds" / "crate.urdf"
    with pytest.raises(Error, match="an object is a text such as 'crate.urdf@1,0'"):
        urdf2fmu.check(examples / "rover.urdf", object=(str(crate), 2, 0))
    found = urdf2fmu.check(examples / "rover.urdf", object=f"{crate}@2,0")
    assert not [finding for finding in found if finding["severity"] == "error"]
