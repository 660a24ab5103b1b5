"""A hand that holds a cube, a humanoid that sits down: ours beside MuJoCo at 240 Hz; a table for docs/performance.md.

    peers/bin/python benches/peers/held.py COMMAND [--rounds 3] [--write]

`COMMAND` is a release build of urdf2fmu. The hand has 16 joints, four a finger, under PD laws: a cube falls between
three fingers and a thumb that close, and gravity then points in six directions in turn, each for 4 s, twice. The
humanoid is `examples/worlds/humanoid_chair.toml`. Links of the hand touch each other, those of the humanoid do not.
MuJoCo takes the same URDF, with implicitfast, elliptic cones, several points a pair and its own softness of contacts;
once more with friction ten times as stiff against the normal (`impratio`), which it has against creep.
Both run in one process, one after the other in each round. Times are CPU times of the thread that steps, without
samples; the best round counts.
"""

import argparse
import math
import time
import xml.etree.ElementTree as xml
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import mujoco
import numpy as np

from page import machine, write
from world_ours import POSE, Exported

ROOT = Path(__file__).resolve().parents[2]
G, RATE, PER_ROW = 9.81, 60, 4
WORLDS = ROOT / "examples/worlds"
TURNED = ((0, 0, -1), (1, 0, 0), (0, 0, 1), (-1, 0, 0), (0, 1, 0), (0, -1, 0))
BEGIN, TURN, HOLD = 2.0, 1.0, 4.0
# Inertia of the hand's rotors beyond their gears, kg·m²: without any MuJoCo goes unstable there.
ROTOR = 5e-4


def box(size, mass, origin):
    """Collision and inertia of a solid box, in a URDF."""
    x, y, z = (side**2 * mass / 12 for side in size)
    place = f'<origin xyz="{origin[0]} {origin[1]} {origin[2]}"/>'
    return (f'<inertial>{place}<mass value="{mass}"/><inertia ixx="{y + z!r}" iyy="{x + z!r}" izz="{x + y!r}" ixy="0" '
            f'ixz="0" iyz="0"/></inertial><collision>{place}<geometry><box size="{size[0]} {size[1]} {size[2]}"/>'
            '</geometry></collision>')


def hand():
    """A palm that looks up, three fingers on its one side and a thumb on the other; lengths of the Allegro hand."""
    parts = ['<robot name="hand"><link name="palm">', box((0.12, 0.13, 0.02), 0.4, (0, 0, -0.012)), "</link>"]
    for name, x, y in (("index", 0.05, 0.024), ("middle", 0.05, 0), ("ring", 0.05, -0.024), ("thumb", -0.05, 0)):
        inwards = f"0 {-1 if x > 0 else 1} 0"
        parent, at = "palm", f"{x} {y} 0"
        for i, (size, mass, axis) in enumerate((((0.018, 0.018, 0.014), 0.02, "0 0 1"),
                                                ((0.018, 0.018, 0.050), 0.06, inwards),
                                                ((0.016, 0.016, 0.034), 0.04, inwards),
                                                ((0.015, 0.015, 0.025), 0.02, inwards))):
            link, length = f"{name}_{i}", size[2] + 0.004
            parts.append(f'<link name="{link}">{box(size, mass, (0, 0, length / 2))}</link>'
                         f'<joint name="{link}" type="revolute"><parent link="{parent}"/><child link="{link}"/>'
                         f'<origin xyz="{at}"/><axis xyz="{axis}"/>'
                         '<limit lower="-0.5" upper="1.7" effort="0.7" velocity="7"/></joint>')
            parent, at = link, f"0 0 {length}"
    return "".join([*parts, "</robot>"])


CUBE = ('<robot name="cube"><link name="cube">' + box((0.07, 0.07, 0.07), 0.15, (0, 0, 0)) + "</link></robot>")


def fingers(t):
    """Targets of the joints of the hand, rad: open, then closed."""
    closed = min(max(t - 0.1, 0) / 0.4, 1)
    finger = (0.0, -0.25 + 0.55 * closed, 0.1 + 0.6 * closed, 0.1 + 0.4 * closed)
    return finger * 4


def gravity(t):
    """m/s²: turned within a second after each four."""
    phase = (t - BEGIN) / (HOLD + TURN)
    i = max(int(np.floor(phase)), 0)
    share = min(max((phase - i) * (HOLD + TURN) / TURN, 0), 1) if phase > 0 else 1
    a, b = (np.array(TURNED[k % 6], dtype=float) for k in ((i - 1) % 6, i))
    if phase <= 0 or i == 0:
        a = b = np.array(TURNED[0], dtype=float)
    if a @ b < -0.5:  # opposite ones by way of the third axis
        mid = np.array([0.0, 0.0, -1.0]) if a[2] == 0 else np.array([1.0, 0.0, 0.0])
        a, b, share = (a, mid, 2 * share) if share < 0.5 else (mid, b, 2 * share - 1)
    direction = (1 - share) * a + share * b
    return G * direction / np.linalg.norm(direction)


def table():
    """The humanoid's inputs, linear in between."""
    lines = (WORLDS / "humanoid_chair.csv").read_text().split()
    names = [name.split(".")[1] for name in lines[0].split(",")[1:]]
    rows = np.array([[float(x) for x in line.split(",")] for line in lines[1:]])
    return names, lambda t: [float(np.interp(t, rows[:, 0], column)) for column in rows[:, 1:].T]


@dataclass
class Scene:
    """`inputs`: names of the FMU's inputs and, of each, the joints that follow it; `thing`: the free body beside."""

    name: str
    end: float
    urdf: str
    thing: str
    settings: str
    inputs: list
    command: object
    gravity: object
    kp: float
    kd: float
    floating: bool
    touches_itself: bool
    figures: object


def relative(samples, begin, end):
    """How far the thing has moved against the base, mm."""
    def seen(i):
        base, thing = samples[i, :7], samples[i, 7:14]
        w, x, y, z = base[3:]
        r = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                      [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                      [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
        return r.T @ (thing[:3] - base[:3])
    return 1e3 * np.linalg.norm(seen(end) - seen(begin))


def row(t):
    """The row of a time."""
    return round(t * RATE)


def held(samples):
    """Of the cube."""
    phases = [BEGIN + i * (HOLD + TURN) for i in range(1, 12)]
    creeps = [relative(samples, row(p + TURN + 1), row(p + TURN + HOLD - 0.1)) for p in phases]
    # The first direction again, six phases later.
    back = relative(samples, row(phases[5] + TURN + HOLD - 0.1), row(BEGIN + HOLD))
    return {"largest creep in 2.9 s under a steady load, mm": max(creeps),
            "moved after all six directions, mm": back,
            "held (1) or lost (0)": float(np.abs(samples[-1, 7:10] - samples[-1, :3]).max() < 0.1)}


def sat(samples):
    """Of the humanoid."""
    moved = np.abs(samples[row(10), :3] - samples[row(8), :3]).max()
    return {"pelvis off its height on the seat, mm": 1e3 * abs(samples[-1, 2] - 0.49),
            "creep of the pelvis in 2 s, mm": 1e3 * moved,
            "chair has slid, mm": 1e3 * np.hypot(samples[-1, 7] + 0.3, samples[-1, 8])}


def scenes():
    """Both."""
    joints = [f"{finger}_{i}" for finger in ("index", "middle", "ring", "thumb") for i in range(4)]
    pd = '[[actuator]]\njoint = "*"\nmode = "pd"\nkp = {}\nkd = {}\n'
    yield Scene("hand of 16 joints holds a cube", 62.0, hand(), CUBE,
                '[robot]\nbase = "fixed"\nself_collision = true\n[initial]\nxyz = [0, 0, 0.5]\n'
                + "joints = { " + ", ".join(f"{j} = {v}" for j, v in zip(joints, fingers(0))) + " }\n"
                + pd.format(5.0, 0.1) + f'[joint."*"]\narmature = {ROTOR!r}\n'
                + '[[world.object]]\nname = "thing"\nurdf = "thing.urdf"\nxyz = [0, 0, 0.6]\n',
                [(joint, [joint]) for joint in joints], fingers, gravity, 5.0, 0.1, False, True, held)
    names, command = table()
    humanoid = (WORLDS / "humanoid.urdf").read_text()
    members = {name: [j.get("name") for j in xml.fromstring(humanoid.encode()).findall("joint")
                      if j.get("name").endswith(name[:-1])] for name in names}
    settings = (WORLDS / "humanoid_chair.toml").read_text().replace("chair.urdf", "thing.urdf")
    settings = settings.replace('name = "chair"', 'name = "thing"')
    yield Scene("humanoid sits down on a chair", 10.0, humanoid, (WORLDS / "chair.urdf").read_text(), settings,
                [(name, members[name]) for name in names], command, lambda t: (0, 0, -G), 4000.0, 150.0, True, False,
                sat)


class Ours(Exported):
    """An FMU of the scene."""

    def __init__(self, scene, command):
        super().__init__(command, scene.urdf, scene.settings, [("thing.urdf", scene.thing)])
        self.scene = scene
        base = [self.ref[f"base.{part}"] for part in POSE] if scene.floating else []
        self.read = base + [self.ref[f"object.thing.{part}"] for part in POSE]
        self.inputs = [self.ref[f"cmd.{name}.position"] for name, _ in scene.inputs]
        self.pull = [self.ref[f"world.gravity.{c}"] for c in "xyz"]

    def run(self, step=0.0, tolerance=1e-3):
        """CPU seconds, samples, steps taken and tried in vain."""
        fmu = self.begin(step, tolerance)
        samples, taken, before = [], 0.0, None
        for i in range(round(self.scene.end * RATE) + 1):
            found = fmu.getReal(self.read)
            samples.append(found if self.scene.floating else [0, 0, 0.5, 1, 0, 0, 0, *found])
            start = time.thread_time()
            fmu.setReal(self.inputs, list(self.scene.command(i / RATE)))
            pull = tuple(map(float, self.scene.gravity(i / RATE)))
            if pull != before:
                fmu.setReal(self.pull, list(pull))
                before = pull
            for j in range(PER_ROW):
                status = fmu.dll.fmi2DoStep(fmu.component, (i + j / PER_ROW) / RATE, 1 / RATE / PER_ROW, 1)
            taken += time.thread_time() - start
            if status > 1:
                raise RuntimeError(f"{self.scene.name}: our step failed")
        return taken, np.array(samples), sum(self.end(fmu))


class MuJoCo:
    """The same files; it begins where ours does."""

    def __init__(self, scene, first, impratio=1):
        def read(text):
            urdf = xml.fromstring(text.encode())
            for joint in urdf.iter("limit"):
                joint.attrib.pop("velocity", None)
            extension = xml.SubElement(urdf, "mujoco")
            xml.SubElement(extension, "compiler", {"discardvisual": "true", "fusestatic": "false"})
            return mujoco.MjSpec.from_string(xml.tostring(urdf, encoding="unicode"))
        spec, thing = read(scene.urdf), read(scene.thing)
        root = xml.fromstring(scene.urdf.encode()).find("link").get("name")
        spec.option.timestep = 1 / RATE / PER_ROW
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        # Several points a pair are its default since 4.0.
        spec.option.impratio = impratio
        if scene.floating:
            spec.body(root).add_freejoint()
        for geom in spec.geoms:
            # The ground and the thing touch all, links each other where the scene says so.
            geom.contype, geom.conaffinity = (3, 3) if scene.touches_itself else (1, 2)
        link = thing.bodies[1].name
        frame = spec.worldbody.add_frame()
        frame.attach_body(thing.body(link), "thing_", "")
        free = spec.body(f"thing_{link}")
        free.add_freejoint(name="thing")
        for geom in free.geoms:
            geom.contype, geom.conaffinity = 2, 3
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], contype=2, conaffinity=3)
        for geom in spec.geoms:
            geom.friction[0] = 0.8
        limits = {j.get("name"): float(j.find("limit").get("effort"))
                  for j in xml.fromstring(scene.urdf.encode()).findall("joint")}
        inputs = {joint: i for i, (_, joints) in enumerate(scene.inputs) for joint in joints}
        self.of_joint = []
        for joint, limit in limits.items():
            actuator = spec.add_actuator(name=joint, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            actuator.forcelimited, actuator.forcerange = True, [-limit, limit]
            actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
            actuator.gainprm[0], actuator.biasprm[1], actuator.biasprm[2] = scene.kp, -scene.kp, -scene.kd
            self.of_joint.append(inputs.get(joint, -1))
        self.scene, self.model = scene, spec.compile()
        self.data = mujoco.MjData(self.model)
        self.place = self.model.joint("thing").qposadr[0]
        qpos = self.data.qpos
        if scene.floating:
            qpos[:7] = first[:7]
        else:
            self.model.body(root).pos[:] = first[:3]
        qpos[self.place:self.place + 7] = first[7:]
        for joint in limits if not scene.floating else ():
            self.model.dof_armature[self.model.joint(joint).dofadr[0]] = ROTOR
        for joint in limits:
            i = inputs.get(joint, -1)
            if i >= 0:
                qpos[self.model.joint(joint).qposadr[0]] = scene.command(0)[i]
        self.begin = qpos.copy()

    def run(self):
        """CPU seconds, samples, steps."""
        model, data, step = self.model, self.data, mujoco.mj_step
        mujoco.mj_resetData(model, data)
        data.qpos[:] = self.begin
        samples, taken = [], 0.0
        base = [0, 0, 0.5, 1, 0, 0, 0]
        for i in range(round(self.scene.end * RATE) + 1):
            q = data.qpos
            samples.append([*(q[:7] if self.scene.floating else base), *q[self.place:self.place + 7]])
            start = time.thread_time()
            command = [*self.scene.command(i / RATE), 0.0]
            data.ctrl[:] = [command[k] for k in self.of_joint]
            model.opt.gravity[:] = self.scene.gravity(i / RATE)
            step(model, data, PER_ROW)
            taken += time.thread_time() - start
        return taken, np.array(samples), len(samples) * PER_ROW


def measure(scene, command, rounds):
    """Rows of the table."""
    ours = Ours(scene, command)
    first = ours.run()[1][0]
    ways = {"MuJoCo": MuJoCo(scene, first).run, "MuJoCo, impratio 10": MuJoCo(scene, first, 10).run,
            "ours, fixed": lambda: ours.run(step=1 / 240), "ours, 1e-3": ours.run,
            "ours, 1e-4": lambda: ours.run(tolerance=1e-4)}
    best, figures, steps = dict.fromkeys(ways, math.inf), {}, {}
    for _ in range(rounds):
        for name, run in ways.items():
            seconds, samples, steps[name] = run()
            best[name] = min(best[name], seconds)
            figures[name] = scene.figures(samples)
    ours.close()
    communication = scene.end * 240
    rows = []
    cells = [f"{best['MuJoCo'] / communication * 1e6:.1f}"] + [
        f"{best[name] / best['MuJoCo']:.2f}" for name in list(ways)[1:]]
    rows.append(f"| {scene.name}: CPU, µs per 1/240 s, ours in MuJoCo's | " + " | ".join(cells) + " |")
    rows.append(f"| {scene.name}: steps per 1/240 s | "
                + " | ".join(f"{steps[name] / communication:.2f}" for name in ways) + " |")
    for figure in figures["MuJoCo"]:
        values = [figures[name][figure] for name in ways]
        rows.append(f"| {scene.name}: {figure} | "
                    + " | ".join("0" if abs(v) < 1e-9 else f"{v:.2g}" for v in values) + " |")
    return rows


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("command", help="urdf2fmu, built")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--write", action="store_true", help="put the table into docs/performance.md")
    arguments = parser.parse_args()
    lines = ["| | MuJoCo | MuJoCo, impratio 10 | ours, fixed | ours, 1e-3 | ours, 1e-4 |", "|---|---|---|---|---|---|"]
    for scene in scenes():
        lines += measure(scene, arguments.command, arguments.rounds)
    lines += ["", f"Best of {arguments.rounds} interleaved rounds on {machine()}; MuJoCo {version('mujoco')}."]
    write("held", "benches/peers/held.py", "\n".join(lines), arguments.write)


if __name__ == "__main__":
    main()
