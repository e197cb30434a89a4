//! Microfacets with the GGX distribution (Walter et al. 2007), and their visible normals.
//!
//! Directions are in the frame of the shading normal, which is z, and point away from the surface.

use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};

/// Narrower lobes are below what directions in f32 resolve: it takes 10,000 roundings to cross this one.
const NARROWEST_ALPHA: f32 = 1e-3;

/// The microfacets of a rough surface. A lobe is of all the light that it gets; how much that is says
/// Fresnel.
#[derive(Clone, Copy, Debug)]
pub struct Ggx {
    /// Slope of the microfacets.
    alpha: f32,
}

impl Ggx {
    /// Microfacets of a perceptual roughness, whose square is alpha (glTF 2.0, appendix B); at least 0.001.
    pub fn new(roughness: f32) -> Self {
        Self { alpha: (roughness * roughness).max(NARROWEST_ALPHA) }
    }

    /// These with so much added to alpha squared, which is 1 at most.
    #[must_use]
    pub fn widened(self, by: f32) -> Self {
        Self { alpha: self.alpha.mul_add(self.alpha, by).sqrt().min(1.0) }
    }

    /// What comes from one direction per steradian of another, without the cosine and Fresnel's share.
    pub fn reflectance(&self, viewer: Vec3, light: Vec3) -> f32 {
        let half = (viewer + light).normalize_or(Vec3::Z);
        // Smith's masking and shadowing, which go together with the height (Heitz 2014, equation 99).
        let both = 1.0 / (1.0 + self.hidden(viewer) + self.hidden(light));
        self.facets(half) * both / (4.0 * viewer.z * light.z)
    }

    /// A direction to the light: mirrored by a microfacet that the viewer sees (Heitz 2018; drawn as Dupuy
    /// and Benyoub 2023 do, from a spherical cap). May be below the surface.
    pub fn sample(&self, viewer: Vec3, square: Vec2) -> Vec3 {
        let facet = self.facet(viewer, square);
        facet * (2.0 * viewer.dot(facet)) - viewer
    }

    /// The normal of a microfacet that the viewer sees.
    pub fn facet(&self, viewer: Vec3, square: Vec2) -> Vec3 {
        let stretched = Vec3::new(self.alpha * viewer.x, self.alpha * viewer.y, viewer.z).normalize();
        let z = (1.0 - square.y) * (1.0 + stretched.z) - stretched.z;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = (TAU * square.x).sin_cos();
        let cap = Vec3::new(radius * cos, radius * sin, z) + stretched;
        Vec3::new(self.alpha * cap.x, self.alpha * cap.y, cap.z).normalize_or(Vec3::Z)
    }

    /// Density of [`Ggx::sample`], per steradian.
    pub fn density(&self, viewer: Vec3, light: Vec3) -> f32 {
        let half = (viewer + light).normalize_or(Vec3::Z);
        let visible = 1.0 / (1.0 + self.hidden(viewer));
        self.facets(half) * visible / (4.0 * viewer.z)
    }

    /// What comes refracted from a direction below per steradian of another, times its cosine, without
    /// Fresnel's share: of radiance over the squared index of refraction (Walter et al. 2007, equation 21).
    /// `ratio` is the light's index over the viewer's.
    pub fn refracted(&self, viewer: Vec3, light: Vec3, ratio: f32) -> f32 {
        let both = 1.0 / (1.0 + self.hidden(viewer) + self.hidden(light));
        self.refracting(viewer, light, ratio) * both
    }

    /// Density of directions refracted by [`Ggx::facet`]s, per steradian.
    pub fn refracted_density(&self, viewer: Vec3, light: Vec3, ratio: f32) -> f32 {
        self.refracting(viewer, light, ratio) / (1.0 + self.hidden(viewer))
    }

    /// What both have in common: the microfacets that bend one direction to the other, seen by the viewer, by
    /// how far their normals spread (equations 16 and 17).
    fn refracting(&self, viewer: Vec3, light: Vec3, ratio: f32) -> f32 {
        let sum = viewer + ratio * light;
        let half = sum.normalize_or(Vec3::Z);
        let half = if half.z < 0.0 { -half } else { half };
        let (to_viewer, to_light) = (viewer.dot(half), -light.dot(half));
        if to_viewer <= 0.0 || to_light <= 0.0 {
            return 0.0;
        }
        let spread = ratio * ratio * to_light / sum.length_squared();
        self.facets(half) * spread * to_viewer / viewer.z
    }

    /// Whether its lobe is the narrowest that there is.
    pub fn is_smooth(&self) -> bool {
        self.alpha <= NARROWEST_ALPHA
    }

    /// Area of the microfacets with a normal, per area and steradian. By the tangent, which keeps its digits
    /// where the cosine is nearly 1.
    fn facets(&self, normal: Vec3) -> f32 {
        let slope = Vec2::new(normal.x, normal.y).length_squared() / (self.alpha * self.alpha);
        let all = slope + normal.z * normal.z;
        FRAC_1_PI / (self.alpha * self.alpha * all * all)
    }

    /// Smith's lambda: microfacets that are hidden from a direction, over those that are not.
    fn hidden(&self, direction: Vec3) -> f32 {
        let tangent = Vec2::new(direction.x, direction.y).length_squared() / (direction.z * direction.z);
        0.5 * ((1.0 + self.alpha * self.alpha * tangent).sqrt() - 1.0)
    }
}
