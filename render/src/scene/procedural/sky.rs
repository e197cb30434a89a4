//! A clear sky with a sun over plain ground, as an environment that needs no file: the analytic daylight
//! model of Preetham, Shirley and Smits (1999), appendix A.2.

use super::random::Random;
use crate::scene::Environment;
use glam::{DMat3, DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

/// Texels from top to bottom.
const HEIGHT: usize = 128;
/// Texels around.
const WIDTH: usize = 2 * HEIGHT;

/// The stream of random numbers that skies take; families of scenes have those below.
const SKIES: u64 = 1001;

/// Half the angle at which the sun is seen, radians: ten times the real one, so that texels resolve it.
const SUN_RADIUS: f64 = 0.0465;

/// Irradiance from the sun over that from the sky, on level ground under a clear sky in the middle of the
/// day.
const SUN_SHARE: f64 = 4.0;

/// The sky of a seed. Sun, haze and ground differ; the irradiance of level ground, divided by pi, is 1 of
/// green.
pub fn sky(seed: u64) -> Environment {
    let mut random = Random::new(SKIES, seed);
    let mut draw = |low: f32, high: f32| f64::from(random.within(low, high));
    let (turbidity, height, around) = (draw(2.0, 6.0), draw(0.35, 1.2), draw(0.0, 2.0 * PI as f32));
    let ground = DVec3::new(draw(0.1, 0.3), draw(0.1, 0.3), draw(0.05, 0.2));
    let to_sun = DVec3::new(height.cos() * around.sin(), height.sin(), height.cos() * around.cos());
    let daylight = Daylight::new(turbidity, FRAC_PI_2 - height);
    let above = |shine: &dyn Fn(DVec3) -> DVec3| -> Vec<DVec3> {
        let of = |towards: DVec3| if towards.y > 0.0 { shine(towards) } else { DVec3::ZERO };
        (0..WIDTH * HEIGHT).map(|texel| of(direction(texel))).collect()
    };
    let sky = above(&|towards| daylight.radiance(towards, to_sun));
    let disc = above(&|towards| SUN_COLOUR * f64::from(towards.angle_between(to_sun) < SUN_RADIUS));
    let sun = SUN_SHARE * level(&sky).y / level(&disc).y;
    let both: Vec<DVec3> = sky.iter().zip(&disc).map(|(sky, disc)| *sky + *disc * sun).collect();
    let total = level(&both);
    let radiance = |texel: usize| if direction(texel).y > 0.0 { both[texel] } else { ground * total };
    let texels: Vec<Vec3> = (0..both.len()).map(|texel| (radiance(texel) / total.y).as_vec3()).collect();
    Environment::new(Path::new("sky"), WIDTH, HEIGHT, texels).expect("finite radiance")
}

/// Irradiance of level ground from texels above the horizon, divided by pi.
fn level(texels: &[DVec3]) -> DVec3 {
    let edge = |row: usize| (PI * row as f64 / HEIGHT as f64).cos();
    let solid_angle = |row: usize| 2.0 * PI / WIDTH as f64 * (edge(row) - edge(row + 1));
    let light = |texel: usize| texels[texel] * direction(texel).y.max(0.0) * solid_angle(texel / WIDTH);
    (0..texels.len()).map(light).sum::<DVec3>() / PI
}

/// The sun's colour through the air.
const SUN_COLOUR: DVec3 = DVec3::new(1.0, 0.95, 0.85);

/// The direction in which [`Environment`] shows the middle of a texel.
fn direction(texel: usize) -> DVec3 {
    let middle = |index: usize, count: usize| (index as f64 + 0.5) / count as f64;
    let (aside, up) = (PI * middle(texel / WIDTH, HEIGHT)).sin_cos();
    let (sin, cos) = (2.0 * PI * middle(texel % WIDTH, WIDTH)).sin_cos();
    DVec3::new(sin * aside, up, -cos * aside)
}

/// The model for one state of the air and height of the sun.
struct Daylight {
    /// Perez coefficients A to E of luminance, x and y.
    perez: [[f64; 5]; 3],
    /// Luminance, x and y at the zenith, over what the distribution is there.
    scale: [f64; 3],
}

impl Daylight {
    fn new(turbidity: f64, sun: f64) -> Self {
        let t = turbidity;
        let perez = [
            [
                0.1787 * t - 1.4630,
                -0.3554 * t + 0.4275,
                -0.0227 * t + 5.3251,
                0.1206 * t - 2.5771,
                -0.0670 * t + 0.3703,
            ],
            [
                -0.0193 * t - 0.2592,
                -0.0665 * t + 0.0008,
                -0.0004 * t + 0.2125,
                -0.0641 * t - 0.8989,
                -0.0033 * t + 0.0452,
            ],
            [
                -0.0167 * t - 0.2608,
                -0.0950 * t + 0.0092,
                -0.0079 * t + 0.2102,
                -0.0441 * t - 1.6537,
                -0.0109 * t + 0.0529,
            ],
        ];
        let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * sun);
        let luminance = (4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192;
        let chromaticity = |rows: [[f64; 4]; 3]| {
            let cubic = |row: [f64; 4]| ((row[0] * sun + row[1]) * sun + row[2]) * sun + row[3];
            t * t * cubic(rows[0]) + t * cubic(rows[1]) + cubic(rows[2])
        };
        let x = chromaticity([
            [0.00166, -0.00375, 0.00209, 0.0],
            [-0.02903, 0.06377, -0.03202, 0.00394],
            [0.11693, -0.21196, 0.06052, 0.25886],
        ]);
        let y = chromaticity([
            [0.00275, -0.00610, 0.00317, 0.0],
            [-0.04214, 0.08970, -0.04153, 0.00516],
            [0.15346, -0.26756, 0.06670, 0.26688],
        ]);
        let zenith = [luminance, x, y];
        let scale = [0, 1, 2].map(|i| zenith[i] / distribution(perez[i], 1.0, sun));
        Self { perez, scale }
    }

    /// Linear sRGB from a unit direction above the horizon.
    fn radiance(&self, towards: DVec3, to_sun: DVec3) -> DVec3 {
        let (height, angle) = (towards.y.max(0.01), towards.angle_between(to_sun));
        let [luminance, x, y] = [0, 1, 2].map(|i| self.scale[i] * distribution(self.perez[i], height, angle));
        let xyz = DVec3::new(x / y, 1.0, (1.0 - x - y) / y) * luminance;
        // IEC 61966-2-1.
        let to_srgb = DMat3::from_cols(
            DVec3::new(3.2406, -0.9689, 0.0557),
            DVec3::new(-1.5372, 1.8758, -0.2040),
            DVec3::new(-0.4986, 0.0415, 1.0570),
        );
        (to_srgb * xyz).max(DVec3::ZERO)
    }
}

/// Perez' distribution for the cosine to the zenith and the angle to the sun.
fn distribution([a, b, c, d, e]: [f64; 5], height: f64, angle: f64) -> f64 {
    (1.0 + a * (b / height).exp()) * (1.0 + c * (d * angle).exp() + e * angle.cos().powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Irradiance of level ground, divided by pi, from the environment as it is looked up, at sixteen points
    /// a texel, since a few hundred random directions meet the sun too rarely.
    fn level(environment: &Environment) -> Vec3 {
        const ROWS: usize = 2 * HEIGHT;
        const COLUMNS: usize = 4 * WIDTH;
        let point = |i: usize| {
            let (row, column) = (i / COLUMNS, i % COLUMNS);
            let (aside, up) = (FRAC_PI_2 * (row as f64 + 0.5) / ROWS as f64).sin_cos();
            let (sin, cos) = (2.0 * PI * (column as f64 + 0.5) / COLUMNS as f64).sin_cos();
            let towards = DVec3::new(sin * aside, up, -cos * aside);
            let solid_angle = FRAC_PI_2 / ROWS as f64 * 2.0 * PI / COLUMNS as f64 * aside;
            environment.radiance(towards.as_vec3()).as_dvec3() * (up * solid_angle / PI)
        };
        (0..ROWS * COLUMNS).map(point).sum::<DVec3>().as_vec3()
    }

    #[test]
    fn level_ground_gets_the_light_that_is_stated() {
        for seed in 0..4 {
            let light = level(&sky(seed));
            assert!((light.y - 1.0).abs() < 0.03, "{seed}: {light}");
            assert!(light.min_element() > 0.5 && light.max_element() < 1.6, "{seed}: {light}");
        }
    }

    #[test]
    fn the_sky_is_blue_opposite_the_sun_and_the_ground_is_darker() {
        let environment = sky(1);
        let texels = environment.texels();
        let brightest = |a: &&Vec3, b: &&Vec3| a.y.total_cmp(&b.y);
        let sun = texels.iter().max_by(brightest).expect("texels");
        let dimmest = texels[..256 * 60].iter().min_by(brightest).expect("texels");
        assert!(sun.y > 50.0 && dimmest.z > dimmest.x, "{sun} {dimmest}");
        assert!(environment.radiance(Vec3::NEG_Y).max_element() < 0.5);
        assert_ne!(sky(1).texels(), sky(2).texels());
    }
}
