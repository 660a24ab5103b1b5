"""What the tests share: the command under test, other people's robots, exports (made once), reports, and a driven robot."""

import csv
import hashlib
import json
import os
import subprocess
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

import robots
from robot import Robot


def pytest_configure(config):
    if "URDF2FMU" not in os.environ or "PYBULLET_DATA" not in os.environ:
        raise pytest.UsageError("run `cargo test`: it builds the command and names it in URDF2FMU, "
                                "and the folder of PyBullet's robots in PYBULLET_DATA")


def failed_under_ci(report):
    """Where the environment variable CI is "true" every test must run: a skipped one fails there."""
    if report.skipped and os.environ.get("CI") == "true":
        report.outcome, report.longrepr = "failed", f"with CI=true none may be skipped: {report.longrepr[-1]}"
    return report


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport():
    return failed_under_ci((yield))


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report():
    return failed_under_ci((yield))


@pytest.fixture(scope="session")
def pybullet_data() -> Path:
    """Folder of the robots that come with PyBullet."""
    return Path(os.environ["PYBULLET_DATA"])


@pytest.fixture(scope="session")
def example_robots() -> Path:
    """Folder of the robots of example-robot-data."""
    return robots.example_robots()


@pytest.fixture(scope="session")
def examples() -> Path:
    """Folder of our own example robots."""
    return Path(__file__).resolve().parents[2] / "examples"


@pytest.fixture(scope="session")
def command():
    """Runs the `urdf2fmu` command and returns the finished process, whatever its exit code."""

    def run(*arguments) -> subprocess.CompletedProcess:
        return subprocess.run([os.environ["URDF2FMU"], *map(str, arguments)], capture_output=True, text=True,
                              timeout=120, check=False)

    return run


@pytest.fixture(scope="session")
def shared(tmp_path_factory):
    """A folder for what is made once for all tests, also those in other processes of the same run."""
    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "shared"
    folder.mkdir(exist_ok=True)
    return folder


@pytest.fixture(scope="session")
def export(command, shared):
    """Exports a URDF with settings (TOML text) and further arguments; the same export is made once.

    Without pictures and pages for people, which take most of an export's time, unless a test looks at them.
    """

    def run(urdf: Path, settings: str = "", *arguments, documented=False) -> Path:
        arguments = arguments if documented else (*arguments, "--no-documentation")
        key = hashlib.sha256(repr((str(urdf), settings, arguments)).encode()).hexdigest()[:12]
        fmu = shared / f"{urdf.stem}_{key}.fmu"
        if not fmu.exists():
            # Another process may be at it: the file appears whole.
            own = fmu.with_suffix(f".{os.getpid()}.fmu")
            config = own.with_suffix(".toml")
            config.write_text(settings)
            done = command("export", urdf, "-o", own, "-c", config, *arguments)
            assert done.returncode == 0, done.stderr
            own.replace(fmu)
        return fmu

    return run


@pytest.fixture
def load():
    """Loads an FMU in FMPy and initialises it; frees it when the test ends."""
    made = []

    def run(fmu: Path, start=None, **options) -> Robot:
        robot = Robot(fmu, **options)
        made.append(robot)
        robot.initialize(start or {})
        return robot

    yield run
    for robot in made:
        robot.free()


@pytest.fixture(scope="session")
def made(command, export, pybullet_data, examples, shared, tmp_path_factory):
    """Simulates a robot that is commanded here and there; gives FMU, results and report. Each is made once."""

    def make(name, seconds=1.0):
        ready = shared / f"report_{name}_{seconds}"
        urdf = {"r2d2": pybullet_data / "r2d2.urdf", "iiwa": pybullet_data / "kuka_iiwa/model.urdf",
                "quadruped": examples / "quadruped.urdf", "humanoid": examples.parent / "tests/robots/humanoid.urdf",
                "joints": examples.parent / "tests/robots/every_joint.urdf"}[name]
        fmu = export(urdf, "[outputs]\nlinks = [\"*\"]\n")
        results = fmu, ready / "out.csv", ready / "r.html"
        if ready.exists():
            return results
        folder = tmp_path_factory.mktemp("report")
        listing = json.loads(command("info", fmu, "--json", "--variables").stdout)
        inputs = [v for v in listing["variables"] if v["causality"] == "input" and "max_effort" not in v["name"]]
        rng = np.random.default_rng(5)
        with open(folder / "in.csv", "w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(["time"] + [v["name"] for v in inputs])
            for time in 0, 0.3, 0.6, 1:
                writer.writerow([time] + list(rng.uniform(-0.5, 0.5, len(inputs)) * (time > 0)))
        run = command("simulate", fmu, "--input-file", folder / "in.csv", "--stop-time", seconds,
                      "--output-file", folder / "out.csv", "--report", folder / "r.html")
        assert run.returncode == 0, run.stderr
        with suppress(OSError):
            # Unless another process was faster, with the same files.
            folder.rename(ready)
        return results

    return make
