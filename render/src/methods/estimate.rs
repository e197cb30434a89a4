//! Images that cheap methods make for networks to read, on the processor: attributes like any other.

use super::{Quality, Surface, gtao, surfel};
use crate::bvh::TracedScene;
use crate::scene::Camera;
use crate::screen::View;
use crate::surfels::{self, SurfelLight};
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute};
use glam::Vec3;
use thiserror::Error;

/// A method that makes what a network reads, with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Estimator {
    /// Openness, with and without its blur.
    Gtao(gtao::GtaoParameters),
    /// Indirect light, of surfaces that the camera does not see, too.
    Surfel(surfel::SurfelParameters),
}

/// What an estimate is made of, for an effect that reaches `radius` metres.
#[derive(Clone, Copy, Debug)]
pub struct EstimateInputs<'a> {
    /// What the camera sees.
    pub gbuffer: &'a GBuffer,
    /// How far the effect reaches, metres.
    pub radius: f32,
    /// Chooses random numbers.
    pub seed: u32,
    /// The scene and the camera, where they are known.
    pub scene: Option<(&'a TracedScene, &'a Camera)>,
}

/// Why there is no estimate.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum EstimateError {
    /// No such method makes estimates.
    #[error("no method `{0}` makes estimates for networks; gtao and surfel do")]
    Unknown(String),
    /// It is not METHOD:QUALITY.
    #[error("`{0}` is not METHOD:QUALITY, such as gtao:high")]
    Form(String),
    /// No such quality.
    #[error("`{0}` is no quality; low, medium, high and ultra are")]
    Quality(String),
    /// The g-buffer lacks what the method reads.
    #[error(transparent)]
    Missing(#[from] MissingAttribute),
    /// Only a scene tells it.
    #[error(
        "the network reads `{layer}`, which `{method}` makes of a scene: of a g-buffer alone it cannot be \
         made. Give a g-buffer that has the layer, compare on a scene, or state `estimates` in the recipe"
    )]
    Scene {
        /// The layer.
        layer: &'static str,
        /// The method.
        method: &'static str,
    },
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
            "surfel" => Ok(Self::Surfel(surfel::SurfelParameters::of(quality))),
            other => Err(EstimateError::Unknown(other.to_owned())),
        }
    }

    /// That of a text `METHOD:QUALITY`.
    ///
    /// # Errors
    /// If there is none.
    pub fn parse(text: &str) -> Result<Self, EstimateError> {
        let (method, quality) = text.split_once(':').ok_or_else(|| EstimateError::Form(text.to_owned()))?;
        Self::named(method, quality)
    }

    /// Its method's name.
    pub const fn method(&self) -> &'static str {
        match self {
            Self::Gtao(_) => "gtao",
            Self::Surfel(_) => "surfel",
        }
    }

    /// What it makes: its image, then the image before the method's own blur, where networks read that.
    pub const fn makes(&self) -> &'static [Attribute] {
        match self {
            Self::Gtao(_) => &[Attribute::Openness, Attribute::RawOpenness],
            Self::Surfel(_) => &[Attribute::IndirectLight],
        }
    }

    /// What it reads of a g-buffer.
    pub const fn reads(&self) -> &'static [Attribute] {
        match self {
            Self::Gtao(_) | Self::Surfel(_) => &[Attribute::Position, Attribute::Normal, Attribute::Valid],
        }
    }

    /// Whether it looks beyond the screen, so that it has to know the scene.
    pub const fn reads_scene(&self) -> bool {
        matches!(self, Self::Surfel(_))
    }

    /// That the scene is not known and has to be.
    pub const fn wants_scene(&self) -> EstimateError {
        EstimateError::Scene { layer: self.makes()[0].name(), method: self.method() }
    }

    /// Whether a g-buffer has all that it makes.
    pub fn is_made(&self, gbuffer: &GBuffer) -> bool {
        self.makes().iter().all(|made| gbuffer.attributes().contains(made))
    }

    /// What it makes of a frame, plane after plane.
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute, or the scene is not known and has to be.
    pub fn on_processor(&self, inputs: &EstimateInputs<'_>) -> Result<Vec<f32>, EstimateError> {
        let surface = Surface::of(inputs.gbuffer)?;
        match self {
            Self::Gtao(parameters) => {
                let [raw, _, blurred] = gtao::on_processor(parameters, &surface, &view(inputs)?);
                Ok([blurred.data(), raw.data()].concat())
            }
            Self::Surfel(parameters) => {
                let (scene, camera) = inputs.scene.ok_or_else(|| self.wants_scene())?;
                let view = View { camera: *camera, ..view(inputs)? };
                let disks =
                    surfels::reference::laid(scene, &parameters.surfels, &view, Some(SurfelLight::Reflected));
                Ok(surfel::splat::light(&surface, &disks, parameters, &view).data().to_vec())
            }
        }
    }
}

/// A g-buffer with what methods estimate of it, by their names and qualities, as far as it has it not.
///
/// # Errors
/// If there is no such method, or it lacks what it reads.
pub fn with_estimates<'a>(
    inputs: &EstimateInputs<'_>,
    methods: impl IntoIterator<Item = (&'a str, &'a str)>,
) -> Result<GBuffer, EstimateError> {
    let mut with = inputs.gbuffer.clone();
    for (method, quality) in methods {
        let estimator = Estimator::named(method, quality)?;
        if !estimator.is_made(&with) {
            with = with.with(estimator.makes(), &estimator.on_processor(inputs)?);
        }
    }
    Ok(with)
}

/// The view of a g-buffer whose camera is not known: what positions say of it, which is all that these
/// methods want to know.
fn view(inputs: &EstimateInputs<'_>) -> Result<View, MissingAttribute> {
    let EstimateInputs { gbuffer, radius, seed, .. } = *inputs;
    let (height, width) = (gbuffer.height(), gbuffer.width());
    let vertical_fov = 2.0 * (0.5 * height as f32 / gbuffer.focal_length()?).atan();
    let camera = Camera { vertical_fov, ..Camera::look_at(Vec3::ZERO, Vec3::NEG_Z) };
    Ok(View { height, width, camera, radius, seed })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::{Frame, Method, Repeats};
    use crate::methods::disks::Disks;
    use crate::methods::march;
    use crate::methods::proving::{beyond, still_life, view as seen};
    use crate::scene::procedural::Family;
    use crate::screen::ScreenMethod;
    use deepshade_shaders::Planes;
    use deepshade_shaders::gpu::Gpu;

    #[test]
    fn an_estimate_is_the_methods_image_though_nobody_says_the_camera() {
        let (height, width) = (31, 45);
        let gbuffer = still_life(height, width);
        let of = |gbuffer| EstimateInputs { gbuffer, radius: 1.0, seed: 11, scene: None };
        let with = with_estimates(&of(&gbuffer), [("gtao", "low")]).expect("estimates");
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
        assert_eq!(with_estimates(&of(&with), [("gtao", "low")]), Ok(with.clone()), "made once");
    }

    #[test]
    fn what_is_not_there_is_named() {
        let gbuffer = still_life(8, 8);
        let of = |gbuffer| EstimateInputs { gbuffer, radius: 1.0, seed: 1, scene: None };
        let refused =
            |method, quality| with_estimates(&of(&gbuffer), [(method, quality)]).map_err(|e| e.to_string());
        assert!(refused("ssao", "low").is_err_and(|error| error.contains("`ssao`")));
        assert!(refused("gtao", "best").is_err_and(|error| error.contains("`best`")));
        let blind = GBuffer::new(vec![Attribute::Valid], Planes::filled(1, 2, 2, 1.0));
        let missing = with_estimates(&of(&blind), [("gtao", "low")]);
        assert!(matches!(missing, Err(EstimateError::Missing(_))));
        let unknown = refused("surfel", "low");
        assert!(unknown.is_err_and(|error| error.contains("`indirect_light`") && error.contains("scene")));
        assert_eq!(Estimator::parse("gtao"), Err(EstimateError::Form("gtao".to_owned())));
    }

    #[test]
    fn surfels_of_a_scene_make_the_methods_own_image() {
        let gpu = Gpu::new().expect("an adapter; lavapipe will do");
        let (scene, view, gbuffer) = beyond::seen(Family::Room, 48, 64);
        let frame =
            Frame { scene: &scene, camera: &view.camera, gbuffer: &gbuffer, radius: view.radius, seed: 3 };
        let method = ScreenMethod::new(
            &gpu,
            Disks::new(surfel::SurfelParameters::of(Quality::Low), surfel::indirect::INDIRECT),
        );
        let expected = method.shade(&frame, Repeats::ONCE).expect("shades").image;
        let scene = Some((&scene, &view.camera));
        let inputs = EstimateInputs { gbuffer: &gbuffer, radius: view.radius, seed: 3, scene };
        let with = with_estimates(&inputs, [("surfel", "low")]).expect("estimates");
        let made = with.select(&[Attribute::IndirectLight]).expect("it was made");
        let mean = |image: &Planes| image.data().iter().sum::<f32>() / image.data().len() as f32;
        assert!(mean(&expected) > 1e-4, "{}", mean(&expected));
        // Shadows of maps and of rays differ, and so do a few surfels that are rounded another way.
        assert!((mean(&made) / mean(&expected) - 1.0).abs() < 0.05, "{} {}", mean(&made), mean(&expected));
        let off = made
            .data()
            .iter()
            .zip(expected.data())
            .filter(|(a, b)| (*a - *b).abs() > 0.1 * b.abs() + 0.01 * mean(&expected));
        assert!(off.count() * 10 < made.data().len());
    }
}
