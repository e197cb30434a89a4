//! Light through a surface that is no metal: straight through a smooth pane, spread by a rough one, and
//! refracted by a body (Walter, Marschner, Li and Torrance, "Microfacet Models for Refraction through Rough
//! Surfaces", 2007).
//!
//! A rough surface loses what its microfacets hide from each other. A body loses it all: of even light that
//! comes out to who sees it from above 1 % at roughness 0.3, 14 % at 0.6, 58 % at 1. What passes a pane is
//! divided by what its lobe leaves of even light, seen from the viewer or the light, whichever is more, so
//! that it passes as much one way as the other: 1 % is lost at roughness 0.3.
//!
//! A path carries radiance over the squared index of refraction, which bending does not change (Veach 1997,
//! 5.2). So a body in even light is invisible but for what it absorbs, and what shines within it shines as
//! outside.
//!
//! Directions are in the frame of the shading normal, which is z and on the viewer's side.

use super::albedo::directional_shares;
use super::{Fresnel, Ggx};
use crate::intersection::SurfacePoint;
use crate::scene::transmission::{Passage, Walls};
use glam::Vec3;

/// Smaller indices of refraction bend as this one does: to less, half vectors in f32 have no direction.
const LEAST_IOR: f32 = 1.01;

/// What passes a point of a surface.
#[derive(Clone, Copy, Debug)]
pub struct Passing {
    /// Share that passes of the light that is not reflected.
    tint: Vec3,
    way: Way,
    /// What a metre of what is behind takes; `None` where that is what is before.
    beyond: Option<Vec3>,
}

/// How light goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    /// As it came.
    Straight,
    /// Spread as the mirrored lobe of this roughness would be.
    Spread(f32),
    /// Bent; the index of refraction behind, over that before.
    Bent(f32),
}

impl Passing {
    /// What passes a point with some microfacets, and Fresnel's share from the viewer's side.
    pub fn new(point: &SurfacePoint, passage: Passage, ggx: &Ggx, fresnel: Fresnel) -> (Self, Fresnel) {
        let tint = point.surface.diffuse * passage.share;
        let (way, beyond, fresnel) = match passage.walls {
            Walls::Thin if ggx.is_smooth() => (Way::Straight, None, fresnel),
            Walls::Thin => (Way::Spread(point.surface.roughness), None, fresnel),
            Walls::Solid { absorption } => {
                let ior = passage.ior.max(LEAST_IOR);
                if point.is_front {
                    (Way::Bent(ior), Some(absorption), fresnel)
                } else {
                    (Way::Bent(1.0 / ior), Some(Vec3::ZERO), fresnel.out_of(ior))
                }
            }
        };
        (Self { tint, way, beyond }, fresnel)
    }

    /// What a metre of what is behind takes; `None` where that is what is before.
    pub const fn beyond(&self) -> Option<Vec3> {
        self.beyond
    }

    /// Whether light goes on as it came.
    pub fn is_straight(&self) -> bool {
        self.way == Way::Straight
    }

    /// Share that passes, at an angle to the microfacets by its cosine.
    pub fn share(&self, fresnel: &Fresnel, cosine: f32) -> Vec3 {
        self.tint * fresnel.let_through(cosine)
    }

    /// Probability with which a ray that meets a microfacet at an angle, by its cosine, passes and is not
    /// reflected.
    pub fn probability(&self, fresnel: &Fresnel, cosine: f32) -> f32 {
        let (passed, reflected) =
            (self.share(fresnel, cosine).element_sum(), fresnel.reflected(cosine).element_sum());
        if passed > 0.0 { passed / (passed + reflected) } else { 0.0 }
    }

    /// Where light comes from that a microfacet sends to the viewer from below.
    pub fn through(&self, viewer: Vec3, facet: Vec3) -> Vec3 {
        let cosine = viewer.dot(facet);
        match self.way {
            Way::Straight => -viewer,
            Way::Spread(_) => below(facet * (2.0 * cosine) - viewer),
            Way::Bent(ratio) => {
                let squared = 1.0 - (1.0 - cosine * cosine) / (ratio * ratio);
                facet * (cosine / ratio - squared.max(0.0).sqrt()) - viewer / ratio
            }
        }
    }

    /// What passes from a direction below to a viewer per steradian, times the cosine.
    pub fn evaluate(&self, ggx: &Ggx, fresnel: &Fresnel, viewer: Vec3, light: Vec3) -> Vec3 {
        let spread = match self.way {
            Way::Straight => return Vec3::ZERO,
            Way::Spread(roughness) => {
                let [seen, lit] = [viewer.z, -light.z].map(|cosine| directional_shares(roughness, cosine)[0]);
                ggx.reflectance(viewer, below(light)) * -light.z / seen.max(lit)
            }
            Way::Bent(ratio) => ggx.refracted(viewer, light, ratio),
        };
        self.share(fresnel, self.cosine(viewer, light)) * spread
    }

    /// Density of [`Passing::through`] a facet that is seen, per steradian, times the probability of passing.
    pub fn density(&self, ggx: &Ggx, fresnel: &Fresnel, viewer: Vec3, light: Vec3) -> f32 {
        let density = match self.way {
            Way::Straight => return 0.0,
            Way::Spread(_) => ggx.density(viewer, below(light)),
            Way::Bent(ratio) => ggx.refracted_density(viewer, light, ratio),
        };
        self.probability(fresnel, self.cosine(viewer, light)) * density
    }

    /// Cosine of the angle at which the viewer meets the microfacets that light from below comes through.
    fn cosine(&self, viewer: Vec3, light: Vec3) -> f32 {
        let sum = match self.way {
            Way::Straight | Way::Spread(_) => viewer + below(light),
            Way::Bent(ratio) => viewer + ratio * light,
        };
        viewer.dot(sum.normalize_or(Vec3::Z)).abs()
    }
}

/// A direction on the other side of the surface.
fn below(direction: Vec3) -> Vec3 {
    Vec3::new(direction.x, direction.y, -direction.z)
}
