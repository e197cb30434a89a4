//! The list of all methods: those of `render`, and `learned`.

use crate::learned::Learned;
use anyhow::{Context, Result, bail, ensure};
use deepshade_infer::Model;
use deepshade_render::method::Method;
use deepshade_render::methods::{
    Quality, aov, bounced_z, epipolar, epipolar_sampling, fog_march, froxel, fxaa, gather, gpu_epipolar,
    gtao, hbao, lpv, min_max, phosphor, prefiltered, ray_march, reconstruction, ring_gather, separable,
    shafts::Shafts, ssdo, ssgi, subsurface, surfel, volume_shell,
};
use deepshade_render::screen::ScreenMethod;
use deepshade_shaders::Effect;
use deepshade_shaders::gpu::{Gpu, GpuError};

/// The name of truth, which is no [`Method`]: it is always rendered, and the others are measured against it.
pub const TRUTH: &str = "truth";

/// The name of the trained network's method.
pub const LEARNED: &str = "learned";

/// The method that takes minutes where others take seconds: it takes part where it is asked for.
pub const SLOW: &str = "aov";

/// What methods are opened with.
#[derive(Clone, Copy)]
pub struct Setup<'a> {
    /// Where they run.
    pub gpu: &'a Gpu,
    /// The network of `learned`.
    pub model: Option<&'a Model>,
    /// How much time analytic methods may take.
    pub quality: Quality,
}

/// A method that can be asked for by name.
struct Entry {
    name: &'static str,
    effect: Effect,
    kind: Kind,
}

/// Compiles a method for a device, at a quality.
type OpenScreen = fn(&Gpu, Quality) -> Result<Box<dyn ScreenMethod>, GpuError>;

/// Makes a method that runs on the processor, at a quality.
type OpenOnProcessor = fn(Quality) -> Box<dyn Method>;

/// How a method is opened.
enum Kind {
    /// A trained network.
    Learned,
    /// One that shades the screen in passes.
    Screen(OpenScreen),
    /// One that runs on the processor.
    Processor(OpenOnProcessor),
}

impl Entry {
    fn open(&self, setup: Setup<'_>) -> Result<Box<dyn Method>> {
        let method: Box<dyn Method> = match self.kind {
            Kind::Learned => Box::new(Learned::new(setup.gpu, setup.model.context("no model is given")?)?),
            Kind::Screen(open) => Box::new(open(setup.gpu, setup.quality)?),
            Kind::Processor(open) => open(setup.quality),
        };
        let (made, wanted) = (method.effect(), self.effect);
        ensure!(made == wanted, "it computes `{made}`, not `{wanted}`");
        Ok(method)
    }
}

/// Every method; a new one is a line here.
const ALL: [Entry; 46] = [
    learned(Effect::Ao),
    learned(Effect::Do),
    learned(Effect::Gi),
    learned(Effect::Ibl),
    learned(Effect::Sss),
    learned(Effect::Dof),
    learned(Effect::MotionBlur),
    learned(Effect::Aa),
    learned(Effect::Multi),
    learned(Effect::Real),
    screen(Effect::Ao, "gtao", |gpu, quality| {
        Ok(Box::new(gtao::Gtao::new(gpu, gtao::Parameters::of(quality))?))
    }),
    screen(Effect::Ao, "hbao", |gpu, quality| {
        Ok(Box::new(hbao::Hbao::new(gpu, hbao::Parameters::of(quality))?))
    }),
    screen(Effect::Ao, "surfel", |gpu, quality| {
        Ok(Box::new(surfel::occlusion::SurfelOcclusion::new(gpu, surfel::Parameters::of(quality).into())?))
    }),
    screen(Effect::Ao, "bounced-z", |gpu, quality| {
        Ok(Box::new(bounced_z::occlusion::BouncedOcclusion::new(
            gpu,
            bounced_z::Parameters::of(quality).into(),
        )?))
    }),
    screen(Effect::Ao, "aov", |gpu, _| Ok(Box::new(aov::OcclusionVolumes::new(gpu, aov::Volumes)?))),
    screen(Effect::Ao, "aov-bounced-z", |gpu, quality| {
        Ok(Box::new(aov::BouncedVolumes::new(gpu, aov::bounced::Parameters::of(quality))?))
    }),
    screen(Effect::Do, "ssdo", |gpu, quality| {
        Ok(Box::new(ssdo::Ssdo::new(gpu, ssdo::Parameters::of(quality))?))
    }),
    screen(Effect::Do, "surfel", |gpu, quality| {
        Ok(Box::new(surfel::directional::SurfelDirectional::new(
            gpu,
            surfel::Parameters::of(quality).into(),
        )?))
    }),
    screen(Effect::Gi, "ssgi", |gpu, quality| {
        Ok(Box::new(ssgi::Ssgi::new(gpu, ssgi::Parameters::of(quality))?))
    }),
    screen(Effect::Gi, "surfel", |gpu, quality| {
        Ok(Box::new(surfel::indirect::SurfelIndirect::new(gpu, surfel::Parameters::of(quality).into())?))
    }),
    screen(Effect::Gi, "bounced-z", |gpu, quality| {
        Ok(Box::new(bounced_z::indirect::BouncedIndirect::new(
            gpu,
            bounced_z::Parameters::of(quality).into(),
        )?))
    }),
    screen(Effect::Gi, "lpv", |gpu, quality| {
        Ok(Box::new(lpv::LightVolume::new(gpu, lpv::Parameters::of(quality))?))
    }),
    screen(Effect::FogMultiple, "lpv", |gpu, quality| {
        let parameters = lpv::Parameters::of(quality);
        Ok(Box::new(lpv::in_medium::MultipleScattering::new(gpu, lpv::in_medium::Multiple(parameters))?))
    }),
    screen(Effect::Glossy, "surfel", |gpu, quality| {
        Ok(Box::new(surfel::glossy::SurfelGlossy::new(gpu, surfel::Parameters::of(quality).into())?))
    }),
    screen(Effect::Glossy, "bounced-z", |gpu, quality| {
        Ok(Box::new(bounced_z::glossy::BouncedGlossy::new(gpu, bounced_z::Parameters::of(quality).into())?))
    }),
    screen(Effect::FogIndirect, "volume-shell", |gpu, quality| {
        Ok(Box::new(volume_shell::VolumeShell::new(gpu, volume_shell::Parameters::of(quality))?))
    }),
    screen(Effect::FogIndirect, "lpv", |gpu, quality| {
        let medium = lpv::passes::Pixel { medium: true, surface: false };
        let indirect = lpv::in_medium::Indirect(lpv::Parameters::of(quality), medium);
        Ok(Box::new(lpv::in_medium::IndirectScattering::new(gpu, indirect)?))
    }),
    screen(Effect::Ibl, "prefiltered", |gpu, quality| {
        Ok(Box::new(prefiltered::Prefiltered::new(gpu, prefiltered::Parameters::of(quality))?))
    }),
    screen(Effect::Sss, "separable", |gpu, quality| {
        Ok(Box::new(separable::Separable::new(gpu, separable::Parameters::of(quality))?))
    }),
    screen(Effect::Sss, "gather", |gpu, quality| {
        Ok(Box::new(gather::Gather::new(gpu, gather::Parameters::of(quality))?))
    }),
    screen(Effect::Subsurface, "separable", |gpu, quality| {
        Ok(Box::new(subsurface::SeparableSubsurface::new(
            gpu,
            subsurface::FromScreen(separable::Parameters::of(quality)),
        )?))
    }),
    screen(Effect::Subsurface, "gather", |gpu, quality| {
        Ok(Box::new(subsurface::GatherSubsurface::new(
            gpu,
            subsurface::FromScreen(gather::Parameters::of(quality)),
        )?))
    }),
    screen(Effect::Subsurface, "surfel", |gpu, quality| {
        Ok(Box::new(surfel::scattering::SurfelScattering::new(gpu, surfel::Parameters::of(quality).into())?))
    }),
    screen(Effect::Dof, "ring-gather", |gpu, quality| {
        Ok(Box::new(ring_gather::RingGather::new(gpu, ring_gather::Parameters::of(quality))?))
    }),
    screen(Effect::MotionBlur, "reconstruction", |gpu, quality| {
        Ok(Box::new(reconstruction::Reconstruction::new(gpu, reconstruction::Parameters::of(quality))?))
    }),
    screen(Effect::Aa, "fxaa", |gpu, quality| {
        Ok(Box::new(fxaa::Fxaa::new(gpu, fxaa::Parameters::of(quality))?))
    }),
    screen(Effect::FogDirect, "volume-shell", |gpu, quality| {
        let parameters = volume_shell::Parameters::of(quality);
        Ok(Box::new(volume_shell::direct::VolumeShellDirect::new(gpu, parameters.into())?))
    }),
    screen(Effect::FogDirect, "gpu-epipolar", |gpu, quality| {
        Ok(Box::new(gpu_epipolar::GpuEpipolar::new(gpu, gpu_epipolar::Parameters::of(quality))?))
    }),
    screen(Effect::FogDirect, "gpu-march", |gpu, quality| {
        Ok(Box::new(fog_march::FogMarch::new(gpu, fog_march::Parameters::of(quality))?))
    }),
    screen(Effect::FogDirect, "froxel", |gpu, quality| {
        Ok(Box::new(froxel::Froxel::new(gpu, froxel::Parameters::of(quality))?))
    }),
    screen(Effect::Phosphor, "rate-equation", |gpu, quality| {
        Ok(Box::new(phosphor::RateEquation::new(gpu, phosphor::Parameters::of(quality))?))
    }),
    screen(Effect::Phosphor, "glassner", |gpu, quality| {
        Ok(Box::new(phosphor::glassner::Glassner::new(gpu, phosphor::glassner::Parameters::of(quality))?))
    }),
    processor(Effect::FogDirect, "epipolar", |quality| Box::new(Shafts(epipolar::Parameters::of(quality)))),
    processor(Effect::FogDirect, "min-max", |quality| Box::new(Shafts(min_max::Parameters::of(quality)))),
    processor(Effect::FogDirect, "epipolar-sampling", |quality| {
        Box::new(Shafts(epipolar_sampling::Parameters::of(quality)))
    }),
    processor(Effect::FogDirect, "ray-march", |quality| Box::new(Shafts(ray_march::Parameters::of(quality)))),
];

/// A trained network for an effect.
const fn learned(effect: Effect) -> Entry {
    Entry { name: LEARNED, effect, kind: Kind::Learned }
}

/// A method that shades the screen in passes.
const fn screen(effect: Effect, name: &'static str, open: OpenScreen) -> Entry {
    Entry { name, effect, kind: Kind::Screen(open) }
}

/// A method that runs on the processor.
const fn processor(effect: Effect, name: &'static str, open: OpenOnProcessor) -> Entry {
    Entry { name, effect, kind: Kind::Processor(open) }
}

/// Opens a method that shades the screen in passes.
///
/// # Errors
/// If the effect has none of that name; those that it has are listed.
pub fn open_screen(effect: Effect, name: &str, gpu: &Gpu, quality: Quality) -> Result<Box<dyn ScreenMethod>> {
    let found = ALL.iter().find_map(|entry| match entry.kind {
        Kind::Screen(open) if entry.effect == effect && entry.name == name => Some(open),
        _ => None,
    });
    let known = screen_names(effect).join(", ");
    let open = found.with_context(|| {
        format!(
            "effect `{effect}` has no method `{name}` that shades the screen in passes; there are: {known}"
        )
    })?;
    Ok(open(gpu, quality)?)
}

/// Names of an effect's methods that shade the screen in passes.
pub fn screen_names(effect: Effect) -> Vec<&'static str> {
    let entries = ALL.iter().filter(|entry| entry.effect == effect && matches!(entry.kind, Kind::Screen(_)));
    entries.map(|entry| entry.name).collect()
}

/// Names of an effect's methods that have qualities: all but trained networks.
pub fn names_with_qualities(effect: Effect) -> Vec<&'static str> {
    let entries = ALL.iter().filter(|entry| entry.effect == effect && !matches!(entry.kind, Kind::Learned));
    entries.map(|entry| entry.name).collect()
}

/// Opens an effect's methods by name, in the order asked for; [`TRUTH`] is passed over.
///
/// # Errors
/// If there is no such method of this effect, one cannot be opened, or it computes another effect, as the network of
/// `learned` may; all are named.
pub fn open(effect: Effect, names: &[&str], setup: Setup<'_>) -> Result<Vec<Box<dyn Method>>> {
    check(effect, names)?;
    let asked = |entry: &&Entry, name: &str| entry.effect == effect && entry.name == name;
    names
        .iter()
        .filter_map(|name| ALL.iter().find(|entry| asked(entry, name)))
        .map(|entry| entry.open(setup).with_context(|| format!("method `{}`", entry.name)))
        .collect()
}

/// Methods that go through a medium that is a grid: the others are left out and said, or refused where they are asked for by
/// name.
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
            bail!("effect `{effect}` has no method `{name}`; there are {}", known.join(", "));
        }
        if names[..index].contains(name) {
            bail!("method `{name}` is asked for twice");
        }
    }
    Ok(())
}

/// Names of an effect's methods, and of truth.
pub fn names_of(effect: Effect) -> Vec<&'static str> {
    ALL.iter().filter(|entry| entry.effect == effect).map(|entry| entry.name).chain([TRUTH]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::{ChannelOrder, NetSpec, Reach, Weights};
    use deepshade_render::bvh::TracedScene;
    use deepshade_render::gbuffer;
    use deepshade_render::method::{Frame, Repeats};
    use deepshade_render::scene::{Camera, Material, Mesh, Scene};
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
            "effect `ao` has no method `ssao`; there are learned, gtao, hbao, surfel, bounced-z, aov, aov-bounced-z, truth"
        );
        assert!(checked(&["hbao", "hbao"]).expect_err("twice").contains("twice"));
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
        let setup = Setup { gpu: &gpu, model: Some(&model), quality: Quality::High };
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
    fn the_learned_method_needs_a_model() {
        let gpu = Gpu::new().expect("an adapter");
        let setup = Setup { gpu: &gpu, model: None, quality: Quality::High };
        let error = open(Effect::Ao, &["learned"], setup).err().expect("no model");
        assert_eq!(format!("{error:#}"), "method `learned`: no model is given");
    }

    #[test]
    fn every_published_network_can_be_asked_for() {
        let reach = Reach { radius: 1.0, diagonal_share: 0.1, height: 24 };
        for effect in Effect::ALL {
            let published = NetSpec::published(effect, ChannelOrder::Interleaved, reach).is_some();
            assert_eq!(names_of(effect).contains(&LEARNED), published, "{effect}");
        }
    }

    #[test]
    fn figures_of_methods_cannot_collide() {
        let names = names_of(Effect::Ao);
        assert!(!names.contains(&"ceiling") && !names.contains(&"white"));
    }
}
