//! Schlick's approximation of Fresnel's reflectance, and what it lets through to a diffuse base.

use glam::Vec3;

/// The grazing reflectance is 1 for specular colours from here on. No material reflects less than 2 %:
/// smaller values mean that something is in the specular reflection's way, at grazing angles too (Lagarde and
/// de Rousiers, "Moving Frostbite to Physically Based Rendering", 2014, 3.2).
const FULL_GRAZING: f32 = 0.02;

/// The mean over a cosine-weighted hemisphere of `(1 - cos)^5`, which is 1/21, taken a little smaller: then
/// the diffuse base and microfacets, whose reflectance at some angles is up to 0.2 % above that of a flat
/// surface, never give back more than they receive.
const MEAN_OF_FIFTH: f32 = 1.0 / 22.0;

/// Share of light that a surface reflects at an angle.
#[derive(Clone, Copy, Debug)]
pub struct Fresnel {
    /// At normal incidence.
    normal: Vec3,
    /// What is added at grazing incidence.
    added: Vec3,
    /// Over the mean of what is let through.
    inverse_mean: Vec3,
    /// The index of refraction of the body that light comes out of; `None` of light that comes from outside.
    out_of: Option<f32>,
}

impl Fresnel {
    /// Of a surface of a specular colour.
    pub fn new(specular: Vec3) -> Self {
        let grazing = (specular.max_element() / FULL_GRAZING).min(1.0);
        let added = (Vec3::splat(grazing) - specular).max(Vec3::ZERO);
        let let_through = Vec3::ONE - specular - added * MEAN_OF_FIFTH;
        // A white mirror lets nothing through.
        let inverse_mean = let_through.max(Vec3::splat(1e-6)).recip();
        Self { normal: specular, added, inverse_mean, out_of: None }
    }

    /// The same surface, met from within a body of an index of refraction of at least 1.
    #[must_use]
    pub const fn out_of(self, ior: f32) -> Self {
        Self { out_of: Some(ior), ..self }
    }

    /// Share reflected at an angle of incidence, by its cosine. From within, it is that of the angle outside,
    /// to which light is bent, and all where there is none (total reflection): the same both ways.
    pub fn reflected(&self, cosine: f32) -> Vec3 {
        let cosine = match self.out_of {
            None => cosine,
            Some(ior) => match 1.0 - ior * ior * (1.0 - cosine * cosine) {
                squared if squared > 0.0 => squared.sqrt(),
                _ => return Vec3::ONE,
            },
        };
        self.normal + self.added * (1.0 - cosine).clamp(0.0, 1.0).powi(5)
    }

    /// Share let through to the base.
    pub fn let_through(&self, cosine: f32) -> Vec3 {
        Vec3::ONE - self.reflected(cosine)
    }

    /// The mean of what is let through and out again, of light from everywhere.
    pub fn mean_let_through(&self) -> Vec3 {
        let mean = Vec3::ONE - self.normal - self.added / 21.0;
        mean * mean * self.inverse_mean
    }

    /// What a lobe reflects that reflects such a share of all light, and such a share of `(1 - cos)^5` of it.
    pub fn mean_of(&self, all: f32, grazing: f32) -> Vec3 {
        self.normal * all + self.added * grazing
    }

    /// Share let out again at an angle, of what the base reflects: in the mean over all of them 1.
    pub fn let_out(&self, cosine: f32) -> Vec3 {
        self.let_through(cosine) * self.inverse_mean
    }
}
