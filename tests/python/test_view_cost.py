"""What a live view costs: memory, time until it is there, and whether one core keeps real time.

`python -B -m pytest -s -k test_view_cost` prints the numbers, see docs/see.md.
"""

import os
import signal
import subprocess
import time

import pytest
from socket_client import Viewer

SECONDS = 5.0
"""Of real time that are measured: a hundredth of them is three frames."""

ROBOTS = ["r2d2", "humanoid"]


def memory(process):
    """The most that the process had in memory, MB."""
    with open(f"/proc/{process.pid}/status", encoding="ascii") as lines:
        return next(int(line.split()[1]) for line in lines if line.startswith("VmHWM:")) / 1000


def core_seconds(process):
    with open(f"/proc/{process.pid}/stat", encoding="utf-8") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@pytest.mark.skipif(not os.path.exists("/proc/self/status"), reason="memory is read as Linux tells it")
@pytest.mark.parametrize("kind", ["fmu", "urdf"])
@pytest.mark.parametrize("name", ROBOTS)
def test_a_view_is_there_at_once_keeps_time_on_one_core_and_stays_small(name, kind, export, examples, pybullet_data):
    urdf = {"r2d2": pybullet_data / "r2d2.urdf",
            "humanoid": examples.parent / "tests/robots/humanoid.urdf"}[name]
    shown = urdf if kind == "urdf" else export(urdf)
    core = {max(os.sched_getaffinity(0))}
    began = time.monotonic()
    process = subprocess.Popen([os.environ["URDF2FMU"], "view", shown, "--no-open"],
                               stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                               preexec_fn=lambda: os.sched_setaffinity(0, core))
    try:
        address = process.stdout.readline().strip()
        there = time.monotonic() - began
        viewer = Viewer(address)
        viewer.send({"run": True})
        viewer.until(lambda: viewer.time > 0)
        start, first, busy = time.monotonic(), viewer.time, core_seconds(process)
        viewer.until(lambda: time.monotonic() > start + SECONDS, SECONDS + 10)
        seconds = time.monotonic() - start
        factor, share = (viewer.time - first) / seconds, (core_seconds(process) - busy) / seconds
        viewer.close()
        most = memory(process)
    finally:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=20)
    print(f"\n{name}.{kind}: there after {there:.3f} s, real-time factor {factor:.4f}, {100 * share:.1f} % of a core, "
          f"{most:.1f} MB at most")
    assert 0.99 <= factor <= 1.01
    assert share < 0.5
    assert most <= 60
    # An FMU holds the model that is built; a URDF has to be read first.
    assert kind == "urdf" or there <= 0.2
