//! The list of all analytic methods. What is known of them elsewhere follows from it.

use super::bounced_z as rays;
use super::dials::{self, Dial, DialError, Tunable, Tuning};
use super::disks::{ByDisks, DiskEffect, Disks};
use super::lpv::{self, in_medium::InMedium};
use super::shafts::{Integration, Shafts};
use super::subsurface::FromScreen;
use super::{
    Quality, aov, composed, epipolar, epipolar_sampling, fog_march, froxel, fxaa, gather, gpu_epipolar, gtao,
    hbao, min_max, occluded_gather, occluded_prefiltered, phosphor, prefiltered, ray_march, reconstruction,
    ring_gather, screen_truth, separable, ssdo, ssgi, surfel, volume_shell,
};
use crate::method::Method;
use crate::screen::{ScreenMethod, Technique};
use deepshade_shaders::Effect;
use deepshade_shaders::gpu::Gpu;
use std::convert::identity;
use std::sync::{Arc, LazyLock};

/// A method that can be asked for by name.
pub struct Entry {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it computes.
    pub effect: Effect,
    dials: Box<dyn Fn(Quality) -> Vec<Dial> + Send + Sync>,
    /// Of one that shades the screen in passes.
    technique: Option<Box<AtQuality>>,
    open: Box<Opening>,
}

/// What a method is at a quality.
type AtQuality = dyn Fn(Quality) -> Arc<dyn Technique> + Send + Sync;

/// How a method is opened, on an adapter, with what is set.
type Opening = dyn Fn(&Gpu, &Tuning) -> Result<Opened, DialError> + Send + Sync;

/// A method that was opened.
pub enum Opened {
    /// One that shades the screen in passes.
    Screen(Box<ScreenMethod>),
    /// One that runs on the processor.
    Processor(Box<dyn Method>),
}

impl Entry {
    /// What can be set of it, in a quality.
    pub fn dials(&self, quality: Quality) -> Vec<Dial> {
        (self.dials)(quality)
    }

    /// Whether it shades the screen in passes.
    pub const fn is_on_screen(&self) -> bool {
        self.technique.is_some()
    }

    /// What it is at a quality, apart from a device; none of one that does not shade the screen in passes.
    pub fn technique(&self, quality: Quality) -> Option<Arc<dyn Technique>> {
        self.technique.as_ref().map(|technique| technique(quality))
    }

    /// The method, on an adapter if it shades the screen in passes.
    ///
    /// # Errors
    /// If something is set that the method does not have.
    pub fn open(&self, gpu: &Gpu, tuning: &Tuning) -> Result<Opened, DialError> {
        (self.open)(gpu, tuning)
    }
}

/// All of them.
pub fn all() -> &'static [Entry] {
    static ALL: LazyLock<Vec<Entry>> = LazyLock::new(entries);
    &ALL
}

/// A new method is a line here.
fn entries() -> Vec<Entry> {
    vec![
        screen(gtao::GtaoParameters::of, identity),
        screen(hbao::HbaoParameters::of, identity),
        disks(surfel::SurfelParameters::of, surfel::occlusion::OCCLUSION),
        disks(rays::BouncedZParameters::of, rays::occlusion::OCCLUSION),
        screen(|_| aov::Volumes, identity),
        screen(aov::bounced::AovBouncedZParameters::of, identity),
        screen(ssdo::SsdoParameters::of, identity),
        disks(surfel::SurfelParameters::of, surfel::directional::DIRECTIONAL),
        disks(rays::BouncedZParameters::of, rays::directional::DIRECTIONAL),
        screen(ssgi::SsgiParameters::of, identity),
        disks(surfel::SurfelParameters::of, surfel::indirect::INDIRECT),
        disks(rays::BouncedZParameters::of, rays::indirect::INDIRECT),
        screen(lpv::LpvParameters::of, identity),
        screen(lpv::LpvParameters::of, InMedium::multiple),
        disks(surfel::SurfelParameters::of, surfel::glossy::GLOSSY),
        disks(rays::BouncedZParameters::of, rays::glossy::GLOSSY),
        screen(volume_shell::VolumeShellParameters::of, identity),
        screen(rays::fog::FogRaysParameters::of, identity),
        screen(lpv::LpvParameters::of, InMedium::indirect),
        screen(prefiltered::PrefilteredParameters::of, identity),
        screen(occluded_prefiltered::OccludedPrefilteredParameters::of, identity),
        screen(separable::SeparableParameters::of, identity),
        screen(gather::GatherParameters::of, identity),
        screen(separable::SeparableParameters::of, FromScreen),
        screen(gather::GatherParameters::of, FromScreen),
        disks(surfel::SurfelParameters::of, surfel::scattering::SCATTERING),
        screen(ring_gather::RingGatherParameters::of, identity),
        screen(occluded_gather::OccludedGatherParameters::of, identity),
        screen(reconstruction::ReconstructionParameters::of, identity),
        screen(fxaa::FxaaParameters::of, identity),
        screen(volume_shell::VolumeShellParameters::of, volume_shell::direct::Direct),
        screen(gpu_epipolar::GpuEpipolarParameters::of, identity),
        screen(fog_march::FogMarchParameters::of, identity),
        screen(froxel::FroxelParameters::of, identity),
        screen(composed::ComposedParameters::of, identity),
        screen(phosphor::RateEquationParameters::of, identity),
        screen(phosphor::glassner::GlassnerParameters::of, identity),
        disks(surfel::SurfelParameters::of, surfel::indirect::KEPT_LIGHT),
        disks(rays::BouncedZParameters::of, rays::indirect::KEPT_LIGHT),
        screen(lpv::LpvParameters::of, lpv::KeptLight),
        processor(screen_truth::ScreenTruthParameters::of, identity),
        shafts(epipolar::EpipolarParameters::of),
        shafts(min_max::MinMaxParameters::of),
        shafts(epipolar_sampling::EpipolarSamplingParameters::of),
        shafts(ray_march::RayMarchParameters::of),
    ]
}

/// A method that shades the screen in passes: the parameters of a quality, and what they make.
fn screen<P: Tunable + 'static, T: Technique + 'static>(
    of: fn(Quality) -> P,
    technique: impl Fn(P) -> T + Copy + Send + Sync + 'static,
) -> Entry {
    let about = technique(of(Quality::default())).about();
    Entry {
        name: about.name,
        effect: about.effect,
        dials: Box::new(move |quality| dials::dials(&of(quality))),
        technique: Some(Box::new(move |quality| Arc::new(technique(of(quality))))),
        open: Box::new(move |gpu, tuning| {
            Ok(Opened::Screen(Box::new(ScreenMethod::new(gpu, technique(tuning.parameters(of)?)))))
        }),
    }
}

/// A method by the disks that a scene is laid out as.
fn disks<P: ByDisks + Tunable + 'static>(of: fn(Quality) -> P, effect: DiskEffect<P>) -> Entry {
    screen(of, move |parameters| Disks::new(parameters, effect))
}

/// A method that runs on the processor.
fn processor<P: Tunable + 'static, M: Method + 'static>(of: fn(Quality) -> P, method: fn(P) -> M) -> Entry {
    let usual = method(of(Quality::default()));
    Entry {
        name: usual.name(),
        effect: usual.effect(),
        dials: Box::new(move |quality| dials::dials(&of(quality))),
        technique: None,
        open: Box::new(move |_, tuning| Ok(Opened::Processor(Box::new(method(tuning.parameters(of)?))))),
    }
}

/// A way to integrate scattered light as such a method.
fn shafts<P: Tunable + Integration + 'static>(of: fn(Quality) -> P) -> Entry {
    processor(of, Shafts)
}
