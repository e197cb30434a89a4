//! How long truth takes.

use deepshade_render::path::{Refinement, Shot};
use deepshade_shaders::Effect;

/// What preparing an image's truth takes, and then `samples` of each of its pixels (x, y) that are wanted, as
/// `measure` has it of work that it does, once or more often. Only the latter grows with samples and pixels:
/// subsurface scattering in screen space, for one, gathers the whole image before the first sample.
pub fn prepared_and_sampled<T>(
    effect: Effect,
    shot: &Shot<'_>,
    (samples, seed): (u32, u32),
    wanted: impl Fn(usize, usize) -> bool + Sync,
    mut measure: impl FnMut(&mut dyn FnMut()) -> T,
) -> [T; 2] {
    let prepare = || Refinement::new(effect, shot, 1, seed);
    // As many as there are measurements: samples are taken of new ones.
    let mut prepared = Vec::new();
    let preparing = measure(&mut || prepared.push(prepare()));
    let sampling = measure(&mut || {
        prepared.pop().unwrap_or_else(prepare).refine(samples, &wanted, |_| {});
    });
    [preparing, sampling]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::views;
    use deepshade_render::bvh::TracedScene;
    use deepshade_render::scene::procedural::Family;
    use std::time::Instant;

    #[test]
    fn what_is_done_once_is_told_from_what_is_done_for_every_sample() {
        let scene = TracedScene::new(Family::StillLife.scene(1)).expect("a scene");
        let camera = views::sample_view(&scene, [64, 64], 1, 2, 0).expect("a view");
        let shot = Shot::new(&scene, &camera, [64, 64], 0.1);
        // The least of several: a busy machine makes some of them long.
        let seconds = |work: &mut dyn FnMut()| {
            let once = |_| {
                let start = Instant::now();
                work();
                start.elapsed().as_secs_f64()
            };
            (0..5).map(once).fold(f64::INFINITY, f64::min)
        };
        let measured = |effect| prepared_and_sampled(effect, &shot, (64, 1), |x, y| x < 8 && y < 8, seconds);
        let [preparing, sampling] = measured(Effect::Sss);
        assert!(preparing > 5.0 * sampling, "the image is gathered first: {preparing} s, {sampling} s");
        let [preparing, sampling] = measured(Effect::Ao);
        assert!(sampling > 5.0 * preparing, "nothing is done first: {preparing} s, {sampling} s");
    }

    #[test]
    fn work_that_is_measured_twice_takes_its_samples_twice() {
        let scene = TracedScene::new(Family::StillLife.scene(1)).expect("a scene");
        let camera = views::sample_view(&scene, [16, 16], 1, 2, 0).expect("a view");
        let shot = Shot::new(&scene, &camera, [16, 16], 0.1);
        let most = deepshade_render::sampler::MAX_SAMPLES;
        let twice = |work: &mut dyn FnMut()| (0..2).for_each(|_| work());
        // More in one sequence would be too many.
        prepared_and_sampled(Effect::Ao, &shot, (most, 1), |x, y| x == 0 && y == 0, twice);
    }
}
