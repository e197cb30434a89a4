mod layers;

use super::*;
use crate::path::chi_square::{self, p_value, rejects};
use crate::path::proving::least_squares;
use crate::sampler::PixelSampler;
use crate::scene::Material;
use glam::Vec4;

/// A point whose shading normal is z and its triangle's as well.
fn flat(material: &Material) -> Bsdf {
    Bsdf::of(&material.surface(&[], [Vec2::ZERO; 2], Vec4::ONE), Vec3::Z, Vec3::Z)
}

fn material(gloss: Gloss, metallic: f32, roughness: f32, colour: Vec3) -> Material {
    Material { gloss, metallic, roughness, ..Material::matte("", colour) }
}

/// To a viewer at an angle from z, in degrees, aside from all axes.
fn viewer(degrees: f32) -> Vec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Vec3::new(sin * 0.6, sin * 0.8, cos)
}

/// Each kind of material, from rough to smooth.
fn materials() -> Vec<(String, Material)> {
    let colour = Vec3::new(0.9, 0.5, 0.2);
    let lambert = ("lambert".to_owned(), material(Gloss::None, 0.0, 1.0, colour));
    let glossy =
        [(Gloss::Microfacets, "ggx"), (Gloss::Phong, "phong")].into_iter().flat_map(|(gloss, name)| {
            [1.0, 0.6, 0.3].into_iter().flat_map(move |roughness| {
                [0.0, 0.5, 1.0].map(|metallic| {
                    let name = format!("{name}, roughness {roughness}, metallic {metallic}");
                    (name, material(gloss, metallic, roughness, colour))
                })
            })
        });
    let tinted =
        Material { specular: Some(Vec3::new(0.1, 0.4, 0.6)), ..material(Gloss::Phong, 0.0, 0.5, colour) };
    std::iter::once(lambert).chain(glossy).chain([("phong, tinted".to_owned(), tinted)]).collect()
}

const ANGLES: [f32; 4] = [0.0, 35.0, 65.0, 84.0];

/// Share of light from everywhere that goes to a viewer, by the rule of midpoints around the x axis, near
/// which no lobe is.
fn albedo(bsdf: &Bsdf, to_viewer: Vec3) -> Vec3 {
    let (rows, columns) = (300, 300);
    let mut sum = Vec3::ZERO;
    for row in 0..rows {
        let x = 2.0 * (row as f32 + 0.5) / rows as f32 - 1.0;
        for column in 0..columns {
            let (sin, cos) = (std::f32::consts::PI * (column as f32 + 0.5) / columns as f32).sin_cos();
            let radius = (1.0 - x * x).sqrt();
            sum += bsdf.evaluate(to_viewer, Vec3::new(x, radius * cos, radius * sin));
        }
    }
    sum * std::f32::consts::TAU / (rows * columns) as f32
}

/// Mean of a function of sampled directions times their weight, and its standard error.
fn estimated(bsdf: &Bsdf, to_viewer: Vec3, light: impl Fn(Vec3) -> f32, samples: u32) -> (Vec3, Vec3) {
    let scramblings = 16;
    let mean_of = |scrambling: u32| {
        let sampler = PixelSampler::new(1, 2, 3).scrambled(scrambling);
        let sample = |i| {
            let sample = bsdf.sample(to_viewer, &mut Stream::new(sampler, i));
            sample.map_or(Vec3::ZERO, |sample| sample.weight * light(sample.direction))
        };
        (0..samples).map(sample).sum::<Vec3>() / samples as f32
    };
    let means: Vec<Vec3> = (0..scramblings).map(mean_of).collect();
    let mean = means.iter().sum::<Vec3>() / scramblings as f32;
    let squares: Vec3 = means.iter().map(|value| (value - mean) * (value - mean)).sum();
    let variance = squares / (scramblings * (scramblings - 1)) as f32;
    (mean, variance.map(f32::sqrt))
}

#[test]
fn every_sampler_has_its_density() {
    let cases: Vec<(String, Bsdf, Vec3)> = materials()
        .into_iter()
        .flat_map(|(name, material)| {
            [0.0, 50.0, 80.0].map(|angle| (format!("{name}, {angle}"), flat(&material), viewer(angle)))
        })
        .collect();
    for (name, bsdf, to_viewer) in &cases {
        let sample = |stream: &mut Stream| bsdf.sample(*to_viewer, stream).map(|sample| sample.direction);
        let p = p_value(Vec3::X, sample, |direction| bsdf.density(*to_viewer, direction));
        println!("{name}: {p}");
        chi_square::proves("chi_square/reflectance", p, cases.len());
    }
}

#[test]
fn a_sampler_does_not_have_the_density_of_a_rougher_surface() {
    for gloss in [Gloss::Microfacets, Gloss::Phong] {
        let [bsdf, rougher] = [0.5, 0.515].map(|roughness| flat(&material(gloss, 1.0, roughness, Vec3::ONE)));
        let sample = |stream: &mut Stream| bsdf.sample(viewer(50.0), stream).map(|sample| sample.direction);
        let p = p_value(Vec3::X, sample, |direction| rougher.density(viewer(50.0), direction));
        chi_square::refutes("chi_square/reflectance", p, 100);
    }
}

#[test]
fn a_tilted_shading_normal_has_its_density_and_lets_no_light_through() {
    let triangle = Vec3::new(0.0, 0.6, 0.8);
    for gloss in [Gloss::None, Gloss::Microfacets, Gloss::Phong] {
        let surface = material(gloss, 0.0, 0.5, Vec3::ONE).surface(&[], [Vec2::ZERO; 2], Vec4::ONE);
        let bsdf = Bsdf::of(&surface, Vec3::Z, triangle);
        let to_viewer = viewer(30.0);
        let sample = |stream: &mut Stream| {
            let direction = bsdf.sample(to_viewer, stream)?.direction;
            assert!(direction.dot(triangle) > 0.0 && direction.z > 0.0);
            Some(direction)
        };
        let p = p_value(Vec3::X, sample, |direction| bsdf.density(to_viewer, direction));
        assert!(!rejects(p, 3), "{gloss:?}: {p}");
        let below_triangle = Vec3::new(0.1, -0.8, 0.4).normalize();
        assert_eq!(bsdf.evaluate(to_viewer, below_triangle), Vec3::ZERO);
        assert_eq!(bsdf.evaluate(below_triangle, to_viewer), Vec3::ZERO);
    }
}

#[test]
fn reflectance_is_the_same_both_ways() {
    for (name, material) in materials() {
        let bsdf = flat(&material);
        for i in 0..200 {
            let direction = |set| {
                let [u, v, ..] = PixelSampler::new(4, 0, 0).sample_4d(i, set);
                cosine_hemisphere(u, v)
            };
            let (a, b) = (direction(0), direction(1));
            let (there, back) = (bsdf.evaluate(a, b) / b.z, bsdf.evaluate(b, a) / a.z);
            assert!(
                (there - back).abs().max_element() <= 1e-3 * there.max_element(),
                "{name}: {there} {back}"
            );
        }
    }
}

#[test]
fn weights_come_to_the_albedo_which_is_at_most_one() {
    let white = materials()
        .into_iter()
        .map(|(name, material)| (format!("white {name}"), Material { base_colour: Vec4::ONE, ..material }));
    for (name, material) in materials().into_iter().chain(white) {
        let bsdf = flat(&material);
        for angle in ANGLES {
            let integral = albedo(&bsdf, viewer(angle));
            let (mean, error) = estimated(&bsdf, viewer(angle), |_| 1.0, 1024);
            let distance = (mean - integral).abs();
            // Three standard errors, and what the rule of midpoints misses.
            assert!(
                distance.cmple(3.0 * error + 5e-4).all(),
                "{name}, {angle}: {mean} +- {error}, {integral}"
            );
            assert!(integral.max_element() < 1.0003, "{name}, {angle}: {integral}");
            let wrong = (1.02 * mean - integral).abs();
            assert!(wrong.cmpgt(3.0 * error + 5e-4).any(), "{name}, {angle}: 2 % are noticed");
        }
    }
}

#[test]
fn a_diffuse_base_that_gets_all_light_would_reflect_more_than_there_is() {
    let surface = material(Gloss::Microfacets, 0.0, 0.3, Vec3::ONE).surface(&[], [Vec2::ZERO; 2], Vec4::ONE);
    let interface = Surface { diffuse: Vec3::ZERO, ..surface };
    let alone = albedo(&Bsdf::of(&interface, Vec3::Z, Vec3::Z), viewer(65.0));
    let together = albedo(&Bsdf::of(&surface, Vec3::Z, Vec3::Z), viewer(65.0));
    assert!((alone + surface.diffuse).max_element() > 1.05, "{alone}");
    assert!(together.max_element() < 1.0, "{together}");
}

#[test]
fn a_lambertian_surface_reflects_its_colour() {
    let colour = Vec3::new(0.9, 0.5, 0.2);
    let bsdf = flat(&material(Gloss::None, 0.0, 0.1, colour));
    for i in 0..100 {
        let sample = bsdf.sample(viewer(80.0), &mut Stream::new(PixelSampler::new(0, 0, 0), i));
        let sample = sample.expect("above a flat surface");
        assert!((sample.weight - colour).abs().max_element() < 1e-5);
        let value = bsdf.evaluate(viewer(80.0), sample.direction);
        assert!((value - colour * sample.direction.z * FRAC_1_PI).abs().max_element() < 1e-6);
    }
}

#[test]
fn smooth_white_surfaces_lose_next_to_nothing() {
    // White: F is 1, and a metal loses only what its microfacets hide from each other.
    for (metallic, least) in [(1.0, 0.999), (0.0, 0.99)] {
        let bsdf = flat(&material(Gloss::Microfacets, metallic, 0.1, Vec3::ONE));
        for angle in [0.0, 35.0, 65.0] {
            let (mean, _) = estimated(&bsdf, viewer(angle), |_| 1.0, 1024);
            assert!(mean.min_element() > least && mean.max_element() < 1.001, "{metallic}, {angle}: {mean}");
        }
    }
}

#[test]
fn the_smoothest_surfaces_are_mirrors() {
    for gloss in [Gloss::Microfacets, Gloss::Phong] {
        let bsdf = flat(&material(gloss, 1.0, 0.0, Vec3::ONE));
        let to_viewer = viewer(50.0);
        for i in 0..200 {
            let Some(sample) = bsdf.sample(to_viewer, &mut Stream::new(PixelSampler::new(0, 0, 0), i)) else {
                continue;
            };
            let angle = sample.direction.angle_between(mirrored(to_viewer));
            assert!(angle < 0.1, "{gloss:?}: {angle}");
            assert!(sample.weight.is_finite() && sample.weight.max_element() < 1.01, "{}", sample.weight);
        }
    }
}

#[test]
fn a_black_surface_reflects_nothing() {
    let bsdf = flat(&material(Gloss::None, 0.0, 0.5, Vec3::ZERO));
    assert!(bsdf.sample(viewer(20.0), &mut Stream::new(PixelSampler::new(0, 0, 0), 0)).is_none());
    assert_eq!(bsdf.density(viewer(20.0), viewer(10.0)), 0.0);
    assert_eq!(bsdf.evaluate(viewer(20.0), viewer(10.0)), Vec3::ZERO);
}

#[test]
fn errors_fall_at_least_as_fast_as_the_root_of_the_samples() {
    // Light that grows towards one side, on a dielectric; truth by many samples.
    let bsdf = flat(&material(Gloss::Microfacets, 0.0, 0.5, Vec3::ONE));
    let light = |direction: Vec3| 1.0 + direction.x + 4.0 * f32::from(direction.y > 0.3);
    let truth = estimated(&bsdf, viewer(50.0), light, 32_768).0.x;
    let fitted = |bias: f32| {
        let points: Vec<(f64, f64)> = (3..12)
            .map(|power| {
                let replicate = |pixel: usize| {
                    let sampler = PixelSampler::new(pixel, 7, 0);
                    let value = |i| {
                        let sample = bsdf.sample(viewer(50.0), &mut Stream::new(sampler, i));
                        sample.map_or(0.0, |sample| sample.weight.x * light(sample.direction))
                    };
                    let mean = (0..1 << power).map(value).sum::<f32>() / (1 << power) as f32;
                    (mean * bias - truth).powi(2)
                };
                let error = (0..64).map(replicate).sum::<f32>() / 64.0;
                (f64::from(power) * std::f64::consts::LN_2, f64::from(0.5 * error.ln()))
            })
            .collect();
        least_squares(&points)
    };
    assert!(fitted(1.0) < -0.5, "{}", fitted(1.0));
    assert!(fitted(1.02) > -0.5, "an error that stays is noticed");
}

#[test]
fn directional_albedo_is_what_surfaces_reflect_to_a_viewer() {
    for (name, material) in materials().into_iter().filter(|(name, _)| name.starts_with("ggx")) {
        let surface = material.surface(&[], [Vec2::ZERO; 2], Vec4::ONE);
        let mut worst_of_diffuse = 0.0f32;
        for degrees in ANGLES {
            let to_viewer = viewer(degrees);
            let right = albedo(&flat(&material), to_viewer);
            let (diffuse, specular) = (surface.diffuse, surface.specular);
            let found = directional_albedo(diffuse, specular, surface.roughness, to_viewer.z);
            let off = (found - right).abs().max_element();
            assert!(off < 0.02, "{name}, {degrees} degrees: {found} is {right}");
            worst_of_diffuse = worst_of_diffuse.max((diffuse - right).abs().max_element());
        }
        assert!(worst_of_diffuse > 0.04, "{name}: it is not the diffuse colour");
    }
}
