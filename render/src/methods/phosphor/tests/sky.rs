//! Light of the environment, which lamps stand for: the passes against the plain version, and against truth,
//! which looks for the environment itself.

use super::*;
use crate::path::{self, Sampling, Shot};
use crate::scene::glow::Schedule;
use crate::scene::{Environment, procedural};
use deepshade_shaders::Effect;

/// Floor and wall without a lamp under such a sky, which shines for two seconds and a half.
fn under(sky: Environment, [height, width]: [usize; 2]) -> (TracedScene, View, GBuffer) {
    let mut glow = glow(&[0.7, 0.1], &[], 3.0);
    glow.schedules.insert(0, Schedule { sky: true, on: vec![[0.0, 2.5]], ..Schedule::default() });
    let lit =
        Scene { environment: Some(sky.into()), ..scene(vec![floor(), wall()], vec![], glow).scene().clone() };
    seen(TracedScene::new(lit).expect("a scene"), camera(), [height, width])
}

/// A dim sky, so that states are far from full.
fn clear_sky() -> Environment {
    let sky = procedural::sky(3);
    let [width, height] = sky.size();
    let dim = 0.3 / sky.mean().max_element();
    let texels = sky.texels().iter().map(|texel| *texel * dim).collect();
    Environment::new("dim".as_ref(), width, height, texels).expect("a sky")
}

#[test]
fn lamps_of_the_sky_are_those_of_the_plain_version() {
    let method = ScreenMethod::new(&gpu(), RateEquationParameters::exact(60));
    prove_twin(&method, &under(clear_sky(), [21, 29]), Tolerance { usual: 5e-4, worst: 0.06 });
}

/// How far the method's image is from truth, over truth's mean: in the mean, and the root of the mean square.
fn off_truth(sky: Environment) -> [f32; 2] {
    let method = ScreenMethod::new(&gpu(), RateEquationParameters::exact(60));
    let frame = under(sky, [21, 29]);
    let (scene, view, _) = &frame;
    let shot = Shot::new(scene, &view.camera, [21, 29], 1.0);
    let truth = path::render(Effect::Phosphor, &shot, Sampling { samples: 64, scramblings: 1, seed: 5 }).mean;
    let image = shaded(&method, &frame);
    let mean = |values: &dyn Fn(usize) -> f32| {
        (0..image.data().len()).map(values).sum::<f32>() / image.data().len() as f32
    };
    let whole = mean(&|index| truth.data()[index]);
    let differences = |index: usize| image.data()[index] - truth.data()[index];
    assert!(whole > 0.01, "{whole}");
    [mean(&differences) / whole, mean(&|index| differences(index).powi(2)).sqrt() / whole]
}

#[test]
fn lamps_of_the_sky_light_as_truth_has_it() {
    for (name, sky) in [("uniform", Environment::uniform(Vec3::splat(0.3))), ("clear", clear_sky())] {
        let [bias, error] = off_truth(sky);
        assert!(bias.abs() < 0.03 && error < 0.12, "{name}: {bias} {error}");
    }
}
