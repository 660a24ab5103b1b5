"""R2D2 in MuJoCo, with its default solver settings."""

import xml.etree.ElementTree as xml
from pathlib import Path

import mujoco

from scenario import FRICTION, GRAVITY, PHASES, START_HEIGHT, STEP, WHEELS, Meter, with_inertia_from_shapes, yaw_of

# Gain of the velocity actuators, N·m·s/rad: a lag of 0.03 rad/s under the 2.8 N·m that skidding takes.
GAIN = 100.0


def build(data: Path, integrator: str):
    """The robot on a plane."""
    urdf = with_inertia_from_shapes(data / "r2d2.urdf")
    extension = xml.SubElement(urdf, "mujoco")
    xml.SubElement(extension, "compiler", {"meshdir": str(data), "discardvisual": "true", "fusestatic": "false",
                                           "balanceinertia": "true"})
    spec = mujoco.MjSpec.from_string(xml.tostring(urdf, encoding="unicode"))
    spec.option.timestep = STEP
    spec.option.gravity = [0, 0, -GRAVITY]
    spec.option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
    spec.body("base_link").add_freejoint()
    spec.body("base_link").pos = [0, 0, START_HEIGHT]
    for geom in spec.geoms:
        # Nothing but the ground, and that with friction 0.5: MuJoCo combines by the larger one.
        geom.contype, geom.conaffinity = 0, 1
        geom.friction[0] = FRICTION
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], contype=1, conaffinity=0,
                            friction=[FRICTION, 0.005, 1e-4])
    for joint in spec.joints:
        if joint.type == mujoco.mjtJoint.mjJNT_FREE:
            continue
        # All other joints are held, as PyBullet's default motors do.
        actuator = spec.add_actuator(name=joint.name, target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        actuator.gainprm[0] = GAIN
        if integrator == "Euler":
            # Its actuators are explicit, and this gain on a wheel of 6e-4 kg·m² is unstable at 1/240 s. Its joint
            # damping is implicit, so the servo is a damper and a constant torque; the effort limit is lost.
            joint.damping[0] = GAIN
        else:
            actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
            actuator.biasprm[2] = -GAIN
            actuator.forcelimited = True
            actuator.forcerange = [-1000, 1000]
    return spec.compile()


class MuJoCo:
    """Runs the scenario; `integrator` is Euler or implicitfast."""

    def __init__(self, data, integrator):
        self.name = f"MuJoCo {integrator}"
        self.model = build(Path(data), integrator)
        self.data = mujoco.MjData(self.model)
        self.wheels = [self.model.actuator(wheel).id for wheel in WHEELS]

    def run(self, clock):
        """One drive: time of the loop in s, and where it led."""
        model, data, meter = self.model, self.data, Meter()
        mujoco.mj_resetData(model, data)
        start = clock()
        for steps, right, left, effort in PHASES:
            model.actuator_forcerange[self.wheels] = [-effort, effort]
            data.ctrl[self.wheels] = [right, right, left, left]
            # One call for the whole phase: the loop of C, without Python's overhead.
            mujoco.mj_step(model, data, steps)
            meter.add(*data.qpos[:3], yaw_of(*data.qpos[3:7]))
        return clock() - start, meter.result()
