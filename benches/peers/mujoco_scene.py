"""A scene in MuJoCo."""

import time
import xml.etree.ElementTree as xml

import mujoco
import numpy as np

from scene import quaternion, rotation


class MuJoCo:
    """`integrator`: Euler, implicitfast or RK4. `stiff`: elliptic cone, impratio 10, contacts as stiff as the step allows."""

    def __init__(self, scene, integrator, step, stiff=False):
        urdf = xml.fromstring(scene.urdf)
        extension = xml.SubElement(urdf, "mujoco")
        xml.SubElement(extension, "compiler", {"discardvisual": "true", "fusestatic": "true", "balanceinertia": "true"})
        spec = mujoco.MjSpec.from_string(xml.tostring(urdf, encoding="unicode"))
        spec.option.timestep = step
        spec.option.gravity = [0, 0, -scene.gravity]
        spec.option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
        if stiff:
            spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
            spec.option.impratio = 10
        if scene.floating:
            spec.body(scene.root()).add_freejoint()
        for geom in spec.geoms:
            geom.contype, geom.conaffinity = 0, 1
            geom.friction[0] = scene.friction
            self.contact(geom, scene, step, stiff)
        if scene.ground:
            plane = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], contype=1, conaffinity=0)
            plane.friction[0] = scene.friction
            self.contact(plane, scene, step, stiff)
        for a in scene.actuators:
            actuator = spec.add_actuator(name=a.joint, target=a.joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            actuator.forcelimited = True
            actuator.forcerange = [-a.limit, a.limit]
            if a.kind == "effort":
                continue
            actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
            if a.kind == "pd":
                actuator.gainprm[0], actuator.biasprm[1], actuator.biasprm[2] = a.kp, -a.kp, -a.kd
            elif integrator == "Euler" and not scene.saturates:
                # Actuators are explicit here, joint damping is implicit: the servo as damper and torque, without limit.
                actuator.gainprm[0], actuator.forcelimited = scene.servo, False
                spec.joint(a.joint).damping[0] += scene.servo
            else:
                # Where actuators are explicit: no gain above what is stable at this step.
                gain = scene.servo
                if integrator != "implicitfast":
                    gain = min(gain, 0.5 * self.servo_inertia(scene, a.joint) / step)
                actuator.gainprm[0], actuator.biasprm[2] = gain, -gain
        self.scene, self.step, self.rows = scene, step, scene.rows()
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.per_row = round(1 / scene.rate / step)
        model = self.model
        joints = [model.joint(name) for name in scene.joint_names()]
        self.places = np.array(([*range(7)] if scene.floating else []) + [j.qposadr[0] for j in joints], dtype=int)
        mujoco.mj_resetData(model, self.data)
        if scene.floating:
            # A free joint's linear velocity is in world axes, its angular velocity in its own.
            self.data.qpos[:7] = [*scene.position, *quaternion(scene.rpy)]
            self.data.qvel[:6] = [*scene.velocity, *(rotation(scene.rpy).T @ np.array(scene.spin))]
        for name, value in scene.joints.items():
            self.data.qpos[model.joint(name).qposadr[0]] = value
        for name, value in scene.joint_velocities.items():
            self.data.qvel[model.joint(name).dofadr[0]] = value
        self.start = self.data.qpos.copy(), self.data.qvel.copy()

    @staticmethod
    def contact(geom, scene, step, stiff):
        """Restitution as the damping ratio of a linear spring–damper; `stiff`: a time constant of two steps."""
        if scene.restitution > 0:
            log = np.log(scene.restitution)
            ratio = -log / np.hypot(np.pi, log)
            # A time constant τ and ratio ζ mean stiffness 1/(τζ)² per mass; the half period is six steps.
            omega = np.pi / (6 * step) if stiff else np.pi / 0.02
            geom.solref = [-omega**2, -2 * ratio * omega]
            geom.solimp = [0.95, 0.95, 0.001, 0.5, 2]
        elif stiff:
            geom.solref = [2 * step, 1]

    @staticmethod
    def servo_inertia(scene, joint):
        """Inertia of a joint's child link about its axis, kg·m²: of its own centre, the least there can be."""
        tree = xml.fromstring(scene.urdf)
        element = next(j for j in tree.findall("joint") if j.get("name") == joint)
        link = next(l for l in tree.findall("link") if l.get("name") == element.find("child").get("link"))
        inertia = link.find("inertial/inertia")
        return 1e-4 if inertia is None else min(float(inertia.get(k)) for k in ("ixx", "iyy", "izz"))

    def run(self):
        """CPU seconds, samples."""
        model, data, rows, places = self.model, self.data, self.rows, self.places
        mujoco.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = self.start
        samples = np.empty((len(rows) + 1, len(places)))
        samples[0] = data.qpos[places]
        ctrl, qpos, n, step = data.ctrl, data.qpos, self.per_row, mujoco.mj_step
        clock = time.process_time
        start = clock()
        if ctrl.size:
            for i, row in enumerate(rows):
                ctrl[:] = row
                step(model, data, n)
                samples[i + 1] = qpos[places]
        else:
            for i in range(len(rows)):
                step(model, data, n)
                samples[i + 1] = qpos[places]
        taken = clock() - start
        return taken - self.overhead(), samples

    def overhead(self):
        """Seconds of CPU that Python takes for a run's loop without a single step in it."""
        model, data, rows, places = self.model, self.data, self.rows, self.places
        ctrl, qpos, step = data.ctrl, data.qpos, mujoco.mj_step
        samples = np.empty((len(rows) + 1, len(places)))
        start = time.process_time()
        for i, row in enumerate(rows):
            if ctrl.size:
                ctrl[:] = row
            step(model, data, 0)
            samples[i + 1] = qpos[places]
        return time.process_time() - start

    def error(self):
        """What MuJoCo warned of: a run that went unstable is none."""
        return any(w.number for w in self.data.warning)
