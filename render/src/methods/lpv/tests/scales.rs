//! The march of fewer pixels.

use super::*;

/// How far images are from each other, over the mean of the first: on average, and at most.
fn off(image: &[f32], other: &[f32]) -> [f32; 2] {
    let brightness = image.iter().sum::<f32>() / image.len() as f32;
    let differences: Vec<f32> = image.iter().zip(other).map(|(a, b)| (a - b).abs() / brightness).collect();
    let sum: f32 = differences.iter().sum();
    [sum / image.len() as f32, differences.iter().copied().fold(0.0, f32::max)]
}

#[test]
fn every_scale_is_as_the_plain_version_has_it() {
    let (gpu, frame) = (gpu(), with_colours(foggy().remove(0)));
    for scale in [1, 3, 4] {
        let parameters = LpvParameters { scale, ..FEW };
        let method = ScreenMethod::new(&gpu, InMedium::multiple(parameters));
        prove_twin(&method, &frame, OF_MEDIUM);
    }
}

#[test]
fn fewer_pixels_make_about_the_same_image() {
    let (scene, view, gbuffer) = with_colours(foggy().remove(0));
    let inputs = PlainInputs { gbuffer: &gbuffer, environment: None, scene: Some(&scene) };
    let image = |scale: usize| {
        let technique = InMedium::multiple(LpvParameters { scale, steps: 64, ..FEW });
        technique.reference(&inputs, &view).expect("attributes").remove(0)
    };
    let whole = image(1);
    for (scale, most) in [(2, [0.01, 0.1]), (3, [0.02, 0.15]), (4, [0.03, 0.2])] {
        let [mean, worst] = off(&whole, &image(scale));
        assert!(mean > 0.0 && mean < most[0] && worst < most[1], "scale {scale}: {mean} {worst}");
    }
}
