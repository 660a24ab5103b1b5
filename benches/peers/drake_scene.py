"""A scene in Drake: SAP at fixed steps, or error-controlled CENIC."""

import time
import xml.etree.ElementTree as xml

import numpy as np
from pydrake.geometry import (AddContactMaterial, CollisionFilterDeclaration, GeometrySet, HalfSpace, ProximityProperties,
                              RoleAssign)
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlant, CoulombFriction, DiscreteContactApproximation, MultibodyPlantConfig
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.tree import PdControllerGains
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import DiagramBuilder

# The position gain that Drake wants beside that of velocity.
TINY = 1e-9


class Drake:
    """`step` > 0: SAP; `accuracy`: CENIC."""

    def __init__(self, scene, step=0.0, accuracy=0.0):
        self.scene, self.rows, self.cenic = scene, scene.rows(), accuracy > 0
        builder = DiagramBuilder()
        config = MultibodyPlantConfig(time_step=step, discrete_contact_approximation="sap", contact_model="point",
                                      penetration_allowance=scene.penetration)
        plant, graph = AddMultibodyPlant(config, builder)
        self.plant = plant
        urdf = xml.fromstring(scene.urdf)
        names = {a.joint for a in scene.actuators}
        for joint in urdf.findall("joint"):
            if joint.get("name") in names:
                limit = joint.find("limit")
                actuator = next(a for a in scene.actuators if a.joint == joint.get("name"))
                transmission = xml.SubElement(urdf, "transmission", {"name": joint.get("name") + "_drive"})
                xml.SubElement(transmission, "type").text = "transmission_interface/SimpleTransmission"
                element = xml.SubElement(transmission, "joint", {"name": joint.get("name")})
                xml.SubElement(element, "hardwareInterface").text = "EffortJointInterface"
                element = xml.SubElement(transmission, "actuator", {"name": joint.get("name")})
                xml.SubElement(element, "mechanicalReduction").text = "1"
                if limit is not None:
                    limit.set("effort", repr(actuator.limit))
                else:
                    joint.append(xml.Element("limit", {"effort": repr(actuator.limit), "velocity": "1e6"}))
        (model,) = Parser(plant).AddModelsFromString(xml.tostring(urdf, encoding="unicode"), ".urdf")
        mass = scene.mass()
        # The same static penetration as ours: a quarter of the weight a point. Two materials act in series.
        stiffness = 2 * mass * 9.81 / (4 * scene.penetration)
        dissipation = 51.0
        if scene.restitution > 0:
            dissipation = self.dissipation(scene)
        if scene.ground:
            properties = ProximityProperties()
            AddContactMaterial(dissipation, stiffness, CoulombFriction(scene.friction, scene.friction), properties)
            plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform(), HalfSpace(), "ground", properties)
        self.retune(plant, graph, model, scene, stiffness, dissipation)
        if not scene.floating and scene.root() != "world":
            plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(scene.root(), model))
        plant.mutable_gravity_field().set_gravity_vector([0, 0, -scene.gravity])
        for a in scene.actuators:
            actuator = plant.GetJointActuatorByName(a.joint, model)
            if a.kind == "pd":
                actuator.set_controller_gains(PdControllerGains(p=a.kp, d=a.kd))
            elif a.kind == "velocity":
                actuator.set_controller_gains(PdControllerGains(p=TINY, d=scene.servo))
        plant.Finalize()
        if scene.ground:
            # Contact with the ground only, as everywhere else.
            own = GeometrySet()
            for index in plant.GetBodyIndices(model):
                for geometry in plant.GetCollisionGeometriesForBody(plant.get_body(index)):
                    own.Add(geometry)
            graph.collision_filter_manager().Apply(CollisionFilterDeclaration().ExcludeWithin(own))
        diagram = builder.Build()
        self.simulator = Simulator(diagram)
        if accuracy > 0:
            ApplySimulatorConfig(SimulatorConfig(integration_scheme="cenic", accuracy=accuracy, max_step_size=0.1,
                                                 use_error_control=True), self.simulator)
        self.context = self.simulator.get_mutable_context()
        self.plant_context = plant.GetMyMutableContextFromRoot(self.context)
        self.model = model
        self.joints = [plant.GetJointByName(name, model) for name in scene.joint_names()]
        if scene.actuators:
            # The order of the input: by actuator.
            names = [plant.get_joint_actuator(i).joint().name() for i in plant.GetJointActuatorIndices(model)]
            self.order = [[a.joint for a in scene.actuators].index(name) for name in names]
            self.port = plant.get_desired_state_input_port(model)
        if scene.floating:
            body = plant.GetBodyByName(scene.root(), model)
            self.quaternion = body.floating_positions_start()
        self.places = [*(self.base_places(body) if scene.floating else []), *(j.position_start() for j in self.joints)]

    @staticmethod
    def base_places(body):
        """Positions hold quaternion (w, x, y, z), then translation."""
        start = body.floating_positions_start()
        return [start + 4, start + 5, start + 6, start, start + 1, start + 2, start + 3]

    @staticmethod
    def dissipation(scene):
        """Hunt–Crossley for the restitution at the speed of the first impact: a − ln(1+a) = −e a − ln(1−e a)."""
        e = scene.restitution
        low, high = 1e-9, 1 / e - 1e-12
        for _ in range(200):
            a = 0.5 * (low + high)
            if a - np.log1p(a) + e * a + np.log1p(-e * a) > 0:
                low = a
            else:
                high = a
        return a / scene.impact

    @staticmethod
    def retune(plant, graph, model, scene, stiffness, dissipation):
        """Materials of the robot's shapes."""
        for index in plant.GetBodyIndices(model):
            for geometry in plant.GetCollisionGeometriesForBody(plant.get_body(index)):
                properties = ProximityProperties()
                AddContactMaterial(dissipation, stiffness, CoulombFriction(scene.friction, scene.friction), properties)
                graph.AssignRole(plant.get_source_id(), geometry, properties, RoleAssign.kReplace)

    def reset(self):
        """To the start."""
        scene, plant, context = self.scene, self.plant, self.plant_context
        self.context.SetTime(0.0)
        positions, velocities = plant.GetPositions(context).copy(), np.zeros(plant.num_velocities())
        for joint in self.joints:
            value, rate = scene.joints.get(joint.name(), 0.0), scene.joint_velocities.get(joint.name(), 0.0)
            positions[joint.position_start()], velocities[joint.velocity_start()] = value, rate
        plant.SetPositions(context, positions)
        plant.SetVelocities(context, velocities)
        if scene.floating:
            body = plant.GetBodyByName(scene.root(), self.model)
            plant.SetFloatingBaseBodyPoseInWorldFrame(context, body, RigidTransform(RollPitchYaw(scene.rpy), scene.position))
            plant.SetFreeBodySpatialVelocity(context=context, body=body, V_JpJc=SpatialVelocity(scene.spin, scene.velocity))
        self.command(0)
        self.simulator.Initialize()

    def command(self, i):
        """Row `i` into the desired states: positions, then velocities."""
        if not self.scene.actuators:
            return
        row = np.array(self.rows[i])[self.order]
        kind = self.scene.actuators[0].kind
        if self.cenic:
            # Drake 1.51 takes CENIC's desired velocities with the wrong sign: a motor told 10 rad/s turns at −10.
            row = -row if kind == "velocity" else row
        zero = np.zeros(len(row))
        self.port.FixValue(self.plant_context, np.concatenate([row, zero] if kind == "pd" else [zero, row]))

    def run(self):
        """CPU seconds, samples."""
        self.reset()
        plant, context, clock = self.plant, self.plant_context, time.process_time
        samples, taken = [plant.GetPositions(context)[self.places]], 0.0
        for i in range(len(self.rows)):
            start = clock()
            if i and self.scene.actuators:
                self.command(i)
            self.simulator.AdvanceTo((i + 1) / self.scene.rate)
            taken += clock() - start
            samples.append(plant.GetPositions(context)[self.places])
        return taken, np.array(samples)
