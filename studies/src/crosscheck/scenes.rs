//! The scenes that are compared in: one by hand, some of the procedural families, some of the real data.

mod blocks;

use super::lambert::{Normals, make_black, make_lambert};
use anyhow::{Context, Result, bail};
use deepshade_dataset::views::sample_view;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::medium::Weather;
use deepshade_render::scene::procedural::Family;
use deepshade_render::scene::{Bounds, Camera, Density, Environment, Lens, Light, Medium, Scene};
use glam::Vec3;
use std::path::Path;
use std::sync::Arc;

/// Shape of the images for which views are sampled.
const SIZE: [usize; 2] = [64, 96];

/// A scene, how it is looked at, and how far effects reach in it.
#[derive(Clone, Debug)]
pub struct CrosscheckScene {
    /// The scene.
    pub scene: Scene,
    /// The camera.
    pub camera: Camera,
    /// Metres.
    pub radius: f32,
}

/// The setting of a name; `None` where it is one of the real data and that is not there.
///
/// # Errors
/// If a file is damaged or there is no setting of that name.
pub fn build(name: &str, data: &Path) -> Result<Option<CrosscheckScene>> {
    let setting = match name {
        "blocks" => blocks::still(),
        "glossy" => under_a_sky(blocks::glossy())?,
        "polished" => blocks::polished(),
        "moving" => blocks::moving(),
        "blobs" => under_a_sky(family(Family::Blobs, 1, 0, Normals::Smooth)?)?,
        "flat-blobs" => under_a_sky(family(Family::Blobs, 1, 0, Normals::Flat)?)?,
        "still-life" => with_lens(family(Family::StillLife, 2, 0, Normals::Flat)?)?,
        "room" => lamp_behind_the_camera(family(Family::Room, 1, 1, Normals::Flat)?)?,
        "fog" => in_fog(family(Family::Colonnade, 1, 0, Normals::Flat)?)?,
        "smoke" => in_smoke(family(Family::Playground, 1, 0, Normals::Flat)?)?,
        "black-smoke" => {
            let mut setting = in_smoke(family(Family::Playground, 1, 0, Normals::Flat)?)?;
            make_black(&mut setting.scene);
            setting
        }
        "cornell-box" => {
            let Some(scene) = real(&data.join("scenes/cornell_box/CornellBox-Original.obj"))? else {
                return Ok(None);
            };
            let camera = Camera::look_at(Vec3::new(0.1, 1.0, 3.3), Vec3::new(0.0, 0.95, 0.0));
            CrosscheckScene { scene, camera, radius: f32::INFINITY }
        }
        "sponza" => {
            let Some(scene) = real(&data.join("scenes/sponza/sponza.gltf"))? else { return Ok(None) };
            lamp_behind_the_camera(seen(scene, 3)?)?
        }
        _ => bail!("no scene `{name}` to compare in"),
    };
    Ok(Some(setting))
}

/// A procedural scene with its own lights.
fn family(family: Family, seed: u64, view: usize, normals: Normals) -> Result<CrosscheckScene> {
    let mut scene = family.scene(seed);
    make_lambert(&mut scene, normals);
    seen(scene, view)
}

/// A scene from a file, if that is there.
fn real(path: &Path) -> Result<Option<Scene>> {
    if !path.is_file() {
        return Ok(None);
    }
    let mut scene = Scene::load(path, 0.0)?;
    make_lambert(&mut scene, Normals::Flat);
    Ok(Some(scene))
}

/// A sampled view of a scene; effects reach over a fifth of it.
fn seen(scene: Scene, view: usize) -> Result<CrosscheckScene> {
    let traced = TracedScene::new(scene)?;
    let camera = sample_view(&traced, SIZE, 0, 0, view)?;
    Ok(CrosscheckScene { radius: 0.2 * traced.diagonal(), scene: traced.scene().clone(), camera })
}

/// Replaces all lights by a lamp behind the camera, in free space. Light close to a lamp grows without bound,
/// and with it the noise of what is sampled there by chance; a lamp that is not in sight and not near a wall
/// is far from most of what is.
fn lamp_behind_the_camera(setting: CrosscheckScene) -> Result<CrosscheckScene> {
    let traced = TracedScene::new(setting.scene)?;
    let reach = traced.diagonal();
    let back = setting.camera.rotation * Vec3::new(0.3, 0.4, 0.87).normalize();
    let wall =
        traced.hit(setting.camera.position, back, f32::INFINITY).map_or(f32::INFINITY, |hit| hit.distance);
    let position = setting.camera.position + back * (0.5 * wall).min(0.07 * reach);
    let intensity = Vec3::new(1.0, 0.9, 0.7) * (0.2 * reach).powi(2);
    let lights = vec![Light::Point { position, intensity, range: f32::INFINITY }];
    Ok(CrosscheckScene { scene: Scene { lights, ..traced.scene().clone() }, ..setting })
}

/// Replaces all lights by a sky of a gradient with a soft sun and a red glow, so that no turned or mirrored
/// one looks the same.
fn under_a_sky(setting: CrosscheckScene) -> Result<CrosscheckScene> {
    const SKY: [usize; 2] = [128, 64];
    let lobe = |direction: Vec3, towards: Vec3, sharpness: f32| {
        (sharpness * (direction.dot(towards.normalize()) - 1.0)).exp()
    };
    let radiance = |i: usize| {
        let at = [(i % SKY[0]) as f32 / SKY[0] as f32, ((i / SKY[0]) as f32 + 0.5) / SKY[1] as f32];
        let (sin, cos) = (std::f32::consts::TAU * at[0]).sin_cos();
        let (side, up) = (std::f32::consts::PI * at[1]).sin_cos();
        let direction = Vec3::new(sin * side, up, cos * side);
        Vec3::new(0.3, 0.5, 0.9) * (0.6 + 0.4 * up)
            + Vec3::new(5.0, 4.5, 3.5) * lobe(direction, Vec3::new(0.8, 0.7, 0.2), 12.0)
            + Vec3::new(1.5, 0.2, 0.1) * lobe(direction, Vec3::new(-0.3, 0.1, -1.0), 6.0)
    };
    let texels = (0..SKY[0] * SKY[1]).map(radiance).collect();
    let sky = Environment::new("sky".as_ref(), SKY[0], SKY[1], texels)?;
    let scene = Scene { lights: Vec::new(), environment: Some(Arc::new(sky)), ..setting.scene };
    Ok(CrosscheckScene { scene, ..setting })
}

/// Gives the camera a lens that focuses what is in the middle of the image.
fn with_lens(setting: CrosscheckScene) -> Result<CrosscheckScene> {
    let traced = TracedScene::new(setting.scene)?;
    let forward = setting.camera.rotation * Vec3::NEG_Z;
    let hit = traced.hit(setting.camera.position, forward, f32::INFINITY);
    let focus = hit.map_or(traced.diagonal(), |hit| hit.distance);
    let camera = Camera { lens: Some(Lens::new(0.04 * focus, focus)?), ..setting.camera };
    Ok(CrosscheckScene { scene: traced.scene().clone(), camera, ..setting })
}

/// Fills a box around the scene and the camera with thin fog, in which there are a lamp and the scene's sun.
fn in_fog(setting: CrosscheckScene) -> Result<CrosscheckScene> {
    let is_sun = |light: &Light| matches!(light, Light::Directional { .. });
    let suns: Vec<Light> = setting.scene.lights.iter().copied().filter(is_sun).collect();
    let mut setting = lamp_behind_the_camera(setting)?;
    setting.scene.lights.extend(suns);
    let bounds = setting.scene.bounds().grow(setting.camera.position);
    let margin = Vec3::splat(0.013 * bounds.diagonal());
    let bounds = Bounds { min: bounds.min - margin, max: bounds.max + margin };
    let thin = 1.0 / bounds.diagonal();
    let medium = Medium::new(
        Vec3::new(0.3, 0.2, 0.1) * thin,
        Vec3::new(0.8, 1.0, 1.4) * thin,
        0.4,
        Density::Within(bounds),
    )?;
    Ok(in_medium(setting, medium))
}

/// Fills the scene with smoke. Some of it is everywhere in the view: where light is rarer than samples, the
/// noise of a value cannot be told from its samples.
fn in_smoke(setting: CrosscheckScene) -> Result<CrosscheckScene> {
    let around = setting.scene.bounds();
    let half = around.size() * Vec3::new(0.61, 0.73, 0.63);
    let middle = around.centre() + around.size() * Vec3::new(0.02, 0.05, -0.03);
    let bounds = Bounds { min: middle - half, max: middle + half };
    let smoke = Weather::smoke(5, 0.1 * bounds.diagonal(), 1.0);
    let grid = smoke.grid(bounds, 24, 0.0).context("smoke")?;
    let thick = 4.0 / bounds.diagonal();
    let medium = Medium::new(
        Vec3::new(0.1, 0.2, 0.3) * thick,
        Vec3::new(1.0, 0.8, 0.9) * thick,
        -0.2,
        Density::Grid(grid),
    )?;
    Ok(in_medium(setting, medium))
}

fn in_medium(setting: CrosscheckScene, medium: Medium) -> CrosscheckScene {
    CrosscheckScene { scene: Scene { medium: Some(Arc::new(medium)), ..setting.scene }, ..setting }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crosscheck::cases;

    #[test]
    fn a_case_of_absent_data_is_left_out_and_an_unknown_one_refused() {
        let nowhere = Path::new("no/such/folder");
        assert!(build("sponza", nowhere).expect("absent").is_none());
        assert!(build("castle", nowhere).is_err());
    }

    #[test]
    fn scenes_are_lit_where_their_effects_want_light() {
        // The cheap ones.
        for name in ["blocks", "moving", "room"] {
            assert!(cases::ALL.iter().any(|case| case.scene == name), "{name}");
            let setting = build(name, Path::new("")).expect("built").expect("procedural");
            assert!(!setting.scene.lights.is_empty() && setting.radius > 0.0);
        }
    }
}
