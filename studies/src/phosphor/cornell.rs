//! A room like the Cornell box whose red and blue walls keep light, as in the thesis' Figure 8.15.

use anyhow::{Context, Result};
use deepshade_glow::file::MaterialFile;
use deepshade_glow::paint::Paint;
use deepshade_render::scene::glow::{Glow, GlowSurface, Schedule, Start};
use deepshade_render::scene::{Camera, Light, Material, MaterialId, Mesh, Scene};
use glam::{Mat3, Vec3};
use std::sync::Arc;

/// When the lamp goes out, seconds; it begins to shine at 0.
pub const OFF: f32 = 10.0;
/// Intensity of the lamp, W/sr.
pub const BRIGHT: f32 = 6.0;

const GREY: MaterialId = MaterialId(0);
/// Materials of walls that keep light, after [`GREY`]: the name of their paint and their colour.
const KEEPING: [(&str, Vec3); 2] = [("red", Vec3::new(0.6, 0.1, 0.08)), ("blue", Vec3::new(0.12, 0.2, 0.6))];

/// The room under a lamp that shines at these times, and the camera before its open side; `all` is whether
/// every surface keeps light.
///
/// # Errors
/// If a preset is missing.
pub fn room(intensity: f32, all: bool, on: Vec<[f32; 2]>) -> Result<(Scene, Camera)> {
    let presets = MaterialFile::presets();
    let paint = |name: &str| {
        let material = presets.named(name).context("a preset")?;
        Paint::new(material, None).map_err(anyhow::Error::msg)
    };
    let mut surfaces = Vec::new();
    for (name, _) in KEEPING {
        surfaces.push(GlowSurface::new(Some(name), paint(name)?));
    }
    if all {
        surfaces.push(GlowSurface::new(None, paint("blue")?));
    }
    let schedules = vec![Schedule { on, ..Schedule::default() }];
    let glow = Glow { surfaces, medium: None, schedules, start: Start::Share(0.0), moment: OFF };
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let sides = [([z, x, -y], 0), ([x, z, y], 0), ([x, y, -z], 0), ([y, z, -x], 1), ([z, y, x], 2)];
    let walls = sides.map(|(axes, material)| side(columns(axes), Vec3::ZERO, material));
    let mut meshes = walls.to_vec();
    meshes.extend(block(Vec3::new(0.35, -0.7, 0.3), Vec3::splat(0.3), -0.3));
    meshes.extend(block(Vec3::new(-0.35, -0.4, -0.3), Vec3::new(0.3, 0.6, 0.3), 0.35));
    let lamp = Light::Point {
        position: Vec3::new(0.0, 0.85, 0.1),
        intensity: Vec3::splat(intensity),
        range: f32::INFINITY,
    };
    let matte = KEEPING.map(|(name, colour)| Material::matte(name, colour));
    let scene = Scene {
        name: "glowing box".to_owned(),
        meshes: meshes.into(),
        materials: [vec![Material::matte("grey", Vec3::splat(0.7))], matte.to_vec()].concat(),
        lights: vec![lamp],
        glow: Some(Arc::new(glow)),
        ..Scene::default()
    };
    Ok((scene, Camera::look_at(Vec3::new(0.0, 0.0, 3.4), Vec3::ZERO)))
}

fn columns([x, y, z]: [Vec3; 3]) -> Mat3 {
    Mat3::from_cols(x, y, z)
}

/// A square of 2 m: two directions along it and the one that it lies in, each as long as the half of a side.
fn side(axes: Mat3, middle: Vec3, material: u32) -> Mesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    Mesh {
        positions: corners.map(|(along, up)| middle + axes * Vec3::new(along, up, 1.0)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material: MaterialId(material),
        ..Mesh::default()
    }
}

/// The sides of a block that stands, turned about its height.
fn block(middle: Vec3, half: Vec3, turn: f32) -> Vec<Mesh> {
    let turned = Mat3::from_rotation_y(turn) * Mat3::from_diagonal(half);
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let sides = [[x, -z, y], [x, y, z], [-x, y, -z], [-z, y, x], [z, y, -x]];
    sides.map(|axes| side(turned * columns(axes), middle, GREY.0)).to_vec()
}
