"""A world in PyBullet with its default settings, but for drag, motors and sleep."""

import time

import numpy as np
import pybullet as p

from scene import quaternion
from world import G, RATE, Samples


def turned(rpy):
    """x, y, z, w."""
    w, x, y, z = quaternion(rpy)
    return [x, y, z, w]


class PyBullet:
    """One physics client per instance."""

    def __init__(self, world, step):
        self.world, self.step, self.rows = world, step, world.rows()
        self.per_row = round(1 / RATE / step)
        self.client = p.connect(p.DIRECT)
        self.fill()

    def fill(self):
        """Everything anew: a saved state forgets the caches of contacts."""
        world, c = self.world, {"physicsClientId": self.client}
        p.resetSimulation(**c)
        p.setGravity(0, 0, -G, **c)
        p.setPhysicsEngineParameter(fixedTimeStep=self.step, numSubSteps=0, deterministicOverlappingPairs=1, **c)
        if world.restitution:
            p.setPhysicsEngineParameter(restitutionVelocityThreshold=0.01, **c)
        if world.ground:
            self.tune(p.createMultiBody(0, p.createCollisionShape(p.GEOM_PLANE, **c), **c), -1)
        self.ids = {}
        for body in world.bodies:
            made = p.createMultiBody(body.mass, self.shape(body), basePosition=body.xyz,
                                     baseOrientation=turned(body.rpy), **c)
            self.tune(made, -1, body)
            if body.mass:
                self.ids[body.name] = made
                p.resetBaseVelocity(made, body.velocity, body.spin, **c)
        if world.slides:
            names = ["", *(s.body.name for s in world.slides)]
            places = {"": np.zeros(3), **{s.body.name: np.array(s.body.xyz) for s in world.slides}}
            count, bodies = len(world.slides), [s.body for s in world.slides]
            zero, one = [[0, 0, 0]] * count, [[0, 0, 0, 1]] * count
            self.robot = p.createMultiBody(
                0, linkMasses=[b.mass for b in bodies], linkCollisionShapeIndices=[self.shape(b) for b in bodies],
                linkVisualShapeIndices=[-1] * count, linkOrientations=one, linkInertialFramePositions=zero,
                linkPositions=[list(places[s.body.name] - places[s.parent]) for s in world.slides],
                linkInertialFrameOrientations=one, linkParentIndices=[names.index(s.parent) for s in world.slides],
                linkJointTypes=[p.JOINT_PRISMATIC] * count, linkJointAxis=[s.axis for s in world.slides], **c)
            for i, body in enumerate(bodies):
                self.tune(self.robot, i, body)
                p.setJointMotorControl2(self.robot, i, p.VELOCITY_CONTROL, force=0, **c)

    def shape(self, body):
        """The one of a body."""
        c = {"physicsClientId": self.client}
        if body.kind == "box":
            return p.createCollisionShape(p.GEOM_BOX, halfExtents=[side / 2 for side in body.size], **c)
        if body.kind == "sphere":
            return p.createCollisionShape(p.GEOM_SPHERE, radius=body.size[0], **c)
        return p.createCollisionShape(p.GEOM_CYLINDER, radius=body.size[0], height=body.size[1], **c)

    def tune(self, made, link, body=None):
        """Friction and restitution are products of two bodies'."""
        options, friction = {}, np.sqrt(self.world.friction)
        if body is not None and body.smooth:
            friction = 0.0
        if body is not None and body.mass:
            options = {"localInertiaDiagonal": list(body.inertia())}
        p.changeDynamics(made, link, lateralFriction=friction,
                         restitution=np.sqrt(self.world.restitution), linearDamping=0, angularDamping=0,
                         rollingFriction=0, spinningFriction=0, activationState=p.ACTIVATION_STATE_DISABLE_SLEEPING,
                         physicsClientId=self.client, **options)

    def sample(self):
        """Poses and places."""
        c, poses = self.client, []
        for made in self.ids.values():
            position, (x, y, z, w) = p.getBasePositionAndOrientation(made, physicsClientId=c)
            poses.append([*position, w, x, y, z])
        count = len(self.world.slides)
        return poses, [s[0] for s in p.getJointStates(self.robot, range(count), physicsClientId=c)] if count else []

    def run(self):
        """CPU seconds, samples."""
        self.fill()
        world, c, clock, taken = self.world, self.client, time.thread_time, 0.0
        joints, out = list(range(len(world.slides))), [self.sample()]
        for row in self.rows:
            start = clock()
            for _ in range(self.per_row):
                if joints:
                    effort = row
                    if world.kp:
                        state = np.array([s[:2] for s in p.getJointStates(self.robot, joints, physicsClientId=c)])
                        effort = world.kp * (row - state[:, 0]) - world.kd * state[:, 1]
                    effort = np.clip(effort, -world.limit, world.limit)
                    p.setJointMotorControlArray(self.robot, joints, p.TORQUE_CONTROL, forces=effort, physicsClientId=c)
                p.stepSimulation(physicsClientId=c)
            taken += clock() - start
            out.append(self.sample())
        poses, slides = zip(*out)
        return taken, Samples(np.array(poses), np.array(slides))

    def close(self):
        """Ends the client."""
        p.disconnect(self.client)
