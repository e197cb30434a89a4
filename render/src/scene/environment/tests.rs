use super::*;
use crate::exr_file::{self, Layer, Window, Windows};
use crate::path::chi_square::{p_value, rejects};
use crate::sampler::{PixelSampler, Stream, hash};
use deepshade_shaders::Planes;
use std::f32::consts::FRAC_PI_2;

fn random(i: u32) -> f32 {
    (hash(i) >> 8) as f32 / 16_777_216.0
}

fn of_texels(width: usize, height: usize, texel: impl Fn(usize, usize) -> Vec3) -> Environment {
    let texels = (0..width * height).map(|i| texel(i % width, i / width)).collect();
    Environment::new("test".as_ref(), width, height, texels).expect("radiances")
}

/// Some texels bright, most dim, some black.
fn speckled() -> Environment {
    let brightness = |i: u32| if random(i) < 0.3 { 0.0 } else { random(i + 9_000).powi(6) * 50.0 };
    of_texels(16, 9, |x, y| {
        let index = (y * 16 + x) as u32;
        Vec3::new(brightness(index), brightness(index + 300), brightness(index + 600))
    })
}

/// Integral of a function over all directions, by the rule of midpoints.
fn integral(of: impl Fn(Vec3) -> Vec3) -> Vec3 {
    let (rows, columns) = (720, 1440);
    let mut sum = glam::DVec3::ZERO;
    for row in 0..rows {
        let (sin, cos) = (PI * (row as f32 + 0.5) / rows as f32).sin_cos();
        for column in 0..columns {
            let around = Vec2::from_angle(TAU * (column as f32 + 0.5) / columns as f32);
            sum += of(Vec3::new(around.x * sin, cos, around.y * sin)).as_dvec3() * f64::from(sin);
        }
    }
    (sum * std::f64::consts::PI / rows as f64 * 2.0 * std::f64::consts::PI / columns as f64).as_vec3()
}

#[test]
fn directions_are_where_the_documentation_says() {
    // Four columns whose middles are at 1/8, 3/8, 5/8 and 7/8 of the width; two rows at 45 degrees above and
    // below.
    let number = |x: usize, y: usize| Vec3::splat((1 + x + 4 * y) as f32);
    let environment = of_texels(4, 2, number);
    let (a, b) = (0.5f32, 0.5f32.sqrt());
    for (direction, texel) in [
        (Vec3::new(a, b, -a), number(0, 0)),
        (Vec3::new(a, b, a), number(1, 0)),
        (Vec3::new(-a, b, a), number(2, 0)),
        (Vec3::new(-a, b, -a), number(3, 0)),
        (Vec3::new(a, -b, a), number(1, 1)),
    ] {
        let radiance = environment.radiance(direction);
        assert!((radiance - texel).length() < 1e-4, "{radiance} from {direction}");
    }
    // Half way between texels, across the edge of the image too.
    assert!((environment.radiance(Vec3::new(0.0, b, b)).x - 2.5).abs() < 1e-4);
    assert!((environment.radiance(Vec3::new(0.0, b, -b)).x - 2.5).abs() < 1e-4);
    assert!((environment.radiance(Vec3::new(b, 0.0, b)).x - 4.0).abs() < 1e-4);
}

#[test]
fn a_quarter_turn_takes_z_to_x() {
    let straight = speckled();
    let turned = straight.clone().rotated(FRAC_PI_2);
    for i in 0..100 {
        let d = Vec3::new(random(i) - 0.5, random(i + 200) - 0.5, random(i + 400) - 0.5).normalize();
        let rotated = Vec3::new(d.z, d.y, -d.x);
        assert!((turned.radiance(rotated) - straight.radiance(d)).length() < 1e-2, "from {d}");
        let [before, after] = [straight.density(d), turned.density(rotated)];
        assert!((before - after).abs() < 1e-3 * before.max(1.0), "{before} and {after}");
    }
    assert_eq!(turned.rotation(), FRAC_PI_2);
}

#[test]
fn a_uniform_environment_is_sampled_uniformly() {
    let environment = Environment::uniform(Vec3::new(1.0, 2.0, 3.0));
    assert!((environment.mean() - Vec3::new(1.0, 2.0, 3.0)).length() < 1e-5);
    for i in 0..100 {
        let sample = environment.sample(Vec2::new(random(i), random(i + 500))).expect("light");
        assert!((sample.density * 4.0 * PI - 1.0).abs() < 1e-5);
        assert!((sample.direction.length() - 1.0).abs() < 1e-5);
        assert_eq!(sample.radiance, Vec3::new(1.0, 2.0, 3.0));
    }
}

#[test]
fn samples_have_the_density_that_is_claimed() {
    for (environment, wrong) in
        [(speckled(), speckled().rotated(0.1)), (speckled().rotated(2.0), Environment::uniform(Vec3::ONE))]
    {
        let sample =
            |stream: &mut Stream| environment.sample(stream.next_2d()).map(|sample| sample.direction);
        let p = p_value(Vec3::Y, sample, |direction| environment.density(direction));
        assert!(!rejects(p, 2), "p = {p}");
        assert!(rejects(p_value(Vec3::Y, sample, |direction| wrong.density(direction)), 2));
    }
}

#[test]
fn sampled_radiance_over_density_has_the_integral_of_the_radiance() {
    let environment = speckled();
    let expected = integral(|direction| environment.radiance(direction));
    let (mut sum, mut squares, count) = (Vec3::ZERO, Vec3::ZERO, 40_000);
    for i in 0..count {
        let square = Stream::new(PixelSampler::new(i as usize, 3, 5), 0).next_2d();
        let sample = environment.sample(square).expect("light");
        assert_eq!(sample.radiance, environment.radiance(sample.direction));
        let value = sample.radiance / sample.density;
        sum += value;
        squares += value * value;
    }
    let mean = sum / count as f32;
    let error = ((squares / count as f32 - mean * mean) / count as f32).map(f32::sqrt);
    assert!((mean - expected).abs().cmple(3.0 * error).all(), "{mean} +- {error}, not {expected}");
    // 2 % brighter light is noticed.
    assert!((mean * 1.02 - expected).abs().cmpgt(3.0 * error).any(), "{error} is too large to notice");
    // The density has been measured over directions; the mean is one of texels, which interpolation only
    // blurs.
    assert!((integral(|d| Vec3::splat(environment.density(d))).x - 1.0).abs() < 1e-3);
    assert!((environment.mean() * 4.0 * PI - expected).length() < 0.05 * expected.length());
}

#[test]
fn a_black_map_is_never_sampled() {
    let black = of_texels(4, 2, |_, _| Vec3::ZERO);
    assert_eq!(black.sample(Vec2::splat(0.5)), None);
    assert_eq!(
        (black.density(Vec3::X), black.radiance(Vec3::X), black.mean()),
        (0.0, Vec3::ZERO, Vec3::ZERO)
    );
    // One texel shines into its neighbours, and nowhere else.
    let lamp = of_texels(16, 8, |x, y| Vec3::splat(f32::from((x, y) == (3, 4))));
    for i in 0..200 {
        let direction = Vec3::new(random(i) - 0.5, random(i + 200) - 0.5, random(i + 400) - 0.5).normalize();
        assert!(lamp.radiance(direction) == Vec3::ZERO || lamp.density(direction) > 0.0);
        let sample = lamp.sample(Vec2::new(random(i), random(i + 800))).expect("light");
        assert!(sample.density > 0.0 && sample.density.is_finite());
    }
}

#[test]
fn texels_that_are_no_radiance_are_named() {
    for bad in [f32::NAN, f32::INFINITY, -0.5] {
        let mut texels = vec![Vec3::ONE; 8];
        texels[6].y = bad;
        let error = Environment::new("sky.exr".as_ref(), 4, 2, texels).expect_err("bad").to_string();
        assert!(error.starts_with("sky.exr: texel (2, 1) is (1, "), "{error}");
    }
    let error = Environment::new("sky".as_ref(), 3, 2, vec![Vec3::ONE; 5]).expect_err("too few");
    assert_eq!(error.to_string(), "sky: has 5 texels, not 3 x 2");
    assert!(Environment::new("sky".as_ref(), 0, 2, vec![]).is_err());
    assert!(Environment::new("sky".as_ref(), 1, 20_000, vec![Vec3::ONE; 20_000]).is_err());
}

#[test]
fn files_hold_what_was_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let value = |x: usize, y: usize| [0.25 * (x + 1) as f32, 2.0 * (y + 1) as f32, 0.0];
    let is_as_written = |environment: &Environment| {
        assert_eq!(environment.size(), [4, 2]);
        for (index, texel) in environment.texels().iter().enumerate() {
            assert_eq!(texel.to_array(), value(index % 4, index / 4));
        }
    };
    let exr = folder.path().join("sky.exr");
    exr::prelude::write_rgb_file(&exr, 4, 2, |x, y| value(x, y).into()).expect("written");
    is_as_written(&Environment::load(&exr).expect("an environment"));
    let hdr = folder.path().join("sky.HDR");
    let pixels: Vec<image::Rgb<f32>> = (0..8).map(|i| image::Rgb(value(i % 4, i / 4))).collect();
    let file = std::fs::File::create(&hdr).expect("a file");
    image::codecs::hdr::HdrEncoder::new(file).encode(&pixels, 4, 2).expect("written");
    is_as_written(&Environment::load(&hdr).expect("an environment"));
}

/// Such as a sharpening filter leaves beside the sun.
#[test]
fn texels_below_0_are_taken_as_0_and_that_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sharp.exr");
    let value = |x: usize, y: usize| match (x, y) {
        (1, 0) => (-1e-5, 2.0, 0.5),
        (3, 1) => (-0.25, -3.5, -0.0),
        _ => (1.0, 0.5, 0.0),
    };
    exr::prelude::write_rgb_file(&path, 4, 2, value).expect("written");
    let environment = Environment::load(&path).expect("an environment");
    for (index, texel) in environment.texels().iter().enumerate() {
        let (r, g, b) = value(index % 4, index / 4);
        assert_eq!(*texel, Vec3::new(r.max(0.0), g.max(0.0), b.max(0.0)));
    }
    let said = environment.warning().expect("a warning");
    assert!(said.ends_with("sharp.exr: 2 texels below 0, down to -3.5e0, are taken as 0"), "{said}");
    exr::prelude::write_rgb_file(&path, 4, 2, |_, _| (1.0, 0.0, 2.0)).expect("written");
    assert_eq!(Environment::load(&path).expect("an environment").warning(), None);
    exr::prelude::write_rgb_file(&path, 4, 2, |x, _| (-1.0, f32::INFINITY * (x as f32 - 0.5), 2.0))
        .expect("written");
    assert!(Environment::load(&path).expect_err("infinite").to_string().contains("not a radiance"));
}

#[test]
fn a_part_of_a_map_stays_where_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("crop.exr");
    let part = Planes::from_fn(3, 8, 16, |c, y, x| (1 + c + y + x) as f32);
    let data = Window { left: 4, top: 2, width: 16, height: 8 };
    let windows = Windows { data, display: Window::of_size(16, 32) };
    // Without a layer's name, as pictures are.
    let channels = |planes: &Planes| [0, 1, 2].map(|c| Planes::from_data(1, 8, 16, planes.plane(c).to_vec()));
    let planes = channels(&part);
    let layers: Vec<Layer<'_>> =
        ["R", "G", "B"].iter().zip(&planes).map(|(name, plane)| Layer::image(name, plane)).collect();
    exr_file::write_within(&path, &layers, &Default::default(), &windows).expect("written");
    let environment = Environment::load(&path).expect("an environment");
    assert_eq!((environment.width, environment.height), (32, 16));
    for (index, texel) in environment.texels().iter().enumerate() {
        let (x, y) = (index % 32, index / 32);
        let expected = match ((4..20).contains(&x), (2..10).contains(&y)) {
            (true, true) => Vec3::from_array([0, 1, 2].map(|c| part.at(c, y - 2, x - 4))),
            _ => Vec3::ZERO,
        };
        assert_eq!(*texel, expected, "{x}, {y}");
    }
    assert!(environment.warning().is_some_and(|said| said.contains("(4, 2) to (19, 9)")));
}

#[test]
fn files_that_are_no_environments_are_refused_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let error = |name: &str| Environment::load(&folder.path().join(name)).expect_err(name).to_string();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("written");
    assert!(error("missing.hdr").contains("missing.hdr"));
    assert!(error("sky.png").contains("sky.png: not an environment map that is known here"));
    write("huge.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 900000 +X 900000\n");
    assert!(error("huge.hdr").contains("900000 x 900000 texels, where"), "{}", error("huge.hdr"));
    write("hollow.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8000 +X 16000\n");
    assert!(error("hollow.hdr").contains("promises 16000 x 8000 texels in"));
    write("cut.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n\x02\x02\x00\x10\x90");
    assert!(error("cut.hdr").contains("cut.hdr: not a usable Radiance HDR image"));
    write("cut.exr", &[0x76, 0x2f, 0x31, 0x01, 2, 0, 0]);
    assert!(error("cut.exr").contains("cut.exr"));
    let path = folder.path().join("nan.exr");
    exr::prelude::write_rgb_file(&path, 4, 2, |x, _| (1.0, if x == 3 { f32::NAN } else { 1.0 }, 1.0))
        .expect("written");
    assert!(error("nan.exr").contains("nan.exr: texel (3, 0) is (1, NaN, 1)"), "{}", error("nan.exr"));
    let path = folder.path().join("tall.exr");
    exr::prelude::write_rgb_file(&path, 2, 12, |_, _| (1.0, 1.0, 1.0)).expect("written");
    assert!(error("tall.exr").contains("tall.exr: is 2 x 12, not equirectangular"));
}
