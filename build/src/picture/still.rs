//! One picture.

use super::camera::Camera;
use super::light::Lights;
use super::look::{Look, Picture, SAMPLES, Theme};
use super::raster::{self, Layer};
use super::shade::{self, Seen};
use super::solid::Stage;
use crate::scene::Scene;
use urdf2fmu_core::spatial::Pose;

/// A picture of a scene whose links have these poses, and the camera that took it.
pub fn still(scene: &Scene, poses: &[Pose], look: &Look) -> (Picture, Camera) {
    let stage = Stage::new(scene);
    let camera = Camera::fit(&stage.corners(poses), look);
    let picture = draw(&stage, poses, &camera, look, scene.head.ground);
    (picture, camera)
}

/// - `ground`: whether there is a floor
pub(super) fn draw(
    stage: &Stage,
    poses: &[Pose],
    camera: &Camera,
    look: &Look,
    ground: bool,
) -> Picture {
    let triangles = stage.triangles(poses);
    let lights = Lights::new(stage, &triangles, camera, look);
    let corners = raster::project(&triangles, |p| camera.project(p, SAMPLES));
    let (width, height) = (look.width * SAMPLES, look.height * SAMPLES);
    let layer = Layer::new(stage, &triangles, &corners, width, height);
    shade::picture(&Seen {
        stage,
        triangles: &triangles,
        layer: &layer,
        lights: &lights,
        camera,
        look,
        floor: ground && look.theme != Theme::Cutout,
    })
}
