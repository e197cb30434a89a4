//! Images that cheap methods make for networks to read, on the processor: attributes like any other.

use super::{Quality, Surface, gtao};
use crate::scene::Camera;
use crate::screen::View;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute};
use glam::Vec3;
use thiserror::Error;

/// A method that makes what a network reads, with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Estimator {
    /// Openness, with and without its blur.
    Gtao(gtao::GtaoParameters),
}

/// Why there is no estimate.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum EstimateError {
    /// No such method makes estimates.
    #[error("no method `{0}` makes estimates for networks; gtao does")]
    Unknown(String),
    /// No such quality.
    #[error("`{0}` is no quality; low, medium, high and ultra are")]
    Quality(String),
    /// The g-buffer lacks what the method reads.
    #[error(transparent)]
    Missing(#[from] MissingAttribute),
}

impl Estimator {
    /// The method of that name at a quality.
    ///
    /// # Errors
    /// If there is none.
    pub fn named(method: &str, quality: &str) -> Result<Self, EstimateError> {
        let known = Quality::ALL.into_iter().find(|known| known.name() == quality);
        let quality = known.ok_or_else(|| EstimateError::Quality(quality.to_owned()))?;
        match method {
            "gtao" => Ok(Self::Gtao(gtao::GtaoParameters::of(quality))),
            other => Err(EstimateError::Unknown(other.to_owned())),
        }
    }

    /// What it makes: its image, then the image before the method's own blur.
    pub const fn makes(&self) -> &'static [Attribute] {
        match self {
            Self::Gtao(_) => &[Attribute::Openness, Attribute::RawOpenness],
        }
    }

    /// What it reads of a g-buffer.
    pub const fn reads(&self) -> &'static [Attribute] {
        match self {
            Self::Gtao(_) => &[Attribute::Position, Attribute::Normal, Attribute::Valid],
        }
    }

    /// What it makes of a g-buffer, plane after plane, for an effect that reaches `radius` metres.
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute.
    pub fn on_processor(
        &self,
        gbuffer: &GBuffer,
        radius: f32,
        seed: u32,
    ) -> Result<Vec<f32>, MissingAttribute> {
        let view = view(gbuffer, radius, seed)?;
        match self {
            Self::Gtao(parameters) => {
                let surface = Surface::of(gbuffer)?;
                let [raw, _, blurred] = gtao::on_processor(parameters, &surface, &view);
                Ok([blurred.data(), raw.data()].concat())
            }
        }
    }
}

/// A g-buffer with what methods estimate of it, by their names and qualities, as far as it has it not.
///
/// # Errors
/// If there is no such method, or the g-buffer lacks what it reads.
pub fn with_estimates<'a>(
    gbuffer: &GBuffer,
    methods: impl IntoIterator<Item = (&'a str, &'a str)>,
    radius: f32,
    seed: u32,
) -> Result<GBuffer, EstimateError> {
    let mut with = gbuffer.clone();
    for (method, quality) in methods {
        let estimator = Estimator::named(method, quality)?;
        if estimator.makes().iter().any(|made| !with.attributes().contains(made)) {
            with = with.with(estimator.makes(), &estimator.on_processor(gbuffer, radius, seed)?);
        }
    }
    Ok(with)
}

/// The view of a g-buffer whose camera is not known: what positions say of it, which is all that these
/// methods want to know.
fn view(gbuffer: &GBuffer, radius: f32, seed: u32) -> Result<View, MissingAttribute> {
    let (height, width) = (gbuffer.height(), gbuffer.width());
    let vertical_fov = 2.0 * (0.5 * height as f32 / gbuffer.focal_length()?).atan();
    let camera = Camera { vertical_fov, ..Camera::look_at(Vec3::ZERO, Vec3::NEG_Z) };
    Ok(View { height, width, camera, radius, seed })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::march;
    use crate::methods::proving::{still_life, view as seen};

    #[test]
    fn an_estimate_is_the_methods_image_though_nobody_says_the_camera() {
        let (height, width) = (31, 45);
        let gbuffer = still_life(height, width);
        let with = with_estimates(&gbuffer, [("gtao", "low")], 1.0, 11).expect("estimates");
        let parameters = gtao::GtaoParameters::of(Quality::Low);
        let view = View { seed: 11, ..seen(height, width, 1.0) };
        let surface = Surface::of(&gbuffer).expect("all attributes");
        let noisy = gtao::reference::occlude(&surface, &parameters.slices.settings(&view));
        let [raw, _, blurred] = march::blurred(&parameters, &surface, &view, noisy);
        for (attribute, expected) in [(Attribute::Openness, blurred), (Attribute::RawOpenness, raw)] {
            let made = with.select(&[attribute]).expect("it was made");
            let far = made.data().iter().zip(expected.data()).filter(|(a, b)| (*a - *b).abs() > 0.05).count();
            assert!(far * 100 < made.data().len(), "{attribute:?}: {far} pixels");
        }
        assert_eq!(with_estimates(&with, [("gtao", "low")], 1.0, 11), Ok(with), "made once");
    }

    #[test]
    fn what_is_not_there_is_named() {
        let gbuffer = still_life(8, 8);
        let refused = |method, quality| {
            with_estimates(&gbuffer, [(method, quality)], 1.0, 1).map_err(|e| e.to_string())
        };
        assert!(refused("ssao", "low").is_err_and(|error| error.contains("`ssao`")));
        assert!(refused("gtao", "best").is_err_and(|error| error.contains("`best`")));
        let blind = GBuffer::new(vec![Attribute::Valid], deepshade_shaders::Planes::filled(1, 2, 2, 1.0));
        assert!(matches!(with_estimates(&blind, [("gtao", "low")], 1.0, 1), Err(EstimateError::Missing(_))));
    }
}
