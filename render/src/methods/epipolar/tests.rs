//! Scenes of quadrilaterals, a path tracer's truth.

use super::*;
use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::method::{Frame, Method, Repeats};
use crate::methods::ray_march;
use crate::metrics::relative_mse;
use crate::path::proving::{floor, quad};
use crate::scene::{Bounds, Camera, Density, Light, Material, Scene};
use deepshade_shaders::{Attribute, Planes};
use std::sync::Arc;

fn shade(method: &dyn Method, scene: &TracedScene, camera: &Camera) -> (Planes, f64) {
    let gbuffer = gbuffer::render(scene, camera, 240, 320, &[Attribute::Depth, Attribute::Valid]);
    let frame = Frame { scene, camera, gbuffer: &gbuffer, radius: 1.0, seed: 3 };
    let shaded = method.shade(&frame, Repeats::ONCE).expect("an image");
    (shaded.image, shaded.milliseconds)
}

#[test]
fn first() {
    let roof = |x: [f32; 2]| quad([(x[0], -9.), (x[0], 9.), (x[1], 9.), (x[1], -9.)].map(|(x, z)| Vec3::new(x, 3.0, z)));
    let meshes = vec![floor(), roof([-9.0, -2.0]), roof([-1.5, 0.3]), roof([1.0, 1.2]), roof([2.0, 9.0])];
    let sun = Vec3::new(0.3, -1.0, 0.4).normalize();
    let lights = [
        Light::Directional { direction: sun, irradiance: Vec3::new(3.0, 2.0, 1.0), pattern: None },
        Light::Point { position: Vec3::new(0.5, 4.0, -3.0), intensity: Vec3::ONE * 20.0, range: f32::INFINITY },
        Light::Spot {
            position: Vec3::new(0.5, 5.0, -3.0),
            direction: Vec3::NEG_Y,
            intensity: Vec3::ONE * 20.0,
            range: 30.0,
            cos_inner: 0.9,
            cos_outer: 0.8,
            slide: None,
        },
    ];
    let bounds = Bounds { min: Vec3::new(-9.0, -0.5, -9.0), max: Vec3::new(9.0, 6.0, 9.0) };
    for g in [0.0, 0.5] {
        for light in lights {
            for (eye, target) in [
                (Vec3::new(-3.0, 1.5, 4.0), Vec3::new(0.0, 1.0, 0.0)),
                (Vec3::new(0.0, 1.0, 0.0), Vec3::new(-0.3, 2.0, -0.4)),
                (Vec3::new(0.0, 2.0, 0.0), Vec3::new(0.3, 1.0, 0.4)),
                (Vec3::new(-12.0, 7.0, 9.0), Vec3::new(0.0, 1.0, 0.0)),
            ] {
                let medium = Medium::new(Vec3::splat(0.02), Vec3::splat(0.1), g, Density::Within(bounds)).expect("fog");
                let scene = Scene {
                    meshes: meshes.clone().into(),
                    materials: vec![Material::default()],
                    lights: vec![light],
                    medium: Some(Arc::new(medium)),
                    ..Scene::default()
                };
                let scene = TracedScene::new(scene).expect("triangles");
                let camera = Camera::look_at(eye, target);
                let march = ray_march::Parameters { steps: 4096, jitter: false, ..ray_march::Parameters::of(Quality::High) };
                let (truth, slow) = shade(&Shafts(march), &scene, &camera);
                let (image, fast) = shade(&Shafts(Parameters::of(Quality::High)), &scene, &camera);
                let mean = |image: &Planes| image.data().iter().sum::<f32>() / image.data().len() as f32;
                println!("{g} {:?} {eye}: {} {} relmse {:.3e} ms {slow} {fast}", std::mem::discriminant(&light), mean(&truth), mean(&image), relative_mse(&image, &truth));
            }
        }
    }
}
