//! Bevy's own depth of field and a network's beside what a lens shows of Bevy's own frames.

use crate::support::frame::{Frame, differences};
use crate::support::headless::Headless;
use crate::support::own::Program;
use crate::support::{clock, lens, lens_clock};
use crate::{Figures, Result};
use bevy::camera::Hdr;
use bevy::light::DirectionalLight;
use bevy::math::Vec3;
use bevy::post_process::dof::{DepthOfField, DepthOfFieldMode};
use bevy::prelude::Transform;
use deepshade_bevy::LearnedDepthOfField;
use deepshade_shaders::{Effect, Planes};
use std::path::Path;

/// Radius of the lens, metres. Its circles of confusion have radii of up to some 10 pixels here.
const APERTURE_RADIUS: f32 = 0.1;
/// Points of the lens through which truth is seen.
const POINTS: usize = 256;
/// Which light comes from a side, beside that from everywhere.
const LIGHT_GOES: Vec3 = Vec3::new(-1.0, -2.0, -0.5);
/// Circles of Bevy's, in those of the lens: its blur is a hexagon, and averages what is behind each other.
const CIRCLES: [f32; 6] = [0.7, 0.8, 0.9, 1.0, 1.15, 1.3];

/// A frame's figures, and pictures; `focus` is what the camera looks at.
pub fn measured(
    frame: &Frame,
    focus: f32,
    bevy: &mut Headless,
    models: &Path,
    program: &Program<'_>,
) -> Result<(Figures, Vec<(&'static str, Planes)>)> {
    let wanted = LearnedDepthOfField { focal_distance: focus, aperture_radius: APERTURE_RADIUS };
    bevy.add((DirectionalLight::default(), Transform::default().looking_to(LIGHT_GOES, Vec3::Y)));
    bevy.with(Hdr);
    let plain = bevy.light(false)?;
    let truth = lens::truth(bevy, &frame.camera, wanted, POINTS)?;
    let mut figures = Figures::new();
    let mut score = |ssim, mean_abs, image: &Planes| {
        let [similarity, difference] = lens::scores(image, &truth);
        figures.extend([(ssim, similarity), (mean_abs, difference)]);
    };
    score("ssim_bevy_dof_none", "mean_abs_bevy_dof_none", &plain);

    bevy.with(wanted);
    if let Some(failure) = bevy.failures().first() {
        return Err(failure.clone().into());
    }
    let learned = bevy.light(false)?;
    score("ssim_bevy_dof_learned", "mean_abs_bevy_dof_learned", &learned);
    let gbuffer = lens::gbuffer(bevy, [0, 0])?;
    let by_program = program.image(&models.join("dof"), Effect::Dof, &gbuffer, 1.0)?;
    let [here, there] = lens::exposed([&learned, &by_program], &plain);
    let [largest, stray] = differences(&here, &there, 2e-3);
    let ms_learned = clock::learned::<LearnedDepthOfField>(bevy)?;
    bevy.without::<LearnedDepthOfField>();

    let mut best = f64::NEG_INFINITY;
    let mut bevys = None;
    for circle in CIRCLES {
        bevy.with(of_lens(wanted, circle, frame.camera.vertical_fov));
        let image = bevy.light(false)?;
        best = best.max(lens::scores(&image, &truth)[0]);
        if circle == 1.0 {
            score("ssim_bevy_dof", "mean_abs_bevy_dof", &image);
            bevys = Some(image);
        }
    }
    let ms_bevys = lens_clock::bevys(bevy)?;
    bevy.without::<DepthOfField>();
    figures.extend([
        ("max_abs_bevy_dof", largest),
        ("stray_bevy_dof", stray),
        ("ssim_bevy_dof_best", best),
        ("ms_bevy_dof_learned", ms_learned),
        ("ms_bevy_dof", ms_bevys),
    ]);
    let bevys = bevys.ok_or("no circles as they are")?;
    let images =
        [("dof-none", &plain), ("dof-learned", &learned), ("dof-bevy", &bevys), ("dof-truth", &truth)];
    let images = images.map(|(name, image)| (name, shown(image, &truth)));
    Ok((figures, images.into()))
}

/// Bevy's depth of field of the same lens, its circles of confusion multiplied by a number. Bevy's has the
/// diameter `H f² / (S N (F - f)) |d - F| / d` in pixels, where `f = S / (2 tan(fov / 2))` is the focal
/// length. A pinhole's image from all over a lens of radius `R` has `2 R H / (2 tan(fov / 2) F) |d - F| / d`.
/// Both are the same where `N = f F / (2 R (F - f))`.
fn of_lens(lens: LearnedDepthOfField, circle: f32, fov: f32) -> DepthOfField {
    let LearnedDepthOfField { focal_distance, aperture_radius } = lens;
    let DepthOfField { sensor_height, .. } = DepthOfField::default();
    let focal_length = 0.5 * sensor_height / (0.5 * fov).tan();
    let aperture = 2.0 * aperture_radius * circle;
    DepthOfField {
        mode: DepthOfFieldMode::Bokeh,
        focal_distance,
        aperture_f_stops: focal_length * focal_distance / (aperture * (focal_distance - focal_length)),
        // All that this lens has.
        max_circle_of_confusion_diameter: 1000.0,
        ..Default::default()
    }
}

/// A picture from 0 to 1 as a screen shows it.
fn shown(image: &Planes, truth: &Planes) -> Planes {
    let [exposed] = lens::exposed([image], truth);
    exposed.map(|value| value.clamp(0.0, 1.0).powf(1.0 / 2.2))
}
