"""Several bodies that touch: ours beside MuJoCo, PyBullet and Drake at 240 Hz; tables for docs/performance.md.

    python3.11 -m venv peers && peers/bin/pip install -r benches/peers/requirements.txt
    peers/bin/python benches/peers/worlds.py [--rounds 3] [--only TEXT] [--command URDF2FMU] [--write]

The scenes of `world.py`, each with figures whose truth is a closed form or our own result at a tolerance of 1e-7. Ours
is an FMU of a release build, in FMPy's hands, with communication steps of 1/240 s. All run in one process, one after
the other in each round. Times are CPU times of the thread that steps, without samples, with Python's calls: one per
1/240 s for ours, one per 1/60 s for MuJoCo and Drake, and for PyBullet one per 1/240 s and the law of its motors. The
best round counts.
"""

import argparse
import math
import os
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import world as worlds
from page import machine, write
from world_drake import Drake
from world_mujoco import MuJoCo
from world_ours import Ours
from world_pybullet import PyBullet

ROOT = Path(__file__).resolve().parents[2]
STEP = 1 / 240
OURS = ("ours, fixed", "ours, 1e-3")
PEERS = ("MuJoCo", "PyBullet", "Drake, points", "Drake, areas")
# In MuJoCo's times: what takes longer is run once.
PATIENCE = 10
REFERENCE = 1e-7


def build():
    """The command of a release build."""
    subprocess.run(["cargo", "build", "--release", "--package", "urdf2fmu"], cwd=ROOT, check=True)
    return Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release/urdf2fmu"


def measure(world, command, rounds, reference):
    """Seconds per second and samples of each, the reference, and our steps at 1e-3 in a communication step."""
    ours, peers = Ours(world, command), {"MuJoCo": MuJoCo(world, STEP), "PyBullet": PyBullet(world, STEP),
                                         "Drake, points": Drake(world, STEP),
                                         "Drake, areas": Drake(world, STEP, areas=True)}
    ways = {OURS[0]: lambda: ours.run(step=STEP), OURS[1]: lambda: ours.run(tolerance=1e-3),
            **{name: peer.run for name, peer in peers.items()}}
    best, samples, counts = dict.fromkeys(ways, math.inf), {}, (0, 0)
    for _ in range(rounds):
        for name, run in ways.items():
            if math.isfinite(best[name]) and best[name] > PATIENCE * best["MuJoCo"]:
                continue
            try:
                seconds, samples[name], *more = run()
            except RuntimeError as error:  # ours or Drake gave up
                print(f"{name}: {str(error)[:200]}", file=sys.stderr)
                continue
            best[name] = min(best[name], seconds / world.end)
            if name == OURS[1]:
                counts = more[0]
    exact = ours.run(tolerance=reference)[1] if reference else None
    peers["PyBullet"].close()
    ours.close()
    return best, samples, exact, sum(counts) / world.end / 240


def short(value):
    """Three digits."""
    if not math.isfinite(value):
        return "–"
    if value == 0 or abs(value) < 1e-9:
        return "0"
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


def errors(world, figures, samples, exact):
    """Rows of the second table, each after how our error at 1e-3 compares with the best peer's."""
    for figure in figures:
        found = {name: float(figure.value(s)) for name, s in samples.items()}
        own = float(figure.value(exact)) if exact else math.nan
        truth = own if figure.truth is None else figure.truth
        off = {name: abs(value - truth) for name, value in found.items()}
        cells = [short(off.get(name, math.nan)) for name in (*OURS, *PEERS)]
        unit = f", {figure.unit}" if figure.unit else ""
        source = f"{short(truth)} (ours at 1e-7)" if figure.truth is None else short(truth)
        best = min((off[name] for name in PEERS if math.isfinite(off.get(name, math.nan))), default=math.inf)
        ratio = off.get(OURS[1], math.inf) / max(best, 1e-9) if off.get(OURS[1], 1) > 1e-9 else 0.0
        last = "–" if figure.truth is None or not exact else short(abs(own - truth))
        yield ratio, f"| {world.name}: {figure.name}{unit} | {source} | {' | '.join(cells)} | {last} |"


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", default="", help="scenes whose name contains this")
    parser.add_argument("--command", help="urdf2fmu, built already")
    parser.add_argument("--write", action="store_true", help="put the tables into docs/performance.md")
    arguments = parser.parse_args()
    command, slow, wrong = arguments.command or build(), [], []
    for make in worlds.SCENES:
        world, figures = make()
        if arguments.only not in world.name:
            continue
        best, samples, exact, steps = measure(world, command, arguments.rounds, REFERENCE)
        unit, base = 1e6 / 240, best["MuJoCo"]
        others = " | ".join(short(best[name] / base) for name in (*OURS, *PEERS[1:]))
        slow.append((best[OURS[1]] / base, f"| {world.name} | {base * unit:.1f} | {others} | {steps:.2f} |"))
        wrong += errors(world, figures, samples, exact)
        print(slow[-1][1], *(row for _, row in wrong[-len(figures):]), sep="\n", flush=True)

    def rows(found):
        return [row for _, row in sorted(found, key=lambda pair: -pair[0])]
    text = ["CPU time, in that of MuJoCo, which is given per 1/240 s:", "",
            f"| scene | MuJoCo, µs | {' | '.join((*OURS, *PEERS[1:]))} | our steps at 1e-3 per 1/240 s |",
            "|---|---|---|---|---|---|---|---|", *rows(slow), "",
            "How far each is from the truth; rows in which ours at 1e-3 compares worst with the best peer are first:",
            "",
            f"| figure | truth | {' | '.join((*OURS, *PEERS))} | ours, 1e-7 |",
            "|---|---|---|---|---|---|---|---|---|", *rows(wrong), "",
            f"Best of {arguments.rounds} interleaved rounds on {machine()}; "
            + ", ".join(f"{name} {version(name)}" for name in ("mujoco", "pybullet", "drake")) + "."]
    write("worlds", "benches/peers/worlds.py", "\n".join(text), arguments.write)


if __name__ == "__main__":
    main()
