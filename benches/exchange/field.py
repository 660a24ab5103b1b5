"""R2D2 as differential equations that share no code with this project: Pinocchio's algorithms, and the laws of
docs/design.md in continuous time with one patch a wheel.

A wheel lies on two rims: a norm of the fourth powers of their depths, a spring that stiffens, Hunt and Crossley's
dissipation, damping of rocking, one elasto-plastic element for sliding and drilling. Left out is the damping of a
cylinder's face that tilts, which is nothing for one that lies. States: base position, quaternion x y z w, joints;
velocities of the base in world axes, joints; 3 of each wheel's friction; 1 of each velocity motor; idle ones.
"""

import re

import numpy as np
import pinocchio as pin

WHEELS = [f"{place}_wheel_joint" for place in ("right_front", "right_back", "left_front", "left_back")]
GRIPPERS = ["gripper_extension", "left_gripper_joint", "right_gripper_joint"]
RADIUS, HALF_WIDTH = 0.035, 0.05
CROWN = 5e-5 * RADIUS
PENETRATION, DISSIPATION, STIFFEST = 1e-4, 51.0, 30.0
YIELD, LIMIT_YIELD = 1e-3, 1e-4
# Farthest shape of the head from its axis, m.
HEAD = 0.19066
EVEN_CORNERS = 0.55
# Inertia of the wheels as cylinders of 1 kg: the file has 1 kg.m2 about each axis.
CYLINDER = '<inertia ixx="1.139e-3" ixy="0" ixz="0" iyy="1.139e-3" iyz="0" izz="6.125e-4"/>'


def urdf(text):
    """The robot with wheels that have the inertia of cylinders."""
    return re.sub(r'(<link name="\w+_wheel">.*?)<inertia [^>]*>', lambda m: m[1] + CYLINDER, text, flags=re.S)


class Robot:
    """The robot and its commands. `servos`: the grippers hold a position; `limits`: they have limits; `idle`: so many
    shapes have friction that never acts; `target`: position of the grippers, at the start, too."""

    def __init__(self, text, servos=False, limits=False, idle=0, target=(0.0, 0.0, 0.0), friction=0.5):
        text = urdf(text).replace('type="continuous"', 'type="revolute"')
        self.model = pin.buildModelFromXML(text, pin.JointModelFreeFlyer())
        self.data = self.model.createData()
        self.names = list(self.model.names)[2:]
        self.nq, self.nv, self.friction = self.model.nq, self.model.nv, friction
        self.mass = sum(inertia.mass for inertia in self.model.inertias)
        self.stiffness = self.mass * 9.81 / (0.5625 * PENETRATION)
        self.wheels = [self.model.getJointId(name) for name in WHEELS]
        self.servo = np.array([servos and name in GRIPPERS for name in self.names])
        self.motors = int((~self.servo).sum())
        self.effort = self.model.effortLimit[6:].copy()
        q = pin.neutral(self.model)
        inertia = np.diag(pin.crba(self.model, self.data, q))[6:].copy()
        lever = np.array([np.hypot(RADIUS, HALF_WIDTH) if name in WHEELS else HEAD if name == "head_swivel" else 0
                          for name in self.names])
        self.k = self.effort / YIELD
        moved = np.maximum(inertia, self.mass * lever**2)
        self.d = np.maximum(2 * np.sqrt(self.k * moved), self.k * 1e-3)
        self.limit = np.maximum(self.effort, 100 * inertia) / LIMIT_YIELD
        bounded = np.array([limits and name in GRIPPERS for name in self.names])
        self.lower = np.where(bounded, self.model.lowerPositionLimit[7:], -np.inf)
        self.upper = np.where(bounded, self.model.upperPositionLimit[7:], np.inf)
        self.fastest = self.model.velocityLimit[6:].copy()
        self.target, self.speed = np.zeros(self.nv - 6), np.zeros(self.nv - 6)
        for name, value in zip(GRIPPERS, target):
            self.target[self.names.index(name)] = value
        self.states = self.nq + self.nv + 12 + self.motors + 3 * idle
        self.nominal = np.concatenate([np.ones(self.nq + self.nv), np.full(12, PENETRATION),
                                       np.full(self.motors, YIELD), np.full(3 * idle, PENETRATION)])
        self.nominal[2] = 0.01

    def command(self, left, right):
        """Speeds of the wheels, rad/s."""
        for i, name in enumerate(self.names):
            self.speed[i] = (left if "left" in name else right) if name in WHEELS else 0.0

    def start(self):
        """The states at rest, with the lowest wheel on the ground."""
        q = pin.neutral(self.model)
        q[2] = 0.5
        q[7:] = self.target
        pin.forwardKinematics(self.model, self.data, q)
        q[2] += max(depth for _, depth, _ in self.rims())
        return np.concatenate([q, np.zeros(self.states - self.nq)])

    def rims(self):
        """Lowest point of each rim, its depth, and how flat the face lies; two a wheel."""
        found = []
        for joint in self.wheels:
            place = self.data.oMi[joint]
            for side in (1.0, -1.0):
                axis = side * place.rotation[:, 2]
                center = place.translation + axis * HALF_WIDTH
                radius = np.sqrt(RADIUS * (RADIUS + 2 * CROWN))
                a = np.array([axis[0], axis[1], 0.0]) * radius
                q = np.sqrt(a @ a + CROWN**2)
                point = center + a / q * (radius * axis[2]) - np.array([0.0, 0.0, q - CROWN])
                found.append((point, q - CROWN - center[2], CROWN**2 / q**2))
        return found

    def contact(self, rims, V, stored):
        """Force of a wheel's contact, its moment about the origin, and the rate of what friction has stored."""
        depth = np.array([max(rim[1], 0.0) for rim in rims])
        delta = (0.5 * (depth**4).sum()) ** 0.25
        if delta <= 0:
            k = 0.8 * self.stiffness
            return np.zeros(3), np.zeros(3), -stored * k / (2 * np.sqrt(k * self.mass))
        share = 0.5 * (depth / delta) ** 3
        weights = share.sum()
        share /= weights
        along = np.array([(V.linear + np.cross(V.angular, rim[0]))[2] for rim in rims])
        speed = share @ along
        excess = min(delta / PENETRATION, STIFFEST) ** 3
        elastic = self.stiffness * delta * (1 + excess) * weights
        load = elastic * max(1 - DISSIPATION * weights * speed, 0.0)
        center = share @ np.array([rim[0] for rim in rims])
        radius = sum(part * (EVEN_CORNERS * np.hypot(*(rim[0] - center)[:2]) + 2 / 3 * RADIUS * rim[2])
                     for part, rim in zip(share, rims))
        rock = np.minimum(DISSIPATION * (along - speed), 1.0) * min(load, elastic)
        push = (load + share @ rock) * share - rock * share
        u = V.linear + np.cross(V.angular, center)
        u = np.array([u[0], u[1], radius * V.angular[2]])
        k = 0.8 * self.stiffness * (1 + 4 * excess)
        d, cap = 2 * np.sqrt(k * self.mass), self.friction * load
        drag = k * stored + d * u
        size = np.linalg.norm(drag)
        if size > cap:
            drag *= cap / size
        slide = np.array([-drag[0], -drag[1], 0.0])
        force, moment = slide.copy(), np.cross(center, slide)
        moment[2] -= radius * drag[2]
        for rim, newtons in zip(rims, push):
            up = np.array([0.0, 0.0, newtons])
            force += up
            moment += np.cross(rim[0], up)
        return force, moment, (drag - k * stored) / d

    def drive(self, q, v, local, z):
        """Efforts along the joints, and the rates of what the motors have stored."""
        tau, motor = np.zeros(self.nv - 6), ~self.servo
        k, d, cap = self.k[motor], self.d[motor], self.effort[motor]
        drag = np.clip(k * z + d * (v[6:][motor] - self.speed[motor]), -cap, cap)
        tau[motor] -= drag
        if self.servo.any():
            inertia = np.diag(pin.crba(self.model, self.data, q))[6:]
            bias = pin.nonLinearEffects(self.model, self.data, q, local)[6:]
        for i in np.flatnonzero(self.servo):
            cap_i, k_i = self.effort[i], self.k[i]
            gain = max(2 * np.sqrt(k_i * inertia[i]), k_i * 1e-3)
            braking = 0.5 * max(cap_i - abs(bias[i]), 0.1 * cap_i) / inertia[i]
            slope, error = k_i / gain, self.target[i] - q[7 + i]
            if abs(error) * slope**2 <= braking:
                wanted = slope * abs(error)
            else:
                wanted = np.sqrt(2 * braking * (abs(error) - 0.5 * braking / slope**2))
            wanted = np.copysign(min(wanted, self.fastest[i]), error)
            tau[i] += np.clip(bias[i] + gain * (wanted - v[6 + i]), -cap_i, cap_i)
        below, above = np.maximum(self.lower - q[7:], 0), np.maximum(q[7:] - self.upper, 0)
        tau += self.limit * below * np.maximum(1 - DISSIPATION * v[6:], 0)
        tau -= self.limit * above * np.maximum(1 + DISSIPATION * v[6:], 0)
        return tau, (drag - k * z) / d

    def rates(self, x):
        """Derivatives of the states."""
        q, v = x[:self.nq].copy(), x[self.nq:self.nq + self.nv]
        first = self.nq + self.nv
        squared = q[3:7] @ q[3:7]
        q[3:7] /= np.sqrt(squared)
        R = pin.Quaternion(q[3:7]).matrix()
        local = np.concatenate([R.T @ v[:3], R.T @ v[3:6], v[6:]])
        pin.forwardKinematics(self.model, self.data, q, local)
        out, rims = np.zeros(self.states), self.rims()
        forces = [pin.Force.Zero() for _ in range(self.model.njoints)]
        for i, joint in enumerate(self.wheels):
            place = self.data.oMi[joint]
            own = slice(first + 3 * i, first + 3 * i + 3)
            force, moment, out[own] = self.contact(rims[2 * i:2 * i + 2], place.act(self.data.v[joint]), x[own])
            forces[joint] = place.actInv(pin.Force(force, moment))
        tau = np.zeros(self.nv)
        own = slice(first + 12, first + 12 + self.motors)
        tau[6:], out[own] = self.drive(q, v, local, x[own])
        a = pin.aba(self.model, self.data, q, local, tau, forces)
        w, quaternion = local[3:6], pin.Quaternion(q[3:7])
        turned = (quaternion * pin.Quaternion(0.0, *w)).coeffs()
        out[:3] = v[:3]
        out[3:7] = 0.5 * np.sqrt(squared) * turned + x[3:7] * (1 - squared)
        out[7:self.nq] = v[6:]
        out[self.nq:first] = np.concatenate([R @ (a[:3] + np.cross(w, local[:3])), R @ a[3:6], a[6:]])
        return out
