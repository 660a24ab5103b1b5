"""R2D2 in PyBullet, with the tutorial's loop and default settings."""

import pybullet
import pybullet_data

from scenario import GRAVITY, PHASES, START_HEIGHT, WHEELS, Meter


class PyBullet:
    """Runs the scenario. Its wheel inertia comes from the shapes by default; friction is 0.5 times the plane's 1."""

    name = "PyBullet"

    def __init__(self):
        self.client = pybullet.connect(pybullet.DIRECT)

    def run(self, clock):
        """One drive: time of the loop in s, and where it led."""
        pybullet.resetSimulation()
        pybullet.setAdditionalSearchPath(pybullet_data.getDataPath())
        pybullet.setGravity(0, 0, -GRAVITY)
        pybullet.loadURDF("plane.urdf")
        robot = pybullet.loadURDF("r2d2.urdf", [0, 0, START_HEIGHT])
        joints = {pybullet.getJointInfo(robot, j)[1].decode(): j for j in range(pybullet.getNumJoints(robot))}
        meter = Meter()
        start = clock()
        for number, (steps, right, left, effort) in enumerate(PHASES):
            if number > 0:  # it settles under its default motors
                for wheel, velocity in zip(WHEELS, [right, right, left, left]):
                    pybullet.setJointMotorControl2(robot, joints[wheel], pybullet.VELOCITY_CONTROL,
                                                   targetVelocity=velocity, force=effort)
            for _ in range(steps):
                pybullet.stepSimulation()
            position, orientation = pybullet.getBasePositionAndOrientation(robot)
            meter.add(*position, pybullet.getEulerFromQuaternion(orientation)[2])
        return clock() - start, meter.result()
