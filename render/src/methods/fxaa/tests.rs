//! The reference against closed forms, the GPU against the reference, and both against truth.

use super::*;
use crate::gbuffer;
use crate::methods::picture::every_pixel;
use crate::methods::proving::{
    Tolerance, everything, lit_still_life, picture_of, prove_comparator, prove_twin, view,
};
use crate::path::{self, Sampling, Shot};
use crate::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{GBuffer, Planes};
use glam::{IVec2, Vec3};

const HEIGHT: usize = 43;
const WIDTH: usize = 61;

/// Of radiances up to about 1. Rounding ends a search a step sooner or later in one pixel of 100.
const TOLERANCE: Tolerance = Tolerance { usual: 1e-5, worst: 0.5 };

fn smoothed(gbuffer: &GBuffer, parameters: &FxaaParameters) -> Planes {
    let settings = parameters.settings(&view(gbuffer.height(), gbuffer.width(), 1.0));
    let [.., image] = reference::shade(&LightImage::of(gbuffer).expect("a picture"), &settings);
    image
}

#[test]
fn what_is_flat_stays_bit_for_bit() {
    let colour = Vec3::new(0.3, 7.7, 1e-3);
    let flat = smoothed(&picture_of(HEIGHT, WIDTH, |_| Some(colour)), &FxaaParameters::of(Quality::High));
    assert_eq!(flat, Planes::from_fn(3, HEIGHT, WIDTH, |c, _, _| colour[c]));
}

/// Light above the line `y = height + slope * x`, sampled in the pixels' middles.
fn step(height: f32, slope: f32) -> impl Fn(IVec2) -> Option<Vec3> + Sync {
    move |at| {
        let above = at.y as f32 + 0.5 < height + slope * (at.x as f32 + 0.5);
        Some(if above { Vec3::ONE } else { Vec3::ZERO })
    }
}

/// Area of a pixel above that line.
fn coverage(at: IVec2, height: f32, slope: f32) -> f32 {
    let columns = 64;
    let covered = |i: i32| {
        let x = at.x as f32 + (i as f32 + 0.5) / columns as f32;
        (height + slope * x - at.y as f32).clamp(0.0, 1.0)
    };
    (0..columns).map(covered).sum::<f32>() / columns as f32
}

#[test]
fn edges_along_rows_and_columns_stay_almost_as_they_are() {
    let row = picture_of(HEIGHT, WIDTH, step(20.0, 0.0));
    let column = picture_of(HEIGHT, WIDTH, |at| step(20.0, 0.0)(IVec2::new(at.y, at.x)));
    for sharp in [row, column] {
        let image = smoothed(&sharp, &FxaaParameters::of(Quality::High));
        let light = sharp.select(&[Attribute::Light]).expect("light");
        let worst = image.data().iter().zip(light.data()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        // A third of the range from its neighbours' mean: smoothstep(1/3)^2 = 0.067 of `subpixel`.
        assert!(worst < 0.04, "{worst}");
    }
}

#[test]
fn a_slanted_edge_becomes_a_ramp_near_to_its_coverage() {
    for (height, slope) in [(14.3, 0.11), (12.0, 0.23), (30.7, -0.171)] {
        let sharp = picture_of(HEIGHT, WIDTH, step(height, slope));
        let image = smoothed(&sharp, &FxaaParameters::of(Quality::Ultra));
        let light = sharp.select(&[Attribute::Light]).expect("light");
        let off = |image: &Planes| {
            let off = every_pixel(HEIGHT, WIDTH, |at| {
                let expected = coverage(at, height, slope);
                (image.at(0, at.y as usize, at.x as usize) - expected).abs()
            });
            off.iter().sum::<f32>()
        };
        assert!(off(&image) < 0.5 * off(&light), "{} of {}", off(&image), off(&light));
        // Along the rows that the line crosses, light rises or falls all the way.
        for y in 0..HEIGHT {
            let row: Vec<f32> = (12..WIDTH - 12).map(|x| image.at(0, y, x) * slope.signum()).collect();
            assert!(row.windows(2).all(|pair| pair[1] >= pair[0] - 0.04), "row {y}: {row:?}");
        }
    }
}

#[test]
fn a_brighter_picture_gives_the_same_brighter() {
    let gbuffer = lit_still_life(HEIGHT, WIDTH);
    let parameters = FxaaParameters { least_contrast: 0.0, ..FxaaParameters::of(Quality::High) };
    let image = smoothed(&gbuffer, &parameters);
    let brighter = picture_of(HEIGHT, WIDTH, |at| {
        let light = LightImage::of(&gbuffer).expect("a picture").light_at(at);
        Some(64.0 * light)
    });
    let brighter = smoothed(&brighter, &parameters);
    for (a, b) in image.data().iter().zip(brighter.data()) {
        assert!((64.0 * a - b).abs() < 1e-4 * b.max(1.0), "{a}, {b}");
    }
}

#[test]
fn gpu_and_reference_agree_at_every_pixel() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let fxaa = ScreenMethod::new(&gpu, FxaaParameters::of(Quality::High));
    let blurry = FxaaParameters { subpixel: 1.0, contrast: 0.05, ..FxaaParameters::of(Quality::Low) };
    for (height, width, parameters) in [
        (HEIGHT, WIDTH, FxaaParameters::of(Quality::High)),
        (HEIGHT, WIDTH, blurry),
        (1, 1, FxaaParameters::of(Quality::High)),
        (17, 5, FxaaParameters::of(Quality::Ultra)),
    ] {
        let view = view(height, width, 1.0);
        prove_twin(&fxaa.with(parameters), &lit_still_life(height, width), None, &view, TOLERANCE);
    }
    let (_, view, gbuffer) = everything(48, 64);
    prove_twin(&fxaa, &gbuffer, None, &view, TOLERANCE);
}

#[test]
fn the_comparator_rejects_what_is_wrong() {
    prove_comparator(
        &smoothed(&lit_still_life(HEIGHT, WIDTH), &FxaaParameters::of(Quality::High)),
        TOLERANCE,
    );
}

#[test]
fn the_method_is_nearer_to_truth_than_the_sharp_picture() {
    let (scene, view, _) = everything(48, 64);
    let shot = Shot::new(&scene, &view.camera, [48, 64], 1.0);
    let gbuffer = gbuffer::render(&scene, &view.camera, 48, 64, &[Attribute::Light, Attribute::Valid]);
    let truth = path::render(Effect::Aa, &shot, Sampling::one(64, 1)).mean;
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let fxaa = ScreenMethod::new(&gpu, FxaaParameters::of(Quality::High));
    let image = crate::methods::proving::on_gpu(&fxaa, &gbuffer, None, &view);
    let sharp = gbuffer.select(&[Attribute::Light]).expect("light");
    let error = |image: &Planes| crate::metrics::relative_mse(image, &truth);
    assert!(error(&image) < 0.8 * error(&sharp), "{} of {}", error(&image), error(&sharp));
}
