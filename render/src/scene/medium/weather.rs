//! Smoke, clouds and fog banks made of noise, which drift with the wind and change as they go.
//!
//! All are a threshold over a sum of octaves of noise, with a shape of their own: smoke thins out towards all
//! faces of its box, clouds have flat bases and heaped tops and are frayed by finer noise, a bank of fog lies
//! on the floor of its box and is thinner the higher up. Change comes from octaves that drift against one
//! another, each by its own features: nothing pops, and it looks alike at all times.

use super::{DensityGrid, MediumError};
use crate::scene::Bounds;
use crate::scene::procedural::noise::{drifting_fbm, fbm};
use glam::Vec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Octaves of the noise.
const OCTAVES: u32 = 4;

/// Noise reaches about so far from its mean, 0.
const REACH: f32 = 0.5;

/// Part of the way from the middle to a face after which a medium begins to thin out.
const THINS_FROM: f32 = 0.7;

/// Smallest billows, in parts of the largest coordinate: the noise counts them with 32-bit numbers.
const FINEST: f32 = 1e-6;

/// Most billows that the wind may have moved by, for the same reason.
const FARTHEST: f32 = 1e6;

/// How much of a cloud's edge finer noise takes away, and how much finer it is.
const FRAYED: f32 = 0.35;
const FINER: f32 = 5.0;

/// By how many times fog is flatter than it is wide.
const FLATTER: f32 = 3.0;

/// Height of a cloud, as a share of its box, where its base ends, and where its top begins to thin out.
const BASE: f32 = 0.12;
const TOP: f32 = 0.35;

/// What noise is to look like.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WeatherKind {
    /// Billows all over a box.
    Smoke,
    /// Heaps with flat bases.
    Clouds,
    /// A layer on the floor.
    FogBank,
}

/// How a medium made of noise looks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weather {
    /// What it is like.
    pub kind: WeatherKind,
    /// The same seed makes the same medium.
    pub seed: u32,
    /// Size of the largest billows, metres.
    pub billow: f32,
    /// From 0 for none to 1 for hardly a hole, about: the share of the box that smoke is in, of the sky that
    /// clouds cover, of the height that fog reaches.
    pub cover: f32,
    /// Where to and how fast it drifts, metres a second.
    #[serde(default)]
    pub wind: Vec3,
    /// How fast it changes: by how many of its features each octave drifts in a second.
    #[serde(default)]
    pub churn: f32,
}

impl Weather {
    /// Smoke that stands still.
    pub const fn smoke(seed: u32, billow: f32, cover: f32) -> Self {
        Self { kind: WeatherKind::Smoke, seed, billow, cover, wind: Vec3::ZERO, churn: 0.0 }
    }

    /// What is in a box at a time, seconds, with about `cells` cubic cells along its longest edge; densities
    /// from 0 to 1.
    ///
    /// # Errors
    /// If a number is not finite, the cover not from 0 to 1, billows are less than a millionth of the box's
    /// distance from the origin, wind or churn have gone farther than a million billows, or as
    /// [`DensityGrid::new`].
    pub fn grid(self, bounds: Bounds, cells: usize, time: f32) -> Result<DensityGrid, MediumError> {
        super::check_box(bounds)?;
        let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
        let drifted = (self.wind * time / self.billow).extend(self.churn * time);
        let near = drifted.is_finite() && drifted.abs().max_element() <= FARTHEST;
        let fine = self.billow.is_finite() && self.billow >= FINEST * farthest && self.billow > 0.0;
        if !(near && fine && (0.0..=1.0).contains(&self.cover)) {
            return Err(MediumError::Weather { weather: self, time });
        }
        let edge = bounds.size().max_element() / cells.max(1) as f32;
        let size = bounds.size().to_array().map(|length| ((length / edge).round() as usize).max(1));
        let count = DensityGrid::cells(size)?;
        let step = bounds.size() / Vec3::from(size.map(|cells| cells as f32));
        let middle = |index: usize| {
            let cell = [index % size[0], index / size[0] % size[1], index / (size[0] * size[1])];
            bounds.min + (Vec3::from(cell.map(|cell| cell as f32)) + 0.5) * step
        };
        let value = |index| self.density(middle(index), bounds, time);
        DensityGrid::new(bounds, size, (0..count).into_par_iter().map(value).collect())
    }

    /// Density at a point of a box.
    fn density(self, point: Vec3, bounds: Bounds, time: f32) -> f32 {
        let aside = (2.0 * (point - bounds.centre()) / bounds.size()).abs();
        let at = (point - self.wind * time) / self.billow;
        match self.kind {
            WeatherKind::Smoke => self.body(at, time) * thinned(aside.max_element()),
            WeatherKind::Clouds => {
                self.cloud(at, height(point, bounds), time) * thinned(aside.x.max(aside.z))
            }
            WeatherKind::FogBank => {
                self.bank(at, height(point, bounds), time) * thinned(aside.x.max(aside.z))
            }
        }
    }

    /// Noise from about -1 to 1.
    fn noise(self, at: Vec3, time: f32) -> f32 {
        drifting_fbm(self.seed, at, OCTAVES, self.churn * time) / REACH
    }

    /// What is left of the noise where as much is covered as is wanted.
    fn body(self, at: Vec3, time: f32) -> f32 {
        (0.5 * (self.noise(at, time) - 1.0) + self.cover).clamp(0.0, 1.0)
    }

    /// A cloud at a share of the box's height.
    fn cloud(self, at: Vec3, height: f32, time: f32) -> f32 {
        let heaped = smooth(height / BASE) * (1.0 - smooth((height - TOP) / (1.0 - TOP)));
        let body = (self.body(at, time) - (1.0 - heaped)).max(0.0) * 2.0;
        let fine = (0.5 + 0.5 * fbm(self.seed.wrapping_add(1), FINER * at, OCTAVES) / REACH).max(0.0);
        ((body - FRAYED * fine) / (1.0 - FRAYED)).clamp(0.0, 1.0)
    }

    /// A bank of fog at a share of the box's height.
    fn bank(self, at: Vec3, height: f32, time: f32) -> f32 {
        let noise = self.noise(at * Vec3::new(1.0, FLATTER, 1.0), time);
        let top = self.cover * (1.0 + 0.5 * noise);
        let below = smooth(2.0 * (1.0 - height / top.max(1e-6)));
        below * (0.75 + 0.25 * noise).clamp(0.0, 1.0)
    }
}

/// The share of a box's height that a point is at.
fn height(point: Vec3, bounds: Bounds) -> f32 {
    (point.y - bounds.min.y) / bounds.size().y
}

/// What is left where the middle is so far away, 1 being a face.
fn thinned(aside: f32) -> f32 {
    smooth((1.0 - aside) / (1.0 - THINS_FROM))
}

/// From 0 to 1 without a kink.
fn smooth(share: f32) -> f32 {
    let share = share.clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Bounds = Bounds { min: Vec3::new(-2.0, 0.0, -1.0), max: Vec3::new(2.0, 2.0, 1.0) };
    const SMOKE: Weather = Weather::smoke(3, 0.7, 0.5);
    const KINDS: [WeatherKind; 3] = [WeatherKind::Smoke, WeatherKind::Clouds, WeatherKind::FogBank];

    fn grid(weather: Weather, time: f32) -> DensityGrid {
        weather.grid(BOX, 32, time).expect("a medium")
    }

    #[test]
    fn a_seed_makes_the_same_medium_and_another_seed_another() {
        for kind in KINDS {
            let weather = Weather { kind, ..SMOKE };
            assert_eq!(grid(weather, 0.0), grid(weather, 0.0));
            assert_ne!(grid(weather, 0.0), grid(Weather { seed: 4, ..weather }, 0.0));
            assert_eq!(grid(weather, 0.0), grid(weather, 5.0), "still, without wind and churn");
        }
        assert_eq!(grid(SMOKE, 0.0).size(), [32, 16, 16]);
    }

    /// The share of cells for which something holds, by densities and heights.
    fn share(grid: &DensityGrid, holds: impl Fn(f32, usize) -> bool) -> f32 {
        let [x, y, _] = grid.size();
        let held = grid.values().iter().enumerate().filter(|(index, value)| holds(**value, index / x % y));
        held.count() as f32 / grid.values().len() as f32
    }

    #[test]
    fn cover_is_about_the_share_that_it_says() {
        for kind in KINDS {
            let covered = |cover| {
                let grid = grid(Weather { kind, cover, ..SMOKE }, 0.0);
                assert!(grid.largest() <= 1.0);
                share(&grid, |value, _| value > 0.0)
            };
            assert!(covered(0.0) < 0.02, "{kind:?}: {}", covered(0.0));
            for cover in [-0.1, 1.1, f32::NAN] {
                let refused = Weather { kind, cover, ..SMOKE }.grid(BOX, 32, 0.0);
                assert!(matches!(refused, Err(MediumError::Weather { .. })), "{cover}");
            }
            let [few, half, all] = [0.3, 0.5, 1.0].map(covered);
            assert!(few < half && half < all, "{kind:?}: {few}, {half}, {all}");
            match kind {
                WeatherKind::Smoke => assert!((half - 0.5).abs() < 0.1 && all > 0.9, "{half}, {all}"),
                WeatherKind::FogBank => assert!((half - 0.5).abs() < 0.1, "{half}"),
                WeatherKind::Clouds => assert!(half > 0.05 && half < 0.5 && all > 0.5, "{half}, {all}"),
            }
        }
    }

    #[test]
    fn clouds_have_bases_and_fog_lies_on_the_floor() {
        let rows = 16;
        let of_row = |grid: &DensityGrid, wanted: usize| {
            rows as f32 * share(grid, |value, row| row == wanted && value > 0.05)
        };
        let clouds = grid(Weather { kind: WeatherKind::Clouds, cover: 0.8, ..SMOKE }, 0.0);
        let [base, heap, top] = [0, 4, 15].map(|row| of_row(&clouds, row));
        assert!(base == 0.0 && heap > 0.2 && top < 0.1 * heap, "{base}, {heap}, {top}");
        let bank = grid(Weather { kind: WeatherKind::FogBank, ..SMOKE }, 0.0);
        let rows: Vec<f32> = (0..rows).map(|row| of_row(&bank, row)).collect();
        assert!(rows.windows(2).all(|two| two[1] <= two[0] + 0.02) && rows[0] > 0.7, "{rows:?}");
        assert_eq!(rows[15], 0.0);
    }

    #[test]
    fn wind_carries_it_and_churn_changes_it_little_by_little() {
        // Where the box does not thin it out.
        let inside = |grid: &DensityGrid, at: Vec3| grid.at(at);
        let still = Weather { billow: 0.8, ..SMOKE };
        let windy = Weather { wind: Vec3::new(0.25, 0.0, 0.0), ..still };
        let churning = Weather { churn: 0.1, ..still };
        let places = (0..200).map(|i| {
            Vec3::new((i % 10) as f32 * 0.1 - 0.5, 0.8 + (i / 10 % 5) as f32 * 0.1, (i / 50) as f32 * 0.1)
        });
        let [before, carried] = [grid(windy, 0.0), grid(windy, 2.0)];
        let [soon, late] = [grid(churning, 0.1), grid(churning, 10.0)];
        let (mut stayed, mut little, mut much) = (0.0f32, 0.0f32, 0.0f32);
        for place in places {
            let moved = inside(&carried, place + Vec3::X * 0.5) - inside(&before, place);
            assert!(moved.abs() < 1e-4, "{place}: {moved}");
            stayed = stayed.max((inside(&carried, place) - inside(&before, place)).abs());
            little = little.max((inside(&soon, place) - inside(&before, place)).abs());
            much = much.max((inside(&late, place) - inside(&before, place)).abs());
        }
        assert!(stayed > 0.1, "the wind is noticed: {stayed}");
        assert!(little > 0.0 && little < 0.03 && much > 0.1, "{little}, {much}");
    }

    #[test]
    fn impossible_weather_is_refused() {
        assert!(matches!(SMOKE.grid(Bounds::EMPTY, 8, 0.0), Err(MediumError::Box(_))));
        assert!(matches!(SMOKE.grid(BOX, 1 << 20, 0.0), Err(MediumError::Size(_))));
        let refused = |weather: Weather, time| {
            assert!(matches!(weather.grid(BOX, 8, time), Err(MediumError::Weather { .. })), "{weather:?}");
        };
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            refused(Weather { billow: bad, ..SMOKE }, 0.0);
        }
        refused(Weather { cover: f32::NAN, ..SMOKE }, 0.0);
        refused(Weather { wind: Vec3::X, ..SMOKE }, 1e8);
        refused(Weather { wind: Vec3::X, ..SMOKE }, f32::NAN);
        refused(Weather { churn: f32::NAN, ..SMOKE }, 1.0);
    }
}
