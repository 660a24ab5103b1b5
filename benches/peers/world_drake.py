"""A world in Drake: discrete, SAP; contact in one point a pair with its default compliance, or hydroelastic."""

import time

import numpy as np
from pydrake.geometry import (AddCompliantHydroelasticProperties, AddContactMaterial, AddRigidHydroelasticProperties,
                              Box, Cylinder, HalfSpace, ProximityProperties, Sphere)
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.plant import AddMultibodyPlant, CoulombFriction, MultibodyPlantConfig
from pydrake.multibody.tree import FixedOffsetFrame, PdControllerGains, PrismaticJoint, SpatialInertia, UnitInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from drake_scene import Drake as Robots
from world import RATE, Samples

SHAPES = {"box": Box, "sphere": Sphere, "cylinder": Cylinder}


# Pa, of an area of contact, which sinks in by a length of the size of the body: some 0.01 mm under cubes of 1 kg.
MODULUS = 1e7


class Drake:
    """`step` in s; `areas`: hydroelastic contact."""

    def __init__(self, world, step, areas=False):
        self.world, self.rows, self.areas = world, world.rows(), areas
        builder = DiagramBuilder()
        config = MultibodyPlantConfig(time_step=step, discrete_contact_approximation="sap",
                                      contact_model="hydroelastic" if areas else "point")
        self.plant, _ = AddMultibodyPlant(config, builder)
        plant = self.plant
        if world.ground:
            properties = self.material(world.friction)
            if areas:
                AddRigidHydroelasticProperties(properties)
            plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform(), HalfSpace(), "ground", properties)
        self.free = {}
        for body in world.bodies:
            if body.mass:
                self.free[body.name] = self.body(body)
            else:
                self.shape(plant.world_body(), body, RigidTransform(RollPitchYaw(body.rpy), body.xyz))
        made = {"": (plant.world_body(), np.zeros(3))}
        self.slides = []
        for slide in world.slides:
            element = self.body(slide.body)
            parent, origin = made[slide.parent]
            offset = RigidTransform(np.array(slide.body.xyz) - origin)
            frame = plant.AddFrame(FixedOffsetFrame(slide.body.name + "_start", parent.body_frame(), offset))
            joint = plant.AddJoint(PrismaticJoint(slide.body.name, frame, element.body_frame(), slide.axis))
            made[slide.body.name] = element, np.array(slide.body.xyz)
            actuator = plant.AddJointActuator(slide.body.name, joint, world.limit)
            if world.kp:
                actuator.set_controller_gains(PdControllerGains(p=world.kp, d=world.kd))
            self.slides.append(joint)
        plant.Finalize()
        self.simulator = Simulator(builder.Build())
        self.context = self.simulator.get_mutable_context()
        self.plant_context = plant.GetMyMutableContextFromRoot(self.context)
        if world.slides:
            # The order of the inputs is that of the actuators, which is that of the slides.
            model = self.slides[0].model_instance()
            self.port = plant.get_desired_state_input_port(model) if world.kp else plant.get_actuation_input_port()

    def body(self, body):
        """With its shape."""
        mass, (x, y, z) = body.mass, body.inertia() / body.mass
        element = self.plant.AddRigidBody(body.name, SpatialInertia(mass, np.zeros(3), UnitInertia(x, y, z)))
        self.shape(element, body, RigidTransform())
        return element

    def material(self, mu):
        """Friction and, by way of dissipation, restitution."""
        properties = ProximityProperties()
        dissipation = Robots.dissipation(self.world) if self.world.restitution else None
        AddContactMaterial(dissipation=dissipation, friction=CoulombFriction(mu, mu), properties=properties)
        return properties

    def shape(self, element, body, pose):
        """The one of a body."""
        properties = self.material(0.0 if body.smooth else self.world.friction)
        if self.areas:
            AddCompliantHydroelasticProperties(0.2 * min(body.size), MODULUS, properties)
        self.plant.RegisterCollisionGeometry(element, pose, SHAPES[body.kind](*body.size), body.name, properties)

    def reset(self):
        """To the start."""
        plant, context = self.plant, self.plant_context
        self.context.SetTime(0.0)
        plant.SetPositions(context, plant.GetPositions(plant.CreateDefaultContext()))
        plant.SetVelocities(context, np.zeros(plant.num_velocities()))
        for body in self.world.moving():
            pose = RigidTransform(RollPitchYaw(body.rpy), body.xyz)
            plant.SetFloatingBaseBodyPoseInWorldFrame(context, self.free[body.name], pose)
            plant.SetFreeBodySpatialVelocity(context=context, body=self.free[body.name],
                                             V_JpJc=SpatialVelocity(body.spin, body.velocity))
        self.command(0)
        self.simulator.Initialize()

    def command(self, i):
        """Row `i`: desired positions, then velocities; or forces."""
        if self.slides:
            row = self.rows[i]
            self.port.FixValue(self.plant_context, np.concatenate([row, 0 * row]) if self.world.kp else row)

    def sample(self):
        """Poses and places."""
        plant, context, poses = self.plant, self.plant_context, []
        for element in self.free.values():
            pose = plant.EvalBodyPoseInWorld(context, element)
            poses.append([*pose.translation(), *pose.rotation().ToQuaternion().wxyz()])
        return poses, [joint.get_translation(context) for joint in self.slides]

    def run(self):
        """CPU seconds, samples."""
        self.reset()
        clock, taken, out = time.thread_time, 0.0, [self.sample()]
        for i in range(len(self.rows)):
            start = clock()
            self.command(i)
            self.simulator.AdvanceTo((i + 1) / RATE)
            taken += clock() - start
            out.append(self.sample())
        poses, slides = zip(*out)
        return taken, Samples(np.array(poses), np.array(slides))
