//! What the numbers of a pair mean, and how bright its light may be. Which attributes its g-buffer holds is
//! in the table of effects; the integrator of its target is [`deepshade_render::path::integrator`]'s.

use deepshade_shaders::{AttributeKind, Effect, GBuffer, Planes};

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
    use deepshade_shaders::Attribute;

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
