use super::*;
use crate::path::chi_square::{self, p_value, p_value_of_distances};
use crate::path::lights::Arrival;
use crate::path::proving::MeanWithError;
use crate::sampler::PixelSampler;
use crate::scene::{Bounds, DensityGrid, Scene};
use glam::Vec2;
use std::f32::consts::FRAC_1_PI;

/// A stream of numbers that are independent of all others.
fn stream(index: u32, seed: u32) -> Stream {
    Stream::new(PixelSampler::new(index as usize, 0, seed), 0)
}

/// Proves a value, and that 5 % more would be noticed.
fn prove(name: &str, found: MeanWithError, expected: Vec3) {
    found.proves(name, expected);
    found.refutes(name, expected * 1.05);
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

/// Density times length along the middle of a grid's box, up to a distance from where it begins; by midpoints
/// that meet the corners of the grids' densities.
fn column_of(grid: &DensityGrid, length: f32) -> f32 {
    let steps = 9_600;
    let step = 3.0 / steps as f32;
    let sum: f64 = (0..steps)
        .map(|i| (i as f32 + 0.5) * step)
        .filter(|at| *at < length)
        .map(|at| f64::from(grid.at(Vec3::new(at, 0.5, 0.5))))
        .sum();
    sum as f32 * step
}

/// The same of a medium, up to a distance on the segment.
fn column(medium: &Medium, length: f32) -> f32 {
    match &medium.density {
        Density::Grid(grid) => column_of(grid, length - 1.0),
        _ => (length - 1.0).clamp(0.0, 3.0),
    }
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
        let found = MeanWithError { mean: dimmed(&medium, Segment { length, ..ALONG }), error: Vec3::ZERO };
        found.proves("beer_lambert/uniform", expected);
        if inside > 0.0 {
            found.refutes("beer_lambert/uniform", (-1.02 * extinction * inside).exp());
        }
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
            let found = MeanWithError::of_independent(|stream| media.transmittance(&segment, stream), 60_000);
            prove("beer_lambert/ratio_tracking", found, passing(&medium, length));
        }
    }
}

#[test]
fn thick_grids_dim_light_without_a_bias_by_roulette() {
    let dense = DensityGrid::new(BOX, [1; 3], vec![2.0]).expect("a grid");
    // Optical depths of 4.2, 3.6 and 5.4, at all of which light is faint.
    let medium = Medium { absorption: Vec3::new(0.5, 0.2, 0.0), ..medium(Density::Grid(dense)) };
    let media = Media { medium: Some(&medium) };
    let found = MeanWithError::of_independent(|stream| media.transmittance(&ALONG, stream), 300_000);
    prove("beer_lambert/thick", found, (-medium.extinction() * 6.0).exp());
}

#[test]
fn flights_pass_and_scatter_as_often_as_light_does() {
    for medium in [uniform(), two_layers(), waves()] {
        for length in [2.2, 6.0] {
            let passed = |stream: &mut Stream| {
                let flight = flight(&medium, length, stream);
                if flight.scattered.is_none() { flight.weight } else { Vec3::ZERO }
            };
            prove("flight/passing", MeanWithError::of_independent(passed, 40_000), passing(&medium, length));
            let scatters = |stream: &mut Stream| {
                let flight = flight(&medium, length, stream);
                if flight.scattered.is_some() { flight.weight } else { Vec3::ZERO }
            };
            prove(
                "flight/scattered",
                MeanWithError::of_independent(scatters, 40_000),
                scattered(&medium, length),
            );
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
            prove(
                "flight/scattered",
                MeanWithError::of_independent(early, 40_000),
                scattered(&medium, until),
            );
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
            prove("flight/certain", MeanWithError::of_independent(early, 40_000), scattered(&medium, until));
        }
    }
}

/// A lamp beside the middle of the box.
fn lamp(aside: f32, intensity: Vec3) -> Light {
    Light::Point { position: Vec3::new(1.3, 0.5 + aside, 0.5), intensity, range: f32::INFINITY }
}

#[test]
fn scattering_of_lamps_is_where_and_as_much_as_that_of_flights() {
    let lights = [lamp(0.05, Vec3::ONE), lamp(-0.3, Vec3::new(9.0, 3.0, 1.0))];
    for medium in [uniform(), two_layers(), waves()] {
        let media = Media { medium: Some(&medium) };
        for until in [1.7, 3.1, 6.0] {
            let early = |stream: &mut Stream| {
                let Flight { scattered, weight } =
                    media.scattering_of_lamps(&lights, &ALONG, THROUGHPUT, stream);
                if scattered.is_some_and(|distance| distance < until) { weight } else { Vec3::ZERO }
            };
            let found = MeanWithError::of_independent(early, 160_000);
            prove("flight/of_lamps", found, scattered(&medium, until));
        }
    }
}

#[test]
fn light_of_a_near_lamp_has_a_tenth_of_the_variance_of_free_flights() {
    let scene = Scene::default();
    let lights = [lamp(0.02, Vec3::ONE)];
    for medium in [uniform(), two_layers(), waves()] {
        let media = Media { medium: Some(&medium) };
        // What the flight sends back of a lamp that nothing dims on its way.
        let lit = |flight: Flight| {
            flight.scattered.map_or(Vec3::ZERO, |distance| {
                flight.weight
                    * Arrival::new(&scene, &lights[0], ALONG.at(distance)).irradiance
                    * (0.25 * FRAC_1_PI)
            })
        };
        // The same by midpoints, of a sixteenth of a millimetre.
        let steps = 48_000;
        let step = 3.0 / steps as f32;
        let mut column = 0.0;
        let mut expected = glam::DVec3::ZERO;
        for i in 0..steps {
            let point = ALONG.at(1.0 + (i as f32 + 0.5) * step);
            let density = medium.density.inside(point);
            let passing = (-medium.extinction() * (column + 0.5 * density * step)).exp();
            let arriving = Arrival::new(&scene, &lights[0], point).irradiance * (0.25 * FRAC_1_PI);
            expected += (SCATTERING * density * passing * arriving * step).as_dvec3();
            column += density * step;
        }
        let expected = expected.as_vec3();
        let count = 100_000;
        let by_lamps = MeanWithError::of_independent(
            |stream| lit(media.scattering_of_lamps(&lights, &ALONG, Vec3::ONE, stream)),
            count,
        );
        let by_flights =
            MeanWithError::of_independent(|stream| lit(media.scattering(&ALONG, Vec3::ONE, stream)), count);
        by_lamps.proves("flight/near_lamp", expected);
        by_lamps.refutes("flight/near_lamp", 1.02 * expected);
        assert!(by_flights.is(expected), "{by_flights:?} is not {expected}");
        let ratio = by_flights.error / by_lamps.error;
        let gain = ratio * ratio;
        println!("a variance {gain} times as small");
        assert!(gain.min_element() > 10.0, "{gain}");
    }
}

/// A colourless medium that absorbs nothing: flights end with the density of collisions.
fn colourless(density: Density) -> Medium {
    Medium::new(Vec3::ZERO, Vec3::splat(0.9), 0.0, density).expect("a medium")
}

#[test]
fn distances_are_sampled_as_they_say() {
    let inside = |flight: Flight| flight.scattered.map(|distance| distance - 1.0);
    let tests = 5;
    // Of coloured light in a uniform medium: all colours' densities, by what is left of them.
    let coloured = uniform();
    let p = |factor: f32| {
        let extinction = factor * coloured.extinction();
        let density =
            |x: f32| THROUGHPUT.dot(extinction * (-extinction * x).exp()) / THROUGHPUT.element_sum();
        let sample = |stream: &mut Stream| inside(flight(&coloured, 6.0, stream));
        p_value_of_distances(3.0, sample, |x| density(x).into())
    };
    chi_square::proves("chi_square/flight", p(1.0), tests);
    chi_square::refutes("chi_square/flight", p(1.05), tests);
    // Through grids: density times what passes.
    for medium in [two_layers(), waves()].map(|medium| colourless(medium.density)) {
        let Density::Grid(grid) = &medium.density else { unreachable!("grids") };
        let columns: Vec<f32> = (0..=3000).map(|i| column_of(grid, i as f32 / 1000.0)).collect();
        let p = |factor: f32| {
            let extinction = factor * 0.9;
            let density = |x: f32| {
                let before = columns[(x * 1000.0).round() as usize];
                extinction * grid.at(Vec3::new(x, 0.5, 0.5)) * (-extinction * before).exp()
            };
            let sample = |stream: &mut Stream| inside(flight(&medium, 6.0, stream));
            p_value_of_distances(3.0, sample, |x| density(x).into())
        };
        chi_square::proves("chi_square/delta_tracking", p(1.0), tests);
        chi_square::refutes("chi_square/delta_tracking", p(1.05), tests);
    }
    // Scattering for certain, and by what lamps send.
    let span = [1.0, 4.0];
    let p = |sampled: f32, claimed: f32| {
        let [sampled, claimed] = [sampled, claimed].map(|density| {
            uniform::Scattering::new(&coloured, density, span, THROUGHPUT).expect("scattering")
        });
        let sample = |stream: &mut Stream| Some(sampled.distance(stream.next_2d()) - 1.0);
        p_value_of_distances(3.0, sample, |x| claimed.density(1.0 + x).into())
    };
    chi_square::proves("chi_square/scattering", p(1.0, 1.0), tests);
    chi_square::refutes("chi_square/scattering", p(1.0, 1.05), tests);
    let p = |sampled: f32, claimed: f32| {
        let [sampled, claimed] =
            [sampled, claimed].map(|aside| [lamp(aside, Vec3::ONE), lamp(-0.6, Vec3::new(4.0, 2.0, 9.0))]);
        let [sampled, claimed] =
            [&sampled, &claimed].map(|lights| Lamps::beside(lights, &ALONG, span).expect("lamps"));
        let sample = |stream: &mut Stream| Some(sampled.distance(stream.next_1d()) - 1.0);
        p_value_of_distances(3.0, sample, |x| claimed.density(1.0 + x).into())
    };
    chi_square::proves("chi_square/lamps", p(0.1, 0.1), tests);
    chi_square::refutes("chi_square/lamps", p(0.1, 0.105), tests);
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
        let found = MeanWithError::of_independent(|stream| flight(&medium, 6.0, stream).weight, 40_000);
        prove("beer_lambert/absorption", found, passing(&medium, 6.0));
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

/// Mean squared distance from its start of light that is absorbed where it collides, after a random walk in
/// an endless medium with a mean free path of half a metre.
fn squared_distance(albedo: f32, anisotropy: f32) -> MeanWithError {
    let (extinction, absorbed) = (Vec3::splat(2.0), 1.0 - albedo);
    let medium = Medium::new(extinction * absorbed, extinction * albedo, anisotropy, Density::Everywhere);
    let medium = medium.expect("a medium");
    let media = Media { medium: Some(&medium) };
    let walk = |stream: &mut Stream| {
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
    };
    MeanWithError::of_independent(walk, 60_000)
}

#[test]
fn random_walks_go_as_far_as_their_second_moment_says() {
    // 2 l^2 / (1 - albedo), and with the mean cosine g another factor 1 / (1 - albedo g).
    for (albedo, g) in [(0.5, 0.0), (0.8, 0.0), (0.8, 0.6), (0.8, -0.6)] {
        let expected = Vec3::splat(0.5 / ((1.0 - albedo) * (1.0 - albedo * g)));
        prove("flight/random_walk", squared_distance(albedo, g), expected);
    }
    squared_distance(0.8, 0.1).refutes("flight/random_walk", Vec3::splat(2.5));
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
        chi_square::proves("chi_square/phase", p(g, g), all.len());
    }
    for (sampled, claimed) in [(0.5, 0.53), (0.0, 0.05), (0.5, -0.5), (-0.8, -0.77)] {
        chi_square::refutes("chi_square/phase", p(sampled, claimed), all.len());
    }
}

#[test]
fn anisotropy_is_the_mean_cosine() {
    for g in [-0.99, -0.6, 0.0, 0.3, 0.9, 0.99] {
        let phase = HenyeyGreenstein::new(g);
        let cosine = |stream: &mut Stream| {
            Vec3::splat(phase.sample(Vec3::Y, Vec2::new(stream.next_1d(), stream.next_1d())).y)
        };
        let found = MeanWithError::of_independent(cosine, 40_000);
        found.proves("phase/mean_cosine", Vec3::splat(g));
        found.refutes("phase/mean_cosine", Vec3::splat(g + 0.02));
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
