//! Glossy receivers, of surfels and of the bounced z-buffer over them: against truth, and the passes against
//! the plain version.

use super::super::glossy::GLOSSY;
use super::*;
use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::methods::bounced_z;
use crate::methods::lobe::ATTRIBUTES;
use crate::methods::proving::mean_difference;
use crate::path::{self, Sampling, Shot};
use crate::scene::{Gloss, Material, MaterialId};
use deepshade_shaders::{Attribute, Effect, GBuffer};

/// The corner with a floor of glossy metal.
fn corner_over(roughness: f32) -> (TracedScene, View, GBuffer) {
    let (scene, view, _) = corner();
    let mut scene = scene.scene().clone();
    let metal = Material { metallic: 1.0, roughness, gloss: Gloss::Microfacets, ..Material::default() };
    scene.materials.push(metal);
    let mut meshes = scene.meshes.to_vec();
    meshes[0].material = MaterialId(1);
    scene.meshes = meshes.into();
    let scene = TracedScene::new(scene).expect("two squares");
    let gbuffer = gbuffer::render(&scene, &view.camera, view.height, view.width, ATTRIBUTES);
    (scene, view, gbuffer)
}

fn image(method: &ScreenMethod, (scene, view, gbuffer): &(TracedScene, View, GBuffer)) -> Planes {
    let frame = Frame { scene, camera: &view.camera, gbuffer, radius: view.radius, seed: view.seed };
    Method::shade(method, &frame, Repeats::ONCE).expect("an image").image
}

fn mean(image: &Planes) -> f32 {
    image.data().iter().sum::<f32>() / image.data().len() as f32
}

/// Mean over an image of the difference of two, over that of truth.
fn off(image: &Planes, truth: &Planes) -> f32 {
    mean_difference(image, truth) / mean(truth)
}

#[test]
fn a_glossy_floor_mirrors_a_lit_wall_as_truth_does() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let surfel = ScreenMethod::new(&gpu, Disks::new(SurfelParameters::of(Quality::High), GLOSSY));
    let bounced =
        bounced_z::BouncedZParameters { directions: 8, ..bounced_z::BouncedZParameters::of(Quality::High) };
    let bounced = ScreenMethod::new(&gpu, Disks::new(bounced, bounced_z::glossy::GLOSSY));
    // Surfels that stand for many blur what a smooth floor mirrors.
    for (roughness, most) in [(0.4, 0.5), (0.8, 0.2)] {
        let seen = corner_over(roughness);
        let (scene, view, _) = &seen;
        let shot = Shot::new(scene, &view.camera, [view.height, view.width], view.radius);
        let truth = path::render(Effect::Glossy, &shot, Sampling::one(256, 1)).mean;
        let [surfel, bounced] = [image(&surfel, &seen), image(&bounced, &seen)];
        let [ratio, ratio_bounced] = [&surfel, &bounced].map(|image| mean(image) / mean(&truth));
        assert!((0.9..1.1).contains(&ratio), "{roughness}: {ratio} of it by surfels");
        assert!((0.85..1.05).contains(&ratio_bounced), "{roughness}: {ratio_bounced} of it along rays");
        let [far, far_bounced] = [off(&surfel, &truth), off(&bounced, &truth)];
        assert!(far < most && far_bounced < 0.15, "{roughness}: {far} and {far_bounced} off");
        assert!(far_bounced < far, "{roughness}: {far} and {far_bounced} off");
        let matte = path::render(Effect::Gi, &shot, Sampling::one(64, 1)).mean;
        assert!(off(&matte, &truth) > 1.3 * far, "{roughness}: a matte floor is {} off", off(&matte, &truth));
    }
}

#[test]
fn what_reflects_nothing_specularly_is_black() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let surfel = ScreenMethod::new(&gpu, Disks::new(SurfelParameters::of(Quality::High), GLOSSY));
    let bounced = ScreenMethod::new(
        &gpu,
        Disks::new(bounced_z::BouncedZParameters::of(Quality::High), bounced_z::glossy::GLOSSY),
    );
    let (scene, view, _) = corner();
    let mut scene = scene.scene().clone();
    scene.materials[0].gloss = Gloss::None;
    let scene = TracedScene::new(scene).expect("two squares");
    let gbuffer = gbuffer::render(&scene, &view.camera, view.height, view.width, ATTRIBUTES);
    let matte = (scene, view, gbuffer);
    assert!(image(&surfel, &matte).data().iter().all(|light| *light == 0.0));
    assert!(image(&bounced, &matte).data().iter().all(|light| *light == 0.0));
}

#[test]
fn what_is_matte_neither_shines_nor_darkens_what_does() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let surfel = ScreenMethod::new(&gpu, Disks::new(SurfelParameters::of(Quality::High), GLOSSY));
    let (scene, view, gbuffer) = corner_over(0.5);
    let metal =
        image(&surfel, &(TracedScene::new(scene.scene().clone()).expect("a corner"), view, gbuffer.clone()));
    // Every other pair of columns is matte.
    let is_matte = |x: usize| x / 2 % 2 == 1;
    let mut planes = gbuffer.planes().clone();
    let first = gbuffer
        .attributes()
        .iter()
        .take_while(|a| **a != Attribute::Specular)
        .map(|a| a.width())
        .sum::<usize>();
    for channel in first..first + 3 {
        for at in (0..view.height * view.width).filter(|at| is_matte(at % view.width)) {
            planes.plane_mut(channel)[at] = 0.0;
        }
    }
    let striped = GBuffer::new(gbuffer.attributes().to_vec(), planes);
    let made = image(&surfel, &(scene, view, striped));
    for (at, (light, whole)) in made.plane(0).iter().zip(metal.plane(0)).enumerate() {
        let right = if is_matte(at % view.width) { 0.0 } else { *whole };
        assert!((light - right).abs() <= 1e-3 * whole.max(1.0), "{light}, not {right}");
    }
}

#[test]
fn the_passes_reflect_as_the_plain_versions_do() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let coarse = surfels::SurfelDensity { scale: 0.03, near: 0.25 };
    let parameters = SurfelParameters { surfels: coarse, levels: 4, ..SurfelParameters::of(Quality::High) };
    let surfel = ScreenMethod::new(&gpu, Disks::new(parameters, GLOSSY));
    let parameters =
        bounced_z::BouncedZParameters { surfels: coarse, ..bounced_z::BouncedZParameters::of(Quality::High) };
    let bounced = ScreenMethod::new(&gpu, Disks::new(parameters, bounced_z::glossy::GLOSSY));
    // Shadow maps end within a texel of where shadows do; radiance has nine bits.
    for roughness in [0.1, 0.5] {
        let seen = corner_over(roughness);
        prove_twin(&surfel, &seen, Tolerance { usual: 1e-2, worst: 0.2 });
        prove_twin(&bounced, &seen, Tolerance { usual: 1e-2, worst: 0.2 });
    }
}
