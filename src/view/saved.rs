//! What the window shows, in a folder: every image as EXR and PNG, the g-buffer, and a comparison that makes
//! them without a window.

use super::Args;
use super::display_image::{DisplayImage, rgb};
use super::method_worker::{MethodFrame, Show};
use super::window::Window;
use crate::compare::{Comparison, ComparisonRun, MethodChoice};
use crate::complete::{Additions, LAMP_ADDED};
use crate::figures::write_atomically;
use crate::location::Location;
use crate::methods::{LEARNED, TRUTH};
use crate::report::images::write_png;
use crate::views::{self, Viewpoint};
use crate::{exposure_time, learned, samples};
use anyhow::{Context, Result};
use deepshade_dataset::Radius;
use deepshade_dataset::recipe::Resolution;
use deepshade_render::exr_file::{self, Layer, Metadata};
use deepshade_render::scene::{Camera, Lens};
use deepshade_shaders::effect::EffectSetting;
use glam::Vec3;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The comparison's file.
const COMPARISON: &str = "compare.toml";
/// By how much axes of cameras differ that are the same but for rounding.
const UPRIGHT: f32 = 1e-4;
/// The g-buffer's file.
const GBUFFER: &str = "gbuffer.exr";

/// What a window shows at a moment, and how it came to be.
pub struct Snapshot {
    picture: Arc<MethodFrame>,
    truth: Option<DisplayImage>,
    /// Samples at which truth rests.
    samples: u32,
    /// Where the network that the user has chosen is from.
    model: Option<Location>,
    args: Arc<Args>,
}

impl Snapshot {
    /// Now, once there is a picture.
    pub fn of(window: &Window) -> Option<Self> {
        let picture = Arc::clone(window.results.picture.as_ref()?);
        let model = picture.request.show.model.as_deref();
        Some(Self {
            model: model.map(|folder| window.state.location_of_network(folder)),
            picture,
            truth: window.truth_of_picture().map(|truth| truth.image.clone()),
            samples: window.state.samples,
            args: Arc::clone(&window.state.args),
        })
    }
}

/// The first of `view-1`, `view-2` and so on in a folder that is not there yet, or of another name and
/// ending.
pub fn free(folder: &Path, name: &str, ending: &str) -> PathBuf {
    (1u32..)
        .map(|number| folder.join(format!("{name}-{number}{ending}")))
        .find(|path| !path.exists())
        .unwrap_or_default()
}

/// Writes what is shown into a folder.
///
/// # Errors
/// If a file cannot be written.
pub fn save(snapshot: &Snapshot, folder: &Path) -> Result<()> {
    let picture = &snapshot.picture;
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    // Before the images: what cannot be said again leaves none.
    let text = format!("{}{}", head(picture, folder), comparison(snapshot)?.keys(folder)?);
    let facts: Metadata = [
        ("scene", picture.request.show.source.to_string()),
        ("effect", picture.request.show.effect.to_string()),
        ("time", picture.request.time.to_string()),
        ("camera_position", picture.camera.position.to_string()),
        ("camera_rotation", picture.camera.rotation.to_string()),
        ("radius_metres", picture.radius.to_string()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into();
    for image in picture.images.iter().chain(&snapshot.truth).chain(&picture.inspected) {
        let layer = Layer::image(&image.name, &image.values).in_full();
        exr_file::write(&folder.join(format!("{}.exr", image.name)), &[layer], &facts)?;
        write_png(&folder.join(format!("{}.png", image.name)), &rgb(&image.picture))?;
    }
    let gbuffer = picture.gbuffer()?;
    exr_file::write(&folder.join(GBUFFER), &[Layer::gbuffer(&gbuffer)], &facts)?;
    write_atomically(&folder.join(COMPARISON), text.as_bytes())
}

/// What the comparison's file is for, and what of the window it cannot say.
fn head(picture: &MethodFrame, folder: &Path) -> String {
    let place = folder.join(COMPARISON);
    let mut lines = vec![
        "What a window showed; without it:".to_owned(),
        format!("  deepshade compare --config {} --out FOLDER", place.display()),
    ];
    if picture.lights != picture.subject.animated.scene.lights {
        lines.push("Lights are where the scene has them, not where they were dragged to.".to_owned());
    }
    if picture.request.show.glow.is_some() {
        lines.push("Surfaces glow as the scene has it, not as it was designed in the window.".to_owned());
    }
    if picture.request.show.temporal {
        lines.push("Images were mixed with those of the frames before; here they are not.".to_owned());
    }
    if picture.request.show.methods.contains(&LEARNED) && is_of_run(&picture.request.show) {
        lines.push(
            "The network is what its training run has come to: its weights may have gone on.".to_owned(),
        );
    }
    let again = view(picture).1;
    if !again.rotation.abs_diff_eq(picture.camera.rotation, UPRIGHT) {
        lines.push("The camera stands upright, and does not lean to a side as in the window.".to_owned());
    }
    if again.vertical_fov != picture.camera.vertical_fov {
        lines.push(format!(
            "The angle of view is {:.1} degrees, not the {:.1} of the window.",
            again.vertical_fov.to_degrees(),
            picture.camera.vertical_fov.to_degrees()
        ));
    }
    let (first, added) = (picture.subject.controller.camera, &picture.subject.added);
    let has_moved = (first.position, first.rotation) != (picture.camera.position, picture.camera.rotation);
    let lamp = added.iter().find(|line| line.starts_with(LAMP_ADDED));
    if let Some(lamp) = lamp.filter(|_| has_moved) {
        lines.push(
            "A lamp was added for the window's first view; one is drawn for this view here:".to_owned(),
        );
        lines.push(format!("  {lamp}"));
    }
    lines.iter().map(|line| format!("# {line}\n")).collect()
}

/// Whether a network's weights are those of a training run, which may replace them.
fn is_of_run(show: &Show) -> bool {
    show.trained.is_some() || show.model.as_deref().is_some_and(learned::is_run)
}

/// How a comparison says from where the picture is seen, and the camera that it has then: one of the file's,
/// if it is that, whose angle of view and inclination cannot be said otherwise.
fn view(picture: &MethodFrame) -> (Viewpoint, Camera) {
    let camera = picture.camera;
    let pinhole = |camera: &Camera| Camera { lens: None, ..*camera };
    let cameras = &picture.subject.animated.scene.cameras;
    let of_file = cameras.iter().find(|(_, own)| pinhole(own) == pinhole(&camera));
    let is_told = |name: &String| cameras.iter().filter(|(other, _)| other == name).count() == 1;
    if let Some((name, own)) = of_file.filter(|(name, _)| is_told(name)) {
        return (Viewpoint::named(name), *own);
    }
    // So far away that rounding turns it by next to nothing, wherever the camera stands.
    let target = camera.position - camera.rotation.z_axis * camera.position.length().max(1.0);
    (Viewpoint::looking(camera.position, target), Camera::look_at(camera.position, target))
}

/// A method with what is set by hand.
fn choice(show: &Show, name: &str) -> MethodChoice {
    MethodChoice { parameters: show.tuning(name).changes, ..MethodChoice::named(name) }
}

/// The comparison that makes what is shown: with all that the window has chosen by its first view, which is
/// another one here.
fn comparison(snapshot: &Snapshot) -> Result<Comparison> {
    let Snapshot { picture, samples, model, args, .. } = snapshot;
    let show = &picture.request.show;
    let effect = show.effect;
    let [height, width] = show.size;
    let put = args.props.all().to_vec();
    let methods = show.methods.iter().map(|name| choice(show, name));
    let network = || model.clone().unwrap_or_else(|| Location::Folder(learned::usual_folder(effect)));
    let run = ComparisonRun {
        scenes: Some(vec![show.source.clone()]),
        effects: Some(vec![effect]),
        methods: Some(methods.chain([MethodChoice::named(TRUTH)]).collect()),
        qualities: Some(vec![show.quality]),
        model: show.methods.contains(&LEARNED).then(network),
        put: (!put.is_empty()).then_some(put),
        resolution: Some(Resolution { height, width }),
        radius: effect.listens_to(EffectSetting::Radius).then_some(Radius::Metres(picture.radius)),
        ..ComparisonRun::default()
    };
    let shutter = effect.listens_to(EffectSetting::Shutter).then(|| args.shutter());
    let run = run.with_options(
        &additions(picture, args),
        &views::Args::one(view(picture).0, args.seed),
        samples::Args::new(Some(*samples), None),
        exposure_time::Args::new(Some(picture.request.time), shutter),
    );
    Comparison::new(None, |_| run.clone())
}

/// What the command line gives the scene, with the lens and the mean free path that were added.
fn additions(picture: &MethodFrame, args: &Args) -> Additions {
    let effect = picture.request.show.effect;
    let mut additions = args.additions.heard_by(effect);
    if let Some(Lens { radius, focus }) =
        picture.camera.lens.filter(|_| effect.listens_to(EffectSetting::Lens))
    {
        (additions.aperture, additions.focus) = (Some(radius), Some(focus));
    }
    // Where materials differ they are the scene's own.
    let mut metres = picture.subject.animated.scene.materials.iter().map(|material| material.mean_free_path);
    if let Some(first) = metres.next().filter(|_| effect.listens_to(EffectSetting::MeanFreePath))
        && first != Vec3::ZERO
        && metres.all(|other| other == first)
    {
        additions.mean_free_path = Some(first);
    }
    additions
}

#[cfg(test)]
mod tests;
