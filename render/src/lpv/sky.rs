//! Light of the sky in a grid. All around it are taken to be cells of even light, as bright as the sky is in
//! each direction, which go on sending it. So light of a sky that is the same everywhere is everywhere the
//! same in a grid that nothing is in.

use super::Volume;
use super::lattice::{DISTANCES, SHARES, mean, neighbours};
use super::propagation::Light;
use super::sides::Begun;
use crate::scene::Environment;
use glam::{Vec3, Vec4};
use rayon::prelude::*;
use std::f32::consts::{PI, TAU};

/// Fewest and most rows of directions in which a sky is looked at.
const ROWS: [usize; 2] = [64, 512];

/// Directions of light.
const WAYS: usize = 26;

/// What a cell outside sends to each of its neighbours, W/m² of a cell's face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky(pub [Vec3; WAYS]);

impl Sky {
    /// That of an environment: to each neighbour goes the mean of the radiance of directions that are nearest
    /// to its own, all times what makes the mean over all directions right.
    pub fn new(environment: &Environment) -> Self {
        let rows = environment.size()[1].clamp(ROWS[0], ROWS[1]);
        let of_row = |row: usize| {
            let mut sums = [Vec4::ZERO; WAYS];
            for column in 0..2 * rows {
                let (down, around) = ((row as f32 + 0.5) / rows as f32, (column as f32 + 0.5) / rows as f32);
                let ((aside, up), (sin, cos)) = ((PI * down).sin_cos(), (PI * around).sin_cos());
                let direction = Vec3::new(aside * sin, up, -aside * cos);
                sums[nearest(-direction)] += aside * environment.radiance(direction).extend(1.0);
            }
            sums
        };
        let rows: Vec<[Vec4; WAYS]> = (0..rows).into_par_iter().map(of_row).collect();
        let sums: [Vec4; WAYS] = std::array::from_fn(|way| rows.iter().map(|row| row[way]).sum());
        let means = sums.map(|sum| sum.truncate() / sum.w);
        let shares: Vec<f32> = neighbours().map(|way| SHARES[way.class]).collect();
        let wanted = sums.iter().sum::<Vec4>();
        let is: Vec3 = means.iter().zip(&shares).map(|(mean, share)| *mean * *share).sum();
        let right = wanted.truncate() / wanted.w / is.max(Vec3::splat(f32::MIN_POSITIVE));
        // Of even light, over fluence on the way through a cell.
        let even = 2.0 * TAU / mean(|class| DISTANCES[class]);
        Self(std::array::from_fn(|way| means[way] * right * (shares[way] * even)))
    }

    /// As the passes read it: of 27 offsets, x changing fastest, of which the middle one is none.
    pub fn record(&self) -> [[f32; 4]; WAYS + 1] {
        let (before, after) = self.0.split_at(WAYS / 2);
        let mut all = before.iter().chain([&Vec3::ZERO]).chain(after);
        std::array::from_fn(|_| all.next().map_or([0.0; 4], |sent| sent.extend(0.0).to_array()))
    }
}

/// The neighbour in whose direction a direction is, about.
fn nearest(direction: Vec3) -> usize {
    let along = |way: Vec3| direction.dot(way);
    let all = neighbours().enumerate();
    all.max_by(|(_, a), (_, b)| along(a.direction).total_cmp(&along(b.direction))).map_or(0, |(way, _)| way)
}

impl Begun {
    /// Light that a scene sends by itself, and that of a sky which comes into cells along the border, as much
    /// of it as `passes` from a point towards where it comes from.
    pub fn under(
        volume: &Volume,
        sent: &[Light],
        Sky(sky): &Sky,
        passes: impl Fn(Vec3, Vec3) -> Vec3,
    ) -> Self {
        let mut begun = Self { sources: vec![sent.to_vec()], halfway: vec![Light::default(); sent.len()] };
        let grid = &volume.grid;
        for cell in grid.border() {
            let outside = |offset| grid.index(grid.at(cell) - offset).is_none();
            for (way, neighbour) in neighbours().enumerate().filter(|(_, way)| outside(way.offset)) {
                let gone = volume.scheme.lobes.gone(&neighbour) * (grid.cell * grid.cell);
                let enters_at = grid.middle(grid.at(cell)) - 0.5 * grid.cell * neighbour.offset.as_vec3();
                let sent = sky[way] * passes(enters_at, -neighbour.direction);
                for (colour, flight) in volume.flights[cell].iter().enumerate() {
                    let light = gone * sent[colour];
                    begun.sources[0][cell][colour] += light * flight.enters[neighbour.class];
                    begun.halfway[cell][colour] += light * flight.tracks_in[neighbour.class];
                }
            }
        }
        begun
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lpv::propagation::Field;
    use crate::lpv::studies::alike;
    use crate::lpv::{Flight, Scheme};
    use glam::{IVec3, Vec4Swizzles};

    #[test]
    fn an_even_sky_fills_an_empty_grid_evenly() {
        let radiance = Vec3::new(0.3, 1.0, 2.0);
        let sky = Sky::new(&Environment::uniform(radiance));
        for scheme in [Scheme::OURS, Scheme::PAPER] {
            let volume = alike(scheme, IVec3::new(7, 5, 6), Flight::by(scheme.factors, 0.0, 0.0));
            let none = vec![Light::default(); volume.grid.cells()];
            let mut field = Field::steady(scheme, Begun::under(&volume, &none, &sky, |_, _| Vec3::ONE));
            field.iterate(&volume, 40);
            for light in field.shown.by_medium.iter() {
                for colour in 0..3 {
                    let ratio = light[colour].w / (4.0 * PI * radiance[colour]);
                    assert!((ratio - 1.0).abs() < 2e-3, "{scheme:?}: {ratio}");
                    assert!(light[colour].xyz().length() < 2e-3 * light[colour].w, "{}", light[colour]);
                }
            }
        }
    }

    #[test]
    fn light_comes_from_where_the_sky_is_bright() {
        // Only what is above the horizon shines.
        let texels = [Vec3::ONE, Vec3::ZERO].map(|texel| [texel; 64]);
        let texels: Vec<Vec3> = (0..32).flat_map(|row| texels[row / 16]).collect();
        let sky = Sky::new(&Environment::new("half".as_ref(), 64, 32, texels).expect("a sky"));
        let even = Sky::new(&Environment::uniform(Vec3::ONE));
        let sum = |sky: &Sky, is: fn(f32) -> bool| -> f32 {
            let ways = neighbours().zip(sky.0).filter(|(way, _)| is(way.direction.y));
            ways.map(|(_, sent)| sent.x).sum()
        };
        let half = sum(&sky, |_| true) / sum(&even, |_| true);
        assert!((half - 0.5).abs() < 0.01, "{half}");
        let [up, down] =
            [sum(&sky, |y| y > 0.1), sum(&sky, |y| y < -0.1)].map(|part| part / sum(&sky, |_| true));
        assert!(up < 1e-3 && down > 0.6, "{up} {down}");
        let record = sky.record();
        assert!(record[13] == [0.0; 4] && record[26][0] == sky.0[25].x && record[12][1] == sky.0[12].y);
    }
}
