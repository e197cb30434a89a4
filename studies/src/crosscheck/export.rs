//! Writes a case as files that `tests/crosscheck/mitsuba_render.py` reads: `scene.json`, a PLY a mesh,
//! textures and the environment as PFM, a medium's grid as .vol.

mod light;

use super::cases::Fault;
use super::files::{write_pfm, write_ply};
use super::lambert::{emission, make_black, make_phong, texture_of};
use super::scenes::CrosscheckScene;
use anyhow::{Result, bail};
use deepshade::shared::figures::write_atomically;
use deepshade_render::path::Sampling;
use deepshade_render::scene::{Camera, Density, Filter, Gloss, Material, Medium, Mesh, Scene, Wrap};
use deepshade_shaders::Effect;
use glam::{Vec2, Vec3, Vec4};
use serde_json::{Value, json};
use std::path::Path;

/// Mitsuba's emitters shine to the front. So that a surface shines to both sides, its back is a surface of
/// its own, so far behind it, metres.
const BACK: f32 = 1e-4;

/// How much brighter the lights of a control are.
const BRIGHTER: f32 = 1.02;

/// Writes a case into a folder. Mitsuba's seeds follow each other from the first, one a scrambling.
///
/// # Errors
/// If a file cannot be written, or the scene holds what Mitsuba would not render alike.
pub fn write(
    folder: &Path,
    effect: Effect,
    setting: &CrosscheckScene,
    fault: Option<Fault>,
    size: [usize; 2],
    sampling: Sampling,
) -> Result<()> {
    let mut scene = setting.scene.clone();
    // Light that is scattered once meets no surface: what Mitsuba, which knows no routes, is left with if
    // surfaces are black.
    if effect == Effect::FogDirect {
        make_black(&mut scene);
    }
    // Environments are reflected by the Phong model, whatever model a material has.
    if effect == Effect::Ibl {
        make_phong(&mut scene);
    }
    let brightness = if fault == Some(Fault::BrighterLights) { BRIGHTER } else { 1.0 };
    let meshes = meshes(folder, &scene, brightness)?;
    let lights =
        scene.lights.iter().map(|light| light::light(light, brightness)).collect::<Result<Vec<_>>>()?;
    let environment = scene.environment.as_deref();
    let environment = environment.map(|map| light::environment(folder, map, brightness)).transpose()?;
    let medium = scene.medium.as_deref().map(|medium| light::medium(folder, medium)).transpose()?;
    let (integrator, minus) = integrators(effect, setting, fault)?;
    let case = json!({
        "size": size,
        "samples_a_seed": sampling.samples.div_ceil(sampling.scramblings),
        "first_seed": sampling.seed,
        "seeds": sampling.scramblings,
        "integrator": integrator,
        "minus": minus,
        "camera": camera(&setting.camera, effect, &scene),
        "meshes": meshes,
        "lights": lights,
        "environment": environment,
        "medium": medium,
    });
    write_atomically(&folder.join("scene.json"), case.to_string().as_bytes())
}

/// The integrator that renders an effect, and the one whose picture is to be taken from its.
fn integrators(
    effect: Effect,
    setting: &CrosscheckScene,
    fault: Option<Fault>,
) -> Result<(Value, Option<Value>)> {
    let mut of_surface = json!({ "type": effect.name() });
    if setting.radius.is_finite() {
        of_surface["radius"] = json!(setting.radius);
    }
    if fault == Some(Fault::NoCosine) {
        of_surface["cosine"] = json!(false);
    }
    if setting.scene.materials.iter().any(|material| material.gloss != Gloss::None) {
        of_surface["glossy"] = json!(true);
    }
    let medium = setting.scene.medium.as_deref();
    Ok(match (effect, medium) {
        (Effect::Ao, None) => {
            of_surface["background"] = json!(1.0);
            (of_surface, None)
        }
        (Effect::Do | Effect::Gi | Effect::Glossy | Effect::Ibl | Effect::Multi, None) => (of_surface, None),
        // A path of two segments is direct light.
        (Effect::Aa | Effect::Dof, None) => (json!({ "type": "path", "max_depth": 2 }), None),
        (Effect::Path, None) => (json!({ "type": "path", "max_depth": -1 }), None),
        (Effect::Path, Some(_)) => (json!({ "type": "volpath", "max_depth": -1 }), None),
        (Effect::FogDirect, Some(_)) => (json!({ "type": "volpath", "max_depth": 2 }), None),
        (Effect::FogMultiple, Some(_)) => {
            let all = json!({ "type": "volpath", "max_depth": -1 });
            (all, Some(json!({ "type": "volpath", "max_depth": 2 })))
        }
        (
            Effect::FogIndirect,
            Some(Medium { absorption, scattering, anisotropy, density: Density::Within(bounds) }),
        ) => {
            let fog = json!({
                "type": effect.name(),
                "scattering": scattering.to_array(),
                "extinction": (*absorption + *scattering).to_array(),
                "low": bounds.min.to_array(),
                "high": bounds.max.to_array(),
                "anisotropy": anisotropy,
            });
            (fog, None)
        }
        _ => bail!("Mitsuba has no {effect} in this scene"),
    })
}

fn camera(camera: &Camera, effect: Effect, scene: &Scene) -> Value {
    let [_, up, backward] = [camera.rotation.x_axis, camera.rotation.y_axis, camera.rotation.z_axis];
    let reach = scene.bounds().grow(camera.position).diagonal();
    // Effects without a lens in their definition are a pinhole's.
    let lens = camera.lens.filter(|_| matches!(effect, Effect::Dof | Effect::Multi | Effect::Path));
    let inside = scene.medium.as_deref().is_some_and(|medium| {
        light::bounds(medium)
            .is_some_and(|b| b.min.cmplt(camera.position).all() && b.max.cmpgt(camera.position).all())
    });
    json!({
        "origin": camera.position.to_array(),
        "target": (camera.position - backward).to_array(),
        "up": up.to_array(),
        "fov_degrees": camera.vertical_fov.to_degrees(),
        "near": 1e-4 * reach,
        "far": 1e3 * reach,
        "lens": lens.map(|lens| json!({ "radius": lens.radius, "focus": lens.focus })),
        "in_medium": inside,
    })
}

/// Writes every mesh, and the backs of those that emit.
fn meshes(folder: &Path, scene: &Scene, brightness: f32) -> Result<Vec<Value>> {
    let mut exported = Vec::new();
    for (index, mesh) in scene.meshes.iter().enumerate() {
        let emission = emission(scene, mesh.material).map(|emission| emission * brightness);
        exported.push(write_mesh(folder, scene, mesh, index.to_string(), emission)?);
        if emission.is_some() {
            exported.push(write_mesh(folder, scene, &back(mesh), format!("{index}_back"), emission)?);
        }
    }
    Ok(exported)
}

fn write_mesh(
    folder: &Path,
    scene: &Scene,
    mesh: &Mesh,
    name: String,
    emission: Option<Vec3>,
) -> Result<Value> {
    let file = format!("{name}.ply");
    write_ply(&folder.join(&file), mesh)?;
    let material = scene.material(mesh.material);
    let colour = material.base_colour.truncate();
    let slot = material.base_colour_texture.filter(|_| !mesh.uvs[0].is_empty());
    let texture = slot.map(|slot| -> Result<Value> {
        let file = format!("{name}.pfm");
        let texture = texture_of(scene, &slot);
        let [width, height] = texture.size();
        let middle = |i: usize| Vec2::new((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
        let size = Vec2::new(width as f32, height as f32);
        let texels = (0..width * height).map(|i| texture.sample(middle(i) / size).truncate() * colour);
        write_pfm(&folder.join(&file), [width, height], &texels.collect::<Vec<_>>())?;
        let wrap = match texture.wrap()[0] {
            Wrap::Repeat => "repeat",
            Wrap::Mirror => "mirror",
            Wrap::Clamp => "clamp",
        };
        let filter = match texture.filter() {
            Filter::Linear => "bilinear",
            Filter::Nearest => "nearest",
        };
        Ok(json!({ "file": file, "wrap": wrap, "filter": filter }))
    });
    Ok(json!({
        "file": file,
        "flat": mesh.normals.is_empty(),
        "colour": colour.to_array(),
        "texture": texture.transpose()?,
        "glossy": glossy(scene, material),
        "emission": emission.map(|emission| emission.to_array()),
    }))
}

/// The model, the colours and the roughness of a material that reflects specularly.
fn glossy(scene: &Scene, material: &Material) -> Option<Value> {
    let surface = material.surface(&scene.textures, [Vec2::ZERO; 2], Vec4::ONE);
    let model = match surface.gloss {
        Gloss::Microfacets => "microfacets",
        Gloss::Phong => "phong",
        Gloss::None => return None,
    };
    Some(json!({
        "type": model,
        "diffuse": surface.diffuse.to_array(),
        "specular": surface.specular.to_array(),
        "roughness": surface.roughness,
    }))
}

/// The other side of a mesh's triangles, a little behind them.
fn back(mesh: &Mesh) -> Mesh {
    let mut back = Mesh { material: mesh.material, ..Mesh::default() };
    for triangle in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(triangle);
        let behind = -(b - a).cross(c - a).normalize_or_zero() * BACK;
        let first = back.positions.len() as u32;
        back.positions.extend([a + behind, c + behind, b + behind]);
        back.triangles.push([first, first + 1, first + 2]);
    }
    back
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crosscheck::files::read_pfm;
    use crate::crosscheck::scenes;

    fn exported(effect: Effect, fault: Option<Fault>) -> Value {
        let folder = tempfile::tempdir().expect("a folder");
        export(folder.path(), "blocks", effect, fault)
    }

    fn export(folder: &Path, scene: &str, effect: Effect, fault: Option<Fault>) -> Value {
        let setting = scenes::build(scene, Path::new("")).expect("built").expect("procedural");
        let sampling = Sampling { samples: 16, scramblings: 2, seed: 5 };
        write(folder, effect, &setting, fault, [4, 6], sampling).expect("written");
        let case: Value =
            serde_json::from_slice(&std::fs::read(folder.join("scene.json")).expect("a file")).expect("JSON");
        for mesh in case["meshes"].as_array().expect("meshes") {
            assert!(folder.join(mesh["file"].as_str().expect("a name")).is_file());
        }
        case
    }

    #[test]
    fn a_case_names_files_that_are_there_and_the_camera_looks_ahead() {
        let case = exported(Effect::Ao, None);
        assert_eq!((&case["integrator"]["type"], &case["seeds"]), (&json!("ao"), &json!(2)));
        assert_eq!((&case["samples_a_seed"], &case["first_seed"]), (&json!(8), &json!(5)));
        let at = |name: &str| {
            Vec3::from_slice(
                &serde_json::from_value::<Vec<f32>>(case["camera"][name].clone()).expect("three numbers"),
            )
        };
        let forward = at("target") - at("origin");
        // The camera of the blocks stands in front of them, to the right and above.
        assert!((forward.length() - 1.0).abs() < 1e-5 && forward.max_element() < 0.0, "{forward}");
        assert!(
            case["meshes"][0]["texture"]["wrap"] == "repeat"
                && case["lights"].as_array().expect("lights").len() == 3
        );
    }

    #[test]
    fn textures_are_read_as_the_scene_says() {
        let folder = tempfile::tempdir().expect("a folder");
        let setting = scenes::build("blocks", Path::new("")).expect("built").expect("procedural");
        let mut scene = setting.scene;
        scene.textures =
            scene.textures.iter().map(|t| (**t).clone().with_filter(Filter::Nearest).into()).collect();
        let mesh = write_mesh(folder.path(), &scene, &scene.meshes[0], "mesh".to_owned(), None);
        assert_eq!(mesh.expect("written")["texture"]["filter"], "nearest");
        let case = exported(Effect::Ao, None);
        assert_eq!(case["meshes"][0]["texture"]["filter"], "bilinear");
    }

    #[test]
    fn faults_are_put_in() {
        let intensity =
            |fault| exported(Effect::Aa, fault)["lights"][0]["intensity"][0].as_f64().expect("a number");
        assert!((intensity(Some(Fault::BrighterLights)) / intensity(None) - 1.02).abs() < 1e-5);
        assert_eq!(exported(Effect::Ao, Some(Fault::NoCosine))["integrator"]["cosine"], false);
        let sky = |fault| {
            let folder = tempfile::tempdir().expect("a folder");
            let case = export(folder.path(), "glossy", Effect::Ibl, fault);
            let sky = folder.path().join(case["environment"].as_str().expect("a sky"));
            read_pfm(&sky, 3).expect("a map").data().iter().sum::<f32>()
        };
        assert!((sky(Some(Fault::BrighterLights)) / sky(None) - 1.02).abs() < 1e-4);
    }

    #[test]
    fn environments_are_reflected_by_the_phong_model() {
        let folder = tempfile::tempdir().expect("a folder");
        for (effect, model) in [(Effect::Ibl, "phong"), (Effect::Path, "microfacets")] {
            let case = export(folder.path(), "glossy", effect, None);
            let meshes = case["meshes"].as_array().expect("meshes");
            assert!(meshes[0]["glossy"].is_null(), "the floor is matte");
            assert!(meshes[1..].iter().all(|mesh| mesh["glossy"]["type"] == model), "{effect}");
        }
    }

    #[test]
    fn the_back_of_a_triangle_faces_away_from_behind() {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let [a, b, c] = back(&mesh).corners(0);
        assert!((b - a).cross(c - a).z < 0.0 && a.z == -BACK);
    }
}
