//! Radiance that a patch emits, in a word; a list beside the patches, made only where any of them emits.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Emitted radiance, on either side of a surface, as `shared/packing.wgsl` packs it.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Emission(u32);

impl Emission {
    /// Nine bits a colour and an exponent of five: 2^-24 to 65,408, and 0.
    pub fn new(radiance: Vec3) -> Self {
        let bounded = radiance.clamp(Vec3::ZERO, Vec3::splat(65_408.0));
        let largest = bounded.max_element().max((-16.0f32).exp2());
        let exponent = largest.log2().floor().clamp(-16.0, 15.0) + 1.0;
        let rounded = |exponent: f32| (bounded / (exponent - 9.0).exp2() + 0.5).floor();
        let exponent = if rounded(exponent).max_element() > 511.0 { exponent + 1.0 } else { exponent };
        let [red, green, blue] = rounded(exponent).to_array().map(|part| part as u32);
        Self(red | green << 9 | blue << 18 | ((exponent + 15.0) as u32) << 27)
    }

    /// The radiance.
    pub fn radiance(self) -> Vec3 {
        let scale = ((self.0 >> 27) as f32 - 24.0).exp2();
        Vec3::from([0, 9, 18].map(|shift| (self.0 >> shift & 511) as f32)) * scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_kept_to_a_five_hundredth_of_its_largest_colour() {
        for emission in
            [Vec3::new(3.0, 0.2, 1.1), Vec3::new(0.001, 0.0, 0.0), Vec3::splat(511.7), Vec3::splat(6e4)]
        {
            let kept = Emission::new(emission).radiance();
            let off = (kept - emission).abs().max_element() / emission.max_element();
            assert!(kept != Vec3::ZERO && off < 2e-3, "{emission}: {kept}");
        }
        assert_eq!([Emission::new(Vec3::ZERO), Emission::default()].map(Emission::radiance), [Vec3::ZERO; 2]);
        assert_eq!(Emission::new(Vec3::INFINITY).radiance(), Vec3::splat(65_408.0));
    }
}
