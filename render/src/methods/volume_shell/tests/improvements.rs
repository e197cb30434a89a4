//! What each improvement brings, and what it leaves as it is.

use super::*;
use crate::methods::proving::mean_difference;

#[test]
fn each_is_alone() {
    for improvement in Improvement::ALL {
        let rest = Improvements::ALL.without(improvement);
        for other in Improvement::ALL {
            assert_eq!(rest.has(other), other != improvement);
            assert!(Improvements::ALL.has(other) && !Improvements::NONE.has(other));
        }
    }
}

#[test]
fn intervals_that_no_shell_touches_add_nothing() {
    let (gpu, seen) = (gpu(), filled(smoke()));
    let few = image(&gpu, coarse(), &seen);
    let all = image(&gpu, without(Improvement::TouchedOnly), &seen);
    // What is at a shell's very edge may round to its other side.
    assert!(mean_difference(&few, &all) < 1e-4 * mean(&all), "{}", mean_difference(&few, &all));
}

#[test]
fn what_is_not_attenuated_is_too_bright_the_more_so_the_denser_the_medium() {
    let gpu = gpu();
    let ratio = |density| {
        let seen = filled(fog(density));
        mean(&image(&gpu, without(Improvement::Attenuation), &seen)) / mean(&image(&gpu, coarse(), &seen))
    };
    let (thin, dense) = (ratio(0.01), ratio(1.0));
    assert!((1.0..1.05).contains(&thin) && dense > 1.3, "{thin}, {dense}");
}

#[test]
fn a_grey_medium_needs_no_colours_and_smoke_does() {
    let gpu = gpu();
    let share_of_blue = |medium, parameters| {
        let image = image(&gpu, parameters, &filled(medium));
        image.plane(2).iter().sum::<f32>() / image.data().iter().sum::<f32>()
    };
    let grey = without(Improvement::Colours);
    assert!((share_of_blue(fog(0.3), grey) - share_of_blue(fog(0.3), coarse())).abs() < 1e-3);
    assert!(share_of_blue(smoke(), grey) > 1.1 * share_of_blue(smoke(), coarse()));
}

#[test]
fn without_far_light_the_image_is_darker_the_larger_the_threshold() {
    let (gpu, seen) = (gpu(), filled(fog(0.3)));
    let light =
        |threshold, parameters| mean(&image(&gpu, VolumeShellParameters { threshold, ..parameters }, &seen));
    let near = without(Improvement::FarLight);
    let [small, large] = [0.01, 0.5].map(|threshold| light(threshold, near));
    assert!(large < 0.7 * small, "{large}, {small}");
    let [small, large] = [0.01, 0.5].map(|threshold| light(threshold, coarse()));
    assert!((large / small - 1.0).abs() < 0.05, "{large}, {small}");
}

/// Fog that ends in the middle of the image, before the wall.
#[test]
fn edges_of_a_medium_stay_sharp() {
    let gpu = gpu();
    let half = Bounds { max: Vec3::new(-0.5, 2.0, 4.0), ..BOX };
    let medium = Medium { density: Density::Within(half), ..fog(1.0) };
    let seen = filled(medium);
    let fine = VolumeShellParameters { levels: 1, ..coarse() };
    let blurred = VolumeShellParameters { levels: 5, ..coarse() };
    let sharp = image(&gpu, fine, &seen);
    let beside = |image: &Planes| {
        let pairs = image.data().iter().zip(sharp.data());
        pairs.filter(|(_, sharp)| **sharp == 0.0).map(|(found, _)| *found).sum::<f32>()
    };
    let plain =
        VolumeShellParameters { improvements: without(Improvement::Silhouettes).improvements, ..blurred };
    assert_eq!(beside(&image(&gpu, blurred, &seen)), 0.0);
    assert!(beside(&image(&gpu, plain, &seen)) > 0.0);
}

#[test]
fn encodings_agree_where_density_changes_slowly_and_not_in_thin_layers() {
    let gpu = gpu();
    let off = |medium: Medium| {
        let seen = filled(medium);
        let parameters = VolumeShellParameters { steps: 200, ..coarse() };
        let paper = VolumeShellParameters {
            improvements: Improvements::ALL.without(Improvement::WideEncoding),
            ..parameters
        };
        let wide = image(&gpu, parameters, &seen);
        mean_difference(&wide, &image(&gpu, paper, &seen)) / mean(&wide)
    };
    let layers = (0..100).map(|y| f32::from(u8::from(y % 25 == 12)) * 25.0).collect();
    let grid = crate::scene::DensityGrid::new(BOX, [1, 100, 1], layers).expect("layers");
    let (slow, layered) = (off(fog(0.3)), off(Medium { density: Density::Grid(grid), ..fog(0.3) }));
    assert!(slow < 0.1 && layered > 2.0 * slow, "{slow}, {layered}");
}
