//! What the window shows, in a folder: every image as EXR and PNG, and a comparison that makes them without a window.

use super::Args;
use super::pictures::Developed;
use super::studio::{Picture, Show};
use super::window::Window;
use crate::compare::{Comparison, MethodChoice, Run};
use crate::figures::write_atomically;
use crate::place::Place;
use crate::report::images::write_png;
use crate::{exposure_time, samples, views};
use anyhow::{Context, Result};
use deepshade_dataset::Radius;
use deepshade_dataset::recipe::Resolution;
use deepshade_render::exr_file::{self, Layer, Metadata};
use deepshade_render::scene::Camera;
use image::{Rgb, RgbImage};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The comparison's file.
const COMPARISON: &str = "compare.toml";

/// What a window shows at a moment, and how it came to be.
pub struct Moment {
    picture: Arc<Picture>,
    truth: Option<Developed>,
    /// Samples at which truth rests.
    samples: u32,
    args: Arc<Args>,
}

impl Moment {
    /// Now, once there is a picture.
    pub fn of(window: &Window) -> Option<Self> {
        Some(Self {
            picture: Arc::clone(window.picture.as_ref()?),
            truth: window.truth_of_picture().map(|truth| truth.image.clone()),
            samples: window.state.samples,
            args: Arc::clone(&window.state.args),
        })
    }
}

/// The first folder `view-1`, `view-2` and so on that is not there yet, or of another name.
pub fn free_folder(name: &str) -> PathBuf {
    (1u32..)
        .map(|number| PathBuf::from(format!("{name}-{number}")))
        .find(|path| !path.exists())
        .unwrap_or_default()
}

/// Writes what is shown into a folder.
///
/// # Errors
/// If a file cannot be written.
pub fn save(moment: &Moment, folder: &Path) -> Result<()> {
    let picture = &moment.picture;
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let facts: Metadata = [
        ("scene", picture.order.show.source.to_string()),
        ("effect", picture.order.show.effect.to_string()),
        ("time", picture.order.time.to_string()),
        ("camera_position", picture.camera.position.to_string()),
        ("camera_rotation", picture.camera.rotation.to_string()),
        ("radius_metres", picture.radius.to_string()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into();
    for image in picture.images.iter().chain(&moment.truth).chain(&picture.inspected) {
        let layer = Layer::image(&image.name, &image.values).in_full();
        exr_file::write(&folder.join(format!("{}.exr", image.name)), &[layer], &facts)?;
        let [width, height] = image.picture.size.map(|side| side as u32);
        let pixel = |x: u32, y: u32| image.picture.pixels[(y * width + x) as usize].to_array();
        let png = RgbImage::from_fn(width, height, |x, y| {
            let [red, green, blue, _] = pixel(x, y);
            Rgb([red, green, blue])
        });
        write_png(&folder.join(format!("{}.png", image.name)), &png)?;
    }
    let text = format!("{}{}", head(picture, folder), comparison(moment)?.keys(folder)?);
    write_atomically(&folder.join(COMPARISON), text.as_bytes())
}

/// What the comparison's file is for, and what of the window it cannot say.
fn head(picture: &Picture, folder: &Path) -> String {
    let place = folder.join(COMPARISON);
    let mut lines = vec![
        "What a window showed; without it:".to_owned(),
        format!("  deepshade compare --config {} --out FOLDER", place.display()),
    ];
    if picture.lights != picture.subject.animated.scene.lights {
        lines.push("Lights are where the scene has them, not where they were dragged to.".to_owned());
    }
    let usual = Camera::look_at(glam::Vec3::ZERO, glam::Vec3::NEG_Z).vertical_fov;
    if picture.order.show.temporal {
        lines.push("Images were mixed with those of the frames before; here they are not.".to_owned());
    }
    if picture.camera.vertical_fov != usual {
        lines.push(format!(
            "The angle of view is {:.1} degrees, not the {:.1} of the window.",
            usual.to_degrees(),
            picture.camera.vertical_fov.to_degrees()
        ));
    }
    lines.iter().map(|line| format!("# {line}\n")).collect()
}

/// A method with what is set by hand.
fn choice(show: &Show, name: &str) -> MethodChoice {
    MethodChoice { parameters: show.tuning(name).changes, ..MethodChoice::named(name) }
}

/// The comparison that makes what is shown.
fn comparison(moment: &Moment) -> Result<Comparison> {
    let Moment { picture, samples, args, .. } = moment;
    let (show, time) = (&picture.order.show, picture.order.time);
    let camera = picture.camera;
    let [height, width] = show.size;
    let put = args.props.all().to_vec();
    let run = Run {
        scenes: Some(vec![show.source.clone()]),
        effects: Some(vec![show.effect]),
        methods: (!show.methods.is_empty())
            .then(|| show.methods.iter().map(|name| choice(show, name)).collect()),
        qualities: Some(vec![show.quality]),
        model: show.model.clone().map(Place::Folder),
        put: (!put.is_empty()).then_some(put),
        resolution: Some(Resolution { height, width }),
        radius: show.radius.map(Radius::Metres),
        ..Run::default()
    };
    let viewpoint = views::Viewpoint::looking(camera.position, camera.position - camera.rotation.z_axis);
    let run = run.with_options(
        &args.additions,
        &views::Args::one(viewpoint, args.seed),
        samples::Args::new(Some(*samples), None),
        exposure_time::Args::new((time != 0.0).then_some(time), None),
    );
    Comparison::new(None, |_| run.clone())
}
