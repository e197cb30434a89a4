//! What a pair of an effect consists of: which attributes its g-buffer holds. The integrator of its target is
//! [`deepshade_render::path::integrator`]'s.

use deepshade_shaders::{Attribute, AttributeKind, Effect, GBuffer, Planes};

/// The attributes that pairs of an effect hold: what its network reads (thesis, Table 7.1), what its analytic methods
/// read beside, and the validity mask.
///
/// Effects of the table are without albedo where it says so: what they compute is multiplied by the diffuse colour
/// afterwards. Fog and full path tracing, which the thesis' networks do not do, have the surfaces' geometry, direct
/// light and colours.
pub const fn attributes(effect: Effect) -> &'static [Attribute] {
    use Attribute::{
        Blurriness, Depth, Diffuse, DiffuseLight, Emission, Glossiness, Light, MeanFreePath, Motion, Normal,
        Position, Specular, ToCamera, Valid, WorldNormal,
    };
    match effect {
        Effect::Ao => &[Position, Normal, Valid],
        Effect::Do => &[WorldNormal, Normal, Position, Valid],
        // The diffuse colour is for looking at the indirect light as it is added to an image.
        Effect::Gi => &[Normal, Position, DiffuseLight, Diffuse, Valid],
        Effect::Glossy => &[Position, Normal, Specular, Glossiness, DiffuseLight, Valid],
        Effect::Ibl => &[WorldNormal, ToCamera, Diffuse, Specular, Glossiness, Valid],
        Effect::Sss => &[Position, MeanFreePath, Light, Valid],
        // The walk below the surface ends where it began in another direction, and takes on the surface's colour.
        // What is reflected specularly does not enter.
        Effect::Subsurface => &[Position, Normal, MeanFreePath, DiffuseLight, Diffuse, Valid],
        Effect::Dof => &[Blurriness, Depth, Light, Valid],
        Effect::MotionBlur => &[Motion, Light, Depth, Valid],
        Effect::Aa => &[Depth, Light, Valid],
        Effect::Multi => &[Normal, Position, Blurriness, Depth, Light, Valid],
        Effect::FogDirect | Effect::FogIndirect | Effect::FogMultiple => {
            &[Position, Normal, Depth, Light, Diffuse, Valid]
        }
        // Where lamps shone tells what was kept of their light.
        Effect::Phosphor | Effect::PhosphorGi => &[Position, Normal, DiffuseLight, Diffuse, Valid],
        Effect::Path => &[Position, Normal, Depth, Light, Diffuse, Specular, Glossiness, Emission, Valid],
        // All that a depth image tells.
        Effect::Real => &[Position, Normal, Valid],
    }
}

/// What the numbers of a pair mean.
pub fn units(effect: Effect) -> String {
    match effect {
        // As data of version 2 have it, to the letter.
        Effect::Ao => {
            "position in metres; ambient occlusion as the open share of the hemisphere, without unit"
                .to_owned()
        }
        _ => format!("lengths in metres, blur and motion in pixels; target: {}", effect.unit()),
    }
}

/// Radiance beyond this is written as this: the largest number of a half float. Only lights themselves, their
/// reflections in mirrors and the like are so bright.
pub const BRIGHTEST: f32 = 65_504.0;

/// An image with nothing brighter than [`BRIGHTEST`].
#[must_use]
pub fn within_half(mut image: Planes) -> Planes {
    image.data_mut().iter_mut().for_each(|value| *value = value.clamp(-BRIGHTEST, BRIGHTEST));
    image
}

/// A g-buffer with no light in it that is brighter than [`BRIGHTEST`].
#[must_use]
pub fn light_within_half(gbuffer: GBuffer) -> GBuffer {
    let attributes = gbuffer.attributes().to_vec();
    let mut planes = gbuffer.planes().clone();
    let channels = attributes.iter().flat_map(|attribute| attribute.channels());
    for (plane, _) in channels.enumerate().filter(|(_, c)| c.attribute.kind() == AttributeKind::Colour) {
        planes.plane_mut(plane).iter_mut().for_each(|value| *value = value.clamp(-BRIGHTEST, BRIGHTEST));
    }
    GBuffer::new(attributes, planes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_has_attributes_of_its_own_kind_and_a_mask() {
        for effect in Effect::ALL {
            let attributes = attributes(effect);
            assert_eq!(attributes.last(), Some(&Attribute::Valid), "{effect}");
            let twice = |i: usize| attributes[..i].contains(&attributes[i]);
            assert!(!(0..attributes.len()).any(twice), "{effect}");
        }
    }

    #[test]
    fn only_light_is_cut_off() {
        let attributes = vec![Attribute::Depth, Attribute::Light];
        let planes = Planes::from_data(4, 1, 1, vec![1e6, 1e6, 2.0, f32::NAN]);
        let cut = light_within_half(GBuffer::new(attributes, planes));
        assert_eq!(cut.planes().data()[..3], [1e6, BRIGHTEST, 2.0]);
        assert!(cut.planes().data()[3].is_nan(), "what is no number is not hidden");
        let image = within_half(Planes::from_data(1, 1, 3, vec![f32::INFINITY, f32::NAN, 0.5]));
        assert!(image.data()[0] == BRIGHTEST && image.data()[1].is_nan() && image.data()[2] == 0.5);
    }
}
