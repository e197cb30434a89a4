//! What a lens shows of Bevy's own frames.

use super::cameras;
use super::headless::Headless;
use deepshade_bevy::LearnedDepthOfField;
use deepshade_render::metrics;
use deepshade_render::scene::Camera;
use deepshade_shaders::{Attribute, Effect, GBuffer, Planes};
use std::error::Error;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// The angle between one point of the lens and the next, which spreads them evenly.
const GOLDEN_ANGLE: f32 = 2.399_963_2;

/// The picture through a lens, `[3, height, width]`: the mean of Bevy's through pinholes all over it.
/// The camera has no effect of its own and is where it was afterwards.
///
/// # Errors
/// If the device fails.
pub fn truth(
    bevy: &mut Headless,
    camera: &Camera,
    lens: LearnedDepthOfField,
    points: usize,
) -> Result<Planes> {
    let LearnedDepthOfField { focal_distance, aperture_radius } = lens;
    let mut sum: Option<Vec<f64>> = None;
    let mut shape = [0; 3];
    // Bevy has pipelines of their own for such projections.
    bevy.with(cameras::on_lens(camera, focal_distance, [0.0; 2]));
    for point in 0..points {
        let radius = aperture_radius * ((point as f32 + 0.5) / points as f32).sqrt();
        let (sine, cosine) = (point as f32 * GOLDEN_ANGLE).sin_cos();
        bevy.put(cameras::on_lens(camera, focal_distance, [radius * cosine, radius * sine]));
        bevy.draw(1);
        let picture = bevy.light(false)?;
        shape = [picture.channels(), picture.height(), picture.width()];
        let sum = sum.get_or_insert_with(|| vec![0.0; picture.data().len()]);
        sum.iter_mut().zip(picture.data()).for_each(|(sum, value)| *sum += f64::from(*value));
    }
    bevy.with(cameras::pinhole(camera));
    let mean = sum.ok_or("a lens has points")?.into_iter().map(|sum| (sum / points as f64) as f32);
    Ok(Planes::from_data(shape[0], shape[1], shape[2], mean.collect()))
}

/// What the network is shown of the last frame, with light as Bevy has it, not exposed; of the part of the
/// picture that begins at `origin`.
///
/// # Errors
/// If the camera has no learned depth of field, or the device fails.
pub fn gbuffer(bevy: &mut Headless, origin: [usize; 2]) -> Result<GBuffer> {
    let shown = bevy.gbuffer::<LearnedDepthOfField>()?;
    let light = part(&bevy.light(true)?, origin, [shown.height(), shown.width()]);
    Ok(shown.with(&[Attribute::Light], light.data()))
}

/// A part of an image: its left upper corner, its rows and columns.
pub fn part(image: &Planes, [left, top]: [usize; 2], [height, width]: [usize; 2]) -> Planes {
    Planes::from_fn(image.channels(), height, width, |c, y, x| image.at(c, top + y, left + x))
}

/// Images exposed so that `like` is about 1 where it is bright.
pub fn exposed<const COUNT: usize>(images: [&Planes; COUNT], like: &Planes) -> [Planes; COUNT] {
    let exposure = metrics::exposure(Effect::Dof, like);
    images.map(|image| metrics::exposed(image, exposure))
}

/// How alike a picture is to truth, both exposed alike: structural similarity and mean difference.
pub fn scores(image: &Planes, truth: &Planes) -> [f64; 2] {
    let [image, truth] = exposed([image, truth], truth);
    let off = image.data().iter().zip(truth.data()).map(|(a, b)| f64::from((a - b).abs()));
    [metrics::ssim(&image, &truth), off.sum::<f64>() / truth.data().len() as f64]
}
