//! The passes against their plain version, and what must hold of images.

mod emission;
mod kept;
mod motion;
mod outside;
mod room;
mod scales;
mod sky;

use super::in_medium::InMedium;
use super::passes::{Filled, MediumLight, Pixel};
use super::*;
use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::lpv::flight::Factors;
use crate::lpv::injection::flights;
use crate::lpv::lobe::Lobes;
use crate::lpv::propagation::{Field, Light, Volume};
use crate::lpv::scheme::Lookup;
use crate::lpv::{LightGrid, Scheme};
use crate::method::{Frame, Method, Repeats};
use crate::methods::proving::Tolerance;
use crate::methods::proving::beyond::{corner, foggy, prove_twin};
use crate::scene::{Camera, Density, Medium, Scene};
use crate::screen::{self, GpuGBuffer, Inputs, MethodPasses, PlainInputs, ScreenMethod};
use deepshade_shaders::GBuffer;
use deepshade_shaders::gpu::{self, Gpu};
use glam::{Vec3, Vec4};

const FEW: LpvParameters =
    LpvParameters { cells: 14, cascades: 1, iterations: 9, steps: 12, scale: 2, scheme: Scheme::OURS };

/// Shadow maps end within a texel of where shadows do.
const TOLERANCE: Tolerance = Tolerance { usual: 1e-3, worst: 0.02 };
/// Light in a medium is fainter.
const OF_MEDIUM: Tolerance = Tolerance { usual: 2e-4, worst: 0.01 };

type ViewedScene = (TracedScene, View, GBuffer);

fn gpu() -> Gpu {
    Gpu::new().expect("an adapter; lavapipe will do")
}

/// The same frame with all that the method reads.
fn with_colours((scene, view, _): ViewedScene) -> ViewedScene {
    let attributes = InMedium::multiple(FEW).about().attributes;
    let gbuffer = gbuffer::render(&scene, &view.camera, view.height, view.width, attributes);
    (scene, view, gbuffer)
}

#[test]
fn surfaces_are_lit_as_the_plain_version_has_it() {
    prove_twin(&ScreenMethod::new(&gpu(), FEW), &with_colours(corner()), TOLERANCE);
}

#[test]
fn a_medium_is_lit_as_the_plain_version_has_it() {
    let gpu = gpu();
    let multiple = ScreenMethod::new(&gpu, InMedium::multiple(FEW));
    let pixel = Pixel { medium: true, surface: false };
    let indirect = ScreenMethod::new(&gpu, InMedium::indirect_at(FEW, pixel));
    for frame in foggy().into_iter().map(with_colours) {
        prove_twin(&multiple, &frame, OF_MEDIUM);
        prove_twin(&indirect, &frame, OF_MEDIUM);
    }
}

/// The passes of such light in a medium that have run twice, and their image, which is the same both times.
fn run_twice(
    gpu: &Gpu,
    (scene, view, gbuffer): &ViewedScene,
    light: MediumLight,
    parameters: LpvParameters,
) -> MethodPasses {
    let method: ScreenMethod = match light {
        MediumLight::Multiple => ScreenMethod::new(gpu, InMedium::multiple(parameters)),
        MediumLight::Reflected { by_surfaces } => {
            let pixel = Pixel { medium: true, surface: by_surfaces };
            ScreenMethod::new(gpu, InMedium::indirect_at(parameters, pixel))
        }
    };
    let there = GpuGBuffer::upload(&gpu.device, gbuffer, method.attributes()).expect("attributes");
    let world = screen::world(gpu, scene.scene(), view).expect("room");
    let inputs = Inputs { gbuffer: &there, environment: None, world: Some(&world) };
    let passes = MethodPasses::new(&method, &inputs, view).expect("room");
    let image = || -> Vec<f32> {
        gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| passes.encode(encoder)).expect("valid passes");
        gpu::read(&gpu.device, &gpu.queue, passes.output()).expect("an image")
    };
    assert_eq!(image(), image(), "nothing is kept from frame to frame");
    passes
}

/// What a pass has written last.
fn written<T: bytemuck::Pod>(gpu: &Gpu, passes: &MethodPasses, label: &str) -> Vec<T> {
    let step = passes.steps().iter().rfind(|step| step.step.pass.is_of(label)).expect("a pass");
    gpu::read(&gpu.device, &gpu.queue, step.writes.last().expect("a buffer")).expect("its contents")
}

/// A kind of light of three planes of cells.
fn light_of(planes: &[[f32; 4]], cells: usize) -> Vec<Light> {
    (0..cells).map(|cell| [0, 1, 2].map(|colour| Vec4::from(planes[colour * cells + cell]))).collect()
}

/// Light of all three colours that surfels have put into each cell, watts.
fn sent(gpu: &Gpu, passes: &MethodPasses, grid: &LightGrid) -> Vec<Light> {
    let inject = passes.steps().iter().find(|step| step.step.pass.is_of("lpv.inject"));
    let sums = inject.and_then(|step| step.writes.first()).expect("light is injected");
    let sums: Vec<[[[u32; 2]; 4]; 3]> = gpu::read(&gpu.device, &gpu.queue, sums).expect("sums");
    // 64 bits of which 40 are behind the point, over the area of a cell's face.
    let face = f64::from(grid.cell * grid.cell);
    let value = |[low, high]: [u32; 2]| {
        (face * (f64::from(high as i32) + f64::from(low) * 2f64.powi(-32)) / 256.0) as f32
    };
    sums.iter().map(|of_cell| of_cell.map(|moments| Vec4::from(moments.map(value)))).collect()
}

/// How far what the passes show of a frame is from what the plain version makes of the same start, over the
/// grid's maximum.
fn furthest_off(gpu: &Gpu, frame: &ViewedScene, light: MediumLight, parameters: LpvParameters) -> f32 {
    let (scene, scheme) = (frame.0.scene(), parameters.scheme);
    let grid = LightGrid::around(scene.bounds(), parameters.cells);
    let cells = grid.cells();
    let kinds = Filled::Medium(light).kinds();
    let start = run_twice(gpu, frame, light, LpvParameters { iterations: 0, ..parameters });
    let links: Vec<[u32; 4]> = written(gpu, &start, "lpv.links");
    let byte = |cell: usize, i: usize| (links[cell][i / 4] >> (8 * (i % 4)) & 255) as f32 / 255.0;
    let volume = Volume {
        grid,
        flights: flights(&grid, scene.medium.as_deref(), scheme.factors, kinds.scattered),
        passing: (0..cells).map(|cell| std::array::from_fn(|link| byte(cell, link))).collect(),
        reflectances: (0..cells).map(|cell| [13, 14, 15].map(|i| byte(cell, i))).collect(),
        scheme,
    };
    let mut field = if kinds.scattered {
        let state: Vec<[f32; 4]> = written(gpu, &start, "lpv.begin");
        let lobes = (0..kinds.count()).map(|kind| light_of(&state[3 * kind * cells..], cells));
        Field::of_lobes(scheme, kinds, lobes.collect())
    } else {
        Field::new(&volume, kinds, &sent(gpu, &start, &grid), &[])
    };
    assert!(field.energy() > 1.0 && volume.passing.iter().flatten().any(|passes| *passes < 0.5));
    field.iterate(&volume, parameters.iterations);
    let shown: Vec<[f32; 4]> = written(gpu, &run_twice(gpu, frame, light, parameters), "lpv.propagate");
    let (mut largest, mut worst) = (0.0f32, 0.0f32);
    // Where nothing was scattered surfaces show no other light than the medium.
    let planes = shown.chunks(3 * cells).map(|plane| light_of(plane, cells));
    for (is, wanted) in planes.zip([field.shown.by_medium, field.shown.by_surfaces]) {
        for (is, wanted) in is.into_iter().flatten().zip(wanted.into_iter().flatten()) {
            largest = largest.max(wanted.w);
            worst = worst.max((is - wanted).abs().max_element());
        }
    }
    assert!(largest > 0.0);
    worst / largest
}

#[test]
fn each_cell_has_what_the_plain_version_makes_of_the_same_start() {
    let gpu = gpu();
    for frame in foggy().into_iter().map(with_colours) {
        for light in [MediumLight::Multiple, MediumLight::Reflected { by_surfaces: false }] {
            let off = furthest_off(&gpu, &frame, light, FEW);
            // 1.01e-5 on an H100, which fuses products and sums.
            assert!(off < 2e-5, "{light:?}: {off}");
        }
    }
}

#[test]
fn so_it_has_in_two_bands_and_in_the_papers_scheme() {
    let (gpu, frame) = (gpu(), with_colours(foggy().remove(1)));
    let two_bands = Scheme { lobes: Lobes::TwoBands, ..Scheme::OURS };
    let linear = Scheme { factors: Factors::Linear, ..Scheme::OURS };
    for scheme in [two_bands, linear, Scheme::PAPER] {
        for light in [MediumLight::Multiple, MediumLight::Reflected { by_surfaces: false }] {
            let off = furthest_off(&gpu, &frame, light, LpvParameters { scheme, ..FEW });
            // A processor's exponential is not quite a GPU's.
            assert!(off < 2e-5, "{scheme:?}, {light:?}: {off}");
        }
    }
}

#[test]
fn surfaces_lit_by_the_cell_that_they_are_in_are_as_the_plain_version_has_it() {
    let scheme = Scheme { lookup: Lookup::Within, ..Scheme::OURS };
    let method = ScreenMethod::new(&gpu(), LpvParameters { scheme, ..FEW });
    // A point between two cells may be in the other one: 0.64 on an H100.
    prove_twin(&method, &with_colours(corner()), Tolerance { worst: 0.7, ..TOLERANCE });
}

/// A frame in another medium, from another place.
fn changed((scene, view, _): &ViewedScene, medium: Medium, camera: Camera) -> ViewedScene {
    let scene = Scene { medium: Some(medium.into()), ..scene.scene().clone() };
    let scene = TracedScene::new(scene).expect("triangles");
    let view = View { camera, ..*view };
    let gbuffer = gbuffer::render(&scene, &camera, view.height, view.width, &[Attribute::Valid]);
    with_colours((scene, view, gbuffer))
}

#[test]
fn extremes_make_no_negative_light() {
    let gpu = gpu();
    let frame = foggy().remove(0);
    let (camera, bounds) = (frame.1.camera, frame.0.scene().bounds());
    let medium = |absorption: f32, scattering: f32| {
        let density = Density::Within(bounds);
        Medium::new(Vec3::splat(absorption), Vec3::splat(scattering), 0.0, density).expect("a medium")
    };
    let outside = Camera::look_at(Vec3::new(-30.0, 20.0, 25.0), bounds.centre());
    let few = LpvParameters { iterations: 4, ..FEW };
    for (medium, camera, parameters, least, most) in [
        (medium(0.0, 0.0), camera, few, 0.0, 0.0),
        (medium(0.1, 0.0), camera, few, 0.0, 0.0),
        // Far too bright, which is stated.
        (medium(0.0, 1e5), camera, few, 0.0, 1e3),
        (medium(0.0, 0.3), outside, few, 1e-3, 10.0),
        (medium(0.1, 0.3), camera, LpvParameters { cells: 1, ..few }, 1e-3, 10.0),
    ] {
        let (scene, view, gbuffer) = changed(&frame, medium, camera);
        let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius: view.radius, seed: 1 };
        let multiple = ScreenMethod::new(&gpu, InMedium::multiple(parameters));
        let indirect = ScreenMethod::new(&gpu, InMedium::indirect(parameters));
        // What surfaces send into one cell may all leave it.
        let of_indirect = if parameters.cells == 1 { 0.0 } else { least };
        for (method, least) in [(&multiple as &dyn Method, least), (&indirect, of_indirect)] {
            let image = method.shade(&frame, Repeats::ONCE).expect("an image").image;
            assert!(image.data().iter().all(|value| value.is_finite() && *value >= 0.0));
            let largest = image.data().iter().copied().fold(0.0, f32::max);
            assert!((least..=most).contains(&largest), "{largest} is not from {least} to {most}");
        }
    }
}
