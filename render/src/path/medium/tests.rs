use super::*;
use crate::path::chi_square::{p_value, rejects};
use crate::path::sampler::PixelSampler;
use crate::scene::{Bounds, DensityGrid};
use glam::{DVec3, Vec2};

/// A stream of numbers that are independent of all others.
fn stream(index: u32, seed: u32) -> Stream {
    Stream::new(PixelSampler::new(index as usize, 0, seed), 0)
}

/// Mean of independent samples and its standard error.
fn estimate(count: u32, sample: impl Fn(&mut Stream) -> Vec3) -> [Vec3; 2] {
    let values: Vec<DVec3> = (0..count).map(|index| sample(&mut stream(index, 1)).as_dvec3()).collect();
    let count = f64::from(count);
    let mean = values.iter().sum::<DVec3>() / count;
    let squares: DVec3 = values.iter().map(|value| (*value - mean) * (*value - mean)).sum();
    [mean.as_vec3(), (squares / (count * (count - 1.0))).map(f64::sqrt).as_vec3()]
}

/// Whether a mean is within three standard errors, and rounding, of what it should be.
fn agrees([mean, error]: [Vec3; 2], expected: Vec3) -> bool {
    (mean - expected).abs().cmple(3.0 * error + 1e-5 * expected.abs()).all()
}

fn assert_mean(found: [Vec3; 2], expected: Vec3) {
    assert!(agrees(found, expected), "{} +- {} is not {expected}", found[0], found[1]);
    assert!(!agrees(found, expected * 1.05), "5 % more would be noticed");
}

const ABSORPTION: Vec3 = Vec3::new(0.1, 0.3, 0.0);
const SCATTERING: Vec3 = Vec3::new(0.2, 0.4, 0.9);
/// What light was multiplied by before.
const THROUGHPUT: Vec3 = Vec3::new(0.3, 1.0, 0.6);

fn medium(density: Density) -> Medium {
    Medium::new(ABSORPTION, SCATTERING, 0.0, density).expect("a medium")
}

/// Three metres long, one across.
const BOX: Bounds = Bounds { min: Vec3::ZERO, max: Vec3::new(3.0, 1.0, 1.0) };

/// Sixteen cells along the box: a thin layer before a dense one.
fn two_layers() -> Medium {
    let values = (0..16).map(|x| if x < 8 { 0.4 } else { 1.7 }).collect();
    medium(Density::Grid(DensityGrid::new(BOX, [16, 1, 1], values).expect("a grid")))
}

/// Density falls and rises all along the box.
fn waves() -> Medium {
    let values = (0..24).map(|x| 1.0 + (x as f32).sin()).collect();
    medium(Density::Grid(DensityGrid::new(BOX, [24, 1, 1], values).expect("a grid")))
}

/// All along the middle of the box, from before to behind it.
const ALONG: Segment = Segment { origin: Vec3::new(-1.0, 0.5, 0.5), direction: Vec3::X, length: 6.0 };

/// Density times length, up to a distance on the segment; by midpoints that meet the corners of the grids' densities.
fn column(medium: &Medium, length: f32) -> f32 {
    let steps = 19_200;
    let step = 6.0 / steps as f32;
    let Density::Grid(grid) = &medium.density else { return (length - 1.0).clamp(0.0, 3.0) };
    let density = |x: f32| if (0.0..3.0).contains(&x) { grid.at(Vec3::new(x, 0.5, 0.5)) } else { 0.0 };
    let sum: f64 = (0..steps)
        .map(|i| (i as f32 + 0.5) * step)
        .filter(|at| *at < length)
        .map(|at| f64::from(density(at - 1.0)))
        .sum();
    sum as f32 * step
}

fn passing(medium: &Medium, length: f32) -> Vec3 {
    (-medium.extinction() * column(medium, length)).exp()
}

/// Share of light that is scattered towards anywhere, up to a distance: albedo times what does not pass.
fn scattered(medium: &Medium, length: f32) -> Vec3 {
    SCATTERING / medium.extinction() * (1.0 - passing(medium, length))
}

fn uniform() -> Medium {
    medium(Density::Within(BOX))
}

fn flight(medium: &Medium, length: f32, stream: &mut Stream) -> Flight {
    Media { medium: Some(medium) }.flight(&Segment { length, ..ALONG }, THROUGHPUT, stream)
}

#[test]
fn the_column_of_a_grid_is_the_sum_of_its_cells() {
    let waves_sum = (0..24).map(|x| 1.0 + (x as f32).sin()).sum::<f32>() / 24.0;
    for (grid, mean) in [(two_layers(), 0.5 * (0.4 + 1.7)), (waves(), waves_sum)] {
        assert!((column(&grid, 6.0) / (3.0 * mean) - 1.0).abs() < 1e-4);
    }
}

#[test]
fn uniform_media_dim_light_as_beer_and_lambert_say() {
    let medium = uniform();
    let dimmed =
        |medium: &Medium, segment| Media { medium: Some(medium) }.transmittance(&segment, &mut stream(0, 0));
    let extinction = ABSORPTION + SCATTERING;
    for (length, inside) in [(0.5, 0.0), (2.5, 1.5), (6.0, 3.0)] {
        let expected = (-extinction * inside).exp();
        assert!((dimmed(&medium, Segment { length, ..ALONG }) - expected).length() < 1e-6);
    }
    // Without an end, and without anything to stop one of the colours.
    let endless = Medium { absorption: Vec3::Y, scattering: Vec3::X, density: Density::Everywhere, ..medium };
    let segment = Segment { length: f32::INFINITY, ..ALONG };
    assert_eq!(dimmed(&endless, segment), Vec3::Z);
    let flight = |index| Media { medium: Some(&endless) }.flight(&segment, Vec3::ONE, &mut stream(index, 0));
    assert!((0..100).all(|index| flight(index).weight.is_finite()));
}

#[test]
fn ratio_tracking_dims_light_by_the_line_integral() {
    for medium in [two_layers(), waves()] {
        for length in [2.2, 6.0] {
            let segment = Segment { length, ..ALONG };
            let media = Media { medium: Some(&medium) };
            let found = estimate(60_000, |stream| media.transmittance(&segment, stream));
            assert_mean(found, passing(&medium, length));
        }
    }
}

#[test]
fn thick_grids_dim_light_without_a_bias_by_roulette() {
    let dense = DensityGrid::new(BOX, [1; 3], vec![2.0]).expect("a grid");
    // Optical depths of 4.2, 3.6 and 5.4, at all of which light is faint.
    let medium = Medium { absorption: Vec3::new(0.5, 0.2, 0.0), ..medium(Density::Grid(dense)) };
    let media = Media { medium: Some(&medium) };
    let found = estimate(300_000, |stream| media.transmittance(&ALONG, stream));
    assert_mean(found, (-medium.extinction() * 6.0).exp());
}

#[test]
fn flights_pass_and_scatter_as_often_as_light_does() {
    for medium in [uniform(), two_layers(), waves()] {
        for length in [2.2, 6.0] {
            let passed = |stream: &mut Stream| {
                let flight = flight(&medium, length, stream);
                if flight.scattered.is_none() { flight.weight } else { Vec3::ZERO }
            };
            assert_mean(estimate(40_000, passed), passing(&medium, length));
            let scatters = |stream: &mut Stream| {
                let flight = flight(&medium, length, stream);
                if flight.scattered.is_some() { flight.weight } else { Vec3::ZERO }
            };
            assert_mean(estimate(40_000, scatters), scattered(&medium, length));
        }
    }
}

#[test]
fn flights_scatter_where_light_does() {
    for medium in [uniform(), two_layers(), waves()] {
        for until in [1.7, 2.5, 3.1] {
            let early = |stream: &mut Stream| {
                let flight = flight(&medium, 6.0, stream);
                if flight.scattered.is_some_and(|distance| distance < until) {
                    flight.weight
                } else {
                    Vec3::ZERO
                }
            };
            assert_mean(estimate(40_000, early), scattered(&medium, until));
        }
    }
}

#[test]
fn certain_scattering_is_where_and_as_much_as_that_of_flights() {
    for medium in [uniform(), two_layers(), waves()] {
        let media = Media { medium: Some(&medium) };
        for until in [1.7, 3.1, 6.0] {
            let early = |stream: &mut Stream| {
                let Flight { scattered, weight } = media.scattering(&ALONG, THROUGHPUT, stream);
                if scattered.is_some_and(|distance| distance < until) { weight } else { Vec3::ZERO }
            };
            assert_mean(estimate(40_000, early), scattered(&medium, until));
        }
    }
}

#[test]
fn light_never_grows_on_a_flight() {
    let light = THROUGHPUT.element_sum() * 1.000_01;
    for medium in [uniform(), two_layers(), waves()] {
        for index in 0..10_000 {
            let flight = flight(&medium, 6.0, &mut stream(index, 2));
            assert!((THROUGHPUT * flight.weight).element_sum() <= light, "{flight:?}");
        }
    }
}

#[test]
fn what_only_absorbs_scatters_nothing() {
    for density in [uniform().density, two_layers().density] {
        let medium = Medium { scattering: Vec3::ZERO, ..medium(density) };
        let media = Media { medium: Some(&medium) };
        assert!((0..100).all(|index| flight(&medium, 6.0, &mut stream(index, 3)).scattered.is_none()));
        assert_eq!(media.scattering(&ALONG, Vec3::ONE, &mut stream(0, 3)), Flight::passed(Vec3::ZERO));
        let found = estimate(40_000, |stream| flight(&medium, 6.0, stream).weight);
        assert_mean(found, passing(&medium, 6.0));
    }
}

#[test]
fn nothing_is_nothing() {
    let empty = DensityGrid::new(BOX, [2, 2, 2], vec![0.0; 8]).expect("a grid");
    let empty = medium(Density::Grid(empty));
    let aside = Segment { origin: Vec3::new(-1.0, 2.0, 0.5), ..ALONG };
    for (media, segment) in [
        (Media { medium: None }, ALONG),
        (Media { medium: Some(&empty) }, ALONG),
        (Media { medium: Some(&uniform()) }, aside),
    ] {
        let mut stream = stream(0, 4);
        assert_eq!(media.transmittance(&segment, &mut stream), Vec3::ONE);
        assert_eq!(media.flight(&segment, Vec3::ONE, &mut stream), Flight::passed(Vec3::ONE));
        assert_eq!(media.scattering(&segment, Vec3::ONE, &mut stream), Flight::passed(Vec3::ZERO));
    }
}

/// Mean squared distance from its start of light that is absorbed where it collides, after a random walk in an endless
/// medium with a mean free path of half a metre.
fn squared_distance(albedo: f32, anisotropy: f32) -> [Vec3; 2] {
    let (extinction, absorbed) = (Vec3::splat(2.0), 1.0 - albedo);
    let medium = Medium::new(extinction * absorbed, extinction * albedo, anisotropy, Density::Everywhere);
    let medium = medium.expect("a medium");
    let media = Media { medium: Some(&medium) };
    estimate(60_000, |stream| {
        let (mut point, mut direction) = (Vec3::ZERO, Vec3::X);
        let (mut weight, mut sum) = (1.0, 0.0);
        // What is left after 200 collisions of albedo 0.8 is 1e-20.
        for _ in 0..200 {
            let segment = Segment { origin: point, direction, length: f32::INFINITY };
            let flight = media.flight(&segment, Vec3::ONE, stream);
            point += direction * flight.scattered.expect("no exit");
            sum += weight * absorbed * point.length_squared();
            weight *= flight.weight.x;
            direction = media.phase().sample(direction, stream.next_2d());
        }
        Vec3::splat(sum)
    })
}

#[test]
fn random_walks_go_as_far_as_their_second_moment_says() {
    // 2 l^2 / (1 - albedo), and with the mean cosine g another factor 1 / (1 - albedo g).
    for (albedo, g) in [(0.5, 0.0), (0.8, 0.0), (0.8, 0.6), (0.8, -0.6)] {
        let expected = Vec3::splat(0.5 / ((1.0 - albedo) * (1.0 - albedo * g)));
        let found = squared_distance(albedo, g);
        assert!(agrees(found, expected), "{} +- {} is not {expected}", found[0], found[1]);
        assert!(!agrees(found, expected * 1.05), "5 % farther would be noticed");
    }
    assert!(!agrees(squared_distance(0.8, 0.1), Vec3::splat(2.5)), "a mean cosine of 0.1 would be noticed");
}

#[test]
fn phase_functions_are_sampled_as_they_say() {
    let pole = Vec3::new(0.48, -0.6, 0.64);
    // Bins that turn about another axis cut the peak into many.
    let p = |sampled: f32, claimed: f32| {
        let (sampled, claimed) = (HenyeyGreenstein::new(sampled), HenyeyGreenstein::new(claimed));
        let sample = |stream: &mut Stream| Some(sampled.sample(pole, stream.next_2d()));
        p_value(Vec3::new(0.8, 0.6, 0.0), sample, |direction| claimed.evaluate(pole.dot(direction)))
    };
    let all = [-0.8, -0.3, 0.0, 1e-4, 0.5, 0.85];
    for g in all {
        assert!(!rejects(p(g, g), all.len()), "{g}: {}", p(g, g));
    }
    for (sampled, claimed) in [(0.5, 0.53), (0.0, 0.05), (0.5, -0.5), (-0.8, -0.77)] {
        assert!(rejects(p(sampled, claimed), all.len()), "{sampled} is not {claimed}");
    }
}

#[test]
fn anisotropy_is_the_mean_cosine() {
    for g in [-0.99, -0.6, 0.0, 0.3, 0.9, 0.99] {
        let phase = HenyeyGreenstein::new(g);
        let cosine = |stream: &mut Stream| {
            Vec3::splat(phase.sample(Vec3::Y, Vec2::new(stream.next_1d(), stream.next_1d())).y)
        };
        let found = estimate(40_000, cosine);
        assert!(
            (found[0].x - g).abs() < 3.0 * found[1].x + 1e-6,
            "{} +- {} is not {g}",
            found[0].x,
            found[1].x
        );
        // By midpoints over the cosine, fine enough for the peak.
        let steps = 200_000;
        let moment = |power: i32| -> f64 {
            let cosines = (0..steps).map(|i| (f64::from(i) + 0.5) * 2.0 / f64::from(steps) - 1.0);
            let values = cosines.map(|cosine| f64::from(phase.evaluate(cosine as f32)) * cosine.powi(power));
            values.sum::<f64>() * 4.0 * std::f64::consts::PI / f64::from(steps)
        };
        assert!((moment(0) - 1.0).abs() < 2e-3, "{g}: {}", moment(0));
        assert!((moment(1) - f64::from(g)).abs() < 2e-3, "{g}: {}", moment(1));
    }
}
