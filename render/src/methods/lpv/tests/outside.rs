//! Lamps and cameras that are outside of the grid.

use super::room::{mean, shaded};
use super::*;
use crate::methods::proving::view;
use crate::path::{self, Sampling, Shot};
use crate::scene::{Bounds, Light, Material, Mesh};

/// A floor with a wall at one of its edges, in fog; what lights it is a few kilometres away.
fn under(lamp: Light) -> Scene {
    let quad = |corners: [[f32; 3]; 4]| Mesh {
        positions: corners.map(Vec3::from_array).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let floor = quad([[-1., 0., 1.], [1., 0., 1.], [1., 0., -1.], [-1., 0., -1.]]);
    let wall = quad([[1., 0., -1.], [1., 0., 1.], [1., 1., 1.], [1., 1., -1.]]);
    let density = Density::Within(Bounds { min: Vec3::new(-1.0, 0.0, -1.0), max: Vec3::ONE });
    let medium = Medium::new(Vec3::splat(0.05), Vec3::splat(0.6), 0.2, density).expect("fog");
    Scene {
        meshes: vec![floor, wall].into(),
        materials: vec![Material::default()],
        lights: vec![lamp],
        medium: Some(medium.into()),
        ..Scene::default()
    }
}

/// The way that light comes from.
fn up() -> Vec3 {
    Vec3::new(-0.5, 0.9, 0.3).normalize()
}

/// A lamp at a distance, as bright as a sun at the grid.
fn lamp(distance: f32) -> Light {
    let intensity = Vec3::splat(10.0 * distance * distance);
    Light::Point { position: distance * up(), intensity, range: f32::INFINITY }
}

const SEEN_FROM: Vec3 = Vec3::new(-0.2, 1.6, 2.4);

fn seen_from() -> Camera {
    Camera::look_at(SEEN_FROM, Vec3::new(0.3, 0.2, 0.0))
}

#[test]
fn a_lamp_far_outside_of_the_grid_lights_as_a_sun_does() {
    let sun = Light::Directional { direction: -up(), irradiance: Vec3::splat(10.0), pattern: None };
    let indirect = InMedium::indirect_at(FEW, Pixel { medium: true, surface: true });
    let images = |scene: &Scene| {
        let shade = |technique: &dyn Fn(Scene) -> Vec<f32>| technique(scene.clone());
        [
            shade(&|scene| shaded(&FEW, scene, seen_from())),
            shade(&|scene| shaded(&indirect, scene, seen_from())),
            shade(&|scene| shaded(&InMedium::multiple(FEW), scene, seen_from())),
        ]
    };
    let [sunny, far, near] = [sun, lamp(3000.0), lamp(3.0)].map(|lamp| images(&under(lamp)));
    for ((sunny, far), near) in sunny.iter().zip(&far).zip(&near) {
        let off = |image: &[f32]| {
            let differences: Vec<f32> = sunny.iter().zip(image).map(|(a, b)| (a - b).abs()).collect();
            mean(&differences) / mean(sunny)
        };
        assert!(mean(sunny) > 1e-3 && off(far) < 3e-3 && off(near) > 0.03, "{} {}", off(far), off(near));
    }
}

#[test]
fn a_lamp_just_outside_of_the_grid_lights_as_truth_has_it() {
    let scene = TracedScene::new(under(lamp(3.0))).expect("triangles");
    let camera = seen_from();
    let shot = Shot::new(&scene, &camera, [12, 16], 20.0);
    let truth = path::render(Effect::Gi, &shot, Sampling::one(512, 1)).mean;
    let image = shaded(&LpvParameters { cells: 20, iterations: 24, ..FEW }, under(lamp(3.0)), camera);
    let ratio = mean(&image) / mean(truth.data());
    assert!((ratio - 1.0).abs() < 0.15, "{ratio}");
}

#[test]
fn lamps_and_cameras_outside_are_as_the_plain_version_has_them() {
    let gpu = gpu();
    let scene = TracedScene::new(under(lamp(3.0))).expect("triangles");
    let far = Camera::look_at(2.0 * SEEN_FROM, Vec3::new(0.3, 0.2, 0.0));
    for camera in [seen_from(), far] {
        let view = View { camera, radius: 20.0, ..view(48, 64, 1.0) };
        let gbuffer = gbuffer::render(&scene, &camera, 48, 64, &[Attribute::Valid]);
        let frame = with_colours((scene.clone(), view, gbuffer));
        let multiple = ScreenMethod::new(&gpu, InMedium::multiple(FEW));
        prove_twin(&multiple, &frame, OF_MEDIUM);
        prove_twin(&ScreenMethod::new(&gpu, FEW), &frame, TOLERANCE);
    }
}

/// Nothing is between a camera outside and the medium: what comes along a ray is the same wherever on it the
/// camera is.
#[test]
fn light_along_a_ray_does_not_hang_on_how_far_outside_the_camera_is() {
    let (scene, target) = (TracedScene::new(under(lamp(3.0))).expect("triangles"), Vec3::new(0.2, 0.3, -0.1));
    let middle = |distance: f32| {
        let camera = Camera::look_at(target + distance * Vec3::new(-0.2, 0.5, 0.8).normalize(), target);
        // Seeds pixels' noise by their places, which are the same.
        let view = View { camera, radius: 20.0, ..view(1, 1, 1.0) };
        let gbuffer = gbuffer::render(&scene, &camera, 1, 1, InMedium::multiple(FEW).about().attributes);
        let inputs = PlainInputs { gbuffer: &gbuffer, environment: None, scene: Some(&scene) };
        Technique::reference(&InMedium::multiple(FEW), &inputs, &view).expect("attributes").remove(0)[1]
    };
    let [near, far, farther] = [4.0, 40.0, 400.0].map(middle);
    assert!(near > 1e-3, "{near}");
    assert!((far / near - 1.0).abs() < 2e-3 && (farther / near - 1.0).abs() < 2e-2, "{near} {far} {farther}");
}
