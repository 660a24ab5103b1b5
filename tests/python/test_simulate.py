"""`urdf2fmu simulate` is an importer like any other: FMPy gets the same bits from the same steps."""

import fmpy
import numpy as np
import pytest
from fmpy.util import read_csv, write_csv

QUADRUPED = "[[actuator]]\njoint = \"*\"\nmode = \"pd\"\nkp = 60\nkd = 2\n"


@pytest.fixture(params=["r2d2", "iiwa", "quadruped", "flat"])
def case(request, export, pybullet_data, examples):
    """An FMU, inputs over time by name (two jump at 0.5 s), and start values."""
    if request.param == "quadruped":
        fmu, base = export(examples / "quadruped.urdf", QUADRUPED), {"initial.base.position.z": 0.6}
    elif request.param == "iiwa":
        fmu, base = export(pybullet_data / "kuka_iiwa/model.urdf", "[outputs]\nlinks = [\"*_7\"]\n"), {}
    else:
        arguments = ["--naming", "flat"] if request.param == "flat" else []
        fmu, base = export(pybullet_data / "r2d2.urdf", "", *arguments), {}
    description = fmpy.read_model_description(str(fmu))
    inputs = [v for v in description.modelVariables if v.causality == "input"]
    speeds = [v.name for v in inputs if v.name.endswith(("velocity", "position"))]
    rng = np.random.default_rng(len(speeds))
    times = [0.0, 0.31, 0.5, 0.5, 1.0]
    signals = np.zeros(len(times), dtype=[("time", float)] + [(name, float) for name in speeds])
    signals["time"] = times
    for name in speeds:
        signals[name] = rng.uniform(-1, 1, len(times))
    return fmu, signals, base


@pytest.fixture
def run(command, tmp_path):
    """Runs `urdf2fmu simulate` and reads its results."""

    def go(fmu, signals, start, *arguments):
        write_csv(tmp_path / "in.csv", signals)
        values = [part for pair in start.items() for part in ("--start-value", *pair)]
        done = command("simulate", fmu, "--input-file", tmp_path / "in.csv", "--output-file", tmp_path / "out.csv",
                       *values, *arguments)
        assert done.returncode == 0, done.stderr
        return read_csv(tmp_path / "out.csv")

    return go


def test_simulate_gives_the_bits_of_fmpy(case, run):
    fmu, signals, start = case
    options = {"stop_time": 1.0, "output_interval": 1 / 64}
    expected = fmpy.simulate_fmu(str(fmu), input=signals, start_values=start, **options)
    results = run(fmu, signals, start, "--stop-time", "1.0", "--output-interval", str(1 / 64))
    assert results.dtype.names == expected.dtype.names
    assert len(results) == 65 and results["time"][-1] == 1.0
    for name in results.dtype.names:
        np.testing.assert_array_equal(results[name], expected[name].astype(float), err_msg=name)
    # It moved, and the same again is the same: none of it stands still or left over.
    moving = [name for name in results.dtype.names if np.ptp(results[name]) > 1e-3]
    assert len(moving) > 5, moving
    again = run(fmu, signals, start, "--stop-time", "1.0", "--output-interval", str(1 / 64))
    assert again.tobytes() == results.tobytes()


def test_slopes_of_inputs_take_effect_within_long_steps(command, examples, tmp_path):
    """Straight ramps of all wheels, told with their slopes: four steps of 0.5 s give the drive of 400 without."""
    wheels = [f"cmd.{side}_{end}_wheel_joint.velocity" for side in ("left", "right") for end in ("front", "rear")]
    lines = ["time," + ",".join(wheels), "0,0,0,0,0", "1,6,6,6,6", "2,2,2,2,2"]
    (tmp_path / "in.csv").write_text("\n".join(lines))

    def x(interval, *arguments):
        done = command("simulate", examples / "rover.urdf", "--input-file", tmp_path / "in.csv", "--stop-time", "2",
                       "--output-interval", interval, "--output-file", tmp_path / "out.csv", *arguments)
        assert done.returncode == 0, done.stderr
        return read_csv(tmp_path / "out.csv")["base.position.x"][-1]

    # The wheels of 0.1 m turn by 3 + 4 rad.
    assert x("0.5", "--set-input-derivatives") == pytest.approx(0.7, abs=2e-3)
    assert x("0.005") == pytest.approx(0.7, abs=5e-3)
    assert abs(x("0.5") - 0.7) > 0.05


def test_a_urdf_is_simulated_by_way_of_its_fmu(command, examples, tmp_path):
    done = command("simulate", examples / "rover.urdf", "--stop-time", "0.1")
    assert done.returncode == 0, done.stderr
    header, *rows = done.stdout.splitlines()
    assert header.startswith('"time","base.position.x"') and rows[0].startswith("0.0,")
    assert rows[-1].startswith("0.1,") and len(rows) == 25


def test_start_values_are_given_by_name_or_glob(command, export, examples, tmp_path):
    """A glob gives its value to all parameters and inputs that match; of two values of one variable the later counts."""
    fmu = export(examples / "rover.urdf")

    def table(*pairs):
        values = [part for pair in pairs for part in ("--start-value", *pair)]
        done = command("simulate", fmu, "--stop-time", "0.2", "--output-file", tmp_path / "out.csv", *values)
        assert done.returncode == 0, done.stderr
        return read_csv(tmp_path / "out.csv")

    wheels = [f"cmd.{side}_{end}_wheel_joint.velocity" for side in ("left", "right") for end in ("front", "rear")]
    all_ahead = table(*[(name, "5") for name in wheels])
    assert all_ahead["base.position.x"][-1] > 0.05
    assert table(("cmd.*_wheel_joint.velocity", "5")).tobytes() == all_ahead.tobytes()
    left_back = table(("cmd.*_wheel_joint.velocity", "5"), ("cmd.left_*_wheel_joint.velocity", "-5"))
    assert abs(left_back["base.rpy.yaw"][-1]) > 0.05


@pytest.mark.parametrize("text, words", [
    ("", "empty"),
    ("t,x\n0,1\n", "first column must be 'time'"),
    ("time,cmd.head_jont.velocity\n0,1\n", "did you mean 'cmd.head_joint.velocity'?"),
    ("time,head_joint\n0,1\n", "did you mean 'cmd.head_joint.velocity'?"),
    ("time,joint.head_joint.velocity\n0,1\n", "not an input or a tunable parameter, but an output"),
    ("time,cmd.head_joint.velocity\n0,1\n1,fast\n", "line 3, column 2 ('cmd.head_joint.velocity'): 'fast'"),
    ("time,cmd.head_joint.velocity\n0,1\n1\n", "line 3: 1 values, but line 1 names 2 columns"),
    ("time,cmd.head_joint.velocity\n1,1\n0,1\n", "times must not go back"),
])
def test_faulty_inputs_are_told_with_their_place(command, export, examples, tmp_path, text, words):
    (tmp_path / "in.csv").write_text(text)
    done = command("simulate", export(examples / "rover.urdf"), "--input-file", tmp_path / "in.csv")
    assert done.returncode == 1 and "in.csv" in done.stderr and words in done.stderr, done.stderr


@pytest.mark.parametrize("arguments, code, words", [
    (["--start-value", "world.gravty.z", "1"], 2, "did you mean 'world.gravity.z'?"),
    (["--start-value", "world.gravity.z", "down"], 2, "no finite number"),
    (["--start-value", "base.position.z", "1"], 2, "an output"),
    (["--start-value", "cmd.*.speed", "1"], 2, "no parameter or input matches 'cmd.*.speed'"),
    (["--start-value", "cmd.*.max_effort", "strong"], 2, "--start-value cmd.left_front_wheel_joint.max_effort: 'strong'"),
    (["--stop-time", "-1"], 2, "after the start time"),
    (["--output-interval", "0"], 2, "output interval"),
    (["--start-value", "world.gravity.z"], 2, "2 values"),
    (["--start-value", "solver.step_size", "-1"], 3, "0 or a number from 1e-7 to 1.0"),
    (["--start-value", "world.gravity.z", "-1e308"], 3, "a number from -1e4 to 1e4"),
    # A robot that rests needs no step.
    (["--start-value", "solver.max_steps", "1", "--start-value", "cmd.head_joint.velocity", "1", "--output-interval", "1"],
     3, "stopped at 0 s"),
])
def test_exit_codes_tell_whose_fault_it_is(command, export, examples, tmp_path, arguments, code, words):
    output = ["--output-file", tmp_path / "out.csv"]
    done = command("simulate", export(examples / "rover.urdf"), *output, *arguments)
    assert done.returncode == code and words in done.stderr, done.stderr


def test_a_foreign_or_broken_file_is_told(command, tmp_path):
    (tmp_path / "x.fmu").write_bytes(b"no zip")
    done = command("simulate", tmp_path / "x.fmu")
    assert done.returncode == 1 and "x.fmu" in done.stderr, done.stderr
    done = command("simulate", tmp_path / "missing.fmu")
    assert done.returncode == 1 and "missing.fmu" in done.stderr, done.stderr
