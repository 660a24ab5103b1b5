"""Drives the example rover with FMPy: two seconds ahead, two seconds of turning on the spot."""
import sys
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

folder = extract(sys.argv[1] if len(sys.argv) > 1 else "rover.fmu")
model = read_model_description(folder)
ref = {variable.name: variable.valueReference for variable in model.modelVariables}
fmu = FMU2Slave(
    guid=model.guid,
    modelIdentifier=model.coSimulation.modelIdentifier,
    unzipDirectory=folder,
)
fmu.instantiate()
fmu.setupExperiment()
fmu.enterInitializationMode()
fmu.exitInitializationMode()

for step in range(4 * 240):
    left, right = (5.0, 5.0) if step < 2 * 240 else (-5.0, 5.0)  # rad/s
    for side, speed in ("left", left), ("right", right):
        for wheel in "front", "rear":
            command = f"cmd.{side}_{wheel}_wheel_joint"
            names = [command + ".velocity", command + ".max_effort"]
            fmu.setReal([ref[name] for name in names], [speed, 3.0])  # at most 3 N.m
    fmu.doStep(step / 240, 1 / 240)
    if step % 120 == 119:
        names = ("position.x", "position.y", "position.z", "rpy.yaw")
        x, y, z, yaw = fmu.getReal([ref["base." + name] for name in names])
        y, yaw = (round(value, 3) + 0.0 for value in (y, yaw))  # no "-0.000"
        print(
            f"t = {(step + 1) / 240:.1f} s   x = {x:.3f} m   y = {y:+.3f} m   "
            f"z = {z:.4f} m   yaw = {yaw:+.3f} rad"
        )

fmu.terminate()
fmu.freeInstance()
