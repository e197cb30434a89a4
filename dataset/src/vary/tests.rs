use super::*;
use crate::recipe::Recipe;
use crate::{SceneOrCapture, SceneRecord, views};
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::scene::{AlphaMode, Camera, Density, Gloss, Light, Material, Mesh, Scene, SceneSource};
use deepshade_shaders::{Attribute, Effect};
use glam::Vec3;
use std::path::Path;

/// A recipe for an effect with a table `vary`.
pub(super) fn recipe(folder: &Path, effect: &str, vary: &str) -> Recipe {
    let path = folder.join(format!("{effect}.toml"));
    let text = format!(
        "effect = \"{effect}\"\nsplit = \"train\"\nseed = 3\nresolution = {{ height = 24, width = 32 }}\n\
         samples = 2\nradius = {{ diagonal = 0.1 }}\nviews_per_scene = 2\nvalidation_share = 0.5\n{vary}\n\
         [[families]]\nname = \"still-life\"\nscenes = 1\n"
    );
    std::fs::write(&path, text).expect("written");
    Recipe::load(&path).expect("a sound recipe")
}

pub(super) fn record(recipe: &Recipe) -> SceneRecord {
    recipe.plan().expect("a plan")[0].scene.clone()
}

fn camera(scene: &StagedScene<'_>) -> Camera {
    views::sample_view(scene.base(), [24, 32], 1, 2, 0).expect("a view")
}

const SHADED: &str = "vary = { materials = true, textures = { procedural = 5 }, light = true }";

#[test]
fn images_differ_in_what_is_varied_and_in_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = recipe(folder.path(), "aa", SHADED);
    let props = Props::load(&recipe).expect("textures");
    let staged = StagedScene::load(&record(&recipe), &recipe, &props).expect("a scene");
    let camera = camera(&staged);
    let shown = |seed| {
        let (seen_by, variation) = staged.draw(camera, seed);
        assert_eq!(seen_by, camera, "no lens");
        staged.shown(&camera, variation.as_ref()).expect("shown")
    };
    let (first, again, other) = (shown(1), shown(1), shown(2));
    let look = |scene: &TracedScene| format!("{:?} {:?}", scene.scene().materials, scene.scene().lights);
    assert_eq!(look(&first), look(&again));
    assert_ne!(look(&first), look(&other));
    let scene = first.scene();
    assert_eq!(scene.materials.len(), scene.meshes.len(), "every object has a material of its own");
    assert_eq!(scene.lights.len(), 1);
    for (mesh, material) in scene.meshes.iter().zip(&scene.materials) {
        assert_eq!(mesh.uvs[0].len(), mesh.positions.len());
        assert_eq!(material.gloss, Gloss::Phong);
        let slot = material.base_colour_texture.expect("a texture");
        let own = staged.base().scene().textures.len();
        assert_eq!(slot.texture.0 as usize >= own, material.alpha == AlphaMode::Opaque);
        let specular = material.specular.expect("a specular colour");
        let both = material.base_colour.truncate() + specular;
        assert!(both.max_element() <= 1.0 + 1e-6 && specular.min_element() >= 0.0, "{both}");
    }
    assert!(scene.textures.len() - staged.base().scene().textures.len() <= 5, "none is in memory twice");
    let hit = |scene: &TracedScene| scene.hit(camera.position, camera.rotation * Vec3::NEG_Z, f32::INFINITY);
    assert_eq!(hit(&first), hit(staged.base()));
}

#[test]
fn specular_colours_are_of_every_brightness_and_hue() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = recipe(folder.path(), "aa", SHADED);
    let props = Props::load(&recipe).expect("textures");
    let staged = StagedScene::load(&record(&recipe), &recipe, &props).expect("a scene");
    let camera = camera(&staged);
    let colours = (0..40).flat_map(|seed| {
        let (_, variation) = staged.draw(camera, seed);
        let shown = staged.shown(&camera, variation.as_ref()).expect("shown");
        shown.scene().materials.iter().filter_map(|material| material.specular).collect::<Vec<_>>()
    });
    let colours: Vec<Vec3> = colours.collect();
    let share = |holds: &dyn Fn(&Vec3) -> bool| {
        colours.iter().filter(|colour| holds(colour)).count() as f32 / colours.len() as f32
    };
    let [dark, bright] = [share(&|c| c.max_element() < 0.25), share(&|c| c.max_element() > 0.4)];
    assert!(colours.len() >= 100 && dark > 0.15 && bright > 0.15, "{dark} dark, {bright} bright");
    for channel in 0..3 {
        let most = share(&|c| c.max_position() == channel && c.max_element() - c.min_element() > 0.02);
        assert!(most > 0.15, "{most} are of channel {channel}");
    }
}

#[test]
fn nothing_is_drawn_where_nothing_is_varied() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = recipe(folder.path(), "ao", "");
    let props = Props::load(&recipe).expect("nothing");
    let staged = StagedScene::load(&record(&recipe), &recipe, &props).expect("a scene");
    let camera = camera(&staged);
    assert_eq!(staged.draw(camera, 5), (camera, None));
    assert!(std::ptr::eq(&raw const *staged.shown(&camera, None).expect("shown"), staged.base()));
}

#[test]
fn a_dark_scene_gets_a_lamp_that_lights_what_is_seen() {
    let folder = tempfile::tempdir().expect("a folder");
    let obj = "v 0 0 0\nv 4 0 0\nv 4 0 4\nv 0 0 4\nv 1 0 1\nv 1 2 1\nv 3 0 2\nv 2 1.5 3\n\
               f 4 3 2 1\nf 5 6 7\nf 7 6 8\n";
    std::fs::write(folder.path().join("dark.obj"), obj).expect("written");
    let recipe = recipe(folder.path(), "gi", "");
    let scene = Scene::load(&folder.path().join("dark.obj"), 0.0).expect("a scene");
    let blake3 = Some(crate::identity::scene_hash(&scene));
    let dark = SceneRecord { source: SceneOrCapture::Scene(SceneSource::File("dark.obj".into())), blake3 };
    let props = Props::load(&recipe).expect("nothing");
    let staged = StagedScene::load(&dark, &recipe, &props).expect("a scene");
    let camera = Camera::look_at(Vec3::new(2.0, 2.5, 6.0), Vec3::new(2.0, 0.3, 2.0));
    let (_, variation) = staged.draw(camera, 9);
    let shown = staged.shown(&camera, variation.as_ref()).expect("shown");
    let [Light::Point { position, intensity, .. }] = shown.scene().lights[..] else {
        unreachable!("one point light, not {:?}", shown.scene().lights)
    };
    assert!(views::is_open(staged.base(), position, 0.0) && intensity.min_element() > 0.0);
    let lit = views::seen_points(&shown, &camera, [24, 32]).into_iter().filter(|point| {
        let to_lamp = position - point.position;
        point.normal.dot(to_lamp) > 0.0 && !shown.blocked(point.ray_origin(), to_lamp, 1.0)
    });
    assert!(lit.count() > 20);
}

/// A ring, through whose hole a lamp could hang: a place in its box is no place for the lamp of a picture of
/// it.
#[test]
fn a_lamp_for_a_view_of_an_object_stands_beside_the_camera() {
    let ring = |i: usize| {
        let (sin, cos) = (std::f32::consts::TAU * (i / 2 % 16) as f32 / 16.0).sin_cos();
        Vec3::new(cos, if i.is_multiple_of(2) { -0.5 } else { 0.5 }, sin)
    };
    let triangle = |i: usize| if i.is_multiple_of(2) { [i, i + 1, i + 2] } else { [i + 1, i, i + 2] };
    let mesh = Mesh {
        positions: (0..34).map(ring).collect(),
        triangles: (0..32).map(|i| triangle(i).map(|vertex| vertex as u32)).collect(),
        ..Mesh::default()
    };
    let scene = TracedScene::new(Scene {
        meshes: vec![mesh].into(),
        materials: vec![Material::default()],
        ..Scene::default()
    })
    .expect("a ring");
    let eye = Vec3::new(0.5, 1.0, 5.0);
    let camera = Camera::look_at(eye, Vec3::ZERO);
    let seen = views::seen_points(&scene, &camera, [24, 32]);
    for seed in 0..8 {
        let Lamp { position, intensity } = Lamp::of_view(&scene, &camera, [24, 32], seed);
        assert!(position.distance(eye) < 0.6 * eye.length(), "{position} is far from the camera");
        assert!(position.length() > 3.0, "{position} is in the ring");
        let lit = seen.iter().filter(|point| {
            let to_lamp = position - point.position;
            point.normal.dot(to_lamp) > 0.0 && !scene.blocked(point.ray_origin(), to_lamp, 1.0)
        });
        assert!(lit.count() * 10 >= seen.len() * 7);
        // A white surface that faces it shines with 0.7 to 1.5, from about where the ring is.
        let radiance = intensity.x * std::f32::consts::FRAC_1_PI / position.length_squared();
        assert!((0.4..2.5).contains(&radiance), "{radiance}");
        // Somebody who stands in the ring gets the lamp of the ring's box.
        let inside = Camera::look_at(Vec3::new(0.0, 0.1, 0.2), Vec3::X);
        let drawn = Lamp::drawn(&scene, &inside, [24, 32], seed);
        assert_eq!(Lamp::of_view(&scene, &inside, [24, 32], seed), drawn);
    }
}

#[test]
fn lenses_fog_motion_and_skin_stay_in_their_ranges() {
    let folder = tempfile::tempdir().expect("a folder");
    let staged = |effect: &str, vary: &str, check: &dyn Fn(&StagedScene<'_>, Camera)| {
        let recipe = recipe(folder.path(), effect, &format!("vary = {{ {vary} }}"));
        let props = Props::load(&recipe).expect("props");
        let staged = StagedScene::load(&record(&recipe), &recipe, &props).expect("a scene");
        check(&staged, camera(&staged));
    };
    staged("dof", "lens = [2.0, 6.0]", &|scene, camera| {
        let depths: Vec<f32> = views::seen_points(scene.base(), &camera, [24, 32])
            .iter()
            .map(|point| -camera.to_camera(point.position).z)
            .collect();
        for seed in 0..20 {
            let camera = scene.draw(camera, seed).0;
            assert!((1.999..=6.001).contains(&camera.blur_at_infinity(24)), "{seed}");
            assert!(depths.contains(&camera.lens.expect("a lens").focus), "{seed}: what is seen is in focus");
        }
    });
    staged("sss", "mean_free_path = [0.01, 0.02]", &|scene, camera| {
        let (_, variation) = scene.draw(camera, 4);
        let shown = scene.shown(&camera, variation.as_ref()).expect("shown");
        for material in &shown.scene().materials {
            let longest = material.mean_free_path.max_element() / shown.diagonal();
            assert!((0.00999..=0.02001).contains(&longest) && material.mean_free_path.min_element() > 0.0);
        }
    });
    staged("fog-direct", "fog = { optical_depth = [0.5, 2.0], smoke_share = 0.5 }", &|scene, camera| {
        let mut smoky = 0;
        for seed in 0..16 {
            let (_, variation) = scene.draw(camera, seed);
            let shown = scene.shown(&camera, variation.as_ref()).expect("shown");
            let medium = shown.scene().medium.as_ref().expect("a medium");
            medium.check().expect("a sound medium");
            let grid = matches!(medium.density, Density::Grid(_));
            let depth = medium.extinction().x * shown.diagonal() / if grid { 2.0 } else { 1.0 };
            assert!((0.499..=2.001).contains(&depth), "{seed}: {depth}");
            smoky += usize::from(grid);
        }
        assert!((3..14).contains(&smoky), "{smoky} of 16 with smoke");
    });
    staged("motion-blur", "motion = [3.0, 8.0]", &|scene, camera| {
        let (_, variation) = scene.draw(camera, 6);
        let shown = scene.shown(&camera, variation.as_ref()).expect("shown");
        let mut nearest = std::collections::HashMap::new();
        for point in views::seen_points(scene.base(), &camera, [24, 32]) {
            let depth = -camera.to_camera(point.position).z;
            let entry = nearest.entry(point.mesh).or_insert(depth);
            *entry = entry.min(depth);
        }
        let moving =
            shown.scene().meshes.iter().enumerate().filter(|(_, mesh)| !mesh.displacements.is_empty());
        let mut count = 0;
        for (index, mesh) in moving {
            let way = camera.direction_to_camera(mesh.displacements[0]);
            assert!(way.z.abs() < 1e-4 * way.length(), "parallel to the image plane: {way}");
            let pixels = way.length() * camera.focal_length(24) / nearest[&(index as u32)];
            assert!((2.99..=8.01).contains(&pixels), "{pixels}");
            count += 1;
        }
        assert!(count > 0 && count < shown.scene().meshes.len(), "{count} move");
        assert_eq!(shown.bounds(), scene.base().bounds(), "the middle of the exposure is the scene itself");
    });
}

#[test]
fn one_environment_is_in_all_images_and_its_file_is_checked() {
    let folder = tempfile::tempdir().expect("a folder");
    let vary = "vary = { environment = { sky = 2 } }";
    let recipe = recipe(folder.path(), "do", vary);
    let props = Props::load(&recipe).expect("a sky");
    let staged = StagedScene::load(&record(&recipe), &recipe, &props).expect("a scene");
    let camera = camera(&staged);
    let environment = |seed| {
        let (_, variation) = staged.draw(camera, seed);
        assert_eq!(variation.and_then(|variation| variation.lamp), None, "the environment is the light");
        staged.shown(&camera, variation.as_ref()).expect("shown").scene().environment.clone()
    };
    assert_eq!(environment(1).expect("an environment"), environment(2).expect("an environment"));
    assert!(hashes(&recipe).expect("no files").is_empty());

    let picture = |name: &str, grey: u8| {
        let image = image::GrayImage::from_pixel(4, 4, image::Luma([grey]));
        std::fs::create_dir_all(folder.path().join("pool")).expect("made");
        image.save(folder.path().join("pool").join(name)).expect("written");
    };
    picture("a.png", 90);
    picture("b.png", 200);
    let textured = "vary = { textures = { folder = \"pool\" } }";
    let recipe = self::recipe(folder.path(), "aa", textured);
    let made_from = hashes(&recipe).expect("hashes");
    assert_eq!(made_from.len(), 1);
    assert_eq!(Props::load_again(&recipe, &made_from).expect("the same").textures().len(), 2);
    let unread = Props::load(&recipe).expect("a pool");
    picture("b.png", 201);
    let error = Props::load_again(&recipe, &made_from).expect_err("another image").to_string();
    assert!(error.contains("pool") && error.contains("not what the data were made from"), "{error}");
    std::fs::remove_dir_all(folder.path().join("pool")).expect("removed");
    assert!(Props::load(&recipe).expect_err("gone").to_string().contains("pool"));
    std::fs::create_dir(folder.path().join("pool")).expect("made");
    assert!(Props::load(&recipe).expect_err("empty").to_string().contains("holds no PNG or JPEG image"));
    let staged = StagedScene::load(&record(&recipe), &recipe, &unread).expect("a scene");
    let (_, variation) = staged.draw(camera, 1);
    let error = staged.shown(&camera, variation.as_ref()).expect_err("gone when it is drawn").to_string();
    assert!(error.contains("pool"), "{error}");
}

#[test]
fn a_variation_is_what_it_was_after_json() {
    let lamp = Lamp { position: Vec3::new(0.1, 1.0 / 3.0, -7.7e-3), intensity: Vec3::splat(12.345_678) };
    let variation = Variation { seed: u32::MAX, lamp: Some(lamp), fog: None, moment: None };
    let text = serde_json::to_string(&variation).expect("JSON");
    assert_eq!(serde_json::from_str::<Variation>(&text).expect("a variation"), variation);
}

#[test]
fn keys_that_an_effect_lacks_or_does_not_know_are_named() {
    let refused = |effect: Effect, vary: &Vary| vary.check(effect).expect_err("refused");
    let nothing = Vary::default();
    for (effect, key) in [
        (Effect::Do, "environment"),
        (Effect::Ibl, "environment"),
        (Effect::Sss, "mean_free_path"),
        (Effect::Dof, "lens"),
        (Effect::Multi, "lens"),
        (Effect::MotionBlur, "motion"),
        (Effect::FogMultiple, "fog"),
        (Effect::Real, "sensor"),
    ] {
        assert_eq!(refused(effect, &nothing), format!("effect `{effect}` needs the key `vary.{key}`"));
    }
    let lit = Vary { light: true, ..Vary::default() };
    assert_eq!(refused(Effect::Ao, &lit), "`vary.light` means nothing for effect `ao`");
    let noisy = Vary { sensor: Some(Sensor::StructuredLight), ..Vary::default() };
    assert_eq!(refused(Effect::Path, &noisy), "`vary.sensor` means nothing for effect `path`");
    let blurred = Vary { lens: Some([1.0, 2.0]), ..Vary::default() };
    assert_eq!(refused(Effect::Gi, &blurred), "`vary.lens` means nothing for effect `gi`");
    let sky = Vary { environment: Some(Surroundings::Sky(1)), lens: Some([1.0, 2.0]), ..Vary::default() };
    assert_eq!(refused(Effect::Dof, &sky), "`vary.environment` means nothing for effect `dof`");
    assert!(
        lit.check(Effect::Gi).is_ok()
            && blurred.check(Effect::Dof).is_ok()
            && nothing.check(Effect::Ao).is_ok()
    );
    for range in [[2.0, 1.0], [0.0, 1.0], [1.0, 1e9], [f32::NAN, 1.0]] {
        let error = refused(Effect::Dof, &Vary { lens: Some(range), ..Vary::default() });
        assert!(error.contains("`vary.lens` must be two numbers"), "{error}");
    }
    let fog = |fog| Vary { fog: Some(fog), ..Vary::default() };
    let error = refused(Effect::FogDirect, &fog(FogRange { optical_depth: [1.0; 2], smoke_share: 1.5 }));
    assert!(error.contains("`vary.fog.smoke_share` must be 0 to 1"), "{error}");
    let none = Vary { textures: Some(Textures::Procedural(0)), ..Vary::default() };
    assert!(refused(Effect::Aa, &none).contains("`vary.textures.procedural` must be 1 to 512"));
    let one = Vary { environment: Some(Surroundings::Skies(1)), ..Vary::default() };
    assert!(refused(Effect::Do, &one).contains("`vary.environment.skies` must be 2 to 256"));
}

/// A triangle whose node moves evenly along x, from the origin to 4 m in the first two seconds, above another
/// that stays.
const SLIDING: &str = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
    "nodes": [{"mesh": 0}, {"mesh": 1}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}, {"primitives": [{"attributes": {"POSITION": 1}}]}],
    "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
        "samplers": [{"input": 2, "output": 3}]}],
    "buffers": [{"uri": "sliding.bin", "byteLength": 104}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 36},
        {"buffer": 0, "byteOffset": 72, "byteLength": 8}, {"buffer": 0, "byteOffset": 80, "byteLength": 24}],
    "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-2, 0, 0], "max": [2, 2, 0]},
        {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-9, 0, -9], "max": [9, 0, 9]},
        {"bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [2]},
        {"bufferView": 3, "componentType": 5126, "count": 2, "type": "VEC3"}]}"#;

/// [`SLIDING`] as a file of a folder.
pub(super) fn sliding(folder: &Path) -> SceneRecord {
    let sliding = [-2.0f32, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0];
    let floor = [-9.0, 0.0, 9.0, 9.0, 0.0, 9.0, 0.0, 0.0, -9.0];
    let (times, places) = ([0.0, 2.0], [0.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
    let numbers = sliding.into_iter().chain(floor).chain(times).chain(places);
    let bytes: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
    std::fs::write(folder.join("sliding.bin"), bytes).expect("written");
    let path = folder.join("sliding.gltf");
    std::fs::write(&path, SLIDING).expect("written");
    SceneRecord {
        source: SceneOrCapture::Scene(SceneSource::File("sliding.gltf".into())),
        blake3: Some(crate::identity::scene_hash(&Scene::load(&path, 0.0).expect("a scene"))),
    }
}

#[test]
fn what_is_animated_in_a_file_moves_at_a_time_of_its_own_in_every_image() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = sliding(folder.path());
    let vary = "vary = { textures = { procedural = 2 }, motion = [3.0, 8.0] }";
    let recipe = recipe(folder.path(), "motion-blur", vary);
    let props = Props::load(&recipe).expect("textures");
    let staged = StagedScene::load(&file, &recipe, &props).expect("a scene");
    let camera = Camera::look_at(Vec3::new(2.0, 1.5, 8.0), Vec3::new(2.0, 0.5, 0.0));
    let mut places = Vec::new();
    for seed in 0..4 {
        let (camera, variation) = staged.draw(camera, seed);
        let shown = staged.shown(&camera, variation.as_ref()).expect("shown");
        let triangle = &shown.scene().meshes[0];
        // Two metres a second in a twenty-fourth of it; half as far at an end of the animation.
        let way = triangle.displacements[0];
        assert!((0.041..0.084).contains(&way.x) && way.y == 0.0 && way.z == 0.0, "{way}");
        places.push(triangle.positions[0].x);
        let gbuffer = gbuffer::render(&shown, &camera, 24, 32, &[Attribute::Motion]);
        let length = gbuffer.planes().plane(1);
        assert!(length.iter().any(|pixels| *pixels > 0.05), "the network sees it move");
        let again = staged.shown(&camera, variation.as_ref()).expect("shown");
        assert_eq!(again.scene().meshes[0].positions, triangle.positions, "from the manifest alone");
    }
    assert!(places.iter().all(|x| (-2.0..=2.0).contains(x)));
    places.sort_unstable_by(f32::total_cmp);
    places.dedup();
    assert_eq!(places.len(), 4, "each at its own time: {places:?}");
}
