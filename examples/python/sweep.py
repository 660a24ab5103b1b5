"""A parameter sweep or Monte Carlo of one robot, on threads of this process or on a Dask cluster.

    python sweep.py ../rover.urdf --runs 1000 --stop-time 2 \\
        --vary "link.*.friction=0.3:1.2" --vary "link.base_link.mass=6:14" --set "cmd.*_wheel_joint.velocity=5" \\
        --output "base.position.*" --result sweep.parquet
    python sweep.py … --scheduler tcp://10.0.0.5:8786      # workers that have the packages urdf2fmu and numpy
    python sweep.py … --scheduler local                    # a cluster of processes on this machine

A run is a number from 0 on: its parameters follow from that number and the seed alone, so a run gives the same bits
on whichever machine and however often it is done. A run that fails is tried again, then its row tells the error.
Every run has exactly one row in the result, however many workers are lost on the way.

Needs urdf2fmu; for Dask `pip install distributed`, for the result `pip install pyarrow`.
"""

import argparse
import os
import shutil
import sys
import tempfile
import threading
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from pathlib import Path

import numpy as np

import urdf2fmu

STEP = 1 / 100
"""s, a communication step"""
_of_thread = threading.local()


def parameters(number, varied, seed):
    """Those of a run: uniform within their ranges, one draw for each name or glob."""
    random = np.random.default_rng([seed, number])
    return {name: float(random.uniform(low, high)) for name, (low, high) in varied.items()}


def simulation(fmu):
    """A simulation of the FMU that this thread keeps for all of its runs."""
    if getattr(_of_thread, "fmu", None) != fmu:
        _of_thread.robot = urdf2fmu.Simulation(here(fmu))
        _of_thread.fmu = fmu
    return _of_thread.robot


def here(fmu):
    """Where the FMU lies: on a worker of Dask it has been uploaded to the worker's folder."""
    try:
        from distributed import get_worker
        return Path(get_worker().local_directory, fmu.name)
    except (ImportError, ValueError):
        return fmu


def one_run(number, fmu, varied, fixed, outputs, stop_time, seed):
    """One run: its row of the result."""
    robot = simulation(fmu)
    names = {glob: robot.names(glob) for glob in outputs}
    for glob in names:
        if not names[glob]:
            raise ValueError(f"there is no variable '{glob}'; 'base.position.*' are three")
    drawn = parameters(number, varied, seed)
    robot.reset(drawn)
    for name, value in fixed.items():
        robot[name] = value
    for _ in range(round(stop_time / STEP)):
        robot.step(STEP)
    found = {name: float(robot[name]) for of_glob in names.values() for name in of_glob}
    return {"run": number, **drawn, **found}


def sweep(executor: Executor, runs, job, *, retries=2, ahead=200, progress=lambda done, failed: None):
    """All runs, each once: a list of rows in the order of their numbers.

    Args:
        executor: of threads, or `distributed.Client.get_executor(pure=False)`.
        runs: how many.
        job: called with a run's number; gives its row.
        retries: how often a run that failed is done again.
        ahead: how many runs wait at most; a cluster of 100 workers wants more than one for each.
        progress: told after each run.
    """
    rows, tries, waiting = {}, dict.fromkeys(range(runs), 0), {}
    todo = list(range(runs))[::-1]
    failed = 0
    while todo or waiting:
        while todo and len(waiting) < ahead:
            number = todo.pop()
            tries[number] += 1
            waiting[executor.submit(job, number)] = number
        done, _ = wait(waiting, return_when=FIRST_COMPLETED)
        for future in done:
            number = waiting.pop(future)
            error = reason(future)
            if error is None:
                rows[number] = {**future.result(), "tries": tries[number], "error": None}
            elif tries[number] <= retries:
                todo.append(number)
                continue
            else:
                failed += 1
                rows[number] = {"run": number, "tries": tries[number], "error": error}
            progress(len(rows), failed)
    assert sorted(rows) == list(range(runs)), "each run has one row"
    return [rows[number] for number in range(runs)]


def reason(future: Future):
    """Why a run failed; None if it did not."""
    if future.cancelled():
        return "cancelled: the scheduler has lost it"
    error = future.exception()
    return None if error is None else f"{type(error).__name__}: {error}"


class Job:
    """What a run needs but its number; it is sent to each worker."""

    def __init__(self, **options):
        self.options = options

    def __call__(self, number):
        """Does a run."""
        return one_run(number, **self.options)


def check(place):
    """Ends the program where the result could not be written: before the first run, not after the last."""
    try:
        import pyarrow.parquet  # noqa: F401
    except ImportError:
        sys.exit("the result is written by pyarrow: pip install pyarrow")
    if not place.absolute().parent.is_dir():
        sys.exit(f"there is no folder {place.absolute().parent} for the result")


def write(rows, place):
    """Writes the rows as Parquet."""
    import pyarrow
    import pyarrow.parquet

    names = list(dict.fromkeys(name for row in rows for name in row))
    table = pyarrow.table({name: [row.get(name) for row in rows] for name in names})
    pyarrow.parquet.write_table(table, place)


def executor_for(scheduler, threads, fmu):
    """Threads, or a Dask cluster, at an address or made here by `local`; and how many runs go on at once."""
    if scheduler is None:
        return ThreadPoolExecutor(threads), threads
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        sys.exit("a cluster is reached by Dask: pip install distributed")
    if scheduler == "local":
        scheduler = LocalCluster(n_workers=threads, threads_per_worker=1, dashboard_address=None)
    client = Client(scheduler)
    # Workers, also those that come later, get this file and the FMU once, not with every run.
    client.upload_file(__file__)
    client.upload_file(str(fmu), load=False)
    return client.get_executor(pure=False), sum(client.nthreads().values())


def pair(text):
    """`NAME=VALUE`"""
    name, _, value = text.partition("=")
    return name, float(value)


def span(text):
    """`NAME=LOW:HIGH`"""
    name, _, value = text.partition("=")
    low, high = map(float, value.split(":"))
    return name, (low, high)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("robot", help="a URDF or an FMU")
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--vary", type=span, action="append", default=[], metavar="NAME=LOW:HIGH")
    parser.add_argument("--set", type=pair, action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--output", action="append", default=[], metavar="NAME")
    parser.add_argument("--stop-time", type=float, default=2.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--scheduler", help="address of a Dask scheduler, or 'local'")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--result", type=Path, default=Path("sweep.parquet"))
    options = parser.parse_args()
    check(options.result)

    with tempfile.TemporaryDirectory(prefix="sweep-") as folder:
        # A name of its own: the workers of a cluster may serve several sweeps.
        fmu = Path(folder, Path(folder).name + ".fmu")
        if options.robot.endswith(".fmu"):
            shutil.copy(options.robot, fmu)
        else:
            urdf2fmu.export(options.robot, fmu)
        job = Job(fmu=fmu, varied=dict(options.vary), fixed=dict(options.set),
                  outputs=options.output or ["base.position.*"], stop_time=options.stop_time, seed=options.seed)
        executor, workers = executor_for(options.scheduler, options.threads, fmu)

        def progress(done, failed):
            if sys.stderr.isatty():
                print(f"\r{done} of {options.runs} runs, {failed} failed", end="", file=sys.stderr, flush=True)

        rows = sweep(executor, options.runs, job, ahead=4 * workers + 50, progress=progress)
        executor.shutdown()
    if sys.stderr.isatty():
        print(file=sys.stderr)
    write(rows, options.result)
    bad = [row for row in rows if row["error"]]
    for row in bad[:10]:
        print(f"run {row['run']}: {row['error']}", file=sys.stderr)
    print(f"{options.result}: {len(rows)} runs, {len(bad)} failed")
    sys.exit(3 if bad else 0)


if __name__ == "__main__":
    # As a module with a name, under which workers know it.
    import sweep as module
    module.main()
