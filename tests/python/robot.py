"""A robot in an FMU, driven through FMPy by variable names."""

import math
import os
import shutil
from pathlib import Path

import fmpy
from fmpy import fmi2


def extracted(fmu: Path) -> Path:
    """The folder with what is in an FMU that stays as it is, taken out once."""
    folder = Path(fmu).with_suffix(".unzipped")
    if not folder.exists():
        # Another process may be at it: the folder appears whole.
        own = folder.with_suffix(f".{os.getpid()}.unzipped")
        fmpy.extract(str(fmu), unzipdir=str(own))
        try:
            own.rename(folder)
        except OSError:
            shutil.rmtree(own)
            if not folder.exists():
                raise
    return folder


class Robot:
    """One instance: `initialize`, then set inputs by `robot[name] = value`, `step`, read by `robot[name]`."""

    def __init__(self, fmu: Path, *, guid=None, tolerance=None, without_resources=False, messages=None):
        folder = extracted(fmu)
        if without_resources:
            complete, folder = folder, folder.with_suffix(".without_resources")
            shutil.copytree(complete, folder, ignore=shutil.ignore_patterns("resources"), dirs_exist_ok=True)
        self.description = fmpy.read_model_description(str(folder))
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.tolerance = tolerance
        self.time = 0.0
        self.messages = [] if messages is None else messages
        """(status, category, text) of everything that the FMU logged"""

        def log(_environment, _instance, status, category, message):
            self.messages.append((status, category.decode(), message.decode()))

        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(log)
        callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
        callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
        self.slave = fmi2.FMU2Slave(
            guid=guid or self.description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="robot",
        )
        self.slave.component = None
        self.slave.instantiate(callbacks=callbacks, loggingOn=True)

    def initialize(self, start):
        """From instantiated to ready for the first step; `start` holds parameters and inputs."""
        self.slave.setupExperiment(tolerance=self.tolerance, startTime=self.time)
        for name, value in start.items():
            self[name] = value
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        return self

    def free(self):
        """Ends the instance."""
        if self.slave.component is not None:
            self.slave.freeInstance()
            self.slave.component = None

    def __setitem__(self, name, value):
        self.slave.setReal([self.variables[name].valueReference], [value])

    def __getitem__(self, name):
        variable = self.variables[name]
        get = {"Real": self.slave.getReal, "Integer": self.slave.getInteger, "Boolean": self.slave.getBoolean}
        return get[variable.type]([variable.valueReference])[0]

    def step(self, h):
        """One communication step of `h` seconds."""
        self.slave.doStep(self.time, h)
        self.time += h

    def run(self, duration, h=1 / 240):
        """Steps of `h`, a number or a function that draws one, for `duration` seconds; the last one is cut to fit."""
        end = self.time + duration
        while end - self.time > 1e-9:
            step = h() if callable(h) else h
            self.step(end - self.time if end - self.time < step * (1 + 1e-6) else step)

    def outputs(self):
        """Every output by name."""
        return {name: self[name] for name, variable in self.variables.items() if variable.causality == "output"}

    def vector(self, name, axes="xyz"):
        """The components of a vector."""
        return [self[f"{name}.{axis}"] for axis in axes]

    @property
    def yaw(self):
        """Heading, rad, within ±π."""
        return self["base.rpy.yaw"]

    @property
    def tilt(self):
        """Angle between the base's z axis and the vertical, rad."""
        x, y, z, w = self.vector("base.orientation", "xyzw")
        return math.atan2(2 * math.hypot(x * z + w * y, y * z - w * x), 1 - 2 * (x * x + y * y))

    def finite(self):
        """Whether every output is a finite number."""
        return all(math.isfinite(value) for value in self.outputs().values())
