//! The methods that can be asked for by name: [those of `render`](methods::all), and `learned`.

use crate::learned::Learned;
use anyhow::{Context, Result, bail, ensure};
use deepshade_infer::Model;
use deepshade_render::method::{Frame, Method, MethodError, Repeats, Shaded};
use deepshade_render::methods::dials::{Dial, Tuning};
use deepshade_render::methods::{self, Entry, Opened, Quality, screen_truth};
use deepshade_render::screen::ScreenMethod;
use deepshade_shaders::Effect;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::names::did_you_mean;

/// The name of truth, which is no [`Method`]: it is always rendered, and the others are measured against it.
pub const TRUTH: &str = "truth";

/// The name of the trained network's method.
pub const LEARNED: &str = "learned";

/// The method that takes minutes where others take seconds: it takes part where it is asked for.
pub const SLOW: &str = "aov";

/// The method that shows how far methods could get, which no program can run without the scene: it is none of
/// all, and takes part where it is asked for.
pub const STUDY: &str = screen_truth::NAME;

/// Where methods run that have a version for the processor beside that for adapters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Runs {
    /// Where it is faster: on the processor where the adapter is software.
    Fastest,
    /// On the adapter, whatever it is, so that times of several methods are of one device.
    OnAdapter,
}

/// What methods are opened with.
#[derive(Clone, Copy)]
pub struct Setup<'a> {
    /// The adapter that they run on.
    pub gpu: &'a Gpu,
    /// Whether all that can do.
    pub runs: Runs,
    /// The network of `learned`.
    pub model: Option<&'a Model>,
    /// How much time analytic methods may take, and what is set by hand.
    pub tuning: &'a Tuning,
}

/// A method that runs in its passes, be the adapter software.
struct InPasses(ScreenMethod);

impl Method for InPasses {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn effect(&self) -> Effect {
        self.0.effect()
    }

    fn wants_even_fog(&self) -> bool {
        self.0.wants_even_fog()
    }

    fn shade(&self, frame: &Frame<'_>, repeats: Repeats) -> Result<Shaded, MethodError> {
        self.0.shade_in_passes(frame, repeats)
    }
}

/// Effects that trained networks compute.
const OF_NETWORKS: [Effect; 12] = [
    Effect::Ao,
    Effect::Do,
    Effect::Gi,
    Effect::Ibl,
    Effect::Sss,
    Effect::Dof,
    Effect::MotionBlur,
    Effect::Aa,
    Effect::Multi,
    Effect::Path,
    Effect::PhosphorGi,
    Effect::Real,
];

/// An effect's analytic methods.
fn of_effect(effect: Effect) -> impl Iterator<Item = &'static Entry> {
    methods::all().iter().filter(move |entry| entry.effect == effect)
}

fn opened(entry: &Entry, setup: Setup<'_>) -> Result<Box<dyn Method>> {
    Ok(match (entry.open(setup.gpu, setup.tuning)?, setup.runs) {
        (Opened::Screen(method), Runs::Fastest) => method,
        (Opened::Screen(method), Runs::OnAdapter) => Box::new(InPasses(*method)),
        (Opened::Processor(method), _) => method,
    })
}

/// The network of `learned`, if it computes this effect.
fn opened_network(effect: Effect, setup: Setup<'_>) -> Result<Box<dyn Method>> {
    let model = setup.model.context("no model is given")?;
    let method = match setup.runs {
        Runs::Fastest => Learned::new(setup.gpu, model)?,
        Runs::OnAdapter => Learned::on_adapter(setup.gpu, model)?,
    };
    ensure!(method.effect() == effect, "it computes `{}`, not `{effect}`", method.effect());
    Ok(Box::new(method))
}

/// What can be set of an effect's method, in a quality; nothing of trained networks.
///
/// # Errors
/// If the effect has no method of that name; those that it has are listed.
pub fn dials(effect: Effect, name: &str, quality: Quality) -> Result<Vec<Dial>> {
    check(effect, &[name])?;
    let entry = of_effect(effect).find(|entry| entry.name == name);
    Ok(entry.map_or_else(Vec::new, |entry| entry.dials(quality)))
}

/// Opens a method that shades the screen in passes.
///
/// # Errors
/// If the effect has none of that name; those that it has are listed. If something is set that the method
/// does not have.
pub fn open_screen(effect: Effect, name: &str, gpu: &Gpu, tuning: impl Into<Tuning>) -> Result<ScreenMethod> {
    let opened = of_effect(effect)
        .find(|entry| entry.name == name)
        .map(|entry| entry.open(gpu, &tuning.into()).with_context(|| format!("method `{name}`")))
        .transpose()?;
    match opened {
        Some(Opened::Screen(method)) => Ok(*method),
        _ => {
            let known = screen_names(effect);
            let meant = did_you_mean(name, known.iter().copied());
            let known = known.join(", ");
            bail!(
                "effect `{effect}` has no method `{name}`{meant} that shades the screen in passes; there are: {known}"
            )
        }
    }
}

/// Names of an effect's methods that shade the screen in passes.
pub fn screen_names(effect: Effect) -> Vec<&'static str> {
    of_effect(effect).filter(|entry| entry.is_on_screen()).map(|entry| entry.name).collect()
}

/// Names of an effect's methods that have qualities: all but trained networks.
pub fn names_with_qualities(effect: Effect) -> Vec<&'static str> {
    of_effect(effect).map(|entry| entry.name).collect()
}

/// Opens an effect's methods by name, in the order asked for; [`TRUTH`] is passed over.
///
/// # Errors
/// If there is no such method of this effect, one cannot be opened, or it computes another effect, as the
/// network of `learned` may; all are named.
pub fn open(effect: Effect, names: &[&str], setup: Setup<'_>) -> Result<Vec<Box<dyn Method>>> {
    check(effect, names)?;
    let open = |name: &str| match of_effect(effect).find(|entry| entry.name == name) {
        Some(entry) => opened(entry, setup),
        None => opened_network(effect, setup),
    };
    let asked = names.iter().filter(|name| **name != TRUTH);
    asked.map(|name| open(name).with_context(|| format!("method `{name}`"))).collect()
}

/// Methods that go through a medium that is a grid: the others are left out and said, or refused where they
/// are asked for by name.
///
/// # Errors
/// If one that is asked for wants fog that is the same throughout, or all do; those that do not are listed.
pub fn through_grids<T>(all: Vec<T>, by_name: bool, method: impl Fn(&T) -> &dyn Method) -> Result<Vec<T>> {
    let name = |entry: &&T| method(entry).name();
    let (unfit, fit): (Vec<&T>, Vec<&T>) = all.iter().partition(|entry| method(entry).wants_even_fog());
    let [unfit, fit] = [unfit, fit].map(|entries| entries.iter().map(name).collect::<Vec<_>>().join(", "));
    if unfit.is_empty() {
        return Ok(all);
    }
    let what = "fog that is the same throughout, and here it is a grid";
    ensure!(!by_name && !fit.is_empty(), "{unfit}: for {what}");
    note!("without {unfit}: for {what}");
    Ok(all.into_iter().filter(|entry| !method(entry).wants_even_fog()).collect())
}

/// Whether an effect has all of these methods, each named once.
///
/// # Errors
/// If one is unknown or named twice; what there is, is listed.
pub fn check(effect: Effect, names: &[&str]) -> Result<()> {
    let known = names_of(effect);
    for (index, name) in names.iter().enumerate() {
        if !known.contains(name) {
            bail!("{}", unknown(effect, name));
        }
        if names[..index].contains(name) {
            bail!("method `{name}` is asked for twice");
        }
    }
    Ok(())
}

/// What is said of a name that is none of an effect's methods.
pub fn unknown(effect: Effect, name: &str) -> String {
    let known = names_of(effect);
    let meant = did_you_mean(name, known.iter().copied());
    format!("effect `{effect}` has no method `{name}`{meant}; there are {}", known.join(", "))
}

/// Names of an effect's methods, and of truth.
pub fn names_of(effect: Effect) -> Vec<&'static str> {
    let learned = OF_NETWORKS.contains(&effect).then_some(LEARNED);
    learned.into_iter().chain(names_with_qualities(effect)).chain([TRUTH]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::{ChannelOrder, NetSpec, Reach, Weights};
    use deepshade_render::bvh::TracedScene;
    use deepshade_render::gbuffer;
    use deepshade_render::methods::dials::Changes;
    use deepshade_render::scene::{Camera, Material, Mesh, Scene, SceneSource};
    use deepshade_shaders::Attribute;
    use glam::Vec3;

    fn checked(names: &[&str]) -> Result<(), String> {
        check(Effect::Ao, names).map_err(|error| error.to_string())
    }

    #[test]
    fn methods_that_do_not_exist_are_named_with_those_that_do() {
        assert_eq!(checked(&["learned", "hbao", "truth"]), Ok(()));
        let error = checked(&["hbao", "ssao"]).expect_err("no such method");
        assert_eq!(
            error,
            format!("effect `ao` has no method `ssao`; there are {}", names_of(Effect::Ao).join(", "))
        );
        assert!(checked(&["hbao", "hbao"]).expect_err("twice").contains("twice"));
        let error = checked(&["gtoa"]).expect_err("mistyped");
        assert!(
            error.starts_with("effect `ao` has no method `gtoa` (did you mean `gtao`?); there are "),
            "{error}"
        );
    }

    /// A floor whose far edge is in view, with nothing behind it.
    fn floor() -> TracedScene {
        let positions =
            [(-2., 0.), (2., 0.), (2., -4.), (-2., -4.)].map(|(x, z)| Vec3::new(x, 0.0, z)).to_vec();
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
        let scene =
            Scene { meshes: vec![mesh].into(), materials: vec![Material::default()], ..Scene::default() };
        TracedScene::new(scene).expect("a scene")
    }

    #[test]
    fn every_method_opens_under_its_name_and_leaves_the_background_alone() {
        let gpu = Gpu::new().expect("an adapter");
        let reach = Reach { radius: 1.0, diagonal_share: 0.1, height: 24 };
        let spec = NetSpec::ao(ChannelOrder::Interleaved, reach);
        let model = Model { weights: Weights::random(&spec, 1), spec };
        let names = names_of(Effect::Ao);
        let setup =
            Setup { gpu: &gpu, runs: Runs::Fastest, model: Some(&model), tuning: &Quality::High.into() };
        let methods = open(Effect::Ao, &names, setup).expect("methods");
        let opened: Vec<&str> = methods.iter().map(|method| method.name()).collect();
        assert_eq!(opened, names[..names.len() - 1]);

        let scene = floor();
        let camera = Camera::look_at(Vec3::new(0.3, 1.0, 1.0), Vec3::new(0.0, 0.4, -4.0));
        let gbuffer = gbuffer::render(&scene, &camera, 24, 40, &Attribute::ALL);
        let valid = gbuffer.select(&[Attribute::Valid]).expect("a mask");
        let seen = valid.data().iter().filter(|valid| **valid == 1.0).count();
        assert!(seen > 100 && seen < 24 * 40 - 100, "{seen}");
        let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius: 0.5, seed: 1 };
        for method in methods {
            let shaded = method.shade(&frame, Repeats::ONCE).expect("an image");
            assert!(shaded.image.same_shape(&valid), "{}", method.name());
            let pairs = || shaded.image.data().iter().zip(valid.data());
            assert!(pairs().all(|(value, valid)| *valid == 1.0 || *value == 1.0), "{}", method.name());
            assert!(shaded.image.data().iter().all(|value| value.is_finite()), "{}", method.name());
        }
    }

    #[test]
    fn methods_whose_times_stand_side_by_side_run_on_one_device() {
        let gpu = Gpu::new().expect("an adapter");
        let reach = Reach { radius: 1.0, diagonal_share: 0.1, height: 24 };
        let spec = NetSpec::ao(ChannelOrder::Interleaved, reach);
        let model = Model { weights: Weights::random(&spec, 1), spec };
        let scene = floor();
        let camera = Camera::look_at(Vec3::new(0.3, 1.0, 1.0), Vec3::new(0.0, 0.4, -4.0));
        let gbuffer = gbuffer::render(&scene, &camera, 24, 40, &Attribute::ALL);
        let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius: 0.5, seed: 1 };
        let shaded = |runs| {
            let setup = Setup { gpu: &gpu, runs, model: Some(&model), tuning: &Quality::High.into() };
            let methods = open(Effect::Ao, &[LEARNED, "gtao", "hbao"], setup).expect("methods");
            methods.iter().map(|method| method.shade(&frame, Repeats::ONCE).expect("an image")).collect()
        };
        let [adapter, fastest]: [Vec<Shaded>; 2] = [Runs::OnAdapter, Runs::Fastest].map(shaded);
        assert!(adapter.iter().all(|shaded| shaded.device == gpu.info.name));
        for (one, other) in adapter.iter().zip(&fastest) {
            let pairs = one.image.data().iter().zip(other.image.data());
            let far = pairs.filter(|(a, b)| (*a - *b).abs() > 0.02).count();
            assert!(far * 50 < one.image.data().len(), "{far} pixels are others on {}", other.device);
        }
        // Where the adapter is software the processor is faster, so that only what is stated keeps them
        // together.
        let on_processor = fastest.iter().filter(|shaded| shaded.device != gpu.info.name).count();
        assert_eq!(on_processor, if gpu.is_software() { 2 } else { 0 });
    }

    #[test]
    fn every_number_of_every_method_can_be_set_and_its_quality_is_within_range() {
        for entry in methods::all() {
            for quality in Quality::ALL {
                let what = format!("{} of {} at {}", entry.name, entry.effect, quality.name());
                let dials = dials(entry.effect, entry.name, quality).expect("a method");
                assert_eq!(dials.is_empty(), entry.name == SLOW, "{what}");
                for dial in dials {
                    let [least, most] = dial.range;
                    assert!(least < most && (least..=most).contains(&dial.usual), "{what}: {dial:?}");
                    assert!(!dial.text.is_empty() && !dial.text.contains("[`"), "{what}: {dial:?}");
                }
            }
        }
        assert!(dials(Effect::Ao, LEARNED, Quality::High).expect("a network").is_empty());
        assert!(dials(Effect::Ao, "ssao", Quality::High).is_err());
    }

    #[test]
    fn a_number_that_is_set_changes_the_image_and_one_that_is_not_there_is_refused() {
        let gpu = Gpu::new().expect("an adapter");
        let stairs: SceneSource = "stairs:7".parse().expect("a family");
        let scene = TracedScene::new(stairs.scene(0.0).expect("a scene")).expect("a scene");
        let camera = Camera::look_at(Vec3::new(0.3, 1.0, 1.0), Vec3::new(0.0, 0.4, -4.0));
        let gbuffer = gbuffer::render(&scene, &camera, 24, 40, &Attribute::ALL);
        let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius: 0.5, seed: 1 };
        let image = |name: &str, value: f64| {
            let changes = Changes([(name.to_owned(), value.into())].into());
            let tuning = Tuning { quality: Quality::Low, changes };
            let setup = Setup { gpu: &gpu, runs: Runs::Fastest, model: None, tuning: &tuning };
            let method = open(Effect::Ao, &["hbao"], setup)?.remove(0);
            Ok::<_, anyhow::Error>(method.shade(&frame, Repeats::ONCE)?.image)
        };
        let usual = image("strength", 1.3).expect("an image");
        assert!(image("directions", 4.0).expect("an image") == usual, "what it is anyway");
        assert!(image("strength", 0.2).expect("an image") != usual, "less of the shadow");
        let error = format!("{:#}", image("strenght", 1.0).expect_err("no such number"));
        assert!(
            error.contains("no parameter `strenght` (did you mean `strength`?); there are: bias"),
            "{error}"
        );
    }

    #[test]
    fn the_learned_method_needs_a_model() {
        let gpu = Gpu::new().expect("an adapter");
        let setup = Setup { gpu: &gpu, runs: Runs::Fastest, model: None, tuning: &Quality::High.into() };
        let error = open(Effect::Ao, &["learned"], setup).err().expect("no model");
        assert_eq!(format!("{error:#}"), "method `learned`: no model is given");
    }

    #[test]
    fn every_network_that_is_laid_out_can_be_asked_for() {
        let reach = Reach { radius: 1.0, diagonal_share: 0.1, height: 24 };
        for effect in Effect::ALL {
            let published = NetSpec::published(effect, ChannelOrder::Interleaved, reach).is_some();
            let is_laid_out = published || NetSpec::corrected(effect, 4, Vec::new(), reach).is_some();
            assert_eq!(names_of(effect).contains(&LEARNED), is_laid_out, "{effect}");
        }
    }

    #[test]
    fn figures_of_methods_cannot_collide() {
        let names = names_of(Effect::Ao);
        assert!(!names.contains(&"ceiling") && !names.contains(&"white"));
    }
}
