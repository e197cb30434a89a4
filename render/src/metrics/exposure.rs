//! By how much light is scaled before images are compared, so that a dim scene's errors count as a bright
//! one's do.

use deepshade_shaders::Planes;
pub use deepshade_shaders::exposure::of_image as exposure;

/// An image times an exposure.
#[must_use]
pub fn exposed(image: &Planes, exposure: f32) -> Planes {
    let mut image = image.clone();
    image.data_mut().iter_mut().for_each(|value| *value *= exposure);
    image
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::Scores;
    use deepshade_shaders::Effect;

    /// A smooth image with one very bright value.
    fn image(scale: f32, shift: f32) -> Planes {
        Planes::from_fn(3, 16, 16, |c, y, x| match (c, y, x) {
            (0, 3, 3) => 900.0 * scale,
            _ => scale * (0.6 + 0.3 * (0.4 * x as f32 + 0.3 * y as f32 + shift).sin()),
        })
    }

    #[test]
    fn scores_do_not_depend_on_the_lights_power() {
        let scores = |scale: f32| {
            let truth = image(scale, 0.0);
            let exposure = exposure(Effect::Path, &truth);
            Scores::new(&exposed(&image(scale, 0.5), exposure), &exposed(&truth, exposure))
        };
        let (dim, bright) = (scores(0.003), scores(40.0));
        assert!((dim.ssim - bright.ssim).abs() < 1e-4 && dim.ssim < 0.95, "{dim:?} {bright:?}");
        // Without exposure nothing can be told in the dark.
        assert!(Scores::new(&image(0.003, 0.5), &image(0.003, 0.0)).ssim > 0.99);
    }

    #[test]
    fn shares_and_darkness_stay_as_they_are() {
        assert_eq!(exposure(Effect::Ao, &image(0.01, 0.0)), 1.0);
        assert_eq!(exposure(Effect::Gi, &Planes::filled(3, 2, 2, 0.0)), 1.0);
        let light = image(0.5, 0.0);
        assert!((exposure(Effect::Gi, &light) * 0.45 - 1.0).abs() < 0.02);
    }
}
