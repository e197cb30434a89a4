//! Images that cheap methods make for networks to read, on the processor: attributes like any other. Of a
//! scene that takes too long in plain code where a method has no version in vector instructions: an adapter
//! makes it then, if there is one.

use super::{Quality, all};
use crate::bvh::TracedScene;
use crate::method::{Frame, MethodError, Repeats};
use crate::scene::{Camera, Lens};
use crate::screen::{About, PlainInputs, ScreenMethod, Technique, View};
use deepshade_shaders::effect::LitBy;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::host::HostPasses;
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute};
use glam::Vec3;
use std::sync::{Arc, OnceLock};
use thiserror::Error;

/// A method that makes what a network reads, at a quality.
#[derive(Clone, Debug)]
pub struct Estimator {
    technique: Arc<dyn Technique>,
    /// Its passes on an adapter, once they were needed; none where there is no adapter.
    passes: Arc<OnceLock<Option<ScreenMethod>>>,
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
#[derive(Debug, Error)]
pub enum EstimateError {
    /// No such method makes estimates.
    #[error("no method `{method}` makes estimates of `{effect}` for networks; {known}")]
    Unknown {
        /// The method.
        method: String,
        /// The effect.
        effect: Effect,
        /// Which do.
        known: String,
    },
    /// It is not METHOD:QUALITY.
    #[error("`{0}` is not METHOD:QUALITY, such as gtao:high")]
    Form(String),
    /// No such quality.
    #[error("`{0}` is no quality; low, medium, high and ultra are")]
    Quality(String),
    /// The g-buffer lacks what the method reads.
    #[error(transparent)]
    Missing(#[from] MissingAttribute),
    /// The adapter failed.
    #[error(transparent)]
    Method(#[from] MethodError),
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

/// Whether a method has to know the scene: it looks beyond the screen, or at the environment.
fn reads_scene(about: &About) -> bool {
    about.looks_beyond || about.effect.lit_by() == LitBy::Environment
}

/// Whether networks read a method's images: of `ao` those of the screen alone, which are blurred last; of
/// filters of light all; of other light those that follow from the scene, which are there before light is
/// exposed.
fn makes_estimates(about: &About) -> bool {
    match about.effect {
        Effect::Ao => !reads_scene(about),
        effect => effect.definition().filters_light || reads_scene(about),
    }
}

impl Estimator {
    /// An effect's method of that name at a quality.
    ///
    /// # Errors
    /// If there is none.
    pub fn named(effect: Effect, method: &str, quality: &str) -> Result<Self, EstimateError> {
        let known = Quality::ALL.into_iter().find(|known| known.name() == quality);
        let quality = known.ok_or_else(|| EstimateError::Quality(quality.to_owned()))?;
        let of_effect = all().iter().filter(|entry| entry.effect == effect);
        let techniques = of_effect.filter_map(|entry| entry.technique(quality));
        let mut known: Vec<Self> =
            techniques.map(|technique| Self { technique, passes: Arc::default() }).collect();
        known.retain(|estimator| makes_estimates(&estimator.about()));
        if let Some(found) = known.iter().position(|estimator| estimator.method() == method) {
            return Ok(known.swap_remove(found));
        }
        let names: Vec<&str> = known.iter().map(Self::method).collect();
        let known = if names.is_empty() { "none does".to_owned() } else { names.join(" and ") + " do" };
        Err(EstimateError::Unknown { method: method.to_owned(), effect, known })
    }

    /// That of a text `METHOD:QUALITY`.
    ///
    /// # Errors
    /// If there is none.
    pub fn parse(effect: Effect, text: &str) -> Result<Self, EstimateError> {
        let (method, quality) = text.split_once(':').ok_or_else(|| EstimateError::Form(text.to_owned()))?;
        Self::named(effect, method, quality)
    }

    /// The method on an adapter.
    pub fn on(&self, gpu: &Gpu) -> ScreenMethod {
        ScreenMethod::of(gpu, Arc::clone(&self.technique))
    }

    fn about(&self) -> About {
        self.technique.about()
    }

    /// Its passes on an adapter, if there is one, which is asked for once.
    fn passes(&self) -> Option<&ScreenMethod> {
        self.passes.get_or_init(|| Gpu::new().ok().map(|gpu| self.on(&gpu))).as_ref()
    }

    /// Its method's name.
    pub fn method(&self) -> &'static str {
        self.about().name
    }

    /// What it makes: its image, then, of `ao`, the image before the method's own blur.
    pub fn makes(&self) -> &'static [Attribute] {
        match self.about().effect {
            Effect::Ao => &[Attribute::Openness, Attribute::RawOpenness],
            _ => &[Attribute::Estimate],
        }
    }

    /// What it reads of a g-buffer.
    pub fn reads(&self) -> &'static [Attribute] {
        self.about().attributes
    }

    /// Whether it looks beyond the screen, or at the environment, so that it has to know the scene.
    pub fn reads_scene(&self) -> bool {
        reads_scene(&self.about())
    }

    /// Whether it looks beyond the screen.
    pub fn looks_beyond(&self) -> bool {
        self.about().looks_beyond
    }

    /// Its passes as an engine runs them from files, into buffers that are called as what it makes, of a
    /// method of `ao`; none of others.
    pub fn host_passes(&self) -> Option<HostPasses> {
        match (self.reads_scene(), self.makes()) {
            (false, [image, raw]) => self.technique.host_passes(raw.name(), image.name()),
            _ => None,
        }
    }

    /// That the scene is not known and has to be.
    pub fn wants_scene(&self) -> EstimateError {
        EstimateError::Scene { layer: self.makes()[0].name(), method: self.method() }
    }

    /// Whether all that it makes is among the attributes of a g-buffer.
    pub fn is_made(&self, held: &[Attribute]) -> bool {
        self.makes().iter().all(|made| held.contains(made))
    }

    /// What it makes of a frame, plane after plane: in vector instructions where the method has such a
    /// version, else, of a scene, in its passes on an adapter.
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute, the scene is not known and has to be, or the adapter fails.
    pub fn on_processor(&self, inputs: &EstimateInputs<'_>) -> Result<Vec<f32>, EstimateError> {
        let scene = match self.reads_scene() {
            true => Some(inputs.scene.ok_or_else(|| self.wants_scene())?),
            false => None,
        };
        let view = inputs.view();
        let environment = scene.and_then(|(scene, _)| scene.scene().environment.as_deref());
        let plain =
            PlainInputs { gbuffer: inputs.gbuffer, environment, scene: scene.map(|(scene, _)| scene) };
        let by_vectors = self.technique.on_processor(&plain, &view);
        if let (None, Some((scene, camera))) = (&by_vectors, scene)
            && let Some(passes) = self.passes()
        {
            let EstimateInputs { gbuffer, radius, seed, .. } = *inputs;
            let frame = Frame { scene, camera, gbuffer, radius, seed };
            return Ok(passes.shade_in_passes(&frame, Repeats::ONCE)?.image.data().to_vec());
        }
        let mut written = by_vectors.unwrap_or_else(|| self.technique.reference(&plain, &view))?;
        let image = written.pop().unwrap_or_default();
        let raw = if self.makes().len() > 1 { written.swap_remove(0) } else { Vec::new() };
        Ok([image, raw].concat())
    }
}

/// A g-buffer with what methods estimate of it, as far as it has it not.
///
/// # Errors
/// If it lacks what a method reads.
pub fn with_estimates(
    inputs: &EstimateInputs<'_>,
    estimators: &[Estimator],
) -> Result<GBuffer, EstimateError> {
    let mut with = inputs.gbuffer.clone();
    for estimator in estimators {
        if !estimator.is_made(with.attributes()) {
            with = with.with(estimator.makes(), &estimator.on_processor(inputs)?);
        }
    }
    Ok(with)
}

impl EstimateInputs<'_> {
    /// From where the g-buffer is seen: its camera where that is known, else what positions and blurriness
    /// say of one, which is all that methods of the screen want to know.
    pub fn view(&self) -> View {
        let Self { gbuffer, radius, seed, scene } = *self;
        let (height, width) = (gbuffer.height(), gbuffer.width());
        let camera = scene.map_or_else(|| seen_by(gbuffer), |(_, camera)| *camera);
        View { height, width, camera, radius, seed }
    }
}

/// A camera as far as a g-buffer tells its angle of view and its lens.
fn seen_by(gbuffer: &GBuffer) -> Camera {
    let focal_length = gbuffer.focal_length().unwrap_or(1.0);
    let vertical_fov = 2.0 * (0.5 * gbuffer.height() as f32 / focal_length).atan();
    let lens = gbuffer.blur_and_focus().ok().flatten();
    let lens = lens.map(|[blur, focus]| Lens { radius: blur * focus / focal_length, focus });
    Camera { vertical_fov, lens, ..Camera::look_at(Vec3::ZERO, Vec3::NEG_Z) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::{Frame, Repeats};
    use crate::methods::proving::{Tolerance, agree, beyond, everything, still_life, view as seen};
    use crate::methods::{Surface, gtao, march};
    use crate::scene::procedural::{Family, sky};
    use deepshade_shaders::Planes;

    fn estimators(methods: &[(Effect, &str)]) -> Vec<Estimator> {
        let low = |(effect, method): &(Effect, &str)| Estimator::named(*effect, method, "low");
        methods.iter().map(low).collect::<Result<_, _>>().expect("known")
    }

    #[test]
    fn an_estimate_is_the_methods_image_though_nobody_says_the_camera() {
        let (height, width) = (31, 45);
        let gbuffer = still_life(height, width);
        let of = |gbuffer| EstimateInputs { gbuffer, radius: 1.0, seed: 11, scene: None };
        let with = with_estimates(&of(&gbuffer), &estimators(&[(Effect::Ao, "gtao")])).expect("estimates");
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
        let again = with_estimates(&of(&with), &estimators(&[(Effect::Ao, "gtao")])).expect("estimates");
        assert_eq!(again, with, "made once");
    }

    #[test]
    fn a_filter_of_light_needs_neither_scene_nor_camera() {
        let (scene, view, gbuffer) = everything(48, 64);
        let gpu = Gpu::new().expect("an adapter; lavapipe will do");
        let frame =
            Frame { scene: &scene, camera: &view.camera, gbuffer: &gbuffer, radius: view.radius, seed: 3 };
        let filters =
            [(Effect::Dof, "ring-gather"), (Effect::MotionBlur, "reconstruction"), (Effect::Aa, "fxaa")];
        for (effect, method) in filters {
            let estimators = estimators(&[(effect, method)]);
            let expected = estimators[0].on(&gpu).shade_in_passes(&frame, Repeats::ONCE).expect("shades");
            let inputs = EstimateInputs { gbuffer: &gbuffer, radius: view.radius, seed: 3, scene: None };
            let with = with_estimates(&inputs, &estimators).expect("estimates");
            let made = with.select(&[Attribute::Estimate]).expect("it was made");
            // Rounding now and then puts a sample on the neighbouring pixel.
            agree(&made, &expected.image, Tolerance { usual: 1e-3, worst: 1.0 }).expect(method);
        }
    }

    #[test]
    fn what_is_not_there_is_named() {
        let gbuffer = still_life(8, 8);
        let of = |gbuffer| EstimateInputs { gbuffer, radius: 1.0, seed: 1, scene: None };
        let refused = |effect, method, quality| {
            let estimator = Estimator::named(effect, method, quality).map_err(|error| error.to_string())?;
            with_estimates(&of(&gbuffer), &[estimator]).map_err(|error| error.to_string())
        };
        let unknown = refused(Effect::Ao, "ssao", "low");
        assert!(unknown.is_err_and(|error| error.contains("`ssao`") && error.contains("gtao and hbao do")));
        assert!(refused(Effect::Ao, "surfel", "low").is_err_and(|error| error.contains("`surfel`")));
        assert!(refused(Effect::Ao, "gtao", "best").is_err_and(|error| error.contains("`best`")));
        let blind = GBuffer::new(vec![Attribute::Valid], Planes::filled(1, 2, 2, 1.0));
        let missing = with_estimates(&of(&blind), &estimators(&[(Effect::Ao, "gtao")]));
        assert!(matches!(missing, Err(EstimateError::Missing(_))));
        for (effect, method) in [(Effect::Gi, "surfel"), (Effect::Do, "ssdo")] {
            let unknown = refused(effect, method, "low");
            assert!(unknown.is_err_and(|error| error.contains("`estimate`") && error.contains("scene")));
        }
        let form = Estimator::parse(Effect::Ao, "gtao");
        assert!(matches!(form, Err(EstimateError::Form(text)) if text == "gtao"));
    }

    /// What a method makes on the processor and in its passes, low, in a room.
    fn on_processor_and_in_passes(effect: Effect, method: &str) -> [Planes; 2] {
        let gpu = Gpu::new().expect("an adapter; lavapipe will do");
        let (scene, view, gbuffer) = beyond::seen(Family::Room, 48, 64);
        let mut look = scene.scene().look();
        look.environment = Some(Arc::new(sky(1)));
        let scene = scene.with_look(look).expect("traced");
        let frame =
            Frame { scene: &scene, camera: &view.camera, gbuffer: &gbuffer, radius: view.radius, seed: 3 };
        let estimators = estimators(&[(effect, method)]);
        let passes = estimators[0].on(&gpu).shade_in_passes(&frame, Repeats::ONCE).expect("shades").image;
        let scene = Some((&scene, &view.camera));
        let inputs = EstimateInputs { gbuffer: &gbuffer, radius: view.radius, seed: 3, scene };
        let with = with_estimates(&inputs, &estimators).expect("estimates");
        [with.select(&[Attribute::Estimate]).expect("it was made"), passes]
    }

    fn mean(image: &Planes) -> f32 {
        image.data().iter().sum::<f32>() / image.data().len() as f32
    }

    #[test]
    fn surfels_of_a_scene_make_the_methods_own_image() {
        let [made, expected] = on_processor_and_in_passes(Effect::Gi, "surfel");
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

    #[test]
    fn an_adapter_makes_what_has_no_version_for_the_processor() {
        let [made, expected] = on_processor_and_in_passes(Effect::Path, "composed");
        assert!(mean(&expected) > 1e-3, "{}", mean(&expected));
        assert_eq!(made, expected);
    }

    #[test]
    fn light_of_the_environment_is_that_of_the_methods_passes() {
        let [made, expected] = on_processor_and_in_passes(Effect::Do, "ssdo");
        assert!(mean(&expected) > 1e-2, "{}", mean(&expected));
        let both = made.data().iter().zip(expected.data());
        let off = both.filter(|(a, b)| (*a - *b).abs() > 0.02 * b.abs() + 1e-3).count();
        assert!(off * 100 < made.data().len(), "{off} of {} values", made.data().len());
    }
}
