"""A quadruped trots over noise, sampled at three distances: how it moves must not hang on them.

    python benches/rough.py URDF2FMU

runs the trot from 16 places on each and prints, as a Markdown table, the mean over the places of each
figure with its standard error. The heights are the same function, so the means must agree within
their errors, though each run is a different one after a second: a trot that is not controlled
doubles a small difference with every few steps. Needs numpy.
"""

import csv
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROBOT = Path(__file__).resolve().parents[1] / "examples" / "quadruped.urdf"
LEGS = ["front_right", "front_left", "rear_left", "rear_right"]  # every second one is lifted at a time
SECONDS = 10
SETTINGS = """
[initial]
xyz = [{x}, {y}]
joints = {{ "*_thigh_joint" = 0.8, "*_calf_joint" = -1.6 }}
[[world.terrain]]
name = "hills"
type = "heightfield"
generate = "noise"
size = [8, 8]
height = 0.15
resolution = {resolution}
wavelength = 1.0
seed = 5
friction = 1.0
[[actuator]]
joint = "*"
mode = "pd"
kp = 120
kd = 3
[link."*_foot"]
friction = 1.0
"""


def trot():
    """The commands, 50 a second."""
    yield ["time"] + [f"cmd.{leg}_{joint}_joint.position" for leg in LEGS for joint in ("hip", "thigh", "calf")]
    for k in range(50 * SECONDS + 1):
        t, row = k / 50, []
        for i, _ in enumerate(LEGS):
            phase = 2 * math.pi * 1.5 * t + i * math.pi
            lift = max(0.0, math.sin(phase)) * min(1.0, t)
            row += [0, 0.8 + 0.15 * math.cos(phase) * min(1.0, t) + 0.2 * lift, -1.6 - 0.5 * lift]
        yield [t] + row


def run(command, folder, resolution, place):
    """Roll and pitch (standard deviations, rad), bouncing (m/s), way (m) and weight on the ground (N)."""
    (folder / "s.toml").write_text(SETTINGS.format(resolution=resolution, x=place[0], y=place[1]))
    with open(folder / "in.csv", "w", newline="") as file:
        csv.writer(file).writerows(trot())
    subprocess.run([command, "simulate", ROBOT, "-c", folder / "s.toml", "--input-file", folder / "in.csv", "--quiet",
                    "--stop-time", str(SECONDS), "--output-interval", "0.01", "--output-file", folder / "out.csv"],
                   check=True, stdout=subprocess.DEVNULL)
    with open(folder / "out.csv", newline="") as file:
        names, *rows = csv.reader(file)
    columns = dict(zip(names, np.array(rows, dtype=float).T))
    late = columns["time"] > 2
    way = math.hypot(*(columns[f"base.position.{axis}"][-1] - columns[f"base.position.{axis}"][0] for axis in "xy"))
    loads = [name for name in names if name.startswith("contact.") and name.endswith("force.z")]
    return [np.std(columns["base.rpy.roll"][late]), np.std(columns["base.rpy.pitch"][late]),
            np.sqrt(np.mean(columns["base.linear_velocity.z"][late] ** 2)), way,
            sum(np.mean(columns[name][late]) for name in loads)]


def main():
    places = np.random.default_rng(1).uniform(-2, 2, (16, 2))
    print("| samples every | roll, rad | pitch, rad | up and down, m/s | way, m | load, N |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for resolution in (0.1, 0.05, 0.025):
            runs = np.array([run(sys.argv[1], Path(folder), resolution, place) for place in places])
            errors = runs.std(0, ddof=1) / math.sqrt(len(runs))
            cells = [f"{mean:.4g} ± {error:.2g}" for mean, error in zip(runs.mean(0), errors)]
            print(f"| {resolution} m | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
