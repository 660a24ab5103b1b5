"""The Python package: a wheel with the command under test, its example, types, bits and errors."""

import os
import pickle
import re
import shutil
import subprocess
import sys
import threading
import zipfile
from pathlib import Path

import fmpy
import installed
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))
import urdf2fmu  # noqa: E402
from urdf2fmu import Error, Simulation, State  # noqa: E402

WHEELS = "cmd.*_wheel_joint.velocity"


@pytest.fixture(scope="module")
def rover(examples, tmp_path_factory):
    """The FMU of the example rover, exported through the package."""
    return urdf2fmu.export(examples / "rover.urdf", tmp_path_factory.mktemp("package") / "rover.fmu")


@pytest.fixture(scope="module")
def wheel(shared):
    return installed.wheel(shared)


@pytest.fixture(scope="module")
def fresh(wheel, tmp_path_factory):
    """The interpreter of an environment that has this wheel and numpy, and nothing of the repository."""
    return installed.environment(wheel, tmp_path_factory.mktemp("fresh"), Path(np.__file__).parents[1])


def run_fresh(python, *arguments, cwd):
    done = subprocess.run([python, *arguments], cwd=cwd, env=installed.variables(), capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_wheel_has_the_command_types_and_licences(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        assert "urdf2fmu/py.typed" in names
        assert any(re.search(r"\.data/scripts/urdf2fmu(\.exe)?$", name) for name in names), names
        assert sum("licenses/LICENSE" in name for name in names) == 2
        tags = next(archive.read(name).decode() for name in names if name.endswith("dist-info/WHEEL"))
    assert re.search(r"^Tag: py3-none-", tags, re.M) and "any" not in tags.split("Tag:")[1], tags


def test_the_example_of_the_documentation_runs_in_a_fresh_environment(fresh, examples, tmp_path):
    text = (ROOT / "docs/python.md").read_text()
    code, expected = re.search(r"```python\n(.*?)```\n\n```\n(.*?)```", text, re.S).groups()
    shutil.copy(examples / "rover.urdf", tmp_path)
    script = tmp_path / "example.py"
    script.write_text(code)
    said = run_fresh(fresh, "-W", "error", script, cwd=tmp_path)
    # How many platforms there are depends on how the command was built.
    assert said.splitlines()[1:] == expected.splitlines()[1:]


def test_the_example_of_the_readme_runs_in_a_fresh_environment(fresh, examples, rover, tmp_path):
    """And drives the rover to where FMPy drives it."""
    blocks = re.findall(r"^```\w*\n(.*?)^```$", (ROOT / "README.md").read_text(), re.M | re.S)
    [code] = [block for block in blocks if block.startswith("import urdf2fmu")]
    for file in "rover.urdf", "rover.toml":
        shutil.copy(examples / file, tmp_path)
    script = tmp_path / "example.py"
    script.write_text(code)
    printed = np.fromstring(run_fresh(fresh, "-W", "error", script, cwd=tmp_path).strip().strip("[]"), sep=" ")
    speeds = {v.name: 5.0 for v in fmpy.read_model_description(str(rover)).modelVariables
              if v.causality == "input" and v.name.endswith("_wheel_joint.velocity")}
    assert len(speeds) == 4
    names = [f"base.position.{axis}" for axis in "xyz"]
    there = fmpy.simulate_fmu(str(rover), stop_time=1.0, output_interval=1 / 240, start_values=speeds, output=names)[-1]
    assert list(printed) == [round(there[name], 3) for name in names] and printed[0] > 0.3


def test_the_environment_runs_its_own_command(fresh, tmp_path):
    place = run_fresh(fresh, "-c", "import urdf2fmu; print(urdf2fmu.command())", cwd=tmp_path).strip()
    assert Path(place).is_relative_to(Path(fresh).parent), place


def test_types_are_complete(fresh, tmp_path):
    """Of the package that the wheel has installed, and of a program that uses it there."""
    user = tmp_path / "user.py"
    user.write_text("""from fractions import Fraction
import numpy as np
import urdf2fmu
path = urdf2fmu.export("a.urdf", config={"robot": {"base": "fixed"}}, package_path=["a", "b"],
                       xacro_arguments={"a": "b"})
table = urdf2fmu.simulate(path, stop_time=1.0, input={"time": [0.0, 1.0], "x": np.zeros(2)})
with urdf2fmu.Simulation(path, start_values={"a": 1.0}) as robot:
    robot["b"] = [1.0, 2.0]
    robot.step(1 / 240)
    robot.step(1)
    robot.step(np.float64(0.1))
    robot.step(np.float32(0.1))
    robot.step(np.int64(1))
    robot.step(Fraction(1, 240))
    state: urdf2fmu.State = robot.save()
    names: list[str] = robot.names("c.*", causality="output")
""")
    for checked in (["-p", "urdf2fmu"], [user]):
        done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", tmp_path / "cache",
                               "--python-executable", fresh, *checked], cwd=tmp_path, capture_output=True, text=True,
                              env=installed.variables(), check=False)
        assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("name", ["rover.urdf", "arm.urdf"])
def test_simulate_gives_the_table_of_fmpy_to_the_bit(name, examples, tmp_path):
    fmu = urdf2fmu.export(examples / name, tmp_path / "robot.fmu")
    inputs = [v.name for v in fmpy.read_model_description(str(fmu)).modelVariables
              if v.causality == "input" and v.type == "Real" and "max_effort" not in v.name]
    times = np.linspace(0, 1, 21)
    signals = np.array([(t, *(0.3 * np.sin((1 + 0.1 * i) * t) for i in range(len(inputs)))) for t in times],
                       dtype=[("time", float), *((n, float) for n in inputs)])
    ours = urdf2fmu.simulate(fmu, stop_time=1.0, output_interval=0.01, input=signals)
    theirs = fmpy.simulate_fmu(str(fmu), stop_time=1.0, output_interval=0.01, step_size=0.01, input=signals,
                               output=[n for n in ours.dtype.names if n != "time"])
    assert ours.dtype == theirs.dtype
    assert len(ours) == len(theirs) == 101
    for column in ours.dtype.names:
        assert ours[column].tobytes() == theirs[column].tobytes(), column


def test_start_values_of_a_run_are_those_of_a_simulation(rover):
    """By name, stem and glob, one for all or one each."""
    start = {"initial.base.position": [1.0, 2.0, 0.5], "cmd.*_wheel_joint.velocity": 5, "world.ground.friction": 0.4}
    table = urdf2fmu.simulate(rover, stop_time=0.5, output_interval=0.1, start_values=start)
    assert [table[f"base.position.{axis}"][0] for axis in "xyz"] == [1.0, 2.0, 0.5]
    with Simulation(rover, start_values=start) as robot:
        for row in table[1:]:
            robot.step(row["time"] - robot.time)
        assert robot["base.position.x"] == pytest.approx(table["base.position.x"][-1], abs=1e-9) and robot[WHEELS].all()


def test_steps_give_the_bits_of_fmpy(rover):
    folder = fmpy.extract(str(rover))
    model = fmpy.read_model_description(folder)
    reals = [v for v in model.modelVariables if v.type == "Real" and v.causality == "output"]
    slave = FMU2Slave(guid=model.guid, unzipDirectory=folder,
                      modelIdentifier=model.coSimulation.modelIdentifier)
    slave.instantiate()
    slave.setupExperiment()
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    wheels = [v.valueReference for v in model.modelVariables if re.fullmatch(r"cmd\..*_wheel_joint\.velocity", v.name)]
    time = 0.0
    with Simulation(rover) as robot:
        for step in range(200):
            speed, h = 5.0 * np.sin(step / 20), (1 / 240, 0.01, 1e-3)[step % 3]
            robot[WHEELS] = speed
            slave.setReal(wheels, [speed] * len(wheels))
            robot.step(h)
            slave.doStep(time, h)
            time += h
            theirs = slave.getReal([v.valueReference for v in reals])
            assert [robot[v.name] for v in reals] == list(theirs), step
    slave.terminate()
    slave.freeInstance()
    shutil.rmtree(folder, ignore_errors=True)


def test_names_stems_and_globs(rover):
    with Simulation(rover) as robot:
        assert robot["base.position"].shape == (3,) and robot["base.orientation"].shape == (4,)
        assert robot["base.position"][2] == robot["base.position.z"] == robot["base.posit*.z"][0]
        assert robot["base.rpy"].tolist() == [robot[f"base.rpy.{a}"] for a in ("roll", "pitch", "yaw")]
        assert isinstance(robot["base.position.z"], float)
        assert robot["contact.left_front_wheel.active"] is True
        assert robot["contact.*.active"].dtype == bool
        assert len(robot["contact.*"]) == len(robot.names("contact.*"))
        assert len(robot.names(WHEELS, causality="input")) == 4
        assert robot.names(WHEELS, causality="output") == []
        assert WHEELS in robot and "base.position" in robot and "nothing" not in robot and 3 not in robot
        robot[WHEELS] = [1, 2, 3, 4]
        assert robot[WHEELS].tolist() == [1, 2, 3, 4]
        assert robot.variables["base.position.x"].unit == "m"


def test_saved_states_continue_with_the_same_bits_here_and_elsewhere(rover):
    def go(robot):
        robot[WHEELS] = 3.0
        for _ in range(50):
            robot.step(0.01)
        return robot["*"].tobytes(), robot.time

    with Simulation(rover) as one, Simulation(rover) as other:
        one.step(0.2)
        state = one.save()
        expected = go(one)
        one.restore(state)
        assert one.time == 0.2 and go(one) == expected
        other.restore(pickle.loads(pickle.dumps(state)))
        assert go(other) == expected
        one.reset()
        assert one.time == 0.0 and one["base.position.x"] == 0.0
        one.reset({"initial.base.position": [1.0, 2.0, 0.5]})
        assert one["base.position"].tolist() == [1.0, 2.0, 0.5]


def test_threads_simulate_at_once_and_agree(rover):
    found = [b""] * 4

    def work(i):
        with Simulation(rover) as robot:
            robot[WHEELS] = 4.0
            for _ in range(100):
                robot.step(0.01)
            found[i] = robot["*"].tobytes()

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found[0] and len(set(found)) == 1


def test_a_page_shows_a_run(rover, command, tmp_path):
    page = urdf2fmu.show(rover, urdf2fmu.simulate(rover, stop_time=0.1))
    done = command("simulate", rover, "--stop-time", "0.1", "--output-file", tmp_path / "run.csv")
    assert done.returncode == 0, done.stderr
    done = command("report", tmp_path / "run.csv", "--model", rover, "-o", tmp_path / "run.html")
    assert done.returncode == 0, done.stderr
    assert page.html == (tmp_path / "run.html").read_text(), "the page of the command"
    frame = page._repr_html_()
    # The page stands in an attribute: no quote of its own may end it.
    assert re.fullmatch(r'<iframe srcdoc="[^"]*" width="100%" height="640" style="[^"]*" allow="fullscreen"></iframe>',
                        frame)
    assert page.save(tmp_path / "page.html").read_text() == page.html
    assert urdf2fmu.show(rover, stop_time=0.05).html.startswith("<!doctype html>")


def test_settings_are_files_or_dicts(examples, tmp_path):
    config = {"robot": {"base": "fixed"}, "fmu": {"author": 'A "quoted" name\n\x7f'}, "outputs": {"links": ["*"]},
              "actuator": [{"joint": "*_wheel_joint", "mode": "effort"}]}
    fmu = urdf2fmu.export(examples / "rover.urdf", tmp_path / "a.fmu", config=config)
    with Simulation(fmu) as robot:
        assert "cmd.left_front_wheel_joint.effort" in robot and "link.base_link.position" in robot
        assert "base.position" not in robot or robot["base.linear_velocity"].tolist() == [0, 0, 0]
    xml = zipfile.ZipFile(fmu).read("modelDescription.xml").decode()
    assert "A &quot;quoted&quot; name" in xml
    file = tmp_path / "settings.toml"
    file.write_text('[robot]\nbase = "fixed"\n')
    with Simulation(examples / "arm.urdf", config=file, mode="effort") as arm:
        assert arm.names("cmd.*.effort")


@pytest.mark.parametrize("call, said", [
    (lambda r: r["base.positoin"], "did you mean 'base.position"),
    (lambda r: r["nothing.*"], "no variable 'nothing"),
    (lambda r: r.__setitem__("nothing", 1), "no variable 'nothing'"),
    (lambda r: r.__setitem__(WHEELS, [1, 2, 3]), "one number or 4"),
    (lambda r: r.__setitem__(WHEELS, [[1, 2, 3, 4]]), "(1, 4)"),
    (lambda r: r.__setitem__("cmd.head_joint.velocity", []), "one number"),
    (lambda r: r.__setitem__(WHEELS, "fast"), "takes numbers"),
    (lambda r: r.__setitem__(WHEELS, None), "NaN|numbers"),
    (lambda r: r.__setitem__(WHEELS, float("nan")), "finite"),
    (lambda r: r.__setitem__("base.position", [0, 0, 1]), "cannot be set"),
    (lambda r: r.step(0), "positive"),
    (lambda r: r.step(float("nan")), "positive"),
    (lambda r: r.step(float("inf")), "positive"),
    (lambda r: r.restore(State(0.0, b"nonsense")), "saved state refused"),
    (lambda r: r.restore(State(0.0, r.save().data[:-1])), "saved state refused"),
])
def test_what_a_simulation_refuses_is_an_error_and_changes_nothing(rover, call, said):
    with Simulation(rover) as robot:
        robot.step(0.01)
        before = robot["*"].tobytes()
        with pytest.raises(Error, match=said):
            call(robot)
        assert robot["*"].tobytes() == before
        robot.step(0.01)


@pytest.mark.parametrize("value", [0.5, 2**31, -(2**40), float("inf"), float("nan")])
def test_whole_numbers_are_whole_and_fit(rover, value):
    with Simulation(rover) as robot:
        assert isinstance(robot["solver.steps"], int)
        with pytest.raises(Error, match="whole numbers"):
            robot["solver.steps"] = value


def test_a_closed_simulation_says_so(rover):
    robot = Simulation(rover)
    robot.close()
    robot.close()
    for call in (lambda: robot.step(0.1), lambda: robot["base.position"], robot.save, robot.reset,
                 lambda: robot.__setitem__(WHEELS, 1)):
        with pytest.raises(Error, match="closed"):
            call()


def test_a_simulation_that_nobody_closed_does_no_harm_at_the_end(rover, tmp_path):
    script = tmp_path / "left.py"
    script.write_text("import sys, urdf2fmu\nclass Circle: pass\nc = Circle(); c.me = c\n"
                      "c.robot = urdf2fmu.Simulation(sys.argv[1]); c.robot.circle = c; c.robot.step(0.1)\n")
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "python"), "TMPDIR": str(tmp_path)}
    done = subprocess.run([sys.executable, script, rover], env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert not list(tmp_path.glob("urdf2fmu-*")), "temporary folders are removed"


def test_bad_files_are_errors(rover, examples, tmp_path):
    text, broken = tmp_path / "text.fmu", tmp_path / "broken.urdf"
    text.write_text("no archive")
    broken.write_text('<robot name="r"><link name="a"/><link name="a"/></robot>')
    for call in (lambda: Simulation(tmp_path / "none.fmu"), lambda: urdf2fmu.simulate(tmp_path / "none.fmu"),
                 lambda: Simulation(text), lambda: urdf2fmu.info(text), lambda: urdf2fmu.show(text),
                 lambda: urdf2fmu.check(text), lambda: urdf2fmu.export(tmp_path / "none.urdf")):
        with pytest.raises(Error, match=r"none|text"):
            call()
    assert [f["code"] for f in urdf2fmu.check(tmp_path / "none.fmu")] == ["U001"]
    with pytest.raises(Error) as caught:
        urdf2fmu.export(broken)
    assert caught.value.exit_code == 1 and not broken.with_suffix(".fmu").exists()
    finding = caught.value.findings[0]
    assert finding["severity"] == "error" and finding["line"] == 1 and finding["message"] in str(caught.value)
    assert finding in urdf2fmu.check(broken)
    with pytest.raises(Error, match="--stop-time"):
        urdf2fmu.simulate(rover, stop_tim=1)
    with pytest.raises(Error, match="no variable 'x'"):
        urdf2fmu.simulate(rover, start_values={"x": 1.0})
    with pytest.raises(Error, match="one length"):
        urdf2fmu.simulate(rover, input={"time": [0, 1], "cmd.head_joint.velocity": [1]})
    with pytest.raises(Error, match="takes one number"):
        urdf2fmu.simulate(rover, start_values={"initial.base.position.x": [1, 2]})
    with pytest.raises(Error, match="takes numbers"):
        urdf2fmu.simulate(rover, input={"time": ["now"]})
    with pytest.raises(Error, match="needs the column 'time'"):
        urdf2fmu.simulate(rover, input={})
    with pytest.raises(Error, match="columns with names"):
        urdf2fmu.simulate(rover, input=[[0, 1]])
    with pytest.raises(Error, match="settings inside"):
        Simulation(rover, mode="effort")
    with pytest.raises(Error, match="did you mean 'fixed'"):
        Simulation(examples / "rover.urdf", config={"robot": {"base": "fxed"}})
    with pytest.raises(Error, match="settings hold"):
        urdf2fmu.check(examples / "rover.urdf", config={"robot": {"base": object()}})


def test_an_fmu_without_a_library_for_this_system_says_which_it_has(rover, tmp_path):
    other = tmp_path / "other.fmu"
    with zipfile.ZipFile(rover) as old, zipfile.ZipFile(other, "w") as new:
        for name in old.namelist():
            place = re.sub("^binaries/[^/]*/", "binaries/amiga/", name)
            if place not in new.namelist():
                new.writestr(place, old.read(name))
    with pytest.raises(Error, match="it has: amiga"):
        Simulation(other)


def driven(fmu):
    """Values on the way of a simulation that sets, reads, saves, restores and resets by all kinds of names."""
    seen = []
    with Simulation(fmu, start_values={"initial.base.position.z": 0.2, "cmd.head_joint.velocity": 0.3},
                    tolerance=1e-4) as robot:
        for k in range(30):
            robot[WHEELS] = [0.1 * k, 2.0, -1.0, 0.5]
            robot.step(0.01)
            seen.append(np.concatenate([np.ravel(robot[name]).astype(float) for name in (
                "base.position", "base.orientation", "base.rpy.yaw", "joint.*.velocity", "contact.*.active",
                "solver.steps", "contact.left_front_wheel.force")]))
        # One element of what is an array in FMI 3; the others keep their values.
        robot["world.gravity.z"] = -3.7
        seen.append(robot["world.gravity"])
        state = robot.save()
        robot.step(0.1)
        seen.append(robot["base.position"])
        robot.restore(pickle.loads(pickle.dumps(state)))
        robot.step(0.1)
        seen.append(robot["base.position"])
        robot.reset({})
        seen.append(robot["base.position"])
    return seen, robot.names(), [(v.kind, v.causality, v.variability, v.unit) for v in robot.variables.values()]


@pytest.mark.parametrize("arrays", ["none", "vectors", "all"])
def test_fmi_3_has_the_names_and_the_bits_of_fmi_2(arrays, rover, examples, tmp_path):
    expected, names, kinds = driven(rover)
    fmu = urdf2fmu.export(examples / "rover.urdf", tmp_path / "three.fmu", fmi=3, arrays=arrays)
    found, own, own_kinds = driven(fmu)
    assert set(own) == set(names)
    if arrays != "all":  # it gathers scalars in other places
        assert own == names and own_kinds == kinds
    for number, (one, other) in enumerate(zip(expected, found, strict=True)):
        assert np.array_equal(one, other), number
    with Simulation(fmu) as robot, pytest.raises(Error, match="fixed parameter .link.base_link.mass"):
        robot["link.base_link.mass"] = -1.0
    tables = [urdf2fmu.simulate(file, stop_time=0.1) for file in (rover, fmu)]
    assert tables[0].dtype == tables[1].dtype or arrays == "all"
    assert all(np.array_equal(tables[0][name], tables[1][name]) for name in tables[0].dtype.names)


def test_a_model_exchange_fmu_is_integrated_by_simulate_and_refused_by_simulation(examples, tmp_path):
    for fmi in 2, 3:
        fmu = urdf2fmu.export(examples / "rover.urdf", tmp_path / f"me{fmi}.fmu", interface="me", fmi=fmi)
        with pytest.raises(Error, match="Model Exchange alone: simulate.*interface=\"both\""):
            Simulation(fmu)
        table = urdf2fmu.simulate(fmu, stop_time=0.05)
        assert len(table) == 13 and abs(table["base.position.z"][-1] - 0.15) < 1e-3

