//! Passes against the plain version, the methods that they wrap, and truth by random walks.

use super::*;
use crate::methods::proving::{
    Tolerance, agree, everything, facing_plane, mean_difference, on_gpu, prove_comparator, prove_twin, view,
    written_on_gpu,
};
use crate::methods::{Quality, gather, separable};
use crate::path::{self, Sampling, Shot};
use crate::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;

fn gpu() -> Gpu {
    Gpu::new().expect("an adapter; lavapipe will do")
}

fn separable(quality: Quality) -> ScreenMethod {
    ScreenMethod::new(&gpu(), FromScreen(separable::SeparableParameters::of(quality)))
}

fn gather(quality: Quality) -> ScreenMethod {
    ScreenMethod::new(&gpu(), FromScreen(gather::GatherParameters::of(quality)))
}

/// A plane that faces the camera, whose surface has a colour and receives light: white light as it leaves it.
fn coloured(colour: impl Fn(IVec2) -> Vec3, light: impl Fn(IVec2) -> Vec3 + Sync) -> GBuffer {
    let (height, width) = (33, 45);
    let white = facing_plane(height, width, Vec3::new(6.0, 3.0, 0.0), light);
    let seen = |attribute| white.select(&[attribute]).expect("an attribute");
    let [position, lengths, received, valid] =
        [Attribute::Position, Attribute::MeanFreePath, Attribute::Light, Attribute::Valid].map(seen);
    let at = |y: usize, x: usize| colour(IVec2::new(x as i32, y as i32));
    let colours = Planes::from_fn(3, height, width, |c, y, x| at(y, x)[c]);
    let lit = Planes::from_fn(3, height, width, |c, y, x| at(y, x)[c] * received.at(c, y, x));
    let data = [position.data(), lengths.data(), colours.data(), lit.data(), valid.data()].concat();
    GBuffer::new(gather(Quality::Low).attributes().to_vec(), Planes::from_data(13, height, width, data))
}

/// Proves of the gather what `prove_twin` does, from the lengths that the passes have written: of those that
/// differ in their last bits samples may be put on neighbouring pixels.
fn prove_gather_twin(quality: Quality, gbuffer: &GBuffer, view: &View, tolerance: Tolerance) {
    let written = written_on_gpu(&gather(quality), gbuffer, None, view);
    let (received, lengths) = entering(gbuffer).expect("attributes");
    let planes = |buffer: &Vec<f32>| Planes::from_data(3, view.height, view.width, buffer.clone());
    let [found_received, found_lengths] = [0, 1].map(|buffer| planes(&written[buffer]));
    assert_eq!(agree(&found_received, &received, tolerance), Ok(()));
    assert_eq!(agree(&found_lengths, &lengths, tolerance), Ok(()));

    let given = given(gbuffer, &found_received, &found_lengths).expect("attributes");
    let inputs = PlainInputs { gbuffer: &given, environment: None, scene: None };
    let scattered = gather::GatherParameters::of(quality)
        .reference(&inputs, view)
        .expect("attributes")
        .pop()
        .expect("an image");
    let colours = gbuffer.select(&[Attribute::Diffuse]).expect("colours");
    let right: Vec<f32> =
        scattered.iter().zip(colours.data()).map(|(light, colour)| light * colour).collect();
    let right = planes(&right);
    assert_eq!(agree(&planes(&written[written.len() - 1]), &right, tolerance), Ok(()));
    prove_comparator(&right, tolerance);
}

fn stripes(at: IVec2) -> Vec3 {
    if at.x / 4 % 2 == 0 { Vec3::new(0.9, 0.5, 0.2) } else { Vec3::new(0.1, 0.0, 1.0) }
}

#[test]
fn the_passes_make_what_the_plain_version_does() {
    let (_, view, gbuffer) = everything(43, 61);
    let tolerance = Tolerance { usual: 1e-4, worst: 0.1 };
    prove_twin(&separable(Quality::Medium), &gbuffer, None, &view, tolerance);
    prove_gather_twin(Quality::Low, &gbuffer, &view, tolerance);
    prove_comparator(&on_gpu(&separable(Quality::Medium), &gbuffer, None, &view), tolerance);
}

#[test]
fn colours_stay_sharp_in_even_light() {
    // What of green falls on the stripes that are black in it is as much as of the others in the mean.
    let even = Vec3::new(2.0, 1.25, 0.5);
    let gbuffer = coloured(stripes, |_| even);
    let view = view(33, 45, 1.0);
    for image in [
        on_gpu(&separable(Quality::High), &gbuffer, None, &view),
        on_gpu(&gather(Quality::High), &gbuffer, None, &view),
    ] {
        for (pixel, found) in (0..33 * 45).map(|i| (i, [0, 1, 2].map(|c| image.plane(c)[i]))) {
            let right = stripes(IVec2::new((pixel % 45) as i32, 0)) * even;
            let off = Vec3::from_array(found) - right;
            assert!(off.abs().max_element() < 1e-4, "{found:?}, not {right} at {pixel}");
        }
    }
}

#[test]
fn one_colour_is_that_of_screen_space_with_a_shorter_length() {
    let colour = Vec3::new(0.8, 0.3, 0.5);
    let step = |at: IVec2| if at.x < 20 { Vec3::ONE } else { Vec3::splat(0.1) };
    let gbuffer = coloured(|_| colour, step);
    let view = view(33, 45, 1.0);
    let found = on_gpu(&separable(Quality::High), &gbuffer, None, &view);
    let shorter = facing_plane(33, 45, Vec3::new(6.0, 3.0, 0.0) / shape(colour), step);
    let plain = ScreenMethod::new(&gpu(), separable::SeparableParameters::of(Quality::High));
    let right = on_gpu(&plain, &shorter, None, &view);
    let same = facing_plane(33, 45, Vec3::new(6.0, 3.0, 0.0), step);
    let longer = ScreenMethod::new(&gpu(), separable::SeparableParameters::of(Quality::High));
    let longer = on_gpu(&longer, &same, None, &view);
    let off = |image: &Planes, c: usize| {
        let differences = found.plane(c).iter().zip(image.plane(c));
        differences.map(|(a, b)| (a - colour[c] * b).abs()).fold(0.0, f32::max)
    };
    for c in 0..3 {
        assert!(off(&right, c) < 1e-4, "{c}: {}", off(&right, c));
    }
    assert!(off(&longer, 1) > 0.02, "another length is noticed: {}", off(&longer, 1));
}

#[test]
fn they_are_nearer_to_truth_than_light_that_is_not_scattered() {
    let (scene, view, gbuffer) = everything(43, 61);
    let shot = Shot::new(&scene, &view.camera, [43, 61], view.radius);
    let truth = path::render(Effect::Subsurface, &shot, Sampling::one(256, 1)).mean;
    let light = gbuffer.select(&[Attribute::DiffuseLight]).expect("light");
    let nothing = mean_difference(&light, &truth);
    for (name, image) in [
        ("separable", on_gpu(&separable(Quality::High), &gbuffer, None, &view)),
        ("gather", on_gpu(&gather(Quality::High), &gbuffer, None, &view)),
    ] {
        let off = mean_difference(&image, &truth);
        assert!(off < 0.9 * nothing, "{name}: {off}, without scattering {nothing}");
    }
}
