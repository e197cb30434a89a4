//! Who takes part in a run: methods of each effect, in their qualities, opened on the device.

use super::description::distinct;
use super::key::{Digest, file_digest};
use super::run::ComparisonRun;
use super::values::MethodChoice;
use crate::eval::rivals::{Rival, rivals};
use crate::learned;
use crate::location::Location;
use crate::methods::{self, LEARNED, Runs, TRUTH};
use anyhow::{Result, bail, ensure};
use deepshade_infer::{Model, NetSpec, Reach, TrainedUnder};
use deepshade_render::methods::dials::Tuning;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Effect, GBuffer};
use std::path::{Path, PathBuf};

/// A method that takes part.
pub struct ComparedMethod {
    /// What it computes.
    pub effect: Effect,
    /// The method, under the name that figures have for it where it is there in several qualities.
    pub rival: Rival,
    /// What pages, tables and figures call it: plainly, where that says all.
    pub label: String,
    /// What tells its images from those of another version.
    pub fingerprint: String,
    /// Where its network is, if it is one.
    network: Option<Location>,
    /// What that is.
    spec: Option<NetSpec>,
}

/// Everybody who takes part in a run.
pub struct ComparedMethods {
    /// Effect by effect.
    pub methods: Vec<ComparedMethod>,
    /// What networks say of the effects' reach.
    reaches: Vec<(Effect, Reach)>,
}

/// A network, and where it is from.
struct Network {
    location: Location,
    folder: PathBuf,
    model: Model,
}

impl ComparedMethod {
    /// The name of its files.
    pub fn file_name(&self) -> String {
        self.rival.name.replace('_', "-")
    }

    /// What is to be said of a frame that is unlike those that its network was trained on.
    pub fn outside(&self, gbuffer: &GBuffer, radius: f32) -> Option<String> {
        learned::outside(self.spec.as_ref()?, gbuffer, radius)
    }
}

impl ComparedMethods {
    /// Opens a run's methods, which are stated from here on, those too that it has by default.
    ///
    /// # Errors
    /// If there is no such network, or one is for another effect, or a method cannot be opened.
    pub fn open(run: &mut ComparisonRun, gpu: &Gpu) -> Result<Self> {
        if run.methods.is_none() {
            run.methods = Some(default_methods(run));
        }
        let (mut methods, mut reaches) = (Vec::new(), Vec::new());
        for effect in run.effects() {
            let names = methods::names_of(*effect);
            for choice in run.methods().iter().filter(|choice| names.contains(&choice.name.as_str())) {
                let network = match choice.name.as_str() {
                    TRUTH => continue,
                    LEARNED => match network(run, choice, *effect)? {
                        Some(network) => Some(network),
                        None => continue,
                    },
                    _ => None,
                };
                let opened = opened(run, choice, *effect, network.as_ref(), gpu)?;
                methods.extend(opened);
                reaches.extend(network.map(|network| (*effect, network.model.spec.reach)));
            }
        }
        let learners = methods.iter().any(|method| method.rival.method_name == LEARNED);
        if run.learns() && !learners {
            let effect = run.effects().iter().find(|effect| methods::names_of(**effect).contains(&LEARNED));
            let effect = effect.copied().unwrap_or(Effect::Ao);
            learned::network(&learned::usual_folder(effect), Some(effect))?;
            bail!("of the networks that are named none is for {effect}");
        }
        Ok(Self { methods, reaches })
    }

    /// Those who compute an effect.
    pub fn of(&self, effect: Effect) -> impl Iterator<Item = &ComparedMethod> {
        self.methods.iter().filter(move |method| method.effect == effect)
    }

    /// How far an effect reaches by its first network.
    pub fn reach(&self, effect: Effect) -> Option<Reach> {
        self.reaches.iter().find(|(of, _)| *of == effect).map(|(_, reach)| *reach)
    }

    /// The environment that an effect's first network knows by heart.
    pub fn environment(&self, effect: Effect) -> Option<&TrainedUnder> {
        self.of(effect).find_map(|one| one.spec.as_ref())?.environment.as_ref()
    }

    /// States those methods in their run that take part, so that it can be said again by name: networks with
    /// the folders that they were found in, since from another folder others would be found.
    pub fn state(&self, run: &mut ComparisonRun) {
        let takes_part = |choice: &MethodChoice| {
            choice.name == TRUTH || self.methods.iter().any(|one| one.rival.method_name == choice.name)
        };
        let methods = run.methods().iter().filter(|choice| takes_part(choice));
        let methods = methods.flat_map(|choice| match (&choice.model, &run.model) {
            (None, None) if choice.name == LEARNED => self.where_found(run, choice),
            _ => vec![choice.clone()],
        });
        run.methods = Some(distinct(methods));
        run.model = run.model.take().filter(|_| run.learns());
    }

    /// A choice of networks that nobody names, network by network.
    fn where_found(&self, run: &ComparisonRun, choice: &MethodChoice) -> Vec<MethodChoice> {
        let networks = run.effects().iter().filter_map(|effect| {
            let location = Location::Folder(learned::usual_folder(*effect));
            let takes_part = self.of(*effect).any(|one| one.network.as_ref() == Some(&location));
            takes_part.then(|| MethodChoice { model: Some(location), ..choice.clone() })
        });
        networks.collect()
    }

    /// Leaves methods of an effect out that do not go through a medium that is a grid, or refuses them where
    /// they are asked for by name.
    ///
    /// # Errors
    /// If one that is asked for wants fog that is the same throughout, or all do.
    pub fn through_grids(&mut self, effect: Effect, by_name: bool) -> Result<()> {
        let all = std::mem::take(&mut self.methods);
        let (of, others): (Vec<_>, Vec<_>) = all.into_iter().partition(|one| one.effect == effect);
        let of = methods::through_grids(of, by_name, |one| one.rival.method.as_ref())?;
        self.methods = others.into_iter().chain(of).collect();
        Ok(())
    }
}

/// Gives everybody a name of its own, and a label: the method's name where it takes part in one form only.
pub fn label(compared_by_run: &mut [ComparedMethods]) {
    name_networks(compared_by_run);
    let forms: Vec<(Effect, &str, String)> = distinct(
        compared_by_run
            .iter()
            .flat_map(|compared| &compared.methods)
            .map(|one| (one.effect, one.rival.method_name, one.rival.name.clone())),
    );
    for method in compared_by_run.iter_mut().flat_map(|compared| &mut compared.methods) {
        let name = method.rival.method_name;
        let count = forms.iter().filter(|form| (form.0, form.1) == (method.effect, name)).count();
        method.label = if count == 1 { name.to_owned() } else { method.file_name() };
    }
}

/// Where several networks of an effect take part, in whatever runs, names say which one it is: by its
/// folder's name, with a number where an earlier one's folder has the same.
fn name_networks(compared_by_run: &mut [ComparedMethods]) {
    let network = |one: &ComparedMethod| Some((one.effect, one.network.clone()?));
    let all = compared_by_run.iter().flat_map(|compared| compared.methods.iter().filter_map(network));
    let all: Vec<(Effect, Location)> = distinct(all);
    for method in compared_by_run.iter_mut().flat_map(|compared| &mut compared.methods) {
        let Some(own) = &method.network else { continue };
        let of = || all.iter().filter(|(effect, _)| *effect == method.effect).map(|(_, location)| location);
        if of().count() == 1 {
            continue;
        }
        let name = folder_name(own);
        let earlier = of()
            .take_while(|location| *location != own)
            .filter(|location| folder_name(location) == name)
            .count();
        let suffix = if earlier == 0 { name } else { format!("{name}_{}", earlier + 1) };
        method.rival.name = format!("{}_{suffix}", method.rival.name);
    }
}

/// All methods of the effects, but for [`methods::SLOW`] and [`methods::STUDY`], and for `learned` where
/// nobody names a network and none lies where it would.
fn default_methods(run: &ComparisonRun) -> Vec<MethodChoice> {
    let mut names = Vec::new();
    for effect in run.effects() {
        let mut of = methods::names_of(*effect);
        let folder = learned::usual_folder(*effect);
        if of.contains(&LEARNED) && run.model.is_none() && !folder.exists() {
            note!("no network in {}: without the method `{LEARNED}`", folder.display());
            of.retain(|name| *name != LEARNED);
        }
        names.extend(of);
    }
    let asked_for = [methods::SLOW, methods::STUDY, TRUTH];
    let names = distinct(names).into_iter().filter(|name| !asked_for.contains(name));
    names.chain([TRUTH]).map(MethodChoice::named).collect()
}

/// The network that `learned` is for an effect; none where there are several effects, or several networks, as
/// a report of several effects names them, and the network is another's, or none is there.
fn network(run: &ComparisonRun, choice: &MethodChoice, effect: Effect) -> Result<Option<Network>> {
    let networks = run.methods().iter().filter(|choice| choice.name == LEARNED).count();
    let several = run.effects().len() > 1 || networks > 1;
    let stated = choice.model.as_ref().or(run.model.as_ref());
    let location = stated.cloned().unwrap_or_else(|| Location::Folder(learned::usual_folder(effect)));
    let folder = location.read()?;
    if several && stated.is_none() && !folder.exists() {
        note!("no network in {}: {effect} without the method `{LEARNED}`", folder.display());
        return Ok(None);
    }
    let model = learned::network(&folder, if several { None } else { Some(effect) })?;
    let made = model.spec.effect;
    ensure!(
        networks > 1 || run.effects().contains(&made),
        "the network in {location} is for {made}, which is none of the effects"
    );
    Ok((made == effect).then_some(Network { location, folder, model }))
}

/// A method of an effect in all its qualities.
fn opened(
    run: &ComparisonRun,
    choice: &MethodChoice,
    effect: Effect,
    network: Option<&Network>,
    gpu: &Gpu,
) -> Result<Vec<ComparedMethod>> {
    let qualities = choice.qualities.as_deref().unwrap_or(run.qualities());
    let names = [choice.name.clone()];
    let changes = &choice.parameters;
    let tunings: Vec<Tuning> =
        qualities.iter().map(|quality| Tuning { quality: *quality, changes: changes.clone() }).collect();
    // Their times stand side by side.
    let device = (gpu, Runs::OnAdapter);
    let rivals = rivals(effect, &names, &tunings, device, network.map(|network| &network.model))?;
    let weights = network.map(|network| weights(&network.folder)).transpose()?;
    let methods = rivals.into_iter().map(|rival| {
        let (network, spec) =
            network.map(|network| (network.location.clone(), network.model.spec.clone())).unzip();
        let label = rival.method_name.to_owned();
        let fingerprint = format!("{} {:?} {weights:?}{changes}", rival.method_name, rival.quality);
        ComparedMethod { effect, rival, label, fingerprint, network, spec }
    });
    Ok(methods.collect())
}

/// What tells a network from another.
fn weights(folder: &Path) -> Result<String> {
    let mut digest = Digest::default();
    for file in learned::files(folder) {
        digest.say(&file_digest(&file)?);
    }
    Ok(digest.finish())
}

/// What a network's place is called, in letters that figures are named by.
fn folder_name(location: &Location) -> String {
    let location = location.to_string();
    let name = Path::new(&location).file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    name.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' }).collect()
}
