//! The list of all analytic methods. What is known of them elsewhere follows from it.

use super::bounced_z as rays;
use super::dials::{self, Dial, DialError, Tunable, Tuning};
use super::disks::{ByDisks, DiskEffect, Disks};
use super::lpv::{self, in_medium::InMedium};
use super::shafts::{Integration, Shafts};
use super::subsurface::FromScreen;
use super::{
    Quality, aov, epipolar, epipolar_sampling, fog_march, froxel, fxaa, gather, gpu_epipolar, gtao, hbao,
    min_max, phosphor, prefiltered, ray_march, reconstruction, ring_gather, screen_truth, separable, ssdo,
    ssgi, surfel, volume_shell,
};
use crate::method::Method;
use crate::screen::{ScreenMethod, Technique};
use deepshade_shaders::Effect;
use deepshade_shaders::gpu::Gpu;
use std::convert::identity;
use std::sync::LazyLock;

/// A method that can be asked for by name.
pub struct Entry {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it computes.
    pub effect: Effect,
    /// Whether it shades the screen in passes.
    pub is_on_screen: bool,
    dials: Box<dyn Fn(Quality) -> Vec<Dial> + Send + Sync>,
    open: Box<Opening>,
}

/// How a method is opened, on an adapter, with what is set.
type Opening = dyn Fn(&Gpu, &Tuning) -> Result<Opened, DialError> + Send + Sync;

/// A method that was opened.
pub enum Opened {
    /// One that shades the screen in passes.
    Screen(ScreenMethod),
    /// One that runs on the processor.
    Processor(Box<dyn Method>),
}

impl Entry {
    /// What can be set of it, in a quality.
    pub fn dials(&self, quality: Quality) -> Vec<Dial> {
        (self.dials)(quality)
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
        screen(gtao::Parameters::of, identity),
        screen(hbao::Parameters::of, identity),
        disks(surfel::Parameters::of, surfel::occlusion::OCCLUSION),
        disks(rays::Parameters::of, rays::occlusion::OCCLUSION),
        screen(|_| aov::Volumes, identity),
        screen(aov::bounced::Parameters::of, identity),
        screen(ssdo::Parameters::of, identity),
        disks(surfel::Parameters::of, surfel::directional::DIRECTIONAL),
        screen(ssgi::Parameters::of, identity),
        disks(surfel::Parameters::of, surfel::indirect::INDIRECT),
        disks(rays::Parameters::of, rays::indirect::INDIRECT),
        screen(lpv::Parameters::of, identity),
        screen(lpv::Parameters::of, InMedium::multiple),
        disks(surfel::Parameters::of, surfel::glossy::GLOSSY),
        disks(rays::Parameters::of, rays::glossy::GLOSSY),
        screen(volume_shell::Parameters::of, identity),
        screen(lpv::Parameters::of, InMedium::indirect),
        screen(prefiltered::Parameters::of, identity),
        screen(separable::Parameters::of, identity),
        screen(gather::Parameters::of, identity),
        screen(separable::Parameters::of, FromScreen),
        screen(gather::Parameters::of, FromScreen),
        disks(surfel::Parameters::of, surfel::scattering::SCATTERING),
        screen(ring_gather::Parameters::of, identity),
        screen(reconstruction::Parameters::of, identity),
        screen(fxaa::Parameters::of, identity),
        screen(volume_shell::Parameters::of, volume_shell::direct::Direct),
        screen(gpu_epipolar::Parameters::of, identity),
        screen(fog_march::Parameters::of, identity),
        screen(froxel::Parameters::of, identity),
        screen(phosphor::Parameters::of, identity),
        screen(phosphor::glassner::Parameters::of, identity),
        disks(surfel::Parameters::of, surfel::indirect::KEPT_LIGHT),
        disks(rays::Parameters::of, rays::indirect::KEPT_LIGHT),
        screen(lpv::Parameters::of, lpv::KeptLight),
        processor(screen_truth::Parameters::of, identity),
        shafts(epipolar::Parameters::of),
        shafts(min_max::Parameters::of),
        shafts(epipolar_sampling::Parameters::of),
        shafts(ray_march::Parameters::of),
    ]
}

/// A method that shades the screen in passes: the parameters of a quality, and what they make.
fn screen<P: Tunable + 'static, T: Technique + 'static>(
    of: fn(Quality) -> P,
    technique: impl Fn(P) -> T + Send + Sync + 'static,
) -> Entry {
    let about = technique(of(Quality::default())).about();
    Entry {
        name: about.name,
        effect: about.effect,
        is_on_screen: true,
        dials: Box::new(move |quality| dials::dials(&of(quality))),
        open: Box::new(move |gpu, tuning| {
            Ok(Opened::Screen(ScreenMethod::new(gpu, technique(tuning.parameters(of)?))))
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
        is_on_screen: false,
        dials: Box::new(move |quality| dials::dials(&of(quality))),
        open: Box::new(move |_, tuning| Ok(Opened::Processor(Box::new(method(tuning.parameters(of)?))))),
    }
}

/// A way to integrate scattered light as such a method.
fn shafts<P: Tunable + Integration + 'static>(of: fn(Quality) -> P) -> Entry {
    processor(of, Shafts)
}
