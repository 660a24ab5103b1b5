"""Times R2D2 driving, per 1/240 s, in urdf2fmu, MuJoCo and PyBullet, interleaved in one run; prints a table.

    python3.11 -m venv peers && peers/bin/pip install -r benches/peers/requirements.txt
    peers/bin/python benches/peers/r2d2.py [--rounds 15] [--write]

The time of the loop alone: no loading, no Python per step except in PyBullet, whose users have it too. CPU time for the
peers, wall time for us, which can only be longer. Each round runs everyone once; best and median over the rounds. Absolute times belong to the machine, the ratios less so. `--write`
puts the table into docs/performance.md.
"""

import argparse
import json
import platform
import statistics
import subprocess
import time
from importlib.metadata import version
from pathlib import Path

import pybullet_data

from mujoco_r2d2 import MuJoCo
from pybullet_r2d2 import PyBullet
from scenario import STEPS, Result

ROOT = Path(__file__).resolve().parents[2]
BEGIN, END = "<!-- r2d2 begin: written by benches/peers/r2d2.py -->", "<!-- r2d2 end -->"


class Ours:
    """The process of benches/r2d2.rs, one solver per instance."""

    def __init__(self, binary, data, solver):
        self.name = f"urdf2fmu, fixed {solver} s" if solver.startswith("1/") else f"urdf2fmu, tolerance {solver}"
        self.solver = solver
        self.process = subprocess.Popen([binary, str(Path(data) / "r2d2.urdf")], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)

    def run(self, _clock):
        """One drive. It times itself by the wall clock; a run that was interrupted loses to the best of the others."""
        self.process.stdin.write(self.solver + "\n")
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline())
        return answer["seconds"], Result(answer["yaw"], answer["forward"], answer["z"])


def build():
    """Compiles the bench; its path."""
    command = ["cargo", "bench", "--package", "urdf2fmu-core", "--bench", "r2d2", "--no-run", "--message-format=json-render-diagnostics"]
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
    artifacts = map(json.loads, done.stdout.splitlines())
    return next(a["executable"] for a in artifacts if a.get("target", {}).get("name") == "r2d2" and a.get("executable"))


def machine():
    """What it ran on."""
    names = [line.split(":")[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
             if line.startswith("model name")] if Path("/proc/cpuinfo").exists() else []
    return names[0] if names else platform.processor() or platform.machine()


def table(runners, times, results):
    """Markdown; ratios to our default, tolerance 1e-3."""
    unit = 1e6 / STEPS
    reference = min(next(times[r.name] for r in runners if r.name == "urdf2fmu, tolerance 1e-3"))
    lines = [
        "| | best, µs | median, µs | times ours at 1e-3 | yaw of the turn, rad | forward, m |",
        "|---|---|---|---|---|---|",
    ]
    for runner in runners:
        best, median = min(times[runner.name]), statistics.median(times[runner.name])
        result = results[runner.name]
        lines.append(f"| {runner.name} | {best * unit:.1f} | {median * unit:.1f} | {best / reference:.2f} "
                     f"| {result.yaw:.3f} | {result.forward:.3f} |")
    lines += ["", f"Best and median of {len(times[runners[0].name])} interleaved runs on {machine()}; "
              f"mujoco {version('mujoco')}, pybullet {version('pybullet')}."]
    return "\n".join(lines)


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--write", action="store_true", help="put the table into docs/performance.md")
    arguments = parser.parse_args()
    data, binary = pybullet_data.getDataPath(), build()
    runners = [Ours(binary, data, solver) for solver in ("1/240", "1e-2", "1e-3", "1e-4")]
    runners += [MuJoCo(data, "implicitfast"), MuJoCo(data, "Euler"), PyBullet()]
    times, results = {runner.name: [] for runner in runners}, {}
    for runner in runners:
        runner.run(time.process_time)  # caches and branch predictors warm
    for _ in range(arguments.rounds):
        for runner in runners:
            seconds, results[runner.name] = runner.run(time.process_time)
            times[runner.name].append(seconds)
    text = table(runners, times, results)
    print(text)
    if arguments.write:
        page = ROOT / "docs/performance.md"
        before, rest = page.read_text().split(BEGIN)
        page.write_text(f"{before}{BEGIN}\n{text}\n{END}{rest.split(END)[1]}")


if __name__ == "__main__":
    main()
