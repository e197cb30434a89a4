//! The frames of a sequence: the camera goes aside and up, and things move.

use super::steadiness::{FrameChanges, Steadiness};
use crate::eval::rivals::Rival;
use anyhow::Result;
use deepshade_dataset::StagedScene;
use deepshade_dataset::testset::FrameRecord;
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::method::{Frame, Repeats};
use deepshade_render::metrics::exposed;
use deepshade_render::path::{Goal, Shot, Truth};
use deepshade_render::scene::Camera;
use deepshade_render::screen::reprojection::ReprojectionParameters;
use deepshade_render::screen::reprojection::reference::{Two, mixed, since};
use deepshade_shaders::{Attribute, Effect, GBuffer, Planes, lists};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// By how many pixels surfaces at the median depth move from a frame to the next as the camera does, to the
/// left and down. They are no whole numbers, so that edges fall elsewhere between samples in each frame.
pub(super) const STEP: [f32; 2] = [1.37, 0.61];
/// By how many pixels things move from a frame to the next, least and most.
pub(super) const THINGS: [f32; 2] = [1.0, 4.0];
/// Samples of truth: flicker is known without its noise.
const SAMPLES: u32 = 64;

/// Who is measured.
#[derive(Clone, Copy)]
pub(super) struct Measured<'a> {
    pub effect: Effect,
    pub rivals: &'a [Rival],
    /// Whether the methods' images are also mixed with those of the frames before.
    pub temporal: bool,
}

/// A sequence.
pub(super) struct Sequence<'a> {
    of: Measured<'a>,
    record: &'a FrameRecord,
    staged: &'a StagedScene<'a>,
    /// As the frame shows it.
    scene: &'a TracedScene,
    /// How far every vertex of every mesh goes from a frame to the next.
    ways: Vec<Vec<Vec3>>,
    /// How large a pixel is at the median depth of what is seen, metres.
    pixel: f32,
}

/// A frame of a sequence.
pub(super) struct Moment {
    camera: Camera,
    surfaces: Surfaces,
    /// The methods' images as shares of white, then those that are mixed with the frames before.
    pub methods: Vec<Planes>,
    /// The methods' images with random numbers of this frame's own, where they are mixed with the frames
    /// before: the mean is calmer than each.
    mixed_in: Vec<Planes>,
    /// Two halves of truth.
    pub truth: [Planes; 2],
    /// Of all of its samples.
    pub truth_mean: Planes,
}

/// What a camera sees of surfaces.
struct Surfaces {
    seen: Vec<bool>,
    /// In camera space, `[3, height, width]`.
    positions: Planes,
    /// How far what each pixel shows has gone since the frame before, metres in world space.
    gone: Vec<Vec3>,
}

impl<'a> Sequence<'a> {
    /// That of a frame of a test set, in a scene as the frame shows it; none where no surface is seen.
    pub(super) fn new(
        of: Measured<'a>,
        record: &'a FrameRecord,
        staged: &'a StagedScene<'a>,
        scene: &'a TracedScene,
    ) -> Option<Self> {
        let camera = &record.camera;
        let depths = depths_of(scene, camera, staged.size(record.seed));
        let [height, _] = staged.size(record.seed);
        let pixel =
            (!depths.is_empty()).then(|| lists::median(depths) as f32 / camera.focal_length(height))?;
        let ways = staged.ways(scene, camera, THINGS, record.seed);
        Some(Self { of, record, staged, scene, ways, pixel })
    }

    /// How steady each method is in so many frames, then the same of the mixed images, and truth's own
    /// change; none where no surface stays in sight.
    ///
    /// # Errors
    /// As [`moment`](Self::moment).
    pub(super) fn steadiness(&self, frames: usize) -> Result<Option<(Vec<Steadiness>, f64)>> {
        let mut before = self.mixed(self.moment(0)?, None);
        let mut since_before_that = before.since(&before);
        let mut all = Vec::new();
        for step in 1..frames {
            let now = self.moment(step)?;
            let since_before = now.since(&before);
            let two = Two { since_before: &since_before, since_before_that: &since_before_that };
            let now = self.mixed(now, Some((&before, two)));
            all.push(FrameChanges::of(two, &now, &before));
            (before, since_before_that) = (now, since_before);
        }
        Ok(Steadiness::of(&all).zip(Steadiness::own_change(&all)))
    }

    /// A frame, with the mixed images where they are asked for.
    fn mixed(&self, moment: Moment, before: Option<(&Moment, Two<'_>)>) -> Moment {
        if self.of.temporal { moment.mixed_with(before) } else { moment }
    }

    /// The frame after so many steps. What is random in methods stays the same, as it does in the estimates
    /// of networks, but in images that are mixed with the frames before.
    ///
    /// # Errors
    /// If things leave what can be traced, or a method fails.
    fn moment(&self, step: usize) -> Result<Moment> {
        let Self { of: Measured { effect, rivals, .. }, record, .. } = *self;
        let aside = Vec3::new(STEP[0], STEP[1], 0.0) * (self.pixel * step as f32);
        let camera =
            Camera { position: record.camera.position + record.camera.rotation * aside, ..record.camera };
        let scene = &self.scene_after(step)?;
        let gbuffer = self.staged.gbuffer(scene, &camera, record.seed);
        let frame =
            Frame { scene, camera: &camera, gbuffer: &gbuffer, radius: record.radius, seed: record.seed };
        let shown = |image: &Planes| exposed(image, record.exposure);
        let shaded = |seed| -> Result<Vec<Planes>> {
            let frame = Frame { seed, ..frame };
            let shade = |rival: &Rival| Ok(shown(&rival.method.shade(&frame, Repeats::ONCE)?.image));
            rivals.iter().map(shade).collect()
        };
        let methods = shaded(record.seed)?;
        let seed = record.seed.wrapping_add(step as u32);
        let mixed_in = if self.of.temporal { shaded(seed)? } else { Vec::new() };
        let size = [gbuffer.height(), gbuffer.width()];
        let shot = Shot::new(scene, &camera, size, record.radius);
        let truth = Truth::render(effect, &shot, Goal::samples(SAMPLES), seed, |_, _| true);
        let truth_mean = shown(&truth.estimate.mean);
        let truth = truth.halves.map(|half| shown(&half));
        let surfaces = self.surfaces(scene, &camera, size)?;
        Ok(Moment { camera, surfaces, methods, mixed_in, truth, truth_mean })
    }

    /// The scene with things moved by so many steps.
    fn scene_after(&self, step: usize) -> Result<TracedScene> {
        let mut scene = self.scene.scene().clone();
        for (mesh, ways) in scene.meshes.iter_mut().zip(&self.ways) {
            let moved = mesh.positions.iter_mut().zip(ways);
            moved.for_each(|(position, way)| *position += step as f32 * *way);
        }
        Ok(TracedScene::new(scene)?)
    }

    fn surfaces(&self, scene: &TracedScene, camera: &Camera, size: [usize; 2]) -> Result<Surfaces> {
        let [height, width] = size;
        let all = geometry(scene, camera, size);
        let seen = all.seen()?;
        let ways = &self.ways;
        let gone = |at: usize| {
            let pixel = Vec2::new((at % width) as f32 + 0.5, (at / width) as f32 + 0.5);
            let hit = scene.hit(camera.position, camera.direction(pixel, height, width), f32::INFINITY);
            hit.filter(|hit| seen[at] && !ways[hit.mesh as usize].is_empty()).map_or(Vec3::ZERO, |hit| {
                let ways = &ways[hit.mesh as usize];
                let triangle = scene.scene().meshes[hit.mesh as usize].triangles[hit.triangle as usize];
                let [a, b, c] = triangle.map(|vertex| ways[vertex as usize]);
                a + hit.barycentric.x * (b - a) + hit.barycentric.y * (c - a)
            })
        };
        let gone = (0..height * width).into_par_iter().map(gone).collect();
        Ok(Surfaces { positions: all.select(&[Attribute::Position])?, gone, seen })
    }
}

fn geometry(scene: &TracedScene, camera: &Camera, [height, width]: [usize; 2]) -> GBuffer {
    gbuffer::render(scene, camera, height, width, &[Attribute::Position, Attribute::Depth, Attribute::Valid])
}

fn depths_of(scene: &TracedScene, camera: &Camera, size: [usize; 2]) -> Vec<f64> {
    let seen = geometry(scene, camera, size);
    let depths = seen.select(&[Attribute::Depth]).map(|depths| depths.data().to_vec()).unwrap_or_default();
    depths.into_iter().filter(|depth| *depth > 0.0).map(f64::from).collect()
}

impl Moment {
    /// What has moved since the frame of a camera before.
    pub(super) fn since(&self, before: &Self) -> Planes {
        let Surfaces { seen, positions, gone } = &self.surfaces;
        since(positions, seen, gone, &self.camera, &before.camera)
    }

    /// The same image, and after it the methods' images mixed with those of the frame before.
    fn mixed_with(mut self, before: Option<(&Self, Two<'_>)>) -> Self {
        let [height, width] = [self.truth[0].height(), self.truth[0].width()];
        let mixing = ReprojectionParameters::default().uniform(height, width, false);
        let plain = self.methods.len();
        let mix = |method: usize| match before {
            Some((before, two)) => {
                mixed(two, &self.mixed_in[method], &before.methods[plain + method], &mixing)
            }
            None => self.mixed_in[method].clone(),
        };
        let more: Vec<Planes> = (0..plain).map(mix).collect();
        self.methods.extend(more);
        self
    }

    /// Which pixels show what has moved since the frame before.
    pub(super) fn moves(&self) -> Vec<bool> {
        self.surfaces.gone.iter().map(|gone| *gone != Vec3::ZERO).collect()
    }

    pub(super) fn seen(&self) -> &[bool] {
        &self.surfaces.seen
    }

    pub(super) const fn width(&self) -> usize {
        self.surfaces.positions.width()
    }
}
