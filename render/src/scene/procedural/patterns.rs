//! Pictures for surfaces whose own do not matter: a pool as large as one likes, of patterns whose edges and
//! colours a blur shows. Stands in for the texture pool of the thesis (7.3.1; Cimpoi et al. 2014), which does
//! not come with the project.

use super::materials::{colour, filled};
use super::noise;
use super::random::Random;
use crate::scene::{Encoding, Texture, Wrap};
use glam::{IVec3, Vec2, Vec3};

/// Texels along the edge of a pattern.
const SIZE: usize = 256;

/// A kind of pattern: makes the colour at a point of the unit square.
type Kind = fn(&mut Random) -> Box<dyn Fn(Vec2) -> Vec3>;

/// All kinds.
const KINDS: [Kind; 6] = [checker, stripes, bricks, voronoi, clouds, landscape];

/// The pattern of a seed.
pub fn pattern(seed: u64) -> Texture {
    let mut random = Random::new(PATTERNS, seed);
    let kind = random.pick(&KINDS);
    let shade = kind(&mut random);
    let texels = filled(SIZE, |uv| shade(uv).extend(1.0));
    // Not all kinds end as they begin.
    Texture::new(SIZE, SIZE, texels, Encoding::Srgb, [Wrap::Mirror; 2])
}

/// The stream of random numbers that patterns take; families of scenes have those below.
const PATTERNS: u64 = 1000;

/// A colour as surfaces have them.
fn any_colour(random: &mut Random) -> Vec3 {
    colour(random.unit(), random.within(0.0, 0.9), random.within(0.05, 0.95))
}

fn checker(random: &mut Random) -> Box<dyn Fn(Vec2) -> Vec3> {
    let colours = [any_colour(random), any_colour(random)];
    let fields = random.count(2, 12) as f32;
    let turn = Vec2::from_angle(random.angle());
    Box::new(move |uv| {
        let cell = (turn.rotate(uv) * fields).floor();
        colours[((cell.x + cell.y).rem_euclid(2.0)) as usize]
    })
}

fn stripes(random: &mut Random) -> Box<dyn Fn(Vec2) -> Vec3> {
    let colours = [any_colour(random), any_colour(random), any_colour(random)];
    let (count, waves, seed) = (random.within(2.0, 16.0), random.within(0.0, 1.5), random.bits());
    let across = Vec2::from_angle(random.angle());
    Box::new(move |uv| {
        let bent = uv.dot(across) * count + waves * noise::fbm(seed, (uv * 3.0).extend(0.5), 3);
        colours[(bent.rem_euclid(1.0) * 3.0) as usize % 3]
    })
}

fn bricks(random: &mut Random) -> Box<dyn Fn(Vec2) -> Vec3> {
    let (stone, mortar) = (any_colour(random), any_colour(random));
    let (columns, rows) = (random.count(2, 6) as f32, random.count(4, 14) as f32);
    let (contrast, joint, seed) = (random.within(0.1, 0.6), random.within(0.02, 0.1), random.bits());
    Box::new(move |uv| {
        let row = (uv.y * rows).floor();
        let along = uv.x * columns + 0.5 * row.rem_euclid(2.0);
        let inside = Vec2::new(along.fract(), (uv.y * rows).fract());
        if inside.min(Vec2::ONE - inside).min_element() < joint {
            return mortar;
        }
        let own = noise::of_cell(seed, IVec3::new(along as i32, row as i32, 0));
        stone * (1.0 - contrast * own) * (1.0 + 0.2 * noise::fbm(seed, (uv * 30.0).extend(0.5), 3))
    })
}

/// Cells around random points (Worley 1996), each in its own colour.
fn voronoi(random: &mut Random) -> Box<dyn Fn(Vec2) -> Vec3> {
    let (cells, seed, edge) = (random.within(3.0, 14.0), random.bits(), random.within(0.0, 0.15));
    let (hue, spread, dark) = (random.unit(), random.within(0.05, 0.5), any_colour(random) * 0.3);
    Box::new(move |uv| {
        let at = uv * cells;
        let mut nearest = [(f32::INFINITY, IVec3::ZERO); 2];
        for (x, y) in (-1..=1).flat_map(|y| (-1..=1).map(move |x| (x, y))) {
            let cell = IVec3::new(at.x.floor() as i32 + x, at.y.floor() as i32 + y, 0);
            let offset = Vec2::new(noise::of_cell(seed, cell), noise::of_cell(seed ^ 1, cell));
            let distance = at.distance(cell.truncate().as_vec2() + offset);
            if distance < nearest[0].0 {
                nearest = [(distance, cell), nearest[0]];
            } else if distance < nearest[1].0 {
                nearest[1] = (distance, cell);
            }
        }
        if nearest[1].0 - nearest[0].0 < edge {
            return dark;
        }
        let own = |salt: u32| noise::of_cell(seed ^ salt, nearest[0].1);
        colour(hue + spread * own(2), 0.2 + 0.6 * own(3), 0.15 + 0.8 * own(4))
    })
}

fn clouds(random: &mut Random) -> Box<dyn Fn(Vec2) -> Vec3> {
    let colours = [any_colour(random), any_colour(random)];
    let (scale, octaves, seed) = (random.within(2.0, 12.0), random.count(1, 6) as u32, random.bits());
    let steepness = random.within(0.8, 4.0);
    Box::new(move |uv| {
        let value = 0.5 + steepness * noise::fbm(seed, (uv * scale).extend(0.5), octaves);
        colours[0].lerp(colours[1], value.clamp(0.0, 1.0))
    })
}

/// Colours and fine detail as photographs of rock, bark and leaves have them: three fractal noises of which
/// one bends the others, in a spectrum that falls like theirs.
fn landscape(random: &mut Random) -> Box<dyn Fn(Vec2) -> Vec3> {
    let palette = [any_colour(random), any_colour(random), any_colour(random), any_colour(random)];
    let (scale, bend, seed) = (random.within(2.0, 6.0), random.within(0.2, 1.5), random.bits());
    Box::new(move |uv| {
        let at = (uv * scale).extend(0.5);
        let warp = Vec3::new(noise::fbm(seed, at, 4), noise::fbm(seed ^ 2, at, 4), 0.0) * bend;
        let base = 0.5 + 1.2 * noise::fbm(seed ^ 3, at + warp, 7);
        let shade = 1.0 + 0.5 * noise::ridged(seed ^ 4, at * 2.0 + warp, 7);
        let place = base.clamp(0.0, 0.999) * 3.0;
        let step = place as usize;
        palette[step].lerp(palette[step + 1], place.fract()) * shade
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_of_every_kind_differ_and_have_contrast() {
        let mut random = Random::new(0, 1);
        for (index, kind) in KINDS.iter().enumerate() {
            let shade = kind(&mut random);
            let values: Vec<Vec3> = (0..1024)
                .map(|i| shade((Vec2::new((i % 32) as f32, (i / 32) as f32) + 0.5) / 32.0))
                .collect();
            assert!(
                values.iter().all(|value| value.is_finite() && value.min_element() >= 0.0),
                "kind {index}"
            );
            let mean = values.iter().sum::<Vec3>() / 1024.0;
            let variance = values.iter().map(|value| (*value - mean).length_squared()).sum::<f32>() / 1024.0;
            assert!(variance > 1e-4, "kind {index}: {variance}");
        }
    }

    #[test]
    fn a_seed_gives_one_pattern() {
        assert_eq!(pattern(3).texels(), pattern(3).texels());
        assert_ne!(pattern(3).texels(), pattern(4).texels());
        assert_eq!(pattern(3).size(), [SIZE, SIZE]);
    }
}
