"""R2D2 in PyBullet as an FMU, to be exported by PythonFMU: what else a user could build. Same inputs, similar outputs."""

import pybullet
import pybullet_data
from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class PyBulletR2D2(Fmi2Slave):
    """Velocity and effort of eight joints in, base and joint states out."""

    author = "urdf2fmu"
    description = "R2D2 in PyBullet"

    def __init__(self, **arguments):
        super().__init__(**arguments)
        self.client = pybullet.connect(pybullet.DIRECT)
        pybullet.setAdditionalSearchPath(pybullet_data.getDataPath(), physicsClientId=self.client)
        pybullet.setGravity(0, 0, -9.81, physicsClientId=self.client)
        pybullet.loadURDF("plane.urdf", physicsClientId=self.client)
        self.robot = pybullet.loadURDF("r2d2.urdf", [0, 0, 0.5], physicsClientId=self.client)
        count = pybullet.getNumJoints(self.robot, physicsClientId=self.client)
        info = [pybullet.getJointInfo(self.robot, j, physicsClientId=self.client) for j in range(count)]
        self.joints = [i[0] for i in info if i[2] != pybullet.JOINT_FIXED]
        for j in range(len(self.joints)):
            for name, start in ("velocity", 0.0), ("effort", 100.0):
                setattr(self, f"in_{name}_{j}", start)
                self.register_variable(Real(f"in_{name}_{j}", causality=Fmi2Causality.input, start=start))
        self.names = [f"base_{k}" for k in range(13)] + [f"joint_{k}" for k in range(3 * len(self.joints))]
        for name in self.names:
            setattr(self, name, 0.0)
            self.register_variable(Real(name, causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        """Steps of 1/240 s; a shorter one only reads, as for the cost of the calls."""
        options = {"physicsClientId": self.client}
        for j, joint in enumerate(self.joints):
            pybullet.setJointMotorControl2(self.robot, joint, pybullet.VELOCITY_CONTROL,
                                           targetVelocity=getattr(self, f"in_velocity_{j}"),
                                           force=getattr(self, f"in_effort_{j}"), **options)
        if step_size > 1e-6:
            pybullet.stepSimulation(**options)
        pose, velocity = (pybullet.getBasePositionAndOrientation(self.robot, **options),
                          pybullet.getBaseVelocity(self.robot, **options))
        values = [*pose[0], *pose[1], *velocity[0], *velocity[1]]
        for joint in self.joints:
            state = pybullet.getJointState(self.robot, joint, **options)
            values += [state[0], state[1], state[3]]
        for name, value in zip(self.names, values):
            setattr(self, name, value)
        return True
