//! One picture, and those of an FMU.

use super::camera::Camera;
use super::frames;
use super::light::Lights;
use super::look::{Look, Picture, SAMPLES, Theme};
use super::png::{encode, while_drawn};
use super::raster::Layer;
use super::shade::{self, Seen};
use super::solid::{Stage, World};
use crate::scene::{self, Scene};
use urdf2fmu_core::parallel;
use urdf2fmu_core::spatial::Pose;

/// Pictures in an FMU: what importers show for it, FMI 3's icon, and one for the documentation;
/// with their sides in pixels, and whether they show the frames of links.
const ALL: [(&str, usize, bool); 3] = [
    ("model.png", 512, false),
    ("terminalsAndIcons/icon.png", 128, false),
    ("documentation/frames.png", 512, true),
];

/// Names and contents of the pictures in a robot's FMU, which show it as it starts.
pub fn all(scene: &Scene) -> impl Iterator<Item = (&'static str, Vec<u8>)> {
    let poses = scene::link_poses(&scene.head, |_| None);
    ALL.into_iter().map(move |(name, side, frames)| {
        let look = Look {
            width: side,
            height: side,
            frames,
            ..Look::default()
        };
        (name, still(scene, &poses, &look).0)
    })
}

/// A PNG of a scene whose links have these poses, and the camera that took it.
pub fn still(scene: &Scene, poses: &[Pose], look: &Look) -> (Vec<u8>, Camera) {
    let stage = Stage::new(scene);
    let fit = || Camera::fit(stage.corners(poses), look);
    if look.frames {
        let camera = fit();
        let subject = Subject::new(scene, stage, &camera, look);
        return (encode(&subject.draw(poses, &camera, look)), camera);
    }
    let (camera, world) = parallel::both(fit, || World::new(&stage, poses));
    let clear = matches!(look.theme, Theme::Clear | Theme::Cutout);
    let png = while_drawn(look.width, clear, |writer| {
        draw(&world, &camera, look, scene.head.ground, |band, pixels| {
            writer.take(band, pixels);
        })
    });
    (png, camera)
}

/// What is drawn.
pub(super) struct Subject {
    stage: Stage,
    /// Axes of frames, drawn over the robot.
    axes: Option<Stage>,
    /// Whether there is a floor.
    ground: bool,
}

impl Subject {
    pub(super) fn new(scene: &Scene, stage: Stage, camera: &Camera, look: &Look) -> Self {
        let axes = || Stage::new(&frames::axes(&scene.head, camera.size));
        Self {
            stage,
            axes: look.frames.then(axes),
            ground: scene.head.ground,
        }
    }

    pub(super) fn draw(&self, poses: &[Pose], camera: &Camera, look: &Look) -> Picture {
        let nobody = |_: usize, _: &[[u8; 4]]| {};
        let world = World::new(&self.stage, poses);
        let mut picture = draw(&world, camera, look, self.ground, nobody);
        if let Some(axes) = &self.axes {
            let plain = Look {
                theme: Theme::Cutout,
                ..look.clone()
            };
            let axes = draw(&World::new(axes, poses), camera, &plain, false, nobody);
            frames::lay_over(&mut picture, &axes);
        }
        picture
    }
}

/// - `ground`: whether there is a floor
/// - `done`: see [`shade::picture`]
fn draw(
    world: &World,
    camera: &Camera,
    look: &Look,
    ground: bool,
    done: impl Fn(usize, &[[u8; 4]]) + Sync,
) -> Picture {
    let (width, height) = (look.width * SAMPLES, look.height * SAMPLES);
    // Each has parts that keep one thread busy; together these keep two busy.
    let (lights, layer) = parallel::both(
        || Lights::new(world, camera, look),
        || Layer::new(world, |p| camera.project(p, SAMPLES), width, height),
    );
    let seen = Seen {
        stage: world.stage,
        layer: &layer,
        lights: &lights,
        camera,
        look,
        floor: ground && look.theme != Theme::Cutout,
    };
    shade::picture(&seen, done)
}
