//! A room like the Cornell box with a cloud in it, as in Nalbach, Ritschel and Seidel 2014 (Figures 10 and
//! 11).

use anyhow::Result;
use deepshade_render::scene::medium::{Weather, WeatherKind};
use deepshade_render::scene::{Bounds, Camera, Density, Light, Material, MaterialId, Medium, Mesh, Scene};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Half of the room's width, height and depth, metres.
const HALF: f32 = 1.0;
/// The box that the cloud is in.
const CLOUD: Bounds = Bounds { min: Vec3::new(-0.8, -0.7, -0.8), max: Vec3::new(0.8, 0.6, 0.8) };
/// Cells of the cloud along its longest edge.
const CELLS: usize = 48;
/// Scattering and absorption of the cloud, 1/m at its thickest: it takes more of blue than of red.
const COEFFICIENTS: [Vec3; 2] = [Vec3::new(2.4, 2.2, 2.0), Vec3::new(0.1, 0.4, 1.0)];

const WHITE: MaterialId = MaterialId(0);
const RED: MaterialId = MaterialId(1);
const GREEN: MaterialId = MaterialId(2);

/// The room and the camera before its open side.
///
/// # Errors
/// If the cloud cannot be made.
pub fn cloud_box() -> Result<(Scene, Camera)> {
    let matte = |base_colour: Vec3| Material { base_colour: base_colour.extend(1.0), ..Material::default() };
    let colours = [Vec3::splat(0.75), Vec3::new(0.65, 0.06, 0.06), Vec3::new(0.12, 0.5, 0.1)];
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let meshes = vec![
        wall([z, x, -y], WHITE),
        wall([x, z, y], WHITE),
        wall([x, y, -z], WHITE),
        wall([y, z, -x], RED),
        wall([z, y, x], GREEN),
    ];
    let lamp = Light::Point {
        position: Vec3::new(0.0, 0.85, 0.3),
        intensity: Vec3::new(4.0, 3.6, 3.0),
        range: f32::INFINITY,
    };
    let weather = Weather { kind: WeatherKind::Clouds, ..Weather::smoke(3, 0.7, 0.8) };
    let [scattering, absorption] = COEFFICIENTS;
    let medium = Medium::new(absorption, scattering, 0.3, Density::Grid(weather.grid(CLOUD, CELLS, 0.0)?))?;
    let scene = Scene {
        name: "cloud box".to_owned(),
        meshes: meshes.into(),
        materials: colours.map(matte).to_vec(),
        lights: vec![lamp],
        medium: Some(Arc::new(medium)),
        ..Scene::default()
    };
    Ok((scene, Camera::look_at(Vec3::new(0.0, 0.0, 3.4), Vec3::ZERO)))
}

/// A side of the room: two directions along it and the one out of the room.
fn wall([along, up, out]: [Vec3; 3], material: MaterialId) -> Mesh {
    let corner = |at: Vec2| HALF * (at.x * along + at.y * up + out);
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    Mesh {
        positions: corners.map(|at| corner(Vec2::from(at))).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material,
        ..Mesh::default()
    }
}
