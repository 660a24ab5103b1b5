"""The programs of examples/python, in an environment with what they need: Dask, pyarrow, Gymnasium.

The environment lies in that of the other tests (environment.py).
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import environment
import installed
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples/python"
ROVER = ROOT / "examples/rover.urdf"
RUNS = int(os.environ.get("SWEEP_RUNS", "40"))
"""Of the sweep that loses a worker. docs/python.md has what 1,000 take."""


@pytest.fixture(scope="module")
def python():
    """Runs Python with the examples' packages and the package under test."""
    interpreter = environment.examples(Path(sys.prefix))

    def run(*arguments, cwd=EXAMPLES):
        variables = {**os.environ, "PYTHONPATH": f"{ROOT / 'python'}{os.pathsep}{EXAMPLES}"}
        done = subprocess.run([interpreter, "-B", *arguments], cwd=cwd, env=variables, capture_output=True, text=True,
                              timeout=300, check=False)
        assert done.returncode == 0, done.stderr[-3000:]
        return done.stdout

    return run


@pytest.fixture(scope="module")
def fresh(shared, tmp_path_factory):
    """Runs Python with the wheel installed and the examples' packages, and nothing of the repository but the examples."""
    packages = installed.packages(environment.examples(Path(sys.prefix)))
    interpreter = installed.environment(installed.wheel(shared), tmp_path_factory.mktemp("fresh"), packages)

    def run(*arguments, cwd):
        done = subprocess.run([interpreter, "-B", *arguments], cwd=cwd, env=installed.variables(PYTHONPATH=str(EXAMPLES)),
                              capture_output=True, text=True, timeout=600, check=False)
        assert done.returncode == 0, done.stderr[-3000:]
        return done.stdout

    return run


LOSS = """
import json, os, signal, sys, tempfile, time
from pathlib import Path
from concurrent.futures import ThreadPoolExecutor
from distributed import Client, LocalCluster
import sweep, urdf2fmu

def failing(number):
    if number == 3:
        raise ValueError("run 3 always fails")
    return {"run": number}

if __name__ == "__main__":
    runs = int(sys.argv[2])
    with tempfile.TemporaryDirectory() as folder:
        fmu = urdf2fmu.export(sys.argv[1], Path(folder, "rover.fmu"))
        job = sweep.Job(fmu=fmu, varied={"link.*.friction": (0.3, 1.2), "link.base_link.mass": (6.0, 14.0)},
                        fixed={"cmd.*_wheel_joint.velocity": 5.0}, outputs=["base.position.*"], stop_time=1.0, seed=7)
        threads = sweep.sweep(ThreadPoolExecutor(2), runs, job)
        kept = sweep.sweep(ThreadPoolExecutor(2), 6, failing, retries=1)
        cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
        executor, count = sweep.executor_for(cluster.scheduler_address, None, fmu)
        killed, told = [], []
        def progress(done, failed):
            told.append(done)
            if done == runs // 4 and not killed:
                nanny = next(iter(cluster.workers.values()))
                killed.append(nanny.pid)
                os.kill(nanny.pid, signal.SIGKILL)
        begun = time.monotonic()
        dask = sweep.sweep(executor, runs, job, progress=progress, ahead=10)
        took = time.monotonic() - begun
        sweep.write(dask, Path(folder, "runs.parquet"))
        import pyarrow.parquet
        back = pyarrow.parquet.read_table(Path(folder, "runs.parquet")).to_pylist()
        cluster.close()
    print(json.dumps({"threads": threads, "dask": dask, "back": back, "killed": killed, "told": told, "kept": kept,
                      "where": urdf2fmu.__file__, "took": took}))
"""


def test_a_sweep_loses_no_run_and_does_none_twice_when_a_worker_dies(fresh, tmp_path):
    """With the package that the wheel has installed."""
    script = tmp_path / "loss.py"
    script.write_text(LOSS)
    found = json.loads(fresh(script, ROVER, str(RUNS), cwd=tmp_path).splitlines()[-1])
    print(f"{RUNS} runs of 1 s on the cluster took {found['took']:.1f} s")
    assert not Path(found["where"]).is_relative_to(ROOT / "python")
    assert len(found["killed"]) == 1
    for rows in found["threads"], found["dask"], found["back"]:
        assert [row["run"] for row in rows] == list(range(RUNS))
        assert all(row["error"] is None for row in rows)
    assert found["told"] == list(range(1, RUNS + 1)), "each run is counted once"
    results = [[{k: v for k, v in row.items() if k != "tries"} for row in rows]
               for rows in (found["threads"], found["dask"])]
    assert results[0] == results[1], "a run has the same bits wherever it is done"
    assert len({row["base.position.x"] for row in found["dask"]}) == RUNS
    errors = {row["run"]: row["error"] for row in found["kept"]}
    assert errors.pop(3) == "ValueError: run 3 always fails" and set(errors.values()) == {None}
    assert [row["tries"] for row in found["kept"]] == [1, 1, 1, 2, 1, 1]


def test_the_sweep_runs_from_the_command_line(python, tmp_path):
    said = python("sweep.py", ROVER, "--runs", "4", "--stop-time", "0.1", "--vary", "link.*.friction=0.3:1.2", "--result",
                  tmp_path / "runs.parquet", "--threads", "2")
    assert said.endswith("runs.parquet: 4 runs, 0 failed\n")


def test_a_result_that_cannot_be_written_is_told_before_the_first_run(python, tmp_path):
    with pytest.raises(AssertionError, match="there is no folder .*nowhere") as told:
        python("sweep.py", ROVER, "--runs", "4", "--result", tmp_path / "nowhere/runs.parquet")
    assert "runs, " not in str(told.value)


def test_an_output_that_is_none_fails_its_run(python, tmp_path):
    with pytest.raises(AssertionError, match="run 0: ValueError: there is no variable 'base.positoin'"):
        python("sweep.py", ROVER, "--runs", "1", "--stop-time", "0.01", "--output", "base.positoin",
               "--result", tmp_path / "runs.parquet")


def test_the_environment_is_one_of_gymnasium_and_its_controller_arrives(python, tmp_path):
    check = ("import sys; from gymnasium.utils.env_checker import check_env; from environment import Drive; "
             "check_env(Drive(sys.argv[1]), skip_render_check=True)")
    python("-c", check, ROVER)
    assert python("environment.py", ROVER).count("reached") == 5


def test_the_controller_reaches_its_goal(python):
    said = python("controller.py", ROVER)
    seconds = float(said.split(" after ")[1].split(" s")[0])
    assert seconds < 10, said


def test_the_linear_model_predicts_a_step(python):
    """Positions, speeds and efforts all beside the state that the model is about: what A and B say, and what happens."""
    check = """
import json, sys
import numpy as np
import urdf2fmu
from linearise import H, SETTINGS, linearise, state
A, B, at, joints = linearise(sys.argv[1])
random = np.random.default_rng(1)
names = [f"initial.joint.{joint}.{what}" for what in ("position", "velocity") for joint in joints]
with urdf2fmu.Simulation(sys.argv[1], config=SETTINGS, mode="effort") as robot:
    def step(x, u):
        robot.reset(dict(zip(names, x)))
        for joint, effort in zip(joints, u):
            robot[f"cmd.{joint}.effort"] = effort
        robot.step(H)
        return state(robot, joints)
    x, u = 1e-3 * random.standard_normal(len(at)), 1e-2 * random.standard_normal(len(joints))
    happened = step(at + x, u) - step(at, np.zeros(len(joints)))
print(json.dumps([(A @ x + B @ u).tolist(), happened.tolist()]))
"""
    predicted, happened = map(np.array, json.loads(python("-c", check, ROOT / "examples/arm.urdf")))
    assert abs(happened).max() > 1e-3
    # What is left is of second order: a thousandth of the change.
    assert abs(predicted - happened).max() < 2e-3 * abs(happened).max()
