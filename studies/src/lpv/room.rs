//! A closed room, in which nothing leaves the grid: with a wall across it, with a lamp, a block or a cloud
//! that moves.

use anyhow::Result;
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::method::{Frame, Method, Repeats};
use deepshade_render::scene::medium::Weather;
use deepshade_render::scene::{Bounds, Camera, Density, Light, Material, Medium, Mesh, Scene};
use deepshade_shaders::{Attribute, Planes};
use glam::Vec3;
use std::sync::Arc;

/// Half of its edges, metres.
const HALF: f32 = 1.0;
/// The box that the cloud is in.
const CLOUD: Bounds = Bounds { min: Vec3::splat(-0.7), max: Vec3::splat(0.7) };
/// Cells of the cloud along an edge.
const CELLS: usize = 24;
/// Metres that a lamp or a block goes in a frame, and seconds that a cloud drifts, at 60 frames a second.
const STEP: f32 = 0.01;
const SECONDS: f32 = 1.0 / 60.0;

/// What moves in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moving {
    /// The lamp.
    Light,
    /// A block in the lamp's light.
    Blockers,
    /// A cloud, by the wind.
    Medium,
}

impl Moving {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Light, Self::Blockers, Self::Medium];

    /// Its name in figures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Blockers => "blockers",
            Self::Medium => "medium",
        }
    }
}

/// The room in a frame of so many.
///
/// # Errors
/// If the cloud cannot be made.
pub fn in_motion(moving: Moving, frame: usize) -> Result<(Scene, Camera)> {
    let along = |is: Moving| if moving == is { STEP * frame as f32 } else { 0.0 };
    let lamp = Vec3::new(-0.5 + along(Moving::Light), 0.8, 0.2);
    let block = Vec3::new(-0.4 + along(Moving::Blockers), -0.2, -0.3);
    let weather = Weather { wind: Vec3::X, ..Weather::smoke(5, 0.8, 0.9) };
    let seconds = if moving == Moving::Medium { SECONDS * frame as f32 } else { 0.0 };
    let density = Density::Grid(weather.grid(CLOUD, CELLS, seconds)?);
    let medium = Medium::new(Vec3::splat(0.1), Vec3::splat(1.5), 0.0, density)?;
    let mut scene = lit(walls(HALF, Vec3::ZERO).into_iter().chain(walls(0.2, block)).collect(), lamp);
    scene.medium = Some(Arc::new(medium));
    Ok((scene, Camera::look_at(Vec3::new(0.9, 0.3, 0.9), Vec3::new(-0.3, -0.2, -0.3))))
}

/// The room with a wall across it that is as thin as a sheet, and the lamp behind it; the cameras on the
/// lamp's side and on the other, where it is dark.
pub fn divided() -> (Scene, [Camera; 2]) {
    // Between the middles of two layers of cells in grids of many sizes.
    let x = 0.13;
    let corner = |y: f32, z: f32| Vec3::new(x, HALF * y, HALF * z);
    let sheet = quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
    let scene = lit(walls(HALF, Vec3::ZERO).into_iter().chain([sheet]).collect(), Vec3::new(0.6, 0.5, 0.0));
    let camera = |side: f32| {
        Camera::look_at(Vec3::new(0.56 + side * 0.4, 0.2, 0.8), Vec3::new(0.56 - side * 0.3, -0.3, -0.8))
    };
    let other = Camera::look_at(Vec3::new(-0.8, 0.2, 0.8), Vec3::new(0.1, -0.3, -0.6));
    (scene, [camera(1.0), other])
}

/// The room in fog of a mean free path of its edge, with walls that reflect so much.
///
/// # Errors
/// If there cannot be such fog.
pub fn foggy(albedo: f32) -> Result<(Scene, Camera)> {
    let inside = Bounds { min: Vec3::splat(-HALF), max: Vec3::splat(HALF) };
    let medium = Medium::new(Vec3::splat(0.05), Vec3::splat(0.45), 0.0, Density::Within(inside))?;
    let mut scene = lit(walls(HALF, Vec3::ZERO), Vec3::new(0.6, 0.5, 0.0));
    scene.materials[0].base_colour = Vec3::splat(albedo).extend(1.0);
    scene.medium = Some(Arc::new(medium));
    Ok((scene, Camera::look_at(Vec3::new(-0.9, 0.4, 0.9), Vec3::new(0.3, -0.3, -0.5))))
}

/// A method's image of a scene.
///
/// # Errors
/// If the scene has no triangles or the device fails.
pub fn image(
    method: &dyn Method,
    scene: Scene,
    camera: &Camera,
    [height, width]: [usize; 2],
) -> Result<Planes> {
    let scene = TracedScene::new(scene)?;
    let attributes = [Attribute::Position, Attribute::Normal, Attribute::Diffuse, Attribute::Valid];
    let gbuffer = gbuffer::render(&scene, camera, height, width, &attributes);
    let frame = Frame { scene: &scene, camera, gbuffer: &gbuffer, radius: scene.diagonal(), seed: 0 };
    Ok(method.shade(&frame, Repeats::ONCE)?.image)
}

/// A scene of white meshes and a lamp.
fn lit(meshes: Vec<Mesh>, position: Vec3) -> Scene {
    let base_colour = Vec3::splat(0.7).extend(1.0);
    Scene {
        name: "room".to_owned(),
        meshes: meshes.into(),
        materials: vec![Material { base_colour, ..Material::default() }],
        lights: vec![Light::Point { position, intensity: Vec3::splat(4.0), range: f32::INFINITY }],
        ..Scene::default()
    }
}

/// The sides of a cube of such half edges around a point.
fn walls(half: f32, middle: Vec3) -> Vec<Mesh> {
    let sides = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
    let side = |out: Vec3| {
        let (along, up) = (Vec3::new(out.y, out.z, out.x), Vec3::new(out.z, out.x, out.y));
        let corner = |a: f32, b: f32| middle + half * (out + a * along + b * up);
        quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)])
    };
    sides.map(side).collect()
}

fn quad(corners: [Vec3; 4]) -> Mesh {
    Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() }
}
