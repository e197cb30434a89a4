//! What a surface reflects of light that comes from everywhere alike, as a share: to everywhere, its
//! hemispherical albedo (pbrt's `rho_hh`), and to one viewer, its directional one (`rho_hd`).

use super::{Fresnel, Ggx, Phong, mirrored};
use crate::scene::{Gloss, Surface};
use glam::{Vec2, Vec3};
use std::sync::LazyLock;

/// Roughnesses of which shares are known, from 0 to 1; between them they are linear.
const ROUGHNESSES: usize = 17;
/// Directions of viewers, whose azimuth does not matter.
const VIEWERS: usize = 64;
/// Directions of light for each, along an edge of their square.
const DIRECTIONS: usize = 12;

/// What a lobe reflects at a roughness.
#[derive(Clone, Copy, Debug, Default)]
struct Shares {
    /// Of microfacets that reflect all.
    microfacets: f32,
    /// Of those that reflect `(1 - cos)^5`.
    grazing: f32,
    /// Of Phong's lobe.
    phong: f32,
}

/// Cosines of viewers from 0 to 1 of which shares are known, as many as [`ROUGHNESSES`].
const COSINES: usize = 17;

/// The share of even light that microfacets over a base reflect to a viewer, of each colour, by the cosine to
/// the normal.
pub fn directional_albedo(diffuse: Vec3, specular: Vec3, roughness: f32, cosine: f32) -> Vec3 {
    let fresnel = Fresnel::new(specular);
    let [all, grazing] = directional_shares(roughness, cosine);
    diffuse * fresnel.let_through(cosine) + fresnel.mean_of(all, grazing)
}

/// What microfacets reflect of even light that reflect all, and that reflect `(1 - cos)^5`: `[COSINES,
/// ROUGHNESSES]`.
pub fn directional_table() -> &'static [[f32; 2]] {
    static TABLE: LazyLock<Vec<[f32; 2]>> = LazyLock::new(|| {
        let part = |i: usize| i as f32 / (COSINES - 1) as f32;
        let of = |i: usize| {
            // Along the surface nothing is seen.
            let cosine = part(i / ROUGHNESSES).max(0.02);
            to_viewer(&Ggx::new(part(i % ROUGHNESSES)), viewer(cosine * cosine))
        };
        (0..COSINES * ROUGHNESSES).map(of).collect()
    });
    &TABLE
}

/// The table's values between its places.
pub(super) fn directional_shares(roughness: f32, cosine: f32) -> [f32; 2] {
    let table = directional_table();
    let [(low, right), (row, up)] = [roughness, cosine].map(|value| {
        let at = value.clamp(0.0, 1.0) * (COSINES - 1) as f32;
        let low = (at as usize).min(COSINES - 2);
        (low, at - low as f32)
    });
    [0, 1].map(|share| {
        let of_row = |row: usize| {
            let at = row * ROUGHNESSES + low;
            (1.0 - right) * table[at][share] + right * table[at + 1][share]
        };
        (1.0 - up) * of_row(row) + up * of_row(row + 1)
    })
}

/// What microfacets reflect to a viewer of even light: those that reflect all, and those that reflect
/// `(1 - cos)^5`.
fn to_viewer(ggx: &Ggx, viewer: Vec3) -> [f32; 2] {
    let mut sum = [0.0; 2];
    for light in squares().map(|square| ggx.sample(viewer, square)) {
        let density = ggx.density(viewer, light);
        if light.z > 0.0 && density > 0.0 {
            let weight = ggx.reflectance(viewer, light) * light.z / density;
            let cosine = viewer.dot((viewer + light).normalize_or(Vec3::Z));
            sum[0] += weight;
            sum[1] += weight * (1.0 - cosine).clamp(0.0, 1.0).powi(5);
        }
    }
    sum.map(|sum| sum / (DIRECTIONS * DIRECTIONS) as f32)
}

/// The share of even light that a surface reflects, of each colour.
pub fn hemispherical_albedo(surface: &Surface) -> Vec3 {
    let Surface { diffuse, specular, .. } = *surface;
    match surface.gloss {
        Gloss::None => diffuse,
        Gloss::Phong => diffuse + specular * shares(surface.roughness).phong,
        Gloss::Microfacets if specular == Vec3::ZERO => diffuse,
        Gloss::Microfacets => {
            let (fresnel, shares) = (Fresnel::new(specular), shares(surface.roughness));
            diffuse * fresnel.mean_let_through() + fresnel.mean_of(shares.microfacets, shares.grazing)
        }
    }
}

/// The shares at a roughness from 0 to 1.
fn shares(roughness: f32) -> Shares {
    static TABLE: LazyLock<[Shares; ROUGHNESSES]> =
        LazyLock::new(|| std::array::from_fn(|i| of_roughness(i as f32 / (ROUGHNESSES - 1) as f32)));
    let at = roughness.clamp(0.0, 1.0) * (ROUGHNESSES - 1) as f32;
    let low = (at as usize).min(ROUGHNESSES - 2);
    let (part, [low, high]) = (at - low as f32, [TABLE[low], TABLE[low + 1]]);
    let mixed = |low: f32, high: f32| low + part * (high - low);
    Shares {
        microfacets: mixed(low.microfacets, high.microfacets),
        grazing: mixed(low.grazing, high.grazing),
        phong: mixed(low.phong, high.phong),
    }
}

/// Means over viewers by their cosine, of light taken as lobes reflect it.
fn of_roughness(roughness: f32) -> Shares {
    let (ggx, phong) = (Ggx::new(roughness), Phong::new(roughness));
    let mut sum = Shares::default();
    for viewer in (0..VIEWERS).map(|i| viewer((i as f32 + 0.5) / VIEWERS as f32)) {
        let [microfacets, grazing] = to_viewer(&ggx, viewer);
        sum.microfacets += microfacets;
        sum.grazing += grazing;
        for square in squares() {
            let light = phong.sample(viewer, square);
            let along = mirrored(viewer).dot(light);
            if light.z > 0.0 && phong.density(along) > 0.0 {
                sum.phong += phong.reflectance(along) * light.z / phong.density(along);
            }
        }
    }
    let count = VIEWERS as f32;
    let phong = sum.phong / (count * (DIRECTIONS * DIRECTIONS) as f32);
    Shares { microfacets: sum.microfacets / count, grazing: sum.grazing / count, phong }
}

/// A direction whose cosine has this square: of even ones a cosine-weighted share.
fn viewer(squared: f32) -> Vec3 {
    Vec3::new((1.0 - squared).sqrt(), 0.0, squared.sqrt())
}

/// The middles of the parts of a square.
fn squares() -> impl Iterator<Item = Vec2> {
    let at = |i: usize| (i as f32 + 0.5) / DIRECTIONS as f32;
    (0..DIRECTIONS * DIRECTIONS).map(move |i| Vec2::new(at(i % DIRECTIONS), at(i / DIRECTIONS)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::bsdf::Bsdf;
    use crate::sampler::{PixelSampler, Stream, cosine_hemisphere};
    use crate::scene::Material;
    use glam::Vec4;

    /// The mean of what the reflectance sends back to viewers, by its own samples.
    fn sampled(surface: &Surface) -> Vec3 {
        let bsdf = Bsdf::of(surface, Vec3::Z, Vec3::Z);
        let samples = 40_000;
        let mut sum = Vec3::ZERO;
        for sample in 0..samples {
            let mut stream = Stream::new(PixelSampler::new(0, 0, 3), sample);
            let square = stream.next_2d();
            let viewer = cosine_hemisphere(square.x, square.y);
            sum += bsdf.sample(viewer, &mut stream).map_or(Vec3::ZERO, |sample| sample.weight);
        }
        sum / samples as f32
    }

    #[test]
    fn it_is_what_the_reflectance_reflects() {
        for (metallic, roughness, gloss) in [
            (0.0, 1.0, Gloss::Microfacets),
            (0.0, 0.3, Gloss::Microfacets),
            (1.0, 0.6, Gloss::Microfacets),
            (0.5, 0.85, Gloss::Microfacets),
            (0.0, 0.5, Gloss::Phong),
            (0.0, 1.0, Gloss::None),
        ] {
            let base_colour = Vec4::new(0.9, 0.5, 0.1, 1.0);
            let material = Material { base_colour, metallic, roughness, gloss, ..Material::default() };
            let surface = material.surface(&[], [Vec2::ZERO; 2], Vec4::ONE);
            let (is, wanted) = (hemispherical_albedo(&surface), sampled(&surface));
            assert!((is - wanted).abs().max_element() < 0.01, "{material:?}: {is} for {wanted}");
        }
    }

    #[test]
    fn rough_white_reflects_less_than_it_receives() {
        let surface = Material::default().surface(&[], [Vec2::ZERO; 2], Vec4::ONE);
        let albedo = hemispherical_albedo(&surface).x;
        assert!((0.92..0.94).contains(&albedo), "{albedo}");
    }
}
