//! What an effect needs and a scene may not bring: light, a lens, fog, a mean free path.

mod additions;
pub mod listeners;
mod past;
pub mod sky;
mod unseen;

pub use additions::Additions;
pub use past::remembered;

use anyhow::{Result, ensure};
use deepshade_dataset::vary::Lamp;
use deepshade_infer::TrainedUnder;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::{Camera, Environment, Lens, Look, Medium};
use deepshade_shaders::Effect;
use deepshade_shaders::effect::{EffectSetting, LitBy};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// A scene and a camera with all that the effect needs.
pub struct Completed {
    /// The scene.
    pub scene: TracedScene,
    /// The camera.
    pub camera: Camera,
    /// What was added, a sentence each.
    pub added: Vec<String>,
}

/// What a picture is to show, and what its command line gives the scene.
#[derive(Clone, Copy)]
pub struct Wants<'a> {
    /// The effect.
    pub effect: Effect,
    /// Rows and columns.
    pub size: [usize; 2],
    /// What is given.
    pub additions: &'a Additions,
    /// Chooses the lamp, and the sky where no network says which.
    pub seed: u32,
    /// The environment that the effect's network knows by heart.
    pub learned: Option<&'a TrainedUnder>,
    /// Whether something moves beside what the scene's displacements say.
    pub animated: bool,
    /// The moment at which a medium that changes is seen, seconds.
    pub time: f32,
}

/// How it is said that a lamp was added: it is drawn for the view, as nothing else is.
pub const LAMP_ADDED: &str = "no light that the effect sees: a lamp";
/// Radius in pixels, at 512 rows, of the circle of confusion at infinity of the lens that is added.
const BLUR: f32 = 8.0;
/// Mean free path of red, green and blue in pixels, at 512 rows, of what is in the middle of the picture.
const MEAN_FREE_PATH: Vec3 = Vec3::new(6.0, 4.0, 3.0);
/// Rays along each side of a picture that look for the medium.
const PROBES: u32 = 32;

/// Adds to a scene and a camera what is wanted and what is missing.
///
/// # Errors
/// If something is given that the effect does not listen to, the environment or the medium cannot be read, or
/// the lens or the medium is none.
pub fn complete(scene: &TracedScene, camera: &Camera, wants: &Wants<'_>) -> Result<Completed> {
    let Wants { effect, additions, .. } = *wants;
    additions.check(effect)?;
    let (mut camera, mut added) = (*camera, scene.scene().warnings.clone());
    let mut look = scene.scene().look();
    if let Some(path) = &additions.environment {
        let environment = Environment::load(path)?;
        added.extend(environment.warning().map(str::to_owned));
        look.environment = Some(Arc::new(environment));
    }
    // Of all light, phosphor is a part that may be missing.
    let glows = effect.is_lit_by_lamps_alone() && effect.listens_to(EffectSetting::Phosphor);
    let glow = (glows || additions.phosphor.is_some()).then(|| additions.glow(scene.scene(), wants.time));
    let (glow, is_said) = glow.transpose()?.unzip();
    look.glow = glow.map(Arc::new).or(look.glow);
    add_light(scene, &camera, wants, &mut look, &mut added);
    let opaque = look.materials.iter().all(|material| material.mean_free_path == Vec3::ZERO);
    if let Some(metres) = additions.mean_free_path {
        look.materials.iter_mut().for_each(|material| material.mean_free_path = metres);
    } else if opaque && effect.listens_to(EffectSetting::MeanFreePath) {
        let metres = MEAN_FREE_PATH * middle_depth(scene, &camera, wants.size) / camera.focal_length(512);
        look.materials.iter_mut().for_each(|material| material.mean_free_path = metres);
        added.push(format!("no material lets light in: all do, with mean free paths of {metres:.4} m"));
    }
    let foggy = effect.needs("fog");
    if let Some(medium) = additions.medium(scene, wants.time)? {
        look.medium = Some(Arc::new(medium));
    } else if foggy && look.medium.is_none() {
        look.medium = Some(Arc::new(additions.fog(scene)?));
        added.push("the scene brings no medium: grey fog, of optical depth 1 along its diagonal".to_owned());
    } else {
        for (option, given) in additions.of_a_medium() {
            ensure!(!given, "{option} means nothing without --extinction");
        }
    }
    if let Some(medium) = look.medium.as_deref().filter(|_| foggy)
        && !meets(scene, &camera, wants.size, medium)
    {
        added.push("no ray of the picture meets the medium: it lies elsewhere".to_owned());
    }
    if is_said == Some(false) {
        let usual = "all does, blue, after a second of light that ends at second 0";
        added.push(format!("nothing is said of what glows: {usual}"));
    }
    let still = scene.scene().meshes.iter().all(|mesh| mesh.displacements.is_empty());
    if effect.needs("motion") && still && !wants.animated {
        added.push("nothing in the scene moves: the picture is of a still scene".to_owned());
    }
    if additions.aperture.is_some() || effect.needs("lens") {
        camera.lens = Some(lens(scene, &camera, wants, &mut added)?);
    } else {
        ensure!(additions.focus.is_none(), "--focus means nothing to {effect} without --aperture");
    }
    let scene = scene.with_look(look)?;
    additions.check_glow(effect, scene.scene(), wants.time)?;
    added.extend(unseen::light(effect, scene.scene()));
    Ok(Completed { scene, camera, added })
}

/// Adds a sky for effects that are lit by one alone, and a lamp for others in a scene where nothing shines
/// for them.
fn add_light(
    scene: &TracedScene,
    camera: &Camera,
    wants: &Wants<'_>,
    look: &mut Look,
    added: &mut Vec<String>,
) {
    let by_sky = wants.effect.lit_by() == LitBy::Environment;
    if by_sky {
        sky::add(look, wants, added);
    }
    let is_kept = look.glow.as_ref().is_some_and(|glow| glow.schedule_of_sky().is_some());
    let dark = if wants.effect.is_lit_by_lamps_alone() {
        look.lights.is_empty() && !(is_kept && look.environment.is_some())
    } else {
        look.environment.is_none() && scene.scene().is_dark()
    };
    if dark && !by_sky && wants.effect.lit_by() != LitBy::Nothing {
        let lamp = Lamp::of_view(scene, camera, wants.size, wants.seed);
        look.lights.push(lamp.light());
        let Lamp { position, intensity } = lamp;
        added.push(format!("{LAMP_ADDED} at {position:.2} m of {intensity:.3} W/sr"));
    }
}

/// The lens that is wanted, as far as it is stated.
fn lens(scene: &TracedScene, camera: &Camera, wants: &Wants<'_>, added: &mut Vec<String>) -> Result<Lens> {
    let Additions { aperture, focus, .. } = *wants.additions;
    let both = aperture.is_some() && focus.is_some();
    let focus = focus.unwrap_or_else(|| middle_depth(scene, camera, wants.size));
    let radius = aperture.unwrap_or_else(|| BLUR * focus / camera.focal_length(512));
    if !both {
        added.push(format!("a lens of radius {radius:.4} m that focuses {focus:.3} m"));
    }
    Ok(Lens::new(radius, focus)?)
}

/// Depth of what is in the middle of a picture of `[height, width]`, metres; the diagonal where nothing is.
fn middle_depth(scene: &TracedScene, camera: &Camera, [height, width]: [usize; 2]) -> f32 {
    let direction = camera.direction(0.5 * Vec2::new(width as f32, height as f32), height, width);
    let depth = |distance: f32| -camera.to_camera(camera.position + direction * distance).z;
    let met = scene.hit(camera.position, direction, f32::INFINITY);
    met.map_or(scene.diagonal(), |hit| depth(hit.distance))
}

/// Whether some ray of a picture of `[height, width]` goes through a medium before it meets a surface, as far
/// as `PROBES` rays a side say.
fn meets(scene: &TracedScene, camera: &Camera, [height, width]: [usize; 2], medium: &Medium) -> bool {
    let ray_meets = |x: u32, y: u32| {
        let share = (Vec2::new(x as f32, y as f32) + 0.5) / PROBES as f32;
        let direction = camera.direction(share * Vec2::new(width as f32, height as f32), height, width);
        let met = scene.hit(camera.position, direction, f32::INFINITY);
        let reach = met.map_or(f32::INFINITY, |hit| hit.distance);
        medium.density.span(camera.position, direction, reach).is_some()
    };
    (0..PROBES).any(|y| (0..PROBES).any(|x| ray_meets(x, y)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser as _;
    use deepshade_render::scene::{Material, Mesh, Scene, procedural};

    /// A wall of 4 m at z = 0, with nothing that shines.
    fn wall() -> TracedScene {
        let corners = [(-2., -2.), (2., -2.), (2., 2.), (-2., 2.)];
        let mesh = Mesh {
            positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let materials = vec![Material::default()];
        TracedScene::new(Scene { meshes: vec![mesh].into(), materials, ..Scene::default() }).expect("a wall")
    }

    fn additions(arguments: &[&str]) -> Additions {
        #[derive(clap::Parser)]
        struct Line {
            #[command(flatten)]
            additions: Additions,
        }
        let line = Line::try_parse_from(["deepshade"].iter().chain(arguments));
        line.expect("a sound command line").additions
    }

    /// A small picture of an effect with what is given.
    fn wants(effect: Effect, additions: &Additions) -> Wants<'_> {
        Wants { effect, size: [16, 16], additions, seed: 1, learned: None, animated: false, time: 0.0 }
    }

    #[test]
    fn what_an_effect_needs_is_added_and_said() {
        let (scene, camera) = (wall(), Camera::look_at(Vec3::Z * 3.0, Vec3::ZERO));
        for effect in Effect::ALL {
            let additions = additions(&[]);
            let wants = wants(effect, &additions);
            let Completed { scene, camera, added } = complete(&scene, &camera, &wants).expect("completed");
            let scene = scene.scene();
            let (sky, unlit) = (effect.lit_by() == LitBy::Environment, effect.lit_by() == LitBy::Nothing);
            assert_eq!(scene.environment.is_some(), sky, "{effect}");
            assert_eq!(scene.lights.len(), usize::from(!sky && !unlit), "{effect}");
            assert_eq!(scene.medium.is_some(), effect.needs("fog"), "{effect}");
            let lens = effect.needs("lens");
            assert_eq!(camera.lens.map(|lens| lens.focus), lens.then_some(3.0), "{effect}");
            assert_eq!(added.is_empty(), unlit && !lens, "{effect}: {added:?}");
        }
    }

    #[test]
    fn a_network_is_given_the_environment_that_it_knows_and_another_one_is_said() {
        let (scene, camera) = (wall(), Camera::look_at(Vec3::Z * 3.0, Vec3::ZERO));
        let under = |scene: &TracedScene, learned: Option<&TrainedUnder>, seed: u32| {
            let additions = additions(&[]);
            let wants = Wants { learned, seed, ..wants(Effect::Ibl, &additions) };
            let Completed { scene, added, .. } = complete(scene, &camera, &wants).expect("completed");
            (scene.scene().environment.clone().expect("an environment"), added.join("; "))
        };
        let known = TrainedUnder::Sky(7);
        let (own, said) = under(&scene, Some(&known), 0);
        assert_eq!(*own, procedural::sky(7), "whatever the seed is");
        assert!(
            said.contains("number 7, which the network was trained under") && !said.contains("another"),
            "{said}"
        );
        let (plain, said) = under(&scene, None, 0);
        assert_eq!(*plain, procedural::sky(0));
        assert!(!said.contains("network"), "{said}");
        let lit = |number: u64| {
            let scene = Scene { environment: Some(procedural::sky(number).into()), ..scene.scene().clone() };
            TracedScene::new(scene).expect("a wall")
        };
        let (_, said) = under(&lit(7), Some(&known), 0);
        assert_eq!(said, "", "the sky that it knows");
        let (kept, said) = under(&lit(8), Some(&known), 0);
        assert_eq!(*kept, procedural::sky(8), "the scene's own");
        assert!(
            said.contains("another environment than the network was trained under, a clear sky, number 7"),
            "{said}"
        );
        let (_, said) = under(&scene, Some(&TrainedUnder::File("0a".repeat(32))), 0);
        assert!(said.contains("another environment") && said.contains(&"0a".repeat(32)), "{said}");
    }

    #[test]
    fn what_shines_for_one_effect_is_dark_for_another() {
        let mut scene = wall().scene().clone();
        scene.materials[0].emission = Vec3::ONE;
        let scene = TracedScene::new(scene).expect("a wall");
        let camera = Camera::look_at(Vec3::Z * 3.0, Vec3::ZERO);
        for effect in Effect::ALL {
            let additions = additions(&[]);
            let wants = wants(effect, &additions);
            let completed = complete(&scene, &camera, &wants).expect("completed");
            let lamps = completed.scene.scene().lights.len();
            assert_eq!(lamps, usize::from(effect.is_lit_by_lamps_alone()), "{effect}");
        }
    }

    #[test]
    fn a_medium_that_drifts_is_seen_at_its_time() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("smoke.toml");
        let smoke = "[weather]\nkind = \"smoke\"\nseed = 7\nbillow = 1.0\ncover = 0.7\nwind = [0.5, 0.0, 0.0]\n\
            [box]\nmin = [-2.0, -2.0, -2.0]\nmax = [2.0, 2.0, 2.0]\n";
        std::fs::write(&path, smoke).expect("written");
        let path = path.to_str().expect("a path");
        let additions = additions(&["--medium", path, "--extinction", "2"]);
        let camera = Camera::look_at(Vec3::Z * 3.0, Vec3::ZERO);
        let at = |time| {
            let wants = Wants { time, ..wants(Effect::FogDirect, &additions) };
            let Completed { scene, .. } = complete(&wall(), &camera, &wants).expect("completed");
            scene.scene().medium.clone().expect("a medium")
        };
        assert_eq!(at(1.0), at(1.0));
        assert_ne!(at(1.0), at(0.0));
    }

    #[test]
    fn a_medium_out_of_view_is_said() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("smoke.toml");
        let said = |low: f32, high: f32| {
            let smoke = format!(
                "[weather]\nkind = \"smoke\"\nseed = 7\nbillow = 1.0\ncover = 1.0\n[box]\n\
                 min = [-1.0, -1.0, {low:.1}]\nmax = [1.0, 1.0, {high:.1}]\n"
            );
            std::fs::write(&path, smoke).expect("written");
            let additions = additions(&["--medium", path.to_str().expect("a path"), "--extinction", "2"]);
            let camera = Camera::look_at(Vec3::Z * 3.0, Vec3::ZERO);
            let completed = complete(&wall(), &camera, &wants(Effect::FogDirect, &additions));
            completed.expect("completed").added.iter().any(|line| line.contains("meets the medium"))
        };
        assert!(!said(0.5, 1.0), "before the wall");
        assert!(said(-2.0, -1.0), "behind the wall");
        assert!(said(4.0, 5.0), "behind the camera");
    }

    #[test]
    fn what_is_asked_for_is_taken() {
        let camera = Camera::look_at(Vec3::Z * 3.0, Vec3::ZERO);
        let completed = |effect, arguments: &[&str]| {
            let additions = additions(arguments);
            let wants = wants(effect, &additions);
            complete(&wall(), &camera, &wants)
        };
        let sharp = completed(Effect::Path, &["--aperture", "0.1", "--focus", "2"]).expect("completed");
        assert_eq!(sharp.camera.lens, Some(Lens { radius: 0.1, focus: 2.0 }));
        let foggy = completed(Effect::Path, &["--extinction", "0.4,0.2,0.1", "--scattering-albedo", "0.5"]);
        let medium = foggy.expect("completed").scene.scene().medium.clone().expect("fog");
        assert!((medium.extinction() - Vec3::new(0.4, 0.2, 0.1)).length() < 1e-6);
        let own = |scene: &Scene| scene.materials[0].mean_free_path;
        let skin = completed(Effect::Sss, &["--mean-free-path", "0.003,0.002,0.001"]).expect("completed");
        assert_eq!(own(skin.scene.scene()), Vec3::new(0.003, 0.002, 0.001));
        assert!(skin.added.iter().all(|line| !line.contains("mean free path")), "{:?}", skin.added);
        let skin = completed(Effect::Subsurface, &[]).expect("completed");
        let pixels = own(skin.scene.scene()) * camera.focal_length(512) / 3.0;
        assert!(pixels.distance(MEAN_FREE_PATH) < 1e-3, "{pixels} pixels at a depth of 3 m");
        for (arguments, named) in [
            (["--environment", "missing.hdr"].as_slice(), "missing.hdr"),
            (&["--focus", "2"], "--focus"),
            (&["--scattering-albedo", "0.5"], "--scattering-albedo means nothing without --extinction"),
            (&["--anisotropy=-0.5"], "--anisotropy means nothing without --extinction"),
            (&["--medium", "missing.vol"], "missing.vol"),
            (&["--extinction", "1", "--scattering-albedo", "1.5"], "--scattering-albedo"),
            (&["--extinction", "1", "--anisotropy", "2"], "anisotropy"),
        ] {
            let error = format!("{:#}", completed(Effect::Path, arguments).err().expect("an error"));
            assert!(error.contains(named), "{error}");
        }
        completed(Effect::FogDirect, &["--anisotropy=-0.5"]).expect("of the fog that is added");
    }

    #[test]
    fn what_an_effect_does_not_listen_to_is_refused_by_name() {
        let camera = Camera::look_at(Vec3::Z * 3.0, Vec3::ZERO);
        for (effect, arguments) in [
            (Effect::Ao, ["--aperture", "0.1"]),
            (Effect::MotionBlur, ["--focus", "2"]),
            (Effect::Gi, ["--extinction", "1"]),
            (Effect::Dof, ["--medium", "missing.vol"]),
            (Effect::Ibl, ["--anisotropy", "0.5"]),
            (Effect::Aa, ["--scattering-albedo", "0.5"]),
            (Effect::Sss, ["--environment", "missing.hdr"]),
            (Effect::Path, ["--mean-free-path", "0.01"]),
        ] {
            let additions = additions(&arguments);
            let wants = wants(effect, &additions);
            let error = complete(&wall(), &camera, &wants).err().expect("an error").to_string();
            let expected = format!("{} means nothing to the effect {effect}, only to ", arguments[0]);
            assert!(error.starts_with(&expected), "{error}");
        }
    }
}
