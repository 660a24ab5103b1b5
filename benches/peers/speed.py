"""CPU time per 1/240 s of robot time beside MuJoCo implicitfast, interleaved in one run; a table for docs/performance.md.

    python3.11 -m venv peers && peers/bin/pip install -r benches/peers/requirements.txt
    peers/bin/python benches/peers/speed.py [--rounds 15] [--only TEXT] [--write]

The scenes of `scene.py`, commands at 60 Hz (50 Hz in the second table). Ours communicates as often as MuJoCo steps: at 240 Hz, and at 1 kHz in the
second table. Both take CPU time of the loop alone; what Python's loop takes without a step is subtracted from MuJoCo's.
Each round runs everyone once; the best round counts, so that what else the machine does falls on nobody.
"""

import argparse
import math
from importlib.metadata import version

import scene as scenes
from mujoco_scene import MuJoCo
from ours import Ours, build
from page import machine, write

SCENES = (scenes.iiwa_free, scenes.panda_free, scenes.r2d2, scenes.a1_standing, scenes.a1_marching,
          scenes.humanoid_standing, scenes.humanoid_falling)
FAST = (scenes.iiwa_free, scenes.panda_free, scenes.r2d2, scenes.a1_standing, scenes.a1_marching, scenes.humanoid_standing)


def measure(scene, binary, rounds, rate):
    """Seconds per second: MuJoCo, then ours at fixed steps, 1e-2, 1e-3, 1e-4; whether MuJoCo's run was stable."""
    per_row = round(rate / scene.rate)
    peer, ours = MuJoCo(scene, "implicitfast", 1 / rate), Ours(scene, binary)
    ways = [lambda: peer.run()[0], lambda: ours.run(step=1 / rate, per_row=per_row)[0]]
    ways += [lambda t=t: ours.run(tolerance=t, per_row=per_row)[0] for t in (1e-2, 1e-3, 1e-4)]
    best = [math.inf] * len(ways)
    for _ in range(rounds):
        best = [min(old, way()) for old, way in zip(best, ways)]
    steps = ours.run(tolerance=1e-3, per_row=per_row)[2]
    ours.close()
    return [t / scene.end for t in best], steps


def table(makers, binary, rounds, rate, only):
    """Markdown."""
    lines = ["| scene | degrees of freedom | MuJoCo implicitfast, µs | ours, fixed | 1e-2 | 1e-3 | 1e-4 | steps at 1e-3 per communication step |",
             "|---|---|---|---|---|---|---|---|"]
    for make in makers:
        scene = make()
        if only not in scene.name:
            continue
        if rate % scene.rate:
            scene.rate = 50  # commands, where a second has no whole number of steps per 1/60 s
        times, steps = measure(scene, binary, rounds, rate)
        unit = 1e6 / 240
        ours = " | ".join(f"{t * unit:.2f} = **{t / times[0]:.2f}×**" for t in times[1:])
        dof = len(scene.joint_names()) + 6 * scene.floating
        each = (steps["steps"] + steps["rejected"]) / (rate * scene.end)
        lines.append(f"| {scene.name} | {dof} | {times[0] * unit:.2f} | {ours} | {each:.2f} |")
        print(lines[-1], flush=True)
    return lines


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--only", default="", help="scenes whose name contains this")
    parser.add_argument("--write", action="store_true", help="put the tables into docs/performance.md")
    arguments = parser.parse_args()
    binary = build()
    text = ["Communication and MuJoCo's steps at 240 Hz:", ""]
    text += table(SCENES, binary, arguments.rounds, 240, arguments.only)
    text += ["", "Both at 1 kHz, still per 1/240 s:", ""]
    text += table(FAST, binary, arguments.rounds, 1000, arguments.only)
    text += ["", f"Best of {arguments.rounds} interleaved rounds on {machine()}; mujoco {version('mujoco')}."]
    write("speed", "benches/peers/speed.py", "\n".join(text), arguments.write)


if __name__ == "__main__":
    main()
