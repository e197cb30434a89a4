//! What glowing surfaces light: by surfels, by rays that meet them and by the grid, against their plain
//! versions and against truth.

use super::*;
use crate::methods::disks::Disks;
use crate::methods::{bounced_z, lpv, surfel};
use crate::path::{self, Sampling, Shot};
use crate::surfels;

/// The room as methods of the effect see it.
fn lit_room((scene, view, _): (TracedScene, View, GBuffer)) -> (TracedScene, View, GBuffer) {
    let attributes = [Attribute::Position, Attribute::Normal, Attribute::Valid];
    let gbuffer = gbuffer::render(&scene, &view.camera, view.height, view.width, &attributes);
    (scene, View { radius: 20.0, ..view }, gbuffer)
}

/// The same at another moment, with paint so many times as bright.
fn changed(
    (scene, view, gbuffer): &(TracedScene, View, GBuffer),
    moment: f32,
    by: f32,
) -> (TracedScene, View, GBuffer) {
    let mut glow = Glow { moment, ..Glow::of(scene.scene()).clone() };
    glow.surfaces[0].paint.states.iter_mut().for_each(|state| state.emission *= by);
    let look = Look { glow: Some(Arc::new(glow)), ..scene.scene().look() };
    (scene.with_look(look).expect("a look"), *view, gbuffer.clone())
}

fn by_surfels(gpu: &Gpu) -> ScreenMethod {
    let surfels = surfels::SurfelDensity { scale: 0.02, near: 0.1 };
    let parameters = surfel::SurfelParameters { surfels, ..surfel::SurfelParameters::of(Quality::High) };
    ScreenMethod::new(gpu, Disks::new(parameters, surfel::indirect::KEPT_LIGHT))
}

fn by_rays(gpu: &Gpu) -> ScreenMethod {
    let surfels = surfels::SurfelDensity { scale: 0.02, near: 0.1 };
    let parameters =
        bounced_z::BouncedZParameters { surfels, ..bounced_z::BouncedZParameters::of(Quality::High) };
    ScreenMethod::new(gpu, Disks::new(parameters, bounced_z::indirect::KEPT_LIGHT))
}

fn by_grid(gpu: &Gpu, cells: usize) -> ScreenMethod {
    let parameters = lpv::LpvParameters { cells, iterations: cells, ..lpv::LpvParameters::of(Quality::High) };
    ScreenMethod::new(gpu, lpv::KeptLight(parameters))
}

/// Shadow maps end within a texel of where shadows do, and a patch is dark or lit. What surfaces light is a
/// thirtieth as bright as they are.
const fn tolerance() -> Tolerance {
    Tolerance { usual: 5e-3 / 30.0, worst: 0.1 / 30.0 }
}

#[test]
fn surfels_and_cells_light_as_their_plain_versions_do() {
    let gpu = gpu();
    prove_twin(&by_surfels(&gpu), &lit_room(room()), tolerance());
    prove_twin(&by_rays(&gpu), &lit_room(room()), tolerance());
    prove_twin(&by_grid(&gpu, 12), &lit_room(room()), tolerance());
}

#[test]
fn splats_on_the_processor_are_the_plain_version() {
    let (scene, view, gbuffer) = lit_room(room());
    let method = Disks::new(surfel::SurfelParameters::of(Quality::Low), surfel::indirect::KEPT_LIGHT);
    let inputs = PlainInputs { gbuffer: &gbuffer, environment: None, scene: Some(&scene) };
    let right = method.reference(&inputs, &view).expect("all attributes").remove(0);
    let made =
        method.on_processor(&inputs, &view).expect("such a version").expect("all attributes").remove(0);
    let largest = right.iter().copied().fold(0.0, f32::max);
    assert!(largest > 1e-5, "{largest}");
    assert!(near(&made, &right, 1e-4 * largest));
}

#[test]
fn patches_keep_light_of_what_moved_where_it_was() {
    let gpu = gpu();
    let method = by_surfels(&gpu);
    let told = lit_room(moving());
    prove_twin(&method, &told, tolerance());
    let still = (told.0.clone().with_past(vec![]).expect("no past"), told.1, told.2.clone());
    let [told, untold] = [&told, &still].map(|frame| shaded(&method, frame));
    let off = told.data().iter().zip(untold.data()).filter(|(a, b)| (*a - *b).abs() > 0.02 * *a).count();
    assert!(off > told.data().len() / 50, "as if it had never moved: {off}");
}

#[test]
fn a_glowing_wall_lights_the_floor_as_truth_says() {
    let gpu = gpu();
    let mut glow = glow(&[0.3], &[[0.0, 9.0]], 1.0);
    glow.surfaces[0].material = Some("wall".to_owned());
    let lit = || vec![lamp(Vec3::new(0.0, 1.0, 1.0), 5.0)];
    let room = lit_room(seen(scene(vec![floor(), wall()], lit(), glow), camera(), [37, 53]));
    let (scene, view, _) = &room;
    let shot = Shot::new(scene, &view.camera, [view.height, view.width], view.radius);
    let truth = path::render(Effect::PhosphorGi, &shot, Sampling::one(256, 1)).mean;
    let mean = |image: &Planes| image.data().iter().sum::<f32>() / image.data().len() as f32;
    let wanted = mean(&truth);
    assert!(wanted > 1e-5, "{wanted}");
    let surfels = mean(&shaded(&by_surfels(&gpu), &room)) / wanted;
    let rays = mean(&shaded(&by_rays(&gpu), &room)) / wanted;
    let grid = mean(&shaded(&by_grid(&gpu, 12), &room)) / wanted;
    assert!((surfels - 1.0).abs() < 0.1 && (rays - 1.0).abs() < 0.1, "{surfels} {rays}");
    assert!((grid - 1.0).abs() < 0.25, "{grid}");
}

/// Paint of a billionth of a thousandth of the light lights as much less, to rounding.
#[test]
fn what_is_faint_is_as_exact_as_what_is_bright() {
    let gpu = gpu();
    let room = lit_room(room());
    let methods = [by_surfels(&gpu), by_rays(&gpu), by_grid(&gpu, 12)];
    let by = (-40.0f32).exp2();
    for method in methods {
        let [bright, faint] = [1.0, by].map(|by| shaded(&method, &changed(&room, 3.0, by)));
        assert!(bright.data().iter().any(|value| *value > 1e-4));
        for (bright, faint) in bright.data().iter().zip(faint.data()) {
            assert!((faint / by - bright).abs() <= 1e-6 * bright, "{}: {faint} {bright}", method.name());
        }
    }
}

/// In the dark all of one state fades alike: after 14 of its lifetimes a millionth is left, everywhere.
#[test]
fn kept_light_fades_as_its_state_does() {
    let gpu = gpu();
    let decay = 0.7f32;
    let mut glow = glow(&[decay], &[[0.0, 1.0]], 1.0);
    glow.surfaces[0].material = Some("wall".to_owned());
    let lit = vec![lamp(Vec3::new(0.0, 1.0, 1.0), 5.0)];
    let room = lit_room(seen(scene(vec![floor(), wall()], lit, glow), camera(), [37, 53]));
    let methods = [by_surfels(&gpu), by_rays(&gpu), by_grid(&gpu, 12)];
    for method in methods {
        let [before, after] = [1.0, 21.0].map(|moment| shaded(&method, &changed(&room, moment, 1.0)));
        let left = (-decay * 20.0).exp();
        let largest = before.data().iter().copied().fold(0.0, f32::max);
        let after: Vec<f32> = after.data().iter().map(|after| after / left).collect();
        // A half of the last of nine bits of the brightest colour, on either side.
        assert!(near(&after, before.data(), largest / 256.0), "{}: {largest}", method.name());
    }
}
