//! Where geometry or the medium degenerates: every image is finite, and that of a march of many steps.

use super::*;
use crate::metrics::relative_mse;
use crate::scene::TextureId;
use crate::scene::{Encoding, Texture, Wrap};

const SIZE: [usize; 2] = [45, 60];

/// Asserts that all methods show what a long march shows (epipolar sampling something finite), and returns it.
fn agreed(name: &str, scene: &TracedScene, camera: &Camera, tolerance: f64) -> Planes {
    let long =
        ray_march::Parameters { steps: 4096, jitter: false, ..ray_march::Parameters::of(Quality::Medium) };
    let expected = image(&Shafts(long), scene, camera, SIZE).expect("an image");
    assert!(expected.data().iter().all(|value| value.is_finite() && *value >= 0.0), "{name}");
    for method in methods(Quality::Medium) {
        let found = image(method.as_ref(), scene, camera, SIZE).expect("an image");
        assert!(
            found.data().iter().all(|value| value.is_finite() && *value >= 0.0),
            "{name}: {}",
            method.name()
        );
        // What is between its samples, epipolar sampling may miss.
        let error = relative_mse(&found, &expected);
        let is_exact = method.name() != epipolar_sampling::Parameters::NAME;
        assert!(error < tolerance || !is_exact, "{name}: {} is off by {error:e}", method.name());
    }
    expected
}

fn is_black(image: &Planes) -> bool {
    image.data().iter().all(|value| *value == 0.0)
}

#[test]
fn the_sun_may_be_anywhere() {
    let direction = Vec3::new(0.3, -1.0, 0.4).normalize();
    let scene = scene(pergola(), vec![sun(direction)], fog(0.5, AROUND));
    let eye = Vec3::new(0.1, 1.2, 0.7);
    let across = direction.any_orthonormal_vector();
    for (name, view) in [
        ("in the middle of the image", -direction),
        ("behind the camera", direction),
        ("across the view", across),
        ("near a corner", -direction + 0.4 * across),
    ] {
        assert!(!is_black(&agreed(name, &scene, &Camera::look_at(eye, eye + view), 2e-3)), "{name}");
    }
    agreed("from outside", &scene, &Camera::look_at(Vec3::new(-14.0, 9.0, 12.0), Vec3::ZERO), 2e-3);
}

#[test]
fn lamps_may_be_anywhere() {
    let eye = Vec3::new(0.1, 1.2, 0.7);
    let ahead = Camera::look_at(eye, eye + Vec3::new(0.2, 0.1, -1.0));
    for (name, position) in [
        ("in the image", eye + Vec3::new(0.5, 0.4, -3.0)),
        ("behind the camera", eye + Vec3::new(0.3, 0.2, 2.0)),
        ("beside the eye", eye + Vec3::X),
        ("above the roof", Vec3::new(0.6, 5.0, -1.0)),
        ("at the eye", eye),
        ("beyond the fog", Vec3::new(0.6, 20.0, -1.0)),
    ] {
        agreed(name, &scene(pergola(), vec![lamp(position)], fog(0.5, AROUND)), &ahead, 2e-3);
    }
}

#[test]
fn where_no_light_is_it_is_black() {
    let ceiling = quad([(-9., -9.), (-9., 9.), (9., 9.), (9., -9.)].map(|(x, z)| Vec3::new(x, 3.0, z)));
    let covered = vec![floor(), ceiling];
    let inside = Camera::look_at(Vec3::new(0.0, 1.0, 5.0), Vec3::new(0.0, 1.2, 0.0));
    // Under a ceiling; a spot that shines from behind it.
    let below = [[-8.0, 0.0, -8.0], [8.0, 2.9, 8.0]];
    for light in [sun(Vec3::NEG_Y), spot(Vec3::Y * 5.0, Vec3::NEG_Y)] {
        let shadow = agreed("shadow", &scene(covered.clone(), vec![light], fog(0.5, below)), &inside, 1e-9);
        assert!(is_black(&shadow));
    }
    let nothing = Medium { scattering: Vec3::ZERO, ..fog(0.0, AROUND) };
    assert!(is_black(&agreed(
        "absorption",
        &scene(pergola(), vec![sun(Vec3::NEG_Y)], nothing),
        &inside,
        1e-9
    )));
    // No sunlight is left where fog has no end.
    let endless = Medium { density: Density::Everywhere, ..fog(0.0, AROUND) };
    assert!(is_black(&agreed("endless", &scene(pergola(), vec![sun(Vec3::NEG_Y)], endless), &inside, 1e-9)));
}

#[test]
fn dense_fog_shows_what_is_near() {
    let direction = Vec3::new(0.3, -1.0, 0.4);
    for [inside, depth] in [[true, false], [true, true], [false, false], [false, true]] {
        let extinction = if depth { 40.0 } else { 4.0 };
        let medium =
            Medium { absorption: Vec3::ZERO, scattering: Vec3::splat(extinction), ..fog(0.2, AROUND) };
        let eye = if inside { Vec3::new(-0.3, 5.8, 0.2) } else { Vec3::new(-12.0, 9.0, 12.0) };
        let camera = Camera::look_at(eye, Vec3::new(0.0, 2.0, 0.0));
        let scene = scene(pergola(), vec![sun(direction)], medium);
        agreed(&format!("inside: {inside}, {extinction}/m"), &scene, &camera, 1e-2);
    }
}

#[test]
fn pictures_colour_the_light() {
    let texels = vec![[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];
    let texture = Texture::new(2, 2, texels, Encoding::Linear, [Wrap::Repeat; 2]);
    let camera = Camera::look_at(Vec3::new(-3.0, 1.5, 4.0), Vec3::new(0.0, 1.2, 0.0));
    let Light::Directional { direction, irradiance, .. } = sun(Vec3::new(0.3, -1.0, 0.4)) else { return };
    let glass = Light::Directional { direction, irradiance, pattern: Some((TextureId(0), 1.5)) };
    let mut slide = spot(Vec3::new(0.5, 5.0, -3.0), Vec3::new(-0.2, -1.0, 0.5));
    if let Light::Spot { slide, .. } = &mut slide {
        *slide = Some(TextureId(0));
    }
    for light in [glass, slide] {
        let plain = scene(pergola(), vec![], fog(0.5, AROUND));
        let coloured =
            Scene { lights: vec![light], textures: vec![texture.clone().into()], ..plain.scene().clone() };
        let coloured = TracedScene::new(coloured).expect("triangles");
        agreed("picture", &coloured, &camera, 2e-3);
    }
}

/// A narrow beam before a wall without any jump of depth (Baran et al. 2010, Figure 13): what epipolar sampling misses.
#[test]
fn a_narrow_beam_before_a_wall_is_seen_by_trees_and_missed_between_samples() {
    let roof = |x: [f32; 2]| {
        quad([(x[0], -5.), (x[0], 5.), (x[1], 5.), (x[1], -5.)].map(|(x, z)| Vec3::new(x, 4.0, z)))
    };
    let wall = quad([(-5., -5.), (5., -5.), (5., 5.), (-5., 5.)].map(|(x, y)| Vec3::new(x, y, -2.0)));
    let meshes = vec![wall, roof([-5.0, 0.0]), roof([0.08, 5.0])];
    let scene =
        scene(meshes, vec![sun(Vec3::new(0.9, -1.0, 0.0))], fog(0.0, [[-5.0, -5.0, -5.0], [5.0, 5.0, 5.0]]));
    let camera = Camera::look_at(Vec3::new(2.0, 1.0, 4.0), Vec3::new(2.0, 1.0, 0.0));
    let size = [120, 160];
    let long =
        ray_march::Parameters { steps: 4096, jitter: false, ..ray_march::Parameters::of(Quality::Medium) };
    let expected = image(&Shafts(long), &scene, &camera, size).expect("an image");
    let [_, tree, sampling, _] = methods(Quality::Medium);
    let error = |method: &dyn Method| {
        relative_mse(&image(method, &scene, &camera, size).expect("an image"), &expected)
    };
    let [tree, sampling] = [error(tree.as_ref()), error(sampling.as_ref())];
    assert!(sampling > 4.0 * tree, "{sampling:e} and {tree:e}");
}
