"""A world in MuJoCo: implicitfast, elliptic cones, several points a pair, its own softness of contacts."""

import time

import mujoco
import numpy as np

from scene import quaternion, rotation
from world import G, RATE, Samples

KINDS = {"box": mujoco.mjtGeom.mjGEOM_BOX, "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
         "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER}


class MuJoCo:
    """`step` in s."""

    def __init__(self, world, step):
        self.world, self.step, self.rows = world, step, world.rows()
        spec = mujoco.MjSpec()
        spec.option.timestep, spec.option.gravity = step, [0, 0, -G]
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        self.spec = spec
        if world.ground:
            self.tune(spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1]))
        for body in world.bodies:
            element = spec.worldbody.add_body(name=body.name, pos=body.xyz, quat=quaternion(body.rpy))
            if body.mass:
                element.add_freejoint()
            self.shape(element, body)
        made = {"": (spec.worldbody, np.zeros(3))}
        for slide in world.slides:
            body = slide.body
            parent, origin = made[slide.parent]
            element = parent.add_body(name=body.name, pos=np.array(body.xyz) - origin)
            element.add_joint(name=body.name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=slide.axis)
            self.shape(element, body)
            made[body.name] = element, np.array(body.xyz)
            actuator = spec.add_actuator(name=body.name, target=body.name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            actuator.forcelimited, actuator.forcerange = True, [-world.limit, world.limit]
            if world.kp:
                actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
                actuator.gainprm[0], actuator.biasprm[1], actuator.biasprm[2] = world.kp, -world.kp, -world.kd
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.per_row = round(1 / RATE / step)
        joint = self.model.body_jntadr
        self.places = [self.model.jnt_qposadr[joint[self.model.body(b.name).id]] for b in world.moving()]
        self.slides = [self.model.joint(s.body.name).qposadr[0] for s in world.slides]

    def tune(self, geom):
        """Friction and restitution, the latter as the damping of a spring."""
        geom.friction[0] = self.world.friction
        if self.world.restitution:
            log = np.log(self.world.restitution)
            ratio, omega = -log / np.hypot(np.pi, log), np.pi / 0.02
            geom.solref = [-omega**2, -2 * ratio * omega]

    def shape(self, element, body):
        """The one of a body."""
        size = np.array({"box": lambda s: np.array(s) / 2, "sphere": lambda s: [s[0], 0, 0],
                         "cylinder": lambda s: [s[0], s[1] / 2, 0]}[body.kind](body.size))
        geom = element.add_geom(type=KINDS[body.kind], size=size, mass=body.mass)
        self.tune(geom)
        if body.smooth:  # the surface of the higher priority counts
            geom.priority, geom.friction[0] = 1, 0

    def sample(self):
        """Poses and places."""
        qpos = self.data.qpos
        return [qpos[i:i + 7].copy() for i in self.places], qpos[self.slides].copy()

    def run(self):
        """CPU seconds, samples."""
        model, data, step, clock, taken = self.model, self.data, mujoco.mj_step, time.thread_time, 0.0
        mujoco.mj_resetData(model, data)
        for body in self.world.moving():
            i = model.jnt_dofadr[model.body_jntadr[model.body(body.name).id]]
            data.qvel[i:i + 6] = [*body.velocity, *(rotation(body.rpy).T @ np.array(body.spin))]
        out = [self.sample()]
        for row in self.rows:
            start = clock()
            if len(row):
                data.ctrl[:] = row
            step(model, data, self.per_row)
            taken += clock() - start
            out.append(self.sample())
        poses, slides = zip(*out)
        return taken, Samples(np.array(poses), np.array(slides))
