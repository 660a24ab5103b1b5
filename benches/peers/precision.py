"""Error against CPU time of urdf2fmu, MuJoCo, PyBullet and Drake on the same URDFs, in one run: docs/accuracy.md.

    python3.11 -m venv peers && peers/bin/pip install -r benches/peers/requirements.txt
    peers/bin/python benches/peers/precision.py [--rounds 5] [--only TEXT] [--write] [--redraw] [--before PLAY]

Every simulator is swept over its steps or tolerances. A round runs every setting of every simulator once, in turn, so
that all of them meet the same load of the machine; the least CPU time of all rounds counts. Loading and set-up are not
in it. Where a formula or an integration of the equations of motion gives the answer, all are compared with that;
else each with its own solution at its finest setting, because their contact models differ. `--write` puts tables into
docs/accuracy.md, figures and the points as JSON into docs/accuracy/. `--before` names the bench `play` of another
version: then it measures that beside this one, without peers, and prints times at equal errors.
"""

import argparse
import json
import math
from importlib.metadata import version

import numpy as np

import changing
import elementary
import scene as scenes
from drake_scene import Drake
from elementary import Case, pose_error
from mujoco_scene import MuJoCo
from ours import ROOT, Ours, build
from page import machine, write
from pybullet_scene import PyBullet

TOLERANCES = [10.0**-k for k in range(1, 9)]
# Beside these where the truth does not come from a run of its own.
FINE = [1e-9, 1e-10, 1e-11, 1e-12]
ACCURACIES = [10.0**-k for k in range(1, 7)]
# Steps per sample of 1/60 s.
STEPS = [1, 2, 4, 8, 16, 32, 64, 128]
# A setting that takes longer than this for one run, s, ends the sweep of its simulator.
PATIENCE = 3.0
MUJOCO = {"MuJoCo Euler": ("Euler", False), "MuJoCo implicitfast": ("implicitfast", False), "MuJoCo RK4": ("RK4", False),
          "MuJoCo elliptic, stiff": ("implicitfast", True)}


def robots():
    """Scenes of whole robots, and over which time."""
    own = "its own solution at its finest setting"
    # Our finest tolerance is the one below which shorter steps than the shortest allowed would be needed.
    moved = []
    for scene, end in ((changing.quadruped_velocities(240, True), 0.5), (changing.quadruped_velocities(1000, True), 0.5),
                       (changing.r2d2(240, True, "turning", file_inertia=True), 1.0),
                       (changing.light_legs(240, True), 1.0)):
        scene.name, scene.end = f"{scene.name}, {scene.rate} Hz", end
        moved.append(scene)
    for scene, finest in ((scenes.r2d2(end=1.5), 1e-9), (scenes.a1_standing(end=1.0), 1e-9),
                          (scenes.a1_marching(end=1.0), 1e-8), (scenes.humanoid_falling(end=0.4), 1e-7),
                          *((scene, 1e-8) for scene in moved)):
        measure = f"largest error of the base's pose and the joints in {scene.end:g} s, m and rad"
        yield Case(scene, pose_error(True), None, own, measure, finest)


class Sweep:
    """The settings of one simulator on one case: from coarse to fine, and one finer as reference."""

    def __init__(self, name, settings, finest, make):
        self.name, self.settings, self.finest, self.make = name, settings, finest, make
        self.runners, self.times, self.samples, self.given_up = {}, {}, {}, set()

    def run(self, setting):
        """Once; keeps the least time. None where it fails."""
        if setting in self.given_up:
            return
        try:
            if setting not in self.runners:
                self.runners[setting] = self.make(setting)
            seconds, samples = self.runners[setting]()
        except Exception as error:  # noqa: BLE001  (a peer that throws has no result, and the others go on)
            print(f"    {self.name} {setting:g}: {str(error).splitlines()[0][:100]}")
            self.given_up.add(setting)
            return
        if not np.isfinite(samples).all():
            self.given_up.add(setting)
            return
        self.samples[setting] = samples
        self.times[setting] = min(seconds, self.times.get(setting, math.inf))
        if seconds > PATIENCE and setting != self.finest:
            self.given_up.update(s for s in self.settings if self.settings.index(s) > self.settings.index(setting))


def sweeps(case, binary):
    """All simulators."""
    scene = case.scene
    h = 1 / scene.rate
    steps = [h / n for n in STEPS if h / n >= 1 / 8000 - 1e-12]
    most = max(1, round(60 * 1024 / scene.rate))  # steps per row where a peer's own solution comes from
    ours = Ours(scene, binary)

    def controlled(tolerance):
        return lambda: ours.run(tolerance=tolerance, repeat=3)[:2]

    def fixed(step):
        return lambda: ours.run(step=step, repeat=3)[:2]
    tolerances = TOLERANCES + FINE if case.reference is not None else [t for t in TOLERANCES if t > 5 * case.finest]
    yield Sweep("urdf2fmu, error control", tolerances, case.finest, controlled)
    yield Sweep("urdf2fmu, fixed steps", steps, None, fixed)
    for name, (integrator, stiff) in MUJOCO.items():
        if stiff and not scene.ground:
            continue
        yield Sweep(name, steps, h / most, lambda s, i=integrator, f=stiff: MuJoCo(scene, i, s, f).run)
    yield Sweep("PyBullet", steps, h / max(1, most // 2), lambda s: PyBullet(scene, s).run)
    yield Sweep("Drake SAP", steps, h / max(1, most // 2), lambda s: Drake(scene, step=s).run)
    yield Sweep("Drake CENIC", ACCURACIES, 1e-7 if case.scene.mass() < 40 else 1e-6, lambda a: Drake(scene, accuracy=a).run)


def measure(case, binary, rounds):
    """Points (setting, seconds of CPU per second, error) of every simulator."""
    all_sweeps = list(sweeps(case, binary))
    for sweep in all_sweeps:
        if case.reference is None and sweep.finest is not None:
            sweep.run(sweep.finest)
    for _ in range(rounds):
        for sweep in all_sweeps:
            for setting in sweep.settings:
                sweep.run(setting)
    references = {sweep.name: sweep.samples.get(sweep.finest) for sweep in all_sweeps}
    # Fixed steps of ours solve the same equations as error control does.
    references["urdf2fmu, fixed steps"] = references["urdf2fmu, error control"]
    points = {}
    for sweep in all_sweeps:
        reference = case.reference if case.reference is not None else references[sweep.name]
        points[sweep.name] = []
        for setting in sweep.settings:
            own = case.reference is None and setting == sweep.finest
            if setting in sweep.samples and reference is not None and not own:
                error = case.error(sweep.samples[setting], reference)
                if error < 10:
                    points[sweep.name].append((setting, sweep.times[setting] / case.scene.end, error))
    return points


# Errors below this are equal: round-off of seconds of motion, and the truth is known no better.
GROUND = 1e-11


def verdict(points):
    """What peers do that ours does not do better: their points that none of ours is below and left of."""
    ours = [(s, t, e - GROUND) for name, list_ in points.items() if name.startswith("urdf2fmu") for s, t, e in list_]
    above = {}
    for name, list_ in points.items():
        if not name.startswith("urdf2fmu"):
            better = [p for p in list_ if not any(o[1] <= p[1] and o[2] <= p[2] for o in ours)]
            if better:
                above[name] = better
    return above


def label(setting, name):
    """A step as a fraction, an accuracy as a power."""
    return f"1/{1 / setting:.0f}" if name in STEPPED else f"{setting:.0e}".replace("e-0", "e-")


def table(case, points):
    """Markdown: a row a simulator, a column a setting; error and time."""
    lines = ["| simulator | setting: error at µs of CPU per second |", "|---|---|"]
    every = sorted({s for name, list_ in points.items() if name in STEPPED for s, *_ in list_}, reverse=True)
    for name, list_ in points.items():
        cells = " · ".join(f"{label(s, name)}: {e:.1e} at {t * 1e6:,.0f}".replace(",", " ") for s, t, e in list_)
        shown = {s for s, *_ in list_}
        missing = [label(s, name) for s in every if name in STEPPED and s not in shown]
        cells += f" · no result: {', '.join(missing)}" if cells and missing else ""
        lines.append(f"| {name} | {cells or 'no run ended with a result'} |")
    above = verdict(points)
    if not above:
        lines += ["", "urdf2fmu is below and left of every point of every peer."]
    else:
        each = "; ".join(f"{name} at {', '.join(f'{label(s, name)} ({e:.1e}, {t * 1e6:.0f} µs)' for s, t, e in list_)}"
                         for name, list_ in above.items())
        lines += ["", f"**Not below and left of:** {each}."]
    return "\n".join(lines)


STYLES = {
    "urdf2fmu, error control": dict(color="#c1121f", marker="o", linewidth=2.4, zorder=5),
    "urdf2fmu, fixed steps": dict(color="#c1121f", marker="s", linewidth=1.4, linestyle="--", zorder=4),
    "MuJoCo Euler": dict(color="#9ec9e2", marker="v"),
    "MuJoCo implicitfast": dict(color="#3f8fc5", marker="^"),
    "MuJoCo RK4": dict(color="#0b4f8a", marker=">"),
    "MuJoCo elliptic, stiff": dict(color="#0b4f8a", marker="<", linestyle=":"),
    "PyBullet": dict(color="#e09f3e", marker="D"),
    "Drake SAP": dict(color="#6a994e", marker="P"),
    "Drake CENIC": dict(color="#386641", marker="X", linestyle="-."),
}


# Those whose setting is a step.
STEPPED = [name for name in STYLES if name not in ("urdf2fmu, error control", "Drake CENIC")]


def draw(results):
    """One figure of all cases."""
    import matplotlib
    matplotlib.use("svg")
    from matplotlib import pyplot

    matplotlib.rcParams.update({"font.size": 9, "svg.hashsalt": "urdf2fmu", "svg.fonttype": "none"})
    folder = ROOT / "docs/accuracy"
    for case, points in results:
        figure, axes = pyplot.subplots(figsize=(6.4, 4.2), layout="constrained")
        for name, list_ in points.items():
            if list_:
                axes.loglog([t for _, t, _ in list_], [max(e, 1e-15) for *_, e in list_], label=name, markersize=5,
                            **STYLES[name])
        axes.set_title(case.scene.name)
        axes.set_xlabel("CPU time per second of simulated time, s")
        axes.set_ylabel(case.measure.replace(" of the base's pose and the joints", ""))
        axes.grid(True, which="major", alpha=0.3)
        axes.legend(fontsize=7, loc="best")
        figure.savefig(folder / f"{case.scene.name.replace(' ', '_').lower()}.svg", metadata={"Date": None})
        pyplot.close(figure)


def page(results):
    """The part of docs/accuracy.md that is measured."""
    lines = []
    for case, points in results:
        lines += [f"### {case.scene.name}", "", f"Compared with {case.truth}. Error: {case.measure}.", "",
                  f"![{case.scene.name}](accuracy/{case.scene.name.replace(' ', '_').lower()}.svg)", "",
                  table(case, points), ""]
    peers = ", ".join(f"{name} {version(name)}" for name in ("mujoco", "pybullet", "drake"))
    lines.append(f"Measured on {machine()}; {peers}.")
    return "\n".join(lines)


def summary(results):
    """A row a scene: the cheapest setting that reaches an error, of ours and of the best peer."""
    lines = ["| scene | error | ours, µs per s | best peer, µs per s | times cheaper |", "|---|---|---|---|---|"]
    for case, points in results:
        ours = [p for name, l in points.items() if name.startswith("urdf2fmu") for p in l]
        peers = [(name, *p) for name, l in points.items() if not name.startswith("urdf2fmu") for p in l]
        for goal in (1e-2, 1e-3, 1e-4, 1e-6):
            a = min((t for _, t, e in ours if e <= goal), default=None)
            b = min(((t, name, s) for name, s, t, e in peers if e <= goal), default=None)
            if a is None and b is None:
                continue
            mine = f"{a * 1e6:.0f}" if a is not None else "not reached"
            other = f"{b[0] * 1e6:.0f} ({b[1]}, {label(b[2], b[1])})" if b else "none reaches it"
            ratio = f"{b[0] / a:.1f}" if a is not None and b else ""
            lines.append(f"| {case.scene.name} | {goal:.0e} | {mine} | {other} | {ratio} |".replace("e-0", "e-"))
    return "\n".join(lines)


def at_240(results):
    """Error of everyone at steps of 1/240 s, ours and CENIC also at 1e-3."""
    wanted = {"urdf2fmu, error control": 1e-3, "Drake CENIC": 1e-3}
    names = list(STYLES)
    lines = ["| scene | " + " | ".join(f"{n}, {'1e-3' if n in wanted else '1/240'}" for n in names) + " |",
             "|---|" + "---|" * len(names)]
    for case, points in results:
        cells = []
        for name in names:
            goal = wanted.get(name, 1 / 240)
            found = [p for p in points.get(name, []) if abs(p[0] / goal - 1) < 1e-6]
            cells.append(f"{found[0][2]:.1e} ({found[0][1] * 1e6:.0f})" if found else "–")
        lines.append(f"| {case.scene.name} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def cases():
    """All of them."""
    return [*(make() for make in elementary.CASES), *robots()]


def front(points):
    """Logarithms (error, time) of the points that none is below and left of, by falling error."""
    best, kept = math.inf, []
    for _, t, e in sorted(points, key=lambda p: p[1]):
        if e < best:
            best = e
            kept.append((math.log(max(e, GROUND)), math.log(t)))
    return kept


def equal_error(now, before):
    """Errors and ratios of times, ours now to before, at equal errors: where both fronts are, thrice a decade."""
    now, before = front(now), front(before)
    if not now or not before:
        return []
    high, low = (pick(f[end][0] for f in (now, before)) for pick, end in ((min, 0), (max, -1)))
    goals = np.arange(high, low - 1e-9, -math.log(10) / 3) if high >= low else []

    def at(goal, curve):
        errors, logs = zip(*reversed(curve))
        return np.interp(goal, errors, logs)
    return [(math.exp(goal), math.exp(at(goal, now) - at(goal, before))) for goal in goals]


def compare(chosen, binary, other, rounds):
    """Times at equal errors of this version and another one: printed. Each is compared with its own solution where
    there is no formula, as their contacts differ."""
    rows, means, names = [], [], ("error control", "fixed steps")
    for case in chosen:
        both = [[sweep for sweep in sweeps(case, each) if sweep.name.startswith("urdf2fmu")] for each in (binary, other)]
        if case.reference is None:
            for controlled, _ in both:
                controlled.run(controlled.finest)
        for _ in range(rounds):
            for kinds in zip(*both):
                for sweep in kinds:
                    for setting in sweep.settings:
                        sweep.run(setting)
        points = []
        for kinds in both:
            truth = case.reference if case.reference is not None else kinds[0].samples.get(kinds[0].finest)
            points.append([[] if truth is None else
                           [(s, kind.times[s] / case.scene.end, case.error(kind.samples[s], truth))
                            for s in kind.settings if s in kind.samples] for kind in kinds])
        print(f"\n### {case.scene.name}", flush=True)
        for i, kind in enumerate(names):
            for which, version_points in zip(("now", "before"), points):
                stepped = "urdf2fmu, " + kind
                cells = " · ".join(f"{label(s, stepped)}: {e:.1e} at {t * 1e6:.0f}" for s, t, e in version_points[i])
                print(f"- {kind}, {which}: {cells}")
        for i, kind in enumerate(names):
            ratios = equal_error(points[0][i], points[1][i])
            if not ratios:
                rows.append(f"| {case.scene.name} | {kind} | – | | |")
                continue
            mean = math.exp(np.mean([math.log(r) for _, r in ratios]))
            worst = max(ratios, key=lambda p: p[1])
            if i == 0:
                means.append(mean)
            rows.append(f"| {case.scene.name} | {kind} | {ratios[0][0]:.0e} … {ratios[-1][0]:.0e} | {mean:.2f} "
                        f"| {worst[1]:.2f} at {worst[0]:.0e} |")
            print(rows[-1], flush=True)
    print("\n| scene | | errors compared | time now / before, mean | most expensive |\n|---|---|---|---|---|")
    print("\n".join(rows))
    print(f"\nError control, all scenes: {math.exp(np.mean(np.log(means))):.2f}.")


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--only", default="", help="scenes whose name contains this")
    parser.add_argument("--write", action="store_true", help="write docs/accuracy.md and docs/accuracy/")
    parser.add_argument("--redraw", action="store_true", help="from docs/accuracy/results.json, without measuring")
    parser.add_argument("--before", help="the bench `play` of another version, to compare with")
    arguments = parser.parse_args()
    if arguments.before:
        compare([case for case in cases() if arguments.only in case.scene.name], build(), arguments.before,
                arguments.rounds)
        return
    store = ROOT / "docs/accuracy/results.json"
    stored = json.loads(store.read_text()) if store.exists() else {}
    binary = None if arguments.redraw else build()
    results = []
    for case in cases():
        if arguments.redraw:
            if case.scene.name not in stored:
                continue
            points = {name: [tuple(p) for p in list_] for name, list_ in stored[case.scene.name].items()}
        elif arguments.only in case.scene.name:
            print(f"\n### {case.scene.name}", flush=True)
            points = measure(case, binary, arguments.rounds)
            print(table(case, points), flush=True)
        else:
            continue
        results.append((case, points))
    if not arguments.write:
        return
    if not arguments.redraw:
        stored.update({case.scene.name: points for case, points in results})
        store.parent.mkdir(exist_ok=True)
        store.write_text(json.dumps(stored, indent=1) + "\n")
        results = [(case, stored[case.scene.name]) for case in cases() if case.scene.name in stored]
    draw(results)
    script, page_name = "benches/peers/precision.py", "docs/accuracy.md"
    write("summary", script, summary(results), True, page_name)
    write("at240", script, at_240(results), True, page_name)
    write("precision", script, page(results), True, page_name)


if __name__ == "__main__":
    main()
