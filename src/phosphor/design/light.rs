//! Places on a scene's surfaces, and the light that they get from frame to frame: that of lamps, with shadows, wherever things
//! are in that frame.

use super::task::Task;
use crate::complete::moves;
use crate::{exposure_time, props};
use anyhow::{Context, Result, ensure};
use deepshade_render::bvh::{Hit, TracedScene};
use deepshade_render::intersection::SurfacePoint;
use deepshade_render::nearest::nearest_in_triangle;
use deepshade_render::path::phosphor::{Afterglow, Place as OnSurface};
use deepshade_render::scene::Mesh;
use deepshade_render::scene::glow::{Glow, Start};
use deepshade_shaders::Effect;
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// How far from a surface a place may be, over the scene's diagonal.
const NEAR: f32 = 0.05;

/// A place on a surface.
#[derive(Clone, Debug)]
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
    /// What of lamps' light the surface reflects diffusely, linear RGB.
    pub fn albedo(&self, scene: &TracedScene) -> Vec3 {
        let [_, second, third] = self.weights;
        let (mesh, triangle) = (self.mesh as u32, self.triangle as u32);
        let hit = Hit { distance: 0.0, mesh, triangle, barycentric: Vec2::new(second, third) };
        SurfacePoint::new(scene, &hit, Vec3::NEG_Y).surface.diffuse
    }
}

/// The scene of a task at a moment, seconds, ready for rays, with lamps switched as the task says.
///
/// # Errors
/// If it cannot be read, or lacks a lamp.
pub fn at(task: &Task, seconds: f32) -> Result<TracedScene> {
    let moment = exposure_time::Args::new(Some(seconds), None);
    let mut scene = moment.scene(&task.scene, &props::Args::new(Vec::new()), Effect::Phosphor)?;
    let glow = Glow {
        surfaces: Vec::new(),
        medium: None,
        schedules: task.schedules()?,
        start: Start::Share(0.0),
        moment: seconds,
    };
    glow.check(&scene).map_err(anyhow::Error::msg)?;
    scene.glow = Some(Arc::new(glow));
    TracedScene::new(scene).with_context(|| format!("scene {}", task.scene))
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

/// Irradiance of places in each frame, linear RGB, `[places][frames]`: the mean from that frame to the next.
///
/// # Errors
/// If a frame's scene cannot be read, or has other triangles than the first.
pub fn received(task: &Task, first: &TracedScene, spots: &[Spot]) -> Result<Vec<Vec<Vec3>>> {
    let moves = moves(&task.scene)?;
    let mut received = vec![Vec::with_capacity(task.frames); spots.len()];
    let mut by_lamps = of_schedules(first, spots)?;
    for frame in 0..task.frames {
        let (from, to) = (task.seconds(frame), task.seconds(frame + 1));
        if moves {
            by_lamps = of_schedules(&at(task, 0.5 * (from + to))?, spots)?;
        }
        let pieces = Glow::of(first.scene()).between(from, to);
        for (received, by_lamps) in received.iter_mut().zip(&by_lamps) {
            let lit = pieces.iter().map(|piece| piece.light(by_lamps) * piece.seconds);
            received.push(lit.sum::<Vec3>() / (to - from));
        }
    }
    Ok(received)
}

/// Irradiance of places by the lamps of each schedule when they shine, `[places][schedules]`.
fn of_schedules(scene: &TracedScene, spots: &[Spot]) -> Result<Vec<Vec<Vec3>>> {
    let afterglow = Afterglow::new(scene);
    let of_spot = |spot: &Spot| {
        let mesh = scene.scene().meshes.get(spot.mesh).filter(|mesh| spot.triangle < mesh.triangles.len());
        let mesh = mesh.context("triangles come and go as the scene moves")?;
        Ok(afterglow.irradiance(&OnSurface::new(mesh, spot.triangle, spot.weights)))
    };
    spots.iter().map(of_spot).collect()
}
