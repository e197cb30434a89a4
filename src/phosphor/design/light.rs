//! Places on a scene's surfaces, and the light that they get from frame to frame: that of lamps, with
//! shadows, wherever things are in that frame.

use super::task::Task;
use anyhow::{Context, Result, ensure};
#[cfg(feature = "view")]
use deepshade_render::bvh::corner_weights;
use deepshade_render::bvh::{Hit, TracedScene};
use deepshade_render::intersection::SurfacePoint;
use deepshade_render::nearest::nearest_in_triangle;
use deepshade_render::path::phosphor::{Afterglow, ReceivingPoint};
use deepshade_render::scene::glow::{Glow, Schedule, Start};
use deepshade_render::scene::{AnimatedScene, Mesh, Scene};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;
use std::sync::Arc;

/// How far from a surface a place may be, over the scene's diagonal.
const NEAR: f32 = 0.05;

/// A place on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Spot {
    pub mesh: usize,
    pub triangle: usize,
    /// Of the triangle's corners.
    pub weights: [f32; 3],
    /// World space, metres, in the first frame.
    pub position: Vec3,
    /// Number of its material.
    pub material: usize,
}

impl Spot {
    /// Where a ray met a scene.
    #[cfg(feature = "view")]
    pub fn of(scene: &Scene, hit: &Hit) -> Self {
        let (mesh, triangle) = (hit.mesh as usize, hit.triangle as usize);
        let (its, weights) = (&scene.meshes[mesh], corner_weights(hit.barycentric));
        let spot = Self { mesh, triangle, weights, position: Vec3::ZERO, material: its.material.0 as usize };
        Self { position: spot.position_in(scene), ..spot }
    }

    /// Where it is in a pose of the scene, metres.
    #[cfg(feature = "view")]
    pub fn position_in(&self, scene: &Scene) -> Vec3 {
        self.between(scene.meshes[self.mesh].corners(self.triangle))
    }

    /// Where it is between its triangle's corners.
    #[cfg(feature = "view")]
    pub fn between(&self, corners: [Vec3; 3]) -> Vec3 {
        corners.iter().zip(self.weights).map(|(corner, weight)| *corner * weight).sum()
    }

    /// What of lamps' light the surface reflects diffusely, linear RGB.
    pub fn albedo(&self, scene: &TracedScene) -> Vec3 {
        let [_, second, third] = self.weights;
        let (mesh, triangle) = (self.mesh as u32, self.triangle as u32);
        let hit = Hit { distance: 0.0, mesh, triangle, barycentric: Vec2::new(second, third) };
        SurfacePoint::new(scene, &hit, Vec3::NEG_Y).surface.diffuse
    }
}

/// What a task's places are on: the scene over time, with lamps switched as the task says. Its file is read
/// once.
pub struct SwitchedScene {
    pub animated: AnimatedScene,
    schedules: Vec<Schedule>,
}

impl SwitchedScene {
    /// That of a task.
    ///
    /// # Errors
    /// If the scene cannot be read, or lacks a lamp.
    pub fn new(task: &Task) -> Result<Self> {
        let scene = || format!("scene {}", task.scene);
        let animated = AnimatedScene::load(&task.scene, 0.0).with_context(scene)?;
        let switched = Self { animated, schedules: task.schedules()? };
        switched.glow(0.0).check(&switched.animated.scene).map_err(anyhow::Error::msg)?;
        Ok(switched)
    }

    /// The scene at a moment, seconds.
    ///
    /// # Errors
    /// If a vertex is nowhere then.
    pub fn scene(&self, seconds: f32) -> Result<Scene> {
        let glow = Some(Arc::new(self.glow(seconds)));
        Ok(Scene { glow, ..self.animated.at(seconds, 0.0)? })
    }

    /// The same, ready for rays.
    ///
    /// # Errors
    /// As [`Self::scene`], and if it is beyond what can be traced.
    pub fn at(&self, seconds: f32) -> Result<TracedScene> {
        Ok(TracedScene::new(self.scene(seconds)?)?)
    }

    fn glow(&self, moment: f32) -> Glow {
        let schedules = self.schedules.clone();
        Glow { surfaces: Vec::new(), medium: None, schedules, start: Start::Share(0.0), moment }
    }
}

/// The point of a scene's surfaces that is next to a place.
///
/// # Errors
/// If none is near.
pub fn spot(scene: &TracedScene, at: Vec3) -> Result<Spot> {
    let meshes = scene.scene().meshes.iter().enumerate();
    let triangles = meshes.flat_map(|(index, mesh)| (0..mesh.triangles.len()).map(move |t| (index, mesh, t)));
    let nearest = |(mesh, its, triangle): (usize, &Mesh, usize)| {
        let corners = its.corners(triangle);
        let weights = nearest_in_triangle(corners, at);
        let position: Vec3 = corners.iter().zip(weights).map(|(corner, weight)| *corner * weight).sum();
        let material = its.material.0 as usize;
        (position.distance(at), Spot { mesh, triangle, weights, position, material })
    };
    let (off, spot) = triangles.map(nearest).min_by(|a, b| a.0.total_cmp(&b.0)).context("no surface")?;
    ensure!(off <= NEAR * scene.diagonal(), "the place at {at} is {off:.2} m from the next surface");
    Ok(spot)
}

/// What light does at places in each frame, linear RGB, `[places][frames]`: irradiance that excites, the mean
/// from that frame to the next, and radiance of lamps' light that the side which `eye` sees reflects, of the
/// lamps that are on in the frame itself. Of both, what moves is where it is halfway to the next frame.
///
/// # Errors
/// If a vertex is nowhere in a frame.
pub fn received(
    task: &Task,
    switched: &SwitchedScene,
    first: &TracedScene,
    (spots, eye): (&[Spot], Vec3),
) -> Result<[PerFrame; 2]> {
    let albedos: Vec<Vec3> = spots.iter().map(|spot| spot.albedo(first)).collect();
    let moves = !switched.animated.rigs.is_empty();
    let [mut excites, mut reflected] = [(); 2].map(|()| vec![Vec::with_capacity(task.frames); spots.len()]);
    let mut irradiance = SpotIrradiance::of(first, spots, eye);
    for frame in 0..task.frames {
        let (from, to) = (task.seconds(frame), task.seconds(frame + 1));
        if moves {
            irradiance = SpotIrradiance::of(&switched.at(0.5 * (from + to))?, spots, eye);
        }
        let pieces = Glow::of(first.scene()).between(from, to);
        let now = pieces.first();
        for (place, albedo) in albedos.iter().enumerate() {
            let all = pieces.iter().map(|piece| piece.light(&irradiance.whole[place]) * piece.seconds);
            excites[place].push(all.sum::<Vec3>() / (to - from));
            let seen = now.map_or(Vec3::ZERO, |piece| piece.light(&irradiance.seen[place]));
            reflected[place].push(*albedo * seen / PI);
        }
    }
    Ok([excites, reflected])
}

/// A colour for each place and frame.
pub type PerFrame = Vec<Vec<Vec3>>;

/// Irradiance of places by the lamps of each schedule when they shine, `[places][schedules]`.
struct SpotIrradiance {
    /// On both sides together.
    whole: Vec<Vec<Vec3>>,
    /// On the side that is seen.
    seen: Vec<Vec<Vec3>>,
}

impl SpotIrradiance {
    fn of(scene: &TracedScene, spots: &[Spot], eye: Vec3) -> Self {
        let afterglow = Afterglow::new(scene);
        let of_spot = |spot: &Spot| {
            let place = ReceivingPoint::new(&scene.scene().meshes[spot.mesh], spot.triangle, spot.weights);
            (afterglow.irradiance(&place), afterglow.irradiance_towards(&place, eye - place.position))
        };
        let (whole, seen) = spots.iter().map(of_spot).unzip();
        Self { whole, seen }
    }
}
