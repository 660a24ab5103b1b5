//! Checked tags → typed robot, by way of urdf-rs.
//!
//! urdf-rs reads a document written from what was checked, with every default filled in: it sees no tag
//! that it would refuse, and the robot is typed by a reader that others use too. Whether something was given
//! at all (`<inertial>`, `<limit>`) is known from the check.

use super::joint::CheckedJoint;
use super::link::{CheckedCollision, CheckedInertial, Geometry};
use super::tree::{CheckedRobot, Order};
use super::xml::is_unprintable;
use crate::model::JointKind;
use crate::spatial::Vec3;
use quick_xml::escape::escape;
use std::fmt::Write as _;

/// The robot as urdf-rs has it: links and joints in `order`.
pub(super) fn read(robot: &CheckedRobot, order: &Order) -> urdf_rs::Result<urdf_rs::Robot> {
    urdf_rs::read_from_string(&document(robot, order))
}

/// A URDF that says everything once. Writing to a string cannot fail, hence the ignored results.
fn document(robot: &CheckedRobot, order: &Order) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "<robot name=\"{}\">", escape(robot.name.as_str()));
    for &i in &order.links {
        let link = &robot.links[i];
        let _ = writeln!(out, "<link name=\"{}\">", escape(link.name));
        if let Some(inertial) = &link.inertial {
            write_inertial(&mut out, inertial);
        }
        for collision in &link.collisions {
            write_collision(&mut out, collision);
        }
        out.push_str("</link>\n");
    }
    for &j in &order.joints {
        write_joint(&mut out, &robot.joints[j]);
    }
    out.push_str("</robot>\n");
    out
}

fn write_origin(out: &mut String, xyz: &Vec3, rpy: &Vec3) {
    let _ = writeln!(
        out,
        "<origin xyz=\"{} {} {}\" rpy=\"{} {} {}\"/>",
        xyz.x, xyz.y, xyz.z, rpy.x, rpy.y, rpy.z
    );
}

fn write_inertial(out: &mut String, inertial: &CheckedInertial) {
    let [ixx, ixy, ixz, iyy, iyz, izz] = inertial.inertia;
    out.push_str("<inertial>");
    write_origin(out, &inertial.xyz, &inertial.rpy);
    let _ = writeln!(
        out,
        "<mass value=\"{}\"/><inertia ixx=\"{ixx}\" ixy=\"{ixy}\" ixz=\"{ixz}\" iyy=\"{iyy}\" iyz=\"{iyz}\" izz=\"{izz}\"/></inertial>",
        inertial.mass
    );
}

fn write_collision(out: &mut String, collision: &CheckedCollision) {
    out.push_str("<collision>");
    write_origin(out, &collision.xyz, &collision.rpy);
    out.push_str("<geometry>");
    let _ = match &collision.geometry {
        Geometry::Box { size: [x, y, z] } => write!(out, "<box size=\"{x} {y} {z}\"/>"),
        Geometry::Cylinder { radius, length } => {
            write!(out, "<cylinder radius=\"{radius}\" length=\"{length}\"/>")
        }
        Geometry::Capsule { radius, length } => {
            write!(out, "<capsule radius=\"{radius}\" length=\"{length}\"/>")
        }
        Geometry::Sphere { radius } => write!(out, "<sphere radius=\"{radius}\"/>"),
        Geometry::Mesh {
            filename,
            scale: [x, y, z],
            ..
        } => write!(
            out,
            "<mesh filename=\"{}\" scale=\"{x} {y} {z}\"/>",
            // Only its place in the list counts: the mesh has been read.
            escape(filename.replace(is_unprintable, " "))
        ),
    };
    out.push_str("</geometry></collision>\n");
}

fn write_joint(out: &mut String, joint: &CheckedJoint) {
    let kind = match joint.kind {
        JointKind::Fixed => "fixed",
        JointKind::Revolute => "revolute",
        JointKind::Continuous => "continuous",
        JointKind::Prismatic => "prismatic",
        JointKind::Planar => "planar",
        JointKind::Floating => "floating",
        JointKind::Spherical => "spherical",
    };
    let name = |reference: &Option<super::joint::LinkReference>| {
        escape(reference.as_ref().map_or("", |r| r.name)).into_owned()
    };
    let _ = writeln!(
        out,
        "<joint name=\"{}\" type=\"{kind}\"><parent link=\"{}\"/><child link=\"{}\"/>",
        escape(joint.name),
        name(&joint.parent),
        name(&joint.child)
    );
    write_origin(out, &joint.xyz, &joint.rpy);
    let axis = joint.axis;
    let (lower, upper) = joint.limits.unwrap_or((0.0, 0.0));
    let _ = writeln!(
        out,
        "<axis xyz=\"{} {} {}\"/><limit lower=\"{lower}\" upper=\"{upper}\" effort=\"{}\" velocity=\"{}\"/>",
        axis.x,
        axis.y,
        axis.z,
        joint.effort.unwrap_or(0.0),
        joint.velocity.unwrap_or(0.0)
    );
    let _ = writeln!(
        out,
        "<dynamics damping=\"{}\" friction=\"{}\"/>",
        joint.damping, joint.friction
    );
    if let Some(mimic) = &joint.mimic {
        let _ = writeln!(
            out,
            "<mimic joint=\"{}\" multiplier=\"{}\" offset=\"{}\"/>",
            escape(mimic.joint),
            mimic.multiplier,
            mimic.offset
        );
    }
    out.push_str("</joint>\n");
}
