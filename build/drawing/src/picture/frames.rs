//! Frames of links, drawn over a picture.
//!
//! Axes inside a robot would be hidden by it, so they are a picture of their own, from the same
//! camera, that is laid over the robot's.

use super::look::Picture;
use crate::scene::{Drawn, Head, Scene, Shape};
use urdf2fmu_core::spatial::{Vec3, quaternion_from_rotation, rotation_to_axis};

/// Length and radius of an axis, as parts of the largest extent of what is shown.
const AXIS: [f64; 2] = [0.12, 0.005];

/// x, y, z: red, green, blue, in sRGB.
const COLORS: [[f64; 4]; 3] = [
    [0.93, 0.13, 0.13, 1.0],
    [0.05, 0.70, 0.12, 1.0],
    [0.10, 0.30, 1.0, 1.0],
];

/// The axes of the base's frame and of those of all links that move, as a scene of its own with the
/// same links. The frames of welded links would only hide these.
///
/// - `size`: largest extent of what is shown, m
pub(super) fn axes(head: &Head, size: f64) -> Scene {
    let [length, radius] = AXIS.map(|part| part * size);
    let moving = head.joints.iter().filter(|joint| !joint.motions.is_empty());
    let bases = head.roots.iter().map(|root| root.link);
    let links = bases.chain(moving.map(|joint| joint.child));
    let axis = |link, i| {
        let axis = Vec3::ith(i, 1.0);
        let q = quaternion_from_rotation(&rotation_to_axis(&axis));
        Drawn {
            link,
            position: (axis * (0.5 * length)).into(),
            orientation: [q.i, q.j, q.k, q.w],
            shape: Shape::Cylinder([radius, length]),
            scale: None,
            color: COLORS[i],
            texture: None,
        }
    };
    let axes = links.flat_map(|link| [0, 1, 2].map(|i| axis(link, i)));
    Scene {
        head: Head {
            visuals: axes.collect(),
            ties: Vec::new(),
            meshes: Vec::new(),
            textures: Vec::new(),
            ..head.clone()
        },
        body: Vec::new(),
    }
}

/// Lays a picture over another of the same size.
pub(super) fn lay_over(picture: &mut Picture, over: &Picture) {
    for (below, above) in picture.pixels.iter_mut().zip(&over.pixels) {
        *below = laid(*below, *above);
    }
}

/// A pixel over another, both sRGB with alpha.
fn laid(below: [u8; 4], above: [u8; 4]) -> [u8; 4] {
    let [under, over] = [below, above].map(|pixel| f32::from(pixel[3]) / 255.0);
    let rest = under * (1.0 - over);
    let alpha = over + rest;
    if alpha <= 0.0 {
        return below;
    }
    let mut pixel = [0; 4];
    for (i, x) in pixel.iter_mut().enumerate() {
        let mixed = if i == 3 {
            alpha * 255.0
        } else {
            (f32::from(above[i]) * over + f32::from(below[i]) * rest) / alpha
        };
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 … 255"
        )]
        let byte = (mixed + 0.5) as u8;
        *x = byte;
    }
    pixel
}

#[cfg(test)]
mod tests {
    use super::laid;

    #[test]
    fn a_pixel_covers_another_as_far_as_its_alpha_says() {
        let red = [200, 0, 0, 255];
        assert_eq!(laid(red, [9, 9, 9, 0]), red);
        assert_eq!(laid(red, [0, 0, 80, 255]), [0, 0, 80, 255]);
        assert_eq!(laid([0; 4], [0, 40, 0, 128]), [0, 40, 0, 128]);
        // Half of each: 128/255 of 100 and 127/255 of 200.
        assert_eq!(laid(red, [100, 0, 0, 128]), [150, 0, 0, 255]);
        assert_eq!(laid([0; 4], [7, 7, 7, 0]), [0; 4]);
    }
}
