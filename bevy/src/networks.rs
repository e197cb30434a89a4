//! The networks on Bevy's device, each loaded and compiled when a camera first asks for it.

use crate::LearnedError;
use crate::effect::LearnedEffect;
use bevy::platform::collections::HashMap;
use bevy::prelude::Resource;
use deepshade_infer::forward::{ImagePass, InputPasses, Options};
use deepshade_infer::{Model, NetSpec, Network};
use deepshade_render::methods::estimate::Estimator;
use deepshade_render::screen::ScreenMethod;
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::Gpu;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Networks by their folders.
#[derive(Resource)]
pub(crate) struct Networks {
    models: PathBuf,
    /// Those that cameras have asked for, also where there is none: then it is not tried again.
    loaded: HashMap<&'static str, Result<Arc<DeviceNetwork>, Arc<LearnedError>>>,
}

/// A network with what runs before and after it, on a device.
pub(crate) struct DeviceNetwork {
    pub gpu: Gpu,
    pub spec: NetSpec,
    /// The methods whose images it reads.
    pub estimates: Vec<(Estimator, ScreenMethod)>,
    pub input: InputPasses,
    pub network: Network,
    pub image: ImagePass,
}

impl Networks {
    /// Those in the folders of a folder; none is loaded yet.
    pub fn new(models: PathBuf) -> Self {
        Self { models, loaded: HashMap::default() }
    }

    /// The network that a component asks for. The first time this takes as long as its kernels take to be
    /// compiled.
    ///
    /// # Errors
    /// If it is not there, is none of the component's effect, or the device refuses.
    pub fn of<E: LearnedEffect>(
        &mut self,
        wanted: &E,
        gpu: &Gpu,
    ) -> Result<Arc<DeviceNetwork>, Arc<LearnedError>> {
        let folder = wanted.folder();
        let load = || {
            let loaded = DeviceNetwork::load::<E>(&self.models.join(folder), gpu);
            loaded.map(Arc::new).map_err(Arc::new)
        };
        self.loaded.entry(folder).or_insert_with(load).clone()
    }
}

impl DeviceNetwork {
    fn load<E: LearnedEffect>(folder: &Path, gpu: &Gpu) -> Result<Self, LearnedError> {
        let Model { spec, weights } = Model::load(folder)?;
        if spec.effect != E::EFFECT {
            let (effect, wanted) = (spec.effect, E::EFFECT);
            return Err(LearnedError::Effect { folder: folder.to_owned(), effect, wanted });
        }
        if spec.runs() != 1 {
            return Err(LearnedError::Mono { folder: folder.to_owned() });
        }
        let device = &gpu.device;
        let mut estimates = Vec::new();
        for estimate in &spec.estimates {
            let estimator =
                Estimator::named(estimate.effect(spec.effect), &estimate.method, &estimate.quality)?;
            let method = estimator.on(gpu);
            estimates.push((estimator, method));
        }
        let input = InputPasses::new(device, &spec)?;
        let made: Vec<Attribute> = estimates.iter().flat_map(|(made, _)| made.makes()).copied().collect();
        let of_methods = estimates.iter().flat_map(|(estimator, _)| estimator.reads()).copied();
        let of_network = input.reads().into_iter().filter(|attribute| !made.contains(attribute));
        if let Some(hidden) = of_network.chain(of_methods).find(|attribute| !E::SHOWN.contains(attribute)) {
            return Err(LearnedError::Attribute { folder: folder.to_owned(), attribute: hidden.name() });
        }
        let network = Network::with(device, &spec, &weights, &Options::default())?;
        let image = ImagePass::new(device, &spec)?;
        Ok(Self { gpu: gpu.clone(), spec, estimates, input, network, image })
    }
}
