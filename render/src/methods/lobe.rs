//! How what is seen at a pixel reflects light specularly to the eye: the plain version of `shared/lobe.wgsl`.
//!
//! Microfacets whatever the material's gloss is: a g-buffer does not know.

use super::Surface;
use crate::path::bsdf::{Fresnel, Ggx};
use crate::raster::groups;
use crate::screen::{Device, GpuGBuffer, MethodStep};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes};
use glam::{IVec2, Mat3, Vec2, Vec3};

/// What glossy receivers read of a g-buffer.
pub const ATTRIBUTES: &[Attribute] =
    &[Attribute::Position, Attribute::Normal, Attribute::Valid, Attribute::Specular, Attribute::Glossiness];

/// The gloss of what is seen.
#[derive(Debug)]
pub struct Gloss {
    specular: Planes,
    glossiness: Planes,
}

/// The pass that gathers it for other passes, and what it writes, `[height, width]` of four: specular colour,
/// and glossiness, which is -1 where no surface is seen.
///
/// # Errors
/// If the device has no room, or refuses the pass.
pub fn step(device: &Device, gbuffer: &GpuGBuffer) -> Result<(wgpu::Buffer, MethodStep), GpuError> {
    let pass = device.pass(Shader::at("methods/gloss"), &[])?;
    let pixels = gbuffer.height() * gbuffer.width();
    let gloss = gpu::empty::<[f32; 4]>(device, "gloss", pixels)?;
    let reads = [Attribute::Valid, Attribute::Specular, Attribute::Glossiness].map(|a| gbuffer.buffer(a));
    let step = MethodStep::bind(device, &pass, groups(pixels), &reads, &[&gloss])?;
    Ok((gloss, step))
}

/// How a pixel's surface reflects light to the eye.
#[derive(Clone, Copy, Debug)]
pub struct Lobe {
    /// From the normal's frame, in which it is z, to the camera's.
    to_camera: Mat3,
    /// Unit direction to the eye, in the normal's frame.
    viewer: Vec3,
    facets: Ggx,
    fresnel: Fresnel,
}

impl Gloss {
    /// That of a g-buffer.
    ///
    /// # Errors
    /// If it lacks an attribute.
    pub fn of(gbuffer: &GBuffer) -> Result<Self, MissingAttribute> {
        let planes = |attribute| gbuffer.select(&[attribute]);
        Ok(Self { specular: planes(Attribute::Specular)?, glossiness: planes(Attribute::Glossiness)? })
    }

    /// The lobe of a pixel; none where the eye is below the surface, which a normal that is bent may lead to.
    pub fn lobe_at(&self, surface: &Surface, at: IVec2) -> Option<Lobe> {
        let [x, y] = [at.x as usize, at.y as usize];
        let specular = Vec3::from_array(std::array::from_fn(|c| self.specular.at(c, y, x)));
        let (tangent, bitangent) = surface.normal_at(at).any_orthonormal_pair();
        let to_camera = Mat3::from_cols(tangent, bitangent, surface.normal_at(at));
        let viewer = to_camera.transpose() * -surface.position_at(at).normalize();
        let facets = Ggx::new(1.0 - self.glossiness.at(0, y, x));
        (viewer.z > 0.0).then(|| Lobe { to_camera, viewer, facets, fresnel: Fresnel::new(specular) })
    }
}

impl Lobe {
    /// It with facets of a larger slope: so much is added to alpha squared.
    #[must_use]
    pub fn widened(self, by: f32) -> Self {
        Self { facets: self.facets.widened(by), ..self }
    }

    /// A direction, camera space, that a place on a disk leads to; its radius squared, and its angle, turns.
    /// May be below the surface.
    pub fn direction(&self, place: Vec2) -> Vec3 {
        self.to_camera * self.facets.sample(self.viewer, Vec2::new(place.y, place.x))
    }

    /// The density of such directions, per steradian.
    pub fn density(&self, direction: Vec3) -> f32 {
        self.facets.density(self.viewer, self.to_camera.transpose() * direction)
    }

    /// Reflectance times the cosine of a direction over that density.
    pub fn weight(&self, direction: Vec3) -> Vec3 {
        self.colour(direction) * self.visibility(direction)
    }

    /// Share of light from a direction that facets reflect which mirror it to the eye.
    pub fn colour(&self, direction: Vec3) -> Vec3 {
        let light = self.to_camera.transpose() * direction;
        self.fresnel.reflected(self.viewer.dot((self.viewer + light).normalize_or(Vec3::Z)))
    }

    /// Share of light that the surface reflects where facets lie flat.
    pub fn usual_colour(&self) -> Vec3 {
        self.fresnel.reflected(self.viewer.z)
    }

    /// Share of what facets mirror that no other facet stops.
    pub fn visibility(&self, direction: Vec3) -> f32 {
        let light = self.to_camera.transpose() * direction;
        if light.z <= 0.0 {
            return 0.0;
        }
        self.facets.reflectance(self.viewer, light) * light.z / self.facets.density(self.viewer, light)
    }
}
