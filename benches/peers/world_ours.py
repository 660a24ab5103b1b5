"""A world as an FMU of ours, run by FMPy."""

import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

from world import RATE, Samples

PER_ROW = 4


def shape(body):
    """As settings have it."""
    value = list(body.size) if len(body.size) > 1 else body.size[0]
    return f"{{ {body.kind} = {value} }}"


def geometry(body):
    """As a URDF has it."""
    return {"box": lambda s: '<box size="{} {} {}"/>'.format(*s),
            "sphere": lambda s: '<sphere radius="{}"/>'.format(*s),
            "cylinder": lambda s: '<cylinder radius="{}" length="{}"/>'.format(*s)}[body.kind](body.size)


def robot(world):
    """The slides as a URDF on a post without a shape."""
    places, parts = {"": np.zeros(3)}, ['<robot name="slides"><link name="post"/>']
    for slide in world.slides:
        body = slide.body
        places[body.name] = np.array(body.xyz)
        xyz = " ".join(map(repr, map(float, places[body.name] - places[slide.parent])))
        inertia = dict(zip(("ixx", "iyy", "izz"), map(float, body.inertia())), ixy=0, ixz=0, iyz=0)
        inertia = " ".join(f'{k}="{v!r}"' for k, v in inertia.items())
        parts.append(
            f'<link name="{body.name}"><inertial><mass value="{body.mass!r}"/><inertia {inertia}/></inertial>'
            f'<collision><geometry>{geometry(body)}</geometry></collision></link>'
            f'<joint name="{body.name}" type="prismatic"><parent link="{slide.parent or "post"}"/>'
            f'<child link="{body.name}"/>'
            f'<origin xyz="{xyz}"/><axis xyz="{" ".join(map(str, slide.axis))}"/>'
            f'<limit lower="-10" upper="10" effort="{world.limit!r}" velocity="100"/></joint>')
    return "".join([*parts, "</robot>"])


def settings(world):
    """All but the slides."""
    mode = "pd" if world.kp else "effort"
    ground = '{ type = "none" }'
    if world.ground:
        ground = f'{{ type = "plane", friction = {world.friction!r}, restitution = {world.restitution!r} }}'
    lines = ["[robot]", 'base = "fixed"', "[world]", f"ground = {ground}",
             '[link."*"]', f"friction = {world.friction!r}", f"restitution = {world.restitution!r}"]
    if world.slides:
        lines += ["[[actuator]]", 'joint = "*"', f'mode = "{mode}"']
    if world.kp:
        lines += [f"max_effort = {world.limit!r}", f"kp = {world.kp!r}", f"kd = {world.kd!r}"]
    for slide in world.slides:
        if slide.body.smooth:
            lines += [f'[link."{slide.body.name}"]', "friction = 0"]
    for body in world.bodies:
        lines += ["[[world.object]]", f'name = "{body.name}"', f"shape = {shape(body)}",
                  f"friction = {world.friction!r}", f"restitution = {world.restitution!r}",
                  f"xyz = {[float(x) for x in body.xyz]}",
                  f"rpy = {[float(x) for x in body.rpy]}"]
        if body.mass:
            lines += [f"mass = {float(body.mass)!r}", f"linear_velocity = {[float(x) for x in body.velocity]}",
                      f"angular_velocity = {[float(x) for x in body.spin]}"]
        else:
            lines.append("static = true")
    return "\n".join(lines) + "\n"


POSE = [f"position.{c}" for c in "xyz"] + [f"orientation.{c}" for c in "wxyz"]
"""The outputs of a pose."""


class Exported:
    """A robot in a world as an FMU: exported once, run as often as wanted."""

    def __init__(self, command, urdf, settings, others=()):
        """`others`: names and texts of files that the settings name."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder)
            for name, text in {"robot.urdf": urdf, "world.toml": settings, **dict(others)}.items():
                (path / name).write_text(text)
            files = [path / "robot.urdf", "-c", path / "world.toml", "-o", path / "world.fmu", "--no-documentation"]
            subprocess.run([command, "export", *files], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
            self.folder = extract(str(path / "world.fmu"))
        self.model = read_model_description(self.folder)
        self.ref = {v.name: v.valueReference for v in self.model.modelVariables}

    def begin(self, step, tolerance):
        """An instance that has been initialised."""
        fmu = FMU2Slave(guid=self.model.guid, modelIdentifier=self.model.coSimulation.modelIdentifier,
                        unzipDirectory=self.folder)
        fmu.instantiate()
        fmu.setReal([self.ref["solver.step_size"], self.ref["solver.tolerance"]], [step, tolerance])
        fmu.setupExperiment()
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        return fmu

    def end(self, fmu):
        """Steps taken and tried in vain by an instance, which is then freed."""
        counts = fmu.getInteger([self.ref["solver.steps"], self.ref["solver.rejected"]])
        fmu.terminate()
        fmu.freeInstance()
        return counts

    def close(self):
        """Removes what was unpacked."""
        shutil.rmtree(self.folder, ignore_errors=True)


class Ours(Exported):
    """A world of the scenes."""

    def __init__(self, world, command):
        super().__init__(command, robot(world), settings(world))
        self.world, self.rows = world, world.rows()
        self.read = [self.ref[f"object.{b.name}.{part}"] for b in world.moving() for part in POSE]
        self.places = [self.ref[f"joint.{s.body.name}.position"] for s in world.slides]
        kind = "position" if world.kp else "effort"
        self.inputs = [self.ref[f"cmd.{s.body.name}.{kind}"] for s in world.slides]

    def run(self, step=0.0, tolerance=1e-3):
        """CPU seconds, samples."""
        fmu = self.begin(step, tolerance)
        poses, slides, taken, clock = [], [], 0.0, time.thread_time
        do_step, component = fmu.dll.fmi2DoStep, fmu.component

        def sample():
            poses.append(fmu.getReal(self.read))
            slides.append(fmu.getReal(self.places) if self.places else [])
        sample()
        for i, row in enumerate(self.rows):
            start = clock()
            if self.inputs:
                fmu.setReal(self.inputs, list(row))
            for j in range(PER_ROW):
                status = do_step(component, (i + j / PER_ROW) / RATE, 1 / RATE / PER_ROW, 1)
            taken += clock() - start
            if status > 1:
                raise RuntimeError(f"{self.world.name}: our step failed")
            sample()
        samples = Samples(np.array(poses).reshape(len(poses), -1, 7), np.array(slides))
        return taken, samples, self.end(fmu)
