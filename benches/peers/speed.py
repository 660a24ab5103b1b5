"""CPU time per 1/240 s of robot time beside MuJoCo implicitfast, interleaved in one run; a table for docs/performance.md.

    python3.11 -m venv peers && peers/bin/pip install -r benches/peers/requirements.txt
    peers/bin/python benches/peers/speed.py [--rounds 15] [--only TEXT] [--write]

The scenes of `scene.py`, commands at 60 Hz (50 Hz in the second table), and those of `changing.py`, whose commands are
set at every step: constant and changing ones side by side. Ours communicates as often as MuJoCo steps: at 240 Hz or at
1 kHz. Both take CPU time of the loop alone; what Python's loop takes without a step is subtracted from MuJoCo's. Each
round runs everyone once; the best round counts, so that what else the machine does falls on nobody. `--pairs` leaves
out the scenes of `scene.py`.
"""

import argparse
import math
from importlib.metadata import version

import changing
import scene as scenes
from mujoco_scene import MuJoCo
from ours import Ours, build
from page import machine, write

SCENES = (scenes.iiwa_free, scenes.panda_free, scenes.r2d2, scenes.a1_standing, scenes.a1_marching,
          scenes.humanoid_standing, scenes.humanoid_falling)
FAST = (scenes.iiwa_free, scenes.panda_free, scenes.r2d2, scenes.a1_standing, scenes.a1_marching, scenes.humanoid_standing)


# Ours in MuJoCo's times: what takes longer is run three times, not in every round.
PATIENCE = 20


def measure(scene, binary, rounds, rate):
    """Seconds per second: MuJoCo, then ours at fixed steps, 1e-2, 1e-3, 1e-4 (∞ where that fails); the counters of
    1e-3."""
    per_row = round(rate / scene.rate)
    peer, ours = MuJoCo(scene, "implicitfast", 1 / rate), Ours(scene, binary)
    steps = dict.fromkeys(("steps", "rejected"), math.nan)

    def way(**options):
        def run():
            try:
                seconds, _, counters = ours.run(per_row=per_row, **options)
            except RuntimeError:
                return math.inf
            if options.get("tolerance") == 1e-3:
                steps.update(counters)
            return seconds
        return run
    ways = [lambda: peer.run()[0], way(step=1 / rate), *(way(tolerance=t) for t in (1e-2, 1e-3, 1e-4))]
    best = [math.inf] * len(ways)
    for i in range(rounds):
        for j, run in enumerate(ways):
            if i < 3 or best[j] < PATIENCE * best[0]:
                best[j] = min(best[j], run())
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


def pairs(binary, rounds, rate, only):
    """Markdown: ratios under constant and under changing commands, and steps of the latter at 1e-3."""
    lines = ["| scene | MuJoCo implicitfast, µs: constant / changing | constant: fixed | 1e-3 | 1e-4 "
             "| changing: fixed | 1e-3 | 1e-4 | steps + rejected at 1e-3 per communication step |", "|---|---|---|---|---|---|---|---|---|"]
    for make in changing.variants():
        name = make(rate, True).name
        if only not in name:
            continue
        (constant, _), (moved, steps) = (measure(make(rate, changes), binary, rounds, rate) for changes in (False, True))
        unit = 1e6 / 240
        ratios = [f"{times[way] / times[0]:.2f}" for times in (constant, moved) for way in (1, 3, 4)]
        ratios[3:] = [f"**{ratio}**" for ratio in ratios[3:]]
        count = rate * make(rate, True).end
        lines.append(f"| {name} | {constant[0] * unit:.1f} / {moved[0] * unit:.1f} | {' | '.join(ratios)} "
                     f"| {steps['steps'] / count:.2f} + {steps['rejected'] / count:.2f} |")
        print(lines[-1], flush=True)
    return lines


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--only", default="", help="scenes whose name contains this")
    parser.add_argument("--pairs", action="store_true", help="constant and changing commands only")
    parser.add_argument("--write", action="store_true", help="put the tables into docs/performance.md")
    arguments = parser.parse_args()
    binary = build()
    foot = f"Best of {arguments.rounds} interleaved rounds on {machine()}; mujoco {version('mujoco')}."
    options = binary, arguments.rounds
    if not arguments.pairs:
        text = ["Communication and MuJoCo's steps at 240 Hz:", "", *table(SCENES, *options, 240, arguments.only), "",
                "Both at 1 kHz, still per 1/240 s:", "", *table(FAST, *options, 1000, arguments.only), "", foot]
        write("speed", "benches/peers/speed.py", "\n".join(text), arguments.write)
    text = ["Communication, commands and MuJoCo's steps at 240 Hz; ours in MuJoCo's times:", "",
            *pairs(*options, 240, arguments.only), "", "The same at 1 kHz, times still per 1/240 s:", "",
            *pairs(*options, 1000, arguments.only), "", foot]
    write("changing", "benches/peers/speed.py", "\n".join(text), arguments.write)


if __name__ == "__main__":
    main()
