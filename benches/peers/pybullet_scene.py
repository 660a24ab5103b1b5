"""A scene in PyBullet.

Without what its users get unasked: air drag, motors on every joint, inertia from shapes. PD is a
torque computed in Python before every step: `POSITION_CONTROL` means something else at every step size.
"""

import os
import tempfile
import time

import numpy as np
import pybullet as p

from scene import quaternion, rotation


class PyBullet:
    """One physics client per instance."""

    def __init__(self, scene, step):
        self.scene, self.step, self.rows = scene, step, scene.rows()
        self.per_row = round(1 / scene.rate / step)
        self.client = p.connect(p.DIRECT)
        c = {"physicsClientId": self.client}
        p.setGravity(0, 0, -scene.gravity, **c)
        # The step and nothing below it; deterministic, so that a run repeats.
        p.setPhysicsEngineParameter(fixedTimeStep=step, numSubSteps=0, deterministicOverlappingPairs=1, **c)
        if scene.restitution > 0:
            p.setPhysicsEngineParameter(restitutionVelocityThreshold=0.01, **c)
        handle, path = tempfile.mkstemp(suffix=".urdf")
        with os.fdopen(handle, "w") as file:
            file.write(scene.urdf)
        self.robot = p.loadURDF(path, useFixedBase=not scene.floating,
                                flags=p.URDF_USE_INERTIA_FROM_FILE | p.URDF_USE_IMPLICIT_CYLINDER, **c)
        os.unlink(path)
        self.ids = {p.getJointInfo(self.robot, i, **c)[1].decode(): i for i in range(p.getNumJoints(self.robot, **c))}
        for link in range(-1, p.getNumJoints(self.robot, **c)):
            p.changeDynamics(self.robot, link, lateralFriction=scene.friction, restitution=scene.restitution,
                             linearDamping=0, angularDamping=0, rollingFriction=0,
                             spinningFriction=0, activationState=p.ACTIVATION_STATE_DISABLE_SLEEPING, **c)
        if scene.ground:
            plane = p.createCollisionShape(p.GEOM_PLANE, **c)
            self.plane = p.createMultiBody(0, plane, **c)
            p.changeDynamics(self.plane, -1, lateralFriction=1.0, restitution=1.0 if scene.restitution else 0.0, **c)
        self.joints = [self.ids[name] for name in scene.joint_names()]
        self.driven = [self.ids[a.joint] for a in scene.actuators]
        # Base states are those of the centre of mass, in its principal axes.
        offset, turn = p.getDynamicsInfo(self.robot, -1, **c)[3:5]
        self.offset, self.turn = np.array(offset), turn
        R = rotation(scene.rpy)
        w, x, y, z = quaternion(scene.rpy)
        if scene.floating:
            _, turned = p.multiplyTransforms([0, 0, 0], [x, y, z, w], [0, 0, 0], turn)
            self.base = list(np.array(scene.position) + R @ self.offset), turned
            self.speed = list(np.array(scene.velocity) + np.cross(scene.spin, R @ self.offset)), list(scene.spin)
            self.back = p.invertTransform([0, 0, 0], turn)
        for joint in self.ids.values():
            p.setJointMotorControl2(self.robot, joint, p.VELOCITY_CONTROL, force=0, **c)
        self.lines = None
        self.first = p.saveState(**c)

    def sample(self):
        """Base pose of the root link and joint positions."""
        c = self.client
        out = []
        if self.scene.floating:
            position, orientation = p.getBasePositionAndOrientation(self.robot, physicsClientId=c)
            _, (x, y, z, w) = p.multiplyTransforms([0, 0, 0], orientation, *self.back)
            R = np.array(p.getMatrixFromQuaternion([x, y, z, w])).reshape(3, 3)
            out = [*(np.array(position) - R @ self.offset), w, x, y, z]
        if self.joints:
            out += [state[0] for state in p.getJointStates(self.robot, self.joints, physicsClientId=c)]
        return out

    def run(self):
        """CPU seconds, samples."""
        c, robot, scene = self.client, self.robot, self.scene
        p.restoreState(self.first, physicsClientId=c)
        if scene.floating:
            p.resetBasePositionAndOrientation(robot, *self.base, physicsClientId=c)
            p.resetBaseVelocity(robot, *self.speed, physicsClientId=c)
        for name, joint in self.ids.items():
            if joint in self.joints:
                p.resetJointState(robot, joint, scene.joints.get(name, 0.0), scene.joint_velocities.get(name, 0.0),
                                  physicsClientId=c)
        pd = bool(scene.actuators) and scene.actuators[0].kind == "pd"
        kp, kd, limit = (np.array([getattr(a, k) for a in scene.actuators]) for k in ("kp", "kd", "limit"))
        samples, taken, clock, driven = [self.sample()], 0.0, time.process_time, self.driven
        step = p.stepSimulation
        for row in self.rows:
            start = clock()
            if scene.actuators and not pd:
                p.setJointMotorControlArray(robot, driven, p.VELOCITY_CONTROL, targetVelocities=row, forces=limit,
                                            physicsClientId=c)
            if pd:
                for _ in range(self.per_row):
                    state = np.array([s[:2] for s in p.getJointStates(robot, driven, physicsClientId=c)])
                    effort = np.clip(kp * (row - state[:, 0]) - kd * state[:, 1], -limit, limit)
                    p.setJointMotorControlArray(robot, driven, p.TORQUE_CONTROL, forces=effort, physicsClientId=c)
                    step(physicsClientId=c)
            else:
                for _ in range(self.per_row):
                    step(physicsClientId=c)
            taken += clock() - start
            samples.append(self.sample())
        return taken, np.array(samples)

    def close(self):
        """Ends the client."""
        p.disconnect(self.client)
