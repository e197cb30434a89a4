//! The plain version: the parts' plain versions, added up.

use super::{Part, Shown, lamps, reflectance, sky, through};
use crate::bvh::TracedScene;
use crate::methods::single_scattering::distances;
use crate::scene::medium::POINTS;
use crate::screen::{PlainInputs, View, Written};
use deepshade_shaders::{Attribute, MissingAttribute, Planes, shows_surface};
use glam::{Vec2, Vec3};

/// The image of parts, of those that the scene has.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn image(parts: &[Part], inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
    inputs.image_of_scene(|scene| {
        let has = parts.iter().filter(|part| (part.has)(scene.scene()));
        let (between, surfaces): (Vec<&Part>, Vec<&Part>) =
            has.partition(|part| part.shown == Shown::Between);
        let mut image = begun(inputs, view)?;
        if lamps::has(scene.scene()) {
            lamps::change(&mut image, scene, inputs, view)?;
        }
        let reflectance = reflectance::image(inputs.gbuffer, scene.scene())?;
        for part in surfaces {
            let mut shaded = part.made.reference(inputs, view)?.pop().unwrap_or_default();
            if let (Shown::FromSky, Some(medium)) = (part.shown, scene.scene().medium.as_deref()) {
                through::dim(&mut shaded, medium, inputs, view)?;
            }
            let reflects = |at: usize| if part.shown.is_reflected() { reflectance.data()[at] } else { 1.0 };
            let all = image.data_mut().iter_mut().zip(shaded).enumerate();
            all.for_each(|(at, (sum, part))| *sum += part * reflects(at));
        }
        dim(&mut image, scene, inputs, view)?;
        for part in between {
            let shaded = part.made.reference(inputs, view)?.pop().unwrap_or_default();
            image.data_mut().iter_mut().zip(shaded).for_each(|(sum, part)| *sum += part);
        }
        Ok(image)
    })
}

/// The direction in which a pixel looks, world space.
fn direction(view: &View, pixel: usize) -> Vec3 {
    let at = Vec2::new((pixel % view.width) as f32, (pixel / view.width) as f32) + 0.5;
    view.camera.ray(at, view.height, view.width, Vec2::ZERO).1
}

/// What surfaces reflect of lamps and emit, and the sky behind them.
fn begun(inputs: &PlainInputs<'_>, view: &View) -> Result<Planes, MissingAttribute> {
    let planes = inputs.gbuffer.select(&[Attribute::Valid, Attribute::Light, Attribute::Emission])?;
    let sky = sky(inputs.environment);
    let radiance = |channel: usize, pixel: usize| {
        if shows_surface(planes.plane(0)[pixel]) {
            planes.plane(1 + channel)[pixel] + planes.plane(4 + channel)[pixel]
        } else {
            sky.radiance(direction(view, pixel))[channel]
        }
    };
    let at = |channel, y: usize, x: usize| radiance(channel, y * view.width + x);
    Ok(Planes::from_fn(3, view.height, view.width, at))
}

/// Dims it by the medium in front of surfaces and of the sky.
fn dim(
    image: &mut Planes,
    scene: &TracedScene,
    inputs: &PlainInputs<'_>,
    view: &View,
) -> Result<(), MissingAttribute> {
    let Some(medium) = scene.scene().medium.as_deref() else { return Ok(()) };
    let distances = distances(inputs.gbuffer)?;
    let pixels = distances.len();
    for (pixel, distance) in distances.into_iter().enumerate() {
        let share = medium.passed_share(view.camera.position, direction(view, pixel), distance, POINTS);
        (0..3).for_each(|channel| image.data_mut()[channel * pixels + pixel] *= share[channel]);
    }
    Ok(())
}
