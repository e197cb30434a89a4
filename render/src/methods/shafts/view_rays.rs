//! The rays from the eye through the middles of pixels, each as far as it is in the medium.

use crate::gbuffer;
use crate::method::Frame;
use deepshade_shaders::{Attribute, GBuffer, shows_surface};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// View rays, row by row from the top left.
#[derive(Clone, Debug)]
pub struct ViewRays {
    /// Where all of them start, world space, metres.
    pub eye: Vec3,
    /// Unit vectors, world space.
    pub directions: Vec<Vec3>,
    /// From which distance to which each is in the medium before a surface, metres; two zeros where it is
    /// not.
    pub spans: Vec<[f32; 2]>,
    camera: crate::scene::Camera,
    height: usize,
    width: usize,
}

/// What is read of a g-buffer.
const WANTED: [Attribute; 2] = [Attribute::Depth, Attribute::Valid];

impl ViewRays {
    /// Those of a frame. Depths that its g-buffer lacks are traced.
    pub fn of(frame: &Frame<'_>) -> Self {
        let (height, width) = (frame.gbuffer.height(), frame.gbuffer.width());
        let distances = distances(frame.gbuffer, frame).unwrap_or_else(|| {
            let traced = gbuffer::render(frame.scene, frame.camera, height, width, &WANTED);
            distances(&traced, frame).expect("what was asked for")
        });
        Self::new(frame, [height, width], &distances)
    }

    fn new(frame: &Frame<'_>, [height, width]: [usize; 2], distances: &[f32]) -> Self {
        let camera = frame.camera;
        let density = frame.scene.scene().medium.as_ref().map(|medium| &medium.density);
        let ray = |i: usize| {
            let direction = camera.direction(middle(i, width), height, width);
            let span = density.and_then(|density| density.span(camera.position, direction, distances[i]));
            (direction, span.unwrap_or_default())
        };
        let (directions, spans) = (0..height * width).into_par_iter().map(ray).unzip();
        Self { eye: camera.position, directions, spans, camera: *camera, height, width }
    }

    /// How many there are.
    pub const fn count(&self) -> usize {
        self.height * self.width
    }

    /// Rows of the image.
    pub const fn height(&self) -> usize {
        self.height
    }

    /// Columns of the image.
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Where a ray is in the image, pixels from the top left corner.
    pub fn at(&self, ray: usize) -> Vec2 {
        middle(ray, self.width)
    }

    /// A world-space direction in camera space: x to the right, y up, z backwards.
    pub fn direction_to_camera(&self, direction: Vec3) -> Vec3 {
        self.camera.direction_to_camera(direction)
    }

    /// The unit direction through a point of the image, world space.
    pub fn direction(&self, at: Vec2) -> Vec3 {
        self.camera.direction(at, self.height, self.width)
    }

    /// The camera's focal length, pixels.
    pub fn focal_length(&self) -> f32 {
        self.camera.focal_length(self.height)
    }
}

/// The middle of a pixel.
fn middle(index: usize, width: usize) -> Vec2 {
    Vec2::new((index % width) as f32 + 0.5, (index / width) as f32 + 0.5)
}

/// How far each pixel's surface is from the eye, metres; infinite where none is seen. `None` if the g-buffer
/// does not say.
fn distances(gbuffer: &GBuffer, frame: &Frame<'_>) -> Option<Vec<f32>> {
    let planes = gbuffer.select(&WANTED).ok()?;
    let (depth, valid) = (planes.plane(0), planes.plane(1));
    let (height, width) = (gbuffer.height(), gbuffer.width());
    let distance = |i: usize| {
        let direction = frame.camera.direction(middle(i, width), height, width);
        let along = -frame.camera.direction_to_camera(direction).z;
        if shows_surface(valid[i]) { depth[i] / along } else { f32::INFINITY }
    };
    Some((0..height * width).map(distance).collect())
}
