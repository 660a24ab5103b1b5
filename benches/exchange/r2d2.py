"""Evaluations that FMPy's CVODE takes for R2D2: of a model in Python that shares no code with ours, and of our FMU.

    python benches/exchange/r2d2.py URDF2FMU [--tolerance 1e-4] [--runs 6]

The robot stands, drives straight at 10 rad/s, and turns on the spot, a second each. Prints Markdown tables of means over
runs whose speeds differ by ten-thousandths, because a single one says little. A Jacobian counts as many evaluations as
there are states: CVODE finds it by differences. First the derivatives of both are compared. Needs the packages of
benches/peers/requirements.txt; twenty minutes.
"""

import argparse
import ctypes
import re
import subprocess
import tempfile
from pathlib import Path

import fmpy
import fmpy.sundials.libraries
import numpy as np
import pybullet_data
from fmpy.fmi2 import FMU2Model
from fmpy.sundials import CVodeSolver

import field

PHASES = ((0, 0), (10, 10), (10, -10))
COUNTERS = ("NumSteps", "NumRhsEvals", "NumJacEvals")
SETTINGS = '[world]\nground = { type = "plane", friction = 0.5 }\n[link."*"]\nfriction = 0.5\n'
AWAY = (-0.1, 0.2, 0.2)


def counters(solver):
    """Steps, evaluations and Jacobians since the solver was reset."""
    found = []
    for name in COUNTERS:
        value = ctypes.c_long()
        getter = getattr(fmpy.sundials.libraries.sundials_cvode, "CVodeGet" + name)
        getter.argtypes = [ctypes.c_void_p, ctypes.POINTER(ctypes.c_long)]
        getter(solver.cvode_mem, ctypes.byref(value))
        found.append(value.value)
    return np.array(found)


def integrate(robot, tolerance, share):
    """Integrates as `fmpy.simulate_fmu` does, speeds times `share`; returns the counters."""
    x, total = robot.start(), np.zeros(len(COUNTERS), int)
    view = lambda pointer, n: np.ctypeslib.as_array(pointer, (n,))

    def put(source):
        return lambda pointer, n: view(pointer, n).__setitem__(slice(None), source())

    def set_x(pointer, n):
        x[:] = view(pointer, n)

    robot.command(0, 0)
    solver = CVodeSolver(nx=len(x), nz=0, get_x=put(lambda: x), set_x=set_x, get_dx=put(lambda: robot.rates(x)),
                         get_z=lambda pointer, n: None, get_nominals=put(lambda: robot.nominal),
                         set_time=lambda t: None, input=None, startTime=0.0, maxStep=len(PHASES) / 50,
                         relativeTolerance=tolerance)
    for second, (left, right) in enumerate(PHASES):
        robot.command(share * left, share * right)
        if second > 0:
            total += counters(solver)
            solver.reset(float(second))
        for i in range(240):
            solver.step(second + i / 240, second + (i + 1) / 240)
    return total + counters(solver)


class Exported:
    """Our FMU for Model Exchange, as `field.Robot` is one."""

    def __init__(self, folder):
        self.folder, description = folder, fmpy.read_model_description(folder)
        self.description = description
        self.reference = {v.name: v.valueReference for v in description.modelVariables}
        self.states = description.numberOfContinuousStates
        self.names = [unknown.variable.derivative.name for unknown in description.derivatives]
        self.buffer = (ctypes.c_double * self.states)()
        self.model = None
        self.start()
        self.model.getNominalsOfContinuousStates(self.buffer, self.states)
        self.nominal = np.array(self.buffer)

    def start(self):
        if self.model:
            self.model.terminate()
            self.model.freeInstance()
        self.model = FMU2Model(guid=self.description.guid, unzipDirectory=self.folder, instanceName="one",
                               modelIdentifier=self.description.modelExchange.modelIdentifier)
        for call in ("instantiate", "setupExperiment", "enterInitializationMode", "exitInitializationMode",
                     "newDiscreteStates", "enterContinuousTimeMode"):
            getattr(self.model, call)()
        self.model.getContinuousStates(self.buffer, self.states)
        return np.array(self.buffer)

    def command(self, left, right):
        for name in field.WHEELS:
            self.model.setReal([self.reference[f"cmd.{name}.velocity"]], [left if "left" in name else right])

    def rates(self, x):
        self.model.setContinuousStates((ctypes.c_double * self.states)(*x), self.states)
        self.model.getDerivatives(self.buffer, self.states)
        return np.array(self.buffer)


def export(command, urdf, folder, settings=""):
    """Exports for Model Exchange and unpacks."""
    config, fmu = folder / "settings.toml", folder / f"{len(list(folder.iterdir()))}.fmu"
    config.write_text(SETTINGS + settings)
    subprocess.run([command, "export", urdf, "-o", fmu, "-c", config, "--interface", "me", "--no-documentation"],
                   check=True, capture_output=True)
    return Exported(fmpy.extract(str(fmu), unzipdir=str(fmu.with_suffix(""))))


def compare(robot, exported):
    """The largest difference of derivatives near the start, as a share of each, and where."""
    names = [f"base.position.{a}" for a in "xyz"] + [f"base.orientation.{a}" for a in "xyzw"]
    names += [f"joint.{name}.position" for name in robot.names]
    names += [f"base.{kind}_velocity.{a}" for kind in ("linear", "angular") for a in "xyz"]
    names += [f"joint.{name}.velocity" for name in robot.names]
    names += [f"state.contact.{name.removesuffix('_joint')}.{a}" for name in field.WHEELS for a in "xyz"]
    names += [f"state.motor.{name}" for name, servo in zip(robot.names, robot.servo) if not servo]
    places, random, worst = [exported.names.index(name) for name in names], np.random.default_rng(1), (0.0, "")
    start = exported.start()
    start[2] -= 2e-5
    for _ in range(100):
        x = start.copy()
        x[places] += 1e-3 * random.normal(size=len(places)) * robot.nominal[:len(places)]
        ours, theirs = exported.rates(x)[places], robot.rates(x[places])
        off = np.abs(ours - theirs) / (np.abs(ours) + 1e-6 * np.abs(ours).max())
        worst = max(worst, (off.max(), names[off.argmax()]))
    return worst


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("command", type=Path, help="the urdf2fmu command")
    parser.add_argument("--tolerance", type=float, default=1e-4)
    parser.add_argument("--runs", type=int, default=6)
    options = parser.parse_args()
    data = Path(pybullet_data.getDataPath())
    text = (data / "r2d2.urdf").read_text()

    def line(name, robot):
        shares = 1 + 1e-4 * (np.arange(options.runs) - options.runs // 2)
        steps, evaluations, jacobians = np.mean([integrate(robot, options.tolerance, s) for s in shares], axis=0)
        total = evaluations + jacobians * robot.states
        print(f"| {name} | {robot.states} | {steps:,.0f} | {evaluations:,.0f} | {jacobians:.0f} | {total:,.0f} |",
              flush=True)

    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for mesh in data.glob("l_finger*"):
            (folder / mesh.name).write_bytes(mesh.read_bytes())
        whole, wheels = folder / "whole.urdf", folder / "wheels.urdf"
        whole.write_text(field.urdf(text))
        bare = lambda m: m[0] if '_wheel"' in m[1] else re.sub(r"<collision>.*?</collision>", "", m[0], flags=re.S)
        wheels.write_text(re.sub(r'(<link name="[^"]*")>.*?</link>', bare, field.urdf(text), flags=re.S))
        away = "[initial.joints]\n" + "".join(f"{n} = {q}\n" for n, q in zip(field.GRIPPERS, AWAY))
        exported = export(options.command, whole, folder)
        alike = field.Robot(text, servos=True, target=AWAY)
        off, where = compare(alike, export(options.command, whole, folder, away))
        print(f"Derivatives differ by at most {off:.1e} of themselves: {where}\n")
        head = "| states | steps | evaluations without Jacobians | Jacobians | all |\n|---|---|---|---|---|---|"
        print(f"| FMU {head}")
        line("all shapes", exported)
        line("all shapes, grippers away from their limits", export(options.command, whole, folder, away))
        line("shapes at the wheels alone", export(options.command, wheels, folder))
        print(f"\n| model in Python {head}")
        for name, what in {
            "shapes at the wheels alone, velocity motors, no limits": {},
            "limits": {"limits": True},
            "servos": {"servos": True},
            "servos, limits": {"servos": True, "limits": True},
            "servos, limits, all shapes": {"servos": True, "limits": True, "idle": 12},
            "the same, grippers away from their limits": {"servos": True, "limits": True, "idle": 12, "target": AWAY},
        }.items():
            line(name, field.Robot(text, **what))


if __name__ == "__main__":
    main()
