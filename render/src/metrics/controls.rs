//! Negative controls: every metric calls equal images equal, and notices each way in which images are
//! commonly wrong.

use super::Scores;
use deepshade_shaders::Planes;

/// A coloured image without any symmetry, away from 0 and 1.
fn image() -> Planes {
    let waves = [[0.31f32, 0.17], [0.23, 0.41], [0.13, 0.29]];
    Planes::from_fn(3, 40, 56, |c, y, x| {
        let [fx, fy] = waves[c];
        let ramp = 0.002 * (x + 2 * y) as f32 + 0.05 * c as f32;
        0.4 + 0.15 * (fx * x as f32).sin() * (fy * y as f32 + 0.5).cos() + ramp
    })
}

/// The image as it comes out of a common mistake.
fn mistakes(image: &Planes) -> [(&'static str, Planes); 5] {
    let (height, width) = (image.height(), image.width());
    let from = |value: &dyn Fn(usize, usize, usize) -> f32| Planes::from_fn(3, height, width, value);
    [
        ("mirrored", from(&|c, y, x| image.at(c, y, width - 1 - x))),
        ("upside down", from(&|c, y, x| image.at(c, height - 1 - y, x))),
        ("shifted by a pixel", from(&|c, y, x| image.at(c, y, (x + 1) % width))),
        ("scaled by 1 %", from(&|c, y, x| image.at(c, y, x) * 1.01)),
        ("channels swapped", from(&|c, y, x| image.at(2 - c, y, x))),
    ]
}

#[test]
fn equal_images_are_equal() {
    let image = image();
    let expected = Scores { ssim: 1.0, psnr: super::psnr::MOST, flip: 0.0, relative_mse: 0.0 };
    let scores = Scores::new(&image, &image);
    assert!((scores.ssim - 1.0).abs() < 1e-12, "{}", scores.ssim);
    assert_eq!(Scores { ssim: 1.0, ..scores }, expected);
}

#[test]
fn every_metric_notices_every_mistake() {
    let image = image();
    for (mistake, wrong) in mistakes(&image) {
        let scores = Scores::new(&wrong, &image);
        assert!(scores.ssim < 0.99999, "{mistake}: ssim {}", scores.ssim);
        assert!(scores.psnr < 50.0, "{mistake}: psnr {}", scores.psnr);
        assert!(scores.flip > 0.003, "{mistake}: flip {}", scores.flip);
        assert!(scores.relative_mse > 5e-5, "{mistake}: relative_mse {}", scores.relative_mse);
    }
}

#[test]
fn what_is_not_a_number_is_not_hidden() {
    let image = image();
    let mut wrong = image.clone();
    wrong.data_mut()[1234] = f32::NAN;
    let scores = Scores::new(&wrong, &image);
    assert!(
        scores.ssim.is_nan() && scores.psnr.is_nan() && scores.flip.is_nan() && scores.relative_mse.is_nan()
    );
}

#[test]
#[should_panic(expected = "one [channels, height, width]")]
fn images_of_different_shapes_are_no_pair() {
    Scores::new(&Planes::filled(1, 8, 16, 0.0), &Planes::filled(1, 16, 8, 0.0));
}
