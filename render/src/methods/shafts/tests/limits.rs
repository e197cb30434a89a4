//! Where geometry or the medium degenerates: every image is finite, and that of a march of many steps.

use super::*;
use crate::methods::shafts::{LampPosition, ViewRays};
use crate::scene::DensityGrid;
use crate::scene::TextureId;
use crate::scene::{Encoding, Texture, Wrap};

const SIZE: [usize; 2] = [45, 60];

/// Asserts that all methods show what a long march shows, epipolar sampling and froxels less exactly, and
/// returns it.
fn agreed(name: &str, scene: &TracedScene, camera: &Camera, tolerance: f64) -> Planes {
    agreed_but(name, scene, camera, tolerance, USUAL)
}

/// By how many times those on the GPU may usually be less exact: froxels are.
const USUAL: [f64; 3] = [1.0, 1.0, 10.0];

/// The same, those on the GPU being so many times less exact.
fn agreed_but(name: &str, scene: &TracedScene, camera: &Camera, tolerance: f64, of_gpu: [f64; 3]) -> Planes {
    let long = ray_march::RayMarchParameters {
        steps: 4096,
        jitter: false,
        ..ray_march::RayMarchParameters::of(Quality::Medium)
    };
    let expected = image(&Shafts(long), scene, camera, SIZE).expect("an image");
    assert!(expected.data().iter().all(|value| value.is_finite() && *value >= 0.0), "{name}");
    for method in methods(Quality::Medium) {
        let found = image(method.as_ref(), scene, camera, SIZE).expect("an image");
        let of = method.name();
        assert!(found.data().iter().all(|value| value.is_finite() && *value >= 0.0), "{name}: {of}");
        let off = error(&found, &expected);
        assert!(
            off < tolerance || of == epipolar_sampling::EpipolarSamplingParameters::NAME,
            "{name}: {of} is off by {off:e}"
        );
    }
    for (method, times) in on_gpu().into_iter().zip(of_gpu) {
        let found = image(method.as_ref(), scene, camera, SIZE).expect("an image");
        let of = method.name();
        assert!(found.data().iter().all(|value| value.is_finite() && *value >= 0.0), "{name}: {of}");
        let off = error(&found, &expected);
        assert!(off < times * tolerance, "{name}: {of} is off by {off:e}");
    }
    // What is between its samples, epipolar sampling may miss: lines are short here.
    let usual = epipolar_sampling::EpipolarSamplingParameters::of(Quality::Medium);
    let sampling = Shafts(epipolar_sampling::EpipolarSamplingParameters { spacing: 2, ..usual });
    let off = error(&image(&sampling, scene, camera, SIZE).expect("an image"), &expected);
    assert!(off < 20.0 * tolerance, "{name}: epipolar sampling is off by {off:e}");
    expected
}

fn is_black(image: &Planes) -> bool {
    image.data().iter().all(|value| *value == 0.0)
}

/// Whether the direction to a sun, or the one opposite to it, is in a camera's image.
fn shows(camera: &Camera, towards: Vec3) -> bool {
    let scene = scene(pergola(), vec![], fog(0.5, AROUND));
    let gbuffer = gbuffer::render(&scene, camera, SIZE[0], SIZE[1], &[Attribute::Depth, Attribute::Valid]);
    let rays = ViewRays::of(&Frame { scene: &scene, camera, gbuffer: &gbuffer, radius: 1.0, seed: 0 });
    let geometry = epipolar::Geometry::new(camera.position, LampPosition::Distant(towards)).expect("a sun");
    let at = geometry.epipole(&rays);
    (0.0..SIZE[1] as f64).contains(&at.x) && (0.0..SIZE[0] as f64).contains(&at.y)
}

#[test]
fn the_sun_may_be_anywhere() {
    let direction = Vec3::new(0.3, -1.0, 0.4).normalize();
    let scene = scene(pergola(), vec![sun(direction)], fog(0.5, AROUND));
    // In a shaft of light.
    let eye = Vec3::new(1.2, 1.2, 1.6);
    let across = direction.any_orthonormal_vector();
    for (name, view, is_shown) in [
        ("in the middle of the image", -direction, true),
        ("behind the camera", direction, true),
        ("across the view", across, false),
        ("near a corner", -direction + 0.4 * across, true),
    ] {
        let camera = Camera::look_at(eye, eye + view);
        assert_eq!(shows(&camera, -direction), is_shown, "{name}");
        assert!(!is_black(&agreed(name, &scene, &camera, 2e-3)), "{name}");
    }
    let outside = Vec3::new(-14.0, 9.0, 12.0);
    agreed("from outside", &scene, &Camera::look_at(outside, Vec3::ZERO), 2e-3);
    let afar = Camera { vertical_fov: 0.1, ..Camera::look_at(10.0 * outside, Vec3::ZERO) };
    agreed("from afar", &scene, &afar, 2e-3);
}

/// Where the way to a side of the fog's box is infinite, and rounding ends rays outside of it.
#[test]
fn the_sun_may_shine_along_an_axis_or_a_plane() {
    let camera = Camera::look_at(Vec3::new(1.2, 1.7, 4.1), Vec3::new(-0.3, 1.3, 0.2));
    for towards in [[0.0, 1.0, 0.0], [0.0, 0.2, 1.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, 0.3, -1.0]] {
        let direction = -Vec3::from(towards).normalize();
        let scene = scene(pergola(), vec![sun(direction)], fog(0.5, AROUND));
        agreed(&format!("towards {towards:?}"), &scene, &camera, 2e-3);
    }
}

/// Between two marched pixels light near a lamp grows as one over the sine of the angle to it.
#[test]
fn epipolar_sampling_interpolates_around_a_lamp() {
    let scene = scene(vec![floor()], vec![lamp(Vec3::new(0.3, 1.5, -1.0))], fog(0.0, AROUND));
    let camera = Camera::look_at(Vec3::new(0.0, 1.5, 4.0), Vec3::new(0.0, 1.4, 0.0));
    let size = [120, 160];
    let march =
        ray_march::RayMarchParameters { jitter: false, ..ray_march::RayMarchParameters::of(Quality::High) };
    let expected = image(&Shafts(march), &scene, &camera, size).expect("an image");
    let sampling = Shafts(epipolar_sampling::EpipolarSamplingParameters::of(Quality::Medium));
    let off = error(&image(&sampling, &scene, &camera, size).expect("an image"), &expected);
    assert!(off < 1e-3, "{off:e}");
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
        // The light is infinitely bright there, and froxels show its mean: finite is all that they have to
        // be.
        let of_gpu = if position == eye { [1.0, 1.0, f64::INFINITY] } else { USUAL };
        let scene = scene(pergola(), vec![lamp(position)], fog(0.5, AROUND));
        agreed_but(name, &scene, &ahead, 2e-3, of_gpu);
    }
}

#[test]
fn lamps_may_be_in_the_middle_of_an_image_of_odd_size() {
    let eye = Vec3::new(0.1, 1.2, 4.0);
    let position = eye - 3.0 * Vec3::Z;
    let scene = scene(pergola(), vec![lamp(position)], fog(0.5, AROUND));
    let camera = Camera::look_at(eye, position);
    for method in on_gpu() {
        let found = image(method.as_ref(), &scene, &camera, [33, 41]).expect("an image");
        let middle: [f32; 3] = std::array::from_fn(|c| found.at(c, 16, 20));
        let beside: [f32; 3] = std::array::from_fn(|c| found.at(c, 16, 21));
        let of = method.name();
        assert!(found.data().iter().all(|value| value.is_finite() && *value >= 0.0), "{of}");
        assert!(middle[0] > beside[0] && beside[0] > 0.0, "{of}: {middle:?} {beside:?}");
    }
}

/// A spot of five degrees across the view.
#[test]
fn narrow_spots_are_not_missed() {
    let (position, direction) = (Vec3::new(-2.5, 1.5, -2.0), Vec3::new(1.0, -0.1, 0.3).normalize());
    let Light::Spot { intensity, range, slide, .. } = spot(position, direction) else { return };
    let beam =
        Light::Spot { position, direction, intensity, range, cos_inner: 0.9995, cos_outer: 0.999, slide };
    let camera = Camera::look_at(Vec3::new(0.3, 1.2, 5.0), Vec3::new(0.0, 1.2, -2.0));
    let scene = scene(vec![floor()], vec![beam], fog(0.5, AROUND));
    assert!(!is_black(&agreed("a narrow spot", &scene, &camera, 2e-2)));
}

/// Mostly empty, and thick where it is not.
#[test]
fn thick_clouds_behind_empty_cells_are_seen() {
    let [min, max] = AROUND.map(Vec3::from);
    let cell = |i: usize| if i % 4 == 2 { 0.1 } else { 0.0 };
    let grid = DensityGrid::new(Bounds { min, max }, [4, 2, 3], (0..24).map(cell).collect()).expect("a grid");
    let medium = Medium { scattering: Vec3::splat(20.0), density: Density::Grid(grid), ..fog(0.3, AROUND) };
    let scene = scene(pergola(), vec![sun(Vec3::new(0.3, -1.0, 0.4))], medium);
    let camera = Camera::look_at(Vec3::new(-14.0, 9.0, 12.0), Vec3::ZERO);
    let long = ray_march::RayMarchParameters {
        steps: 4096,
        jitter: false,
        ..ray_march::RayMarchParameters::of(Quality::Ultra)
    };
    let expected = image(&Shafts(long), &scene, &camera, SIZE).expect("an image");
    assert!(!is_black(&expected));
    let [march, _, froxel] = on_gpu();
    for method in [march, froxel] {
        let off = error(&image(method.as_ref(), &scene, &camera, SIZE).expect("an image"), &expected);
        assert!(off < 2e-2, "{} is off by {off:e}", method.name());
    }
}

#[test]
fn where_no_light_is_it_is_black() {
    let ceiling = quad([(-9., -9.), (-9., 9.), (9., 9.), (9., -9.)].map(|(x, z)| Vec3::new(x, 3.0, z)));
    let covered = vec![floor(), ceiling];
    let inside = Camera::look_at(Vec3::new(0.0, 1.0, 5.0), Vec3::new(0.0, 1.2, 0.0));
    for method in on_gpu() {
        let unlit = scene(covered.clone(), vec![], fog(0.5, AROUND));
        assert!(
            is_black(&image(method.as_ref(), &unlit, &inside, SIZE).expect("an image")),
            "{}",
            method.name()
        );
    }
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
    let inside = Camera::look_at(Vec3::new(-0.3, 5.8, 0.2), Vec3::new(0.0, 2.0, 0.0));
    let outside = Camera::look_at(Vec3::new(-12.0, 9.0, 12.0), Vec3::new(0.0, 2.0, 0.0));
    let diagonal = (Vec3::from(AROUND[1]) - Vec3::from(AROUND[0])).length();
    for light in [sun(Vec3::new(0.3, -1.0, 0.4)), lamp(Vec3::new(0.6, 9.0, -1.0))] {
        for depth in [5.0, 10.0, 15.0, 100.0] {
            let scattering = Vec3::splat(depth / diagonal);
            let medium = Medium { absorption: Vec3::ZERO, scattering, ..fog(0.2, AROUND) };
            let scene = scene(pergola(), vec![light], medium);
            agreed(&format!("inside, {depth}"), &scene, &inside, 1e-2);
            agreed(&format!("outside, {depth}"), &scene, &outside, 1e-2);
        }
    }
}

#[test]
fn fog_may_let_one_colour_pass_and_swallow_another() {
    let scattering = Vec3::new(1e-3, 0.3, 3.0);
    let medium = Medium { absorption: Vec3::ZERO, scattering, ..fog(0.2, AROUND) };
    for light in [sun(Vec3::new(0.3, -1.0, 0.4)), lamp(Vec3::new(0.6, 9.0, -1.0))] {
        let scene = scene(pergola(), vec![light], medium.clone());
        for eye in [Vec3::new(-0.3, 2.0, 0.2), Vec3::new(-14.0, 9.0, 12.0)] {
            agreed(&format!("from {eye}"), &scene, &Camera::look_at(eye, Vec3::new(0.0, 1.0, -1.0)), 1e-2);
        }
    }
}

#[test]
fn pictures_colour_the_light() {
    let texels = vec![[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];
    let texture = Texture::new(2, 2, texels, Encoding::Linear, [Wrap::Repeat; 2]);
    let inside = Camera::look_at(Vec3::new(-3.0, 1.5, 4.0), Vec3::new(0.0, 1.2, 0.0));
    let outside = Camera::look_at(Vec3::new(-30.0, 19.0, 24.0), Vec3::ZERO);
    let Light::Directional { direction, irradiance, .. } = sun(Vec3::new(0.3, -1.0, 0.4)) else { return };
    let glass = Light::Directional { direction, irradiance, pattern: Some((TextureId(0), 1.5)) };
    let mut slide = spot(Vec3::new(0.5, 5.0, -3.0), Vec3::new(-0.2, -1.0, 0.5));
    if let Light::Spot { slide, .. } = &mut slide {
        *slide = Some(TextureId(0));
    }
    for light in [glass, slide] {
        // So low a box that light rays pass beside it, and so dense that what would reach it from there is no
        // number.
        let low = Medium { absorption: Vec3::splat(8.0), ..fog(0.5, [[-9.0, -0.5, -9.0], [9.0, 1.0, 9.0]]) };
        let plain = scene(pergola(), vec![], fog(0.5, AROUND));
        let covered = scene(pergola(), vec![], low);
        for (name, plain, camera) in [
            ("picture", &plain, inside),
            ("picture from outside", &plain, outside),
            ("low", &covered, outside),
        ] {
            let coloured = Scene {
                lights: vec![light],
                textures: vec![texture.clone().into()],
                ..plain.scene().clone()
            };
            // There pixels are as large as the colours: `gpu-epipolar` mixes what single light rays beside
            // them show, and froxels what is half a pixel beside them.
            let of_gpu = if name == "low" { [1.0, 4.0, 20.0] } else { USUAL };
            agreed_but(name, &TracedScene::new(coloured).expect("triangles"), &camera, 5e-3, of_gpu);
        }
    }
}

/// A narrow beam before a wall without any jump of depth (Baran et al. 2010, Figure 13): what epipolar
/// sampling misses.
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
    let size = [240, 320];
    let long = ray_march::RayMarchParameters {
        steps: 4096,
        jitter: false,
        ..ray_march::RayMarchParameters::of(Quality::Medium)
    };
    let expected = image(&Shafts(long), &scene, &camera, size).expect("an image");
    let error =
        |method: &dyn Method| error(&image(method, &scene, &camera, size).expect("an image"), &expected);
    // So many steps that only interpolation is wrong.
    let sampling = |spacing: usize| {
        let usual = epipolar_sampling::EpipolarSamplingParameters::of(Quality::Medium);
        error(&Shafts(epipolar_sampling::EpipolarSamplingParameters { spacing, steps: 4096, ..usual }))
    };
    let tree = error(&Shafts(epipolar::EpipolarParameters::of(Quality::Medium)));
    let [every, few] = [1, 16].map(sampling);
    assert!(tree < 5e-4 && every < 5e-5, "{tree:e}, {every:e}");
    assert!(few > 4.0 * tree, "{few:e}, {tree:e}");
}
