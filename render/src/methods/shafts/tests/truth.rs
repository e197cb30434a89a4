//! The path tracer's `fog-direct`.

use super::*;
use crate::metrics::relative_mse;
use crate::path::{Sampling, Shot, render};
use crate::scene::DensityGrid;
use deepshade_shaders::Effect;

const SIZE: [usize; 2] = [36, 48];

fn truth(scene: &TracedScene, camera: &Camera, samples: u32) -> Planes {
    let shot = Shot::new(scene, camera, SIZE, f32::INFINITY);
    render(Effect::FogDirect, &shot, Sampling::one(samples, 5)).mean
}

fn camera() -> Camera {
    Camera::look_at(Vec3::new(-3.0, 1.5, 4.0), Vec3::new(0.0, 1.2, 0.0))
}

fn lights() -> [Light; 3] {
    let above = Vec3::new(0.5, 5.0, -3.0);
    [sun(Vec3::new(0.3, -1.0, 0.4)), lamp(above), spot(above, Vec3::new(-0.2, -1.0, 0.5))]
}

#[test]
fn all_methods_see_what_the_path_tracer_sees_of_every_light() {
    for light in lights() {
        let scene = scene(pergola(), vec![light], fog(0.5, AROUND));
        let truth = truth(&scene, &camera(), 512);
        for method in methods(Quality::High) {
            let found = image(method.as_ref(), &scene, &camera(), SIZE).expect("an image");
            let error = relative_mse(&found, &truth);
            assert!(error < 2e-3, "{} of {light:?}: {error:e}", method.name());
        }
        // Who is not told what hides the light is found out.
        let blind: [Box<dyn Method>; 2] = [
            Box::new(Shafts(Unshadowed(ray_march::Parameters::of(Quality::High)))),
            Box::new(Shafts(Unshadowed(epipolar::Parameters::of(Quality::High)))),
        ];
        for method in blind {
            let found = image(method.as_ref(), &scene, &camera(), SIZE).expect("an image");
            let error = relative_mse(&found, &truth);
            assert!(error > 2e-2, "{} of {light:?}: {error:e}", method.name());
        }
    }
}

#[test]
fn lights_add_up() {
    let all = lights().to_vec();
    let whole = scene(pergola(), all.clone(), fog(0.5, AROUND));
    let [_, epipolar, ..] = methods(Quality::Low);
    let shade = |scene: &TracedScene| image(epipolar.as_ref(), scene, &camera(), SIZE).expect("an image");
    let mut sum = Planes::filled(3, SIZE[0], SIZE[1], 0.0);
    for light in all {
        let one = shade(&scene(pergola(), vec![light], fog(0.5, AROUND)));
        sum.data_mut().iter_mut().zip(one.data()).for_each(|(sum, one)| *sum += one);
    }
    let found = shade(&whole);
    assert!(found.data().iter().zip(sum.data()).all(|(a, b)| (a - b).abs() <= 1e-5 * b.abs()));
}

#[test]
fn a_march_goes_through_grids() {
    let [min, max] = AROUND.map(Vec3::from);
    let cell = |i: usize| [0.2, 1.5, 0.6, 0.0, 1.0, 2.0, 0.3, 0.8][i % 8];
    let grid = DensityGrid::new(Bounds { min, max }, [4, 2, 3], (0..24).map(cell).collect()).expect("a grid");
    let medium = Medium { density: Density::Grid(grid), ..fog(0.3, AROUND) };
    for light in lights() {
        let scene = scene(pergola(), vec![light], medium.clone());
        let march = Shafts(ray_march::Parameters::of(Quality::High));
        let found = image(&march, &scene, &camera(), SIZE).expect("an image");
        let error = relative_mse(&found, &truth(&scene, &camera(), 4096));
        assert!(error < 3e-3, "{light:?}: {error:e}");
        for method in [1, 3].map(|i| methods(Quality::Low).into_iter().nth(i).expect("four")) {
            let refused = image(method.as_ref(), &scene, &camera(), SIZE).expect_err("a grid").to_string();
            assert!(refused.contains("grid") && refused.contains(method.name()), "{refused}");
        }
    }
}
