//! Closed forms are in f64, by quadrature where an integral is left.

use super::*;
use crate::bvh::TracedScene;
use crate::path::medium::HenyeyGreenstein;
use crate::path::proving::{MeanWithError, prove_slope, quad};
use crate::path::{Integrator, Sampling, render};
use crate::sampler::{PixelSampler, Stream};
use crate::scene::medium::Weather;
use crate::scene::{
    Bounds, Camera, Density, DensityGrid, Environment, Gloss, Light, Material, MaterialId, Medium, Mesh,
    Scene,
};
use deepshade_shaders::Effect;
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;

const ABSORPTION: Vec3 = Vec3::new(0.05, 0.2, 0.1);
const SCATTERING: Vec3 = Vec3::new(0.25, 0.4, 0.9);

fn medium(anisotropy: f32, density: Density) -> Medium {
    Medium::new(ABSORPTION, SCATTERING, anisotropy, density).expect("a medium")
}

fn within(min: [f32; 3], max: [f32; 3]) -> Bounds {
    Bounds { min: min.into(), max: max.into() }
}

/// A uniform medium in a box, and the same as a grid.
fn both_ways(bounds: Bounds) -> [Density; 2] {
    let grid = DensityGrid::new(bounds, [2, 1, 3], vec![1.0; 6]).expect("a grid");
    [Density::Within(bounds), Density::Grid(grid)]
}

/// Lambert's law, with a glow.
fn matte(colour: Vec3, emission: Vec3) -> Material {
    Material { gloss: Gloss::None, emission, ..Material::matte("matte", colour) }
}

/// Meshes with a material each.
fn traced(parts: Vec<(Mesh, Material)>, lights: Vec<Light>, medium: Medium) -> TracedScene {
    let mut scene = Scene { lights, medium: Some(Arc::new(medium)), ..Scene::default() };
    for (index, (mesh, material)) in parts.into_iter().enumerate() {
        scene.meshes.push(Mesh { material: MaterialId(index as u32), ..mesh });
        scene.materials.push(material);
    }
    TracedScene::new(scene).expect("triangles")
}

/// A rectangle at a height y, over ranges of x and z.
fn level(y: f32, [x0, x1]: [f32; 2], [z0, z1]: [f32; 2]) -> Mesh {
    quad([(x0, z0), (x0, z1), (x1, z1), (x1, z0)].map(|(x, z)| Vec3::new(x, y, z)))
}

/// A black wall far to the right.
fn wall(x: f32) -> (Mesh, Material) {
    let corners = [(-9., -9.), (-9., 9.), (9., 9.), (9., -9.)].map(|(y, z)| Vec3::new(x, y, z));
    (quad(corners), matte(Vec3::ZERO, Vec3::ZERO))
}

/// What is seen of light of a route from a point along +x.
fn seen(scene: &TracedScene, from: Vec3, samples: u32, route: Route) -> MeanWithError {
    let camera = Camera::look_at(from, from + Vec3::X);
    let shot = Shot::new(scene, &camera, [1, 1], f32::INFINITY);
    MeanWithError::of(&FullPath::along(route, &shot), &shot, samples)
}

/// Proves a value, and that a light that is 2 % brighter would be noticed.
fn prove(name: &str, found: MeanWithError, expected: Vec3) {
    found.proves(name, expected);
    found.refutes(name, expected * 1.02);
}

/// Of each colour, by its absorption and scattering coefficient.
fn each_colour(radiance: impl Fn(f64, f64) -> f64) -> Vec3 {
    let colour = |c: usize| radiance(f64::from(ABSORPTION[c]), f64::from(SCATTERING[c])) as f32;
    Vec3::new(colour(0), colour(1), colour(2))
}

/// Henyey and Greenstein's formula as they wrote it.
fn phase(g: f32, cosine: f64) -> f64 {
    let g = f64::from(g);
    (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5))
}

/// Integral by midpoints.
fn integral(from: f64, to: f64, steps: u32, function: impl Fn(f64) -> f64) -> f64 {
    let step = (to - from) / f64::from(steps);
    (0..steps).map(|i| function(from + (f64::from(i) + 0.5) * step)).sum::<f64>() * step
}

#[test]
fn the_phase_function_is_that_of_the_closed_forms() {
    for g in [-0.7, 0.0, 0.4, 0.95] {
        for step in 0..=20 {
            let cosine = step as f32 / 10.0 - 1.0;
            let (found, expected) = (HenyeyGreenstein::new(g).evaluate(cosine), phase(g, f64::from(cosine)));
            assert!((f64::from(found) / expected - 1.0).abs() < 1e-4, "{g}, {cosine}");
        }
    }
}

/// Sunlight that leans by an angle towards +x comes through a slit from 0.5 to 1.7 in a roof at 1.5 m.
fn shaft(lean: f32, anisotropy: f32, density: Density) -> TracedScene {
    let sun = Light::Directional {
        direction: Vec3::new(lean.sin(), -lean.cos(), 0.0),
        irradiance: Vec3::new(3.0, 2.0, 1.0),
        pattern: None,
    };
    let roof = |x| (level(1.5, x, [-9.0, 9.0]), matte(Vec3::ONE, Vec3::ZERO));
    traced(vec![roof([-9.0, 0.5]), roof([1.7, 9.0])], vec![sun], medium(anisotropy, density))
}

/// What is seen of it from the middle of the box along +x. The way of all light ends with 1 m below the top
/// of the box.
fn expected_shaft(lean: f32, anisotropy: f32) -> Vec3 {
    let lean = f64::from(lean);
    let lit = [0.5, 1.7].map(|x| x + 1.5 * lean.tan());
    let coloured = each_colour(|absorption, scattering| {
        let extinction = absorption + scattering;
        let [from, to] = lit.map(|x| (-extinction * x).exp());
        // Light that travels towards +x has to turn back to reach the eye.
        let turned = phase(anisotropy, -lean.sin());
        (-extinction / lean.cos()).exp() * turned * scattering / extinction * (from - to)
    });
    coloured * Vec3::new(3.0, 2.0, 1.0)
}

#[test]
fn shafts_of_sunlight_are_as_bright_as_their_lit_segment() {
    let bounds = within([-1.0, -2.0, -1.0], [6.0, 1.0, 1.0]);
    for (lean, anisotropy) in [(0.0, 0.0), (0.5, 0.0), (0.5, 0.6), (-0.2, -0.5)] {
        for density in both_ways(bounds) {
            let found = seen(&shaft(lean, anisotropy, density), Vec3::ZERO, 4096, Route::Direct);
            prove("fog/shaft", found, expected_shaft(lean, anisotropy));
            if anisotropy != 0.0 {
                found.refutes("fog/shaft", expected_shaft(lean, -anisotropy));
                found.refutes("fog/shaft", expected_shaft(lean, 0.0));
            }
        }
    }
}

/// Intensity of the lamp of the airlight.
const INTENSITY: Vec3 = Vec3::new(5.0, 7.0, 9.0);
/// Its distance from the eye, and that of the wall.
const LAMP: f64 = 2.0;
const WALL: f64 = 3.5;
/// Angles between the view and the lamp: it is 1.1 m aside, or 4 cm.
const ASIDE: [f64; 2] = [0.6, 0.02];

/// Airlight of a lamp in endless fog that scatters alike in all directions (Sun et al. 2005, equation 11).
fn sun_airlight(aside: f64, absorption: f64, scattering: f64) -> f64 {
    let extinction = absorption + scattering;
    let (t, t_wall) = (extinction * LAMP, extinction * WALL);
    let (sin, cos) = aside.sin_cos();
    let front = scattering * (-t * cos).exp() / (2.0 * PI * LAMP * sin);
    let a1 = t * sin;
    let a2 = 0.25 * PI + 0.5 * ((t_wall - t * cos) / (t * sin)).atan();
    front * integral(0.5 * aside, a2, 40_000, |x| (-a1 * x.tan()).exp())
}

/// The same as an integral along the view, for any anisotropy.
fn airlight(aside: f64, anisotropy: f32, absorption: f64, scattering: f64) -> f64 {
    let extinction = absorption + scattering;
    integral(0.0, WALL, 40_000, |x| {
        let to_lamp = DVec3::new(LAMP * aside.cos() - x, LAMP * aside.sin(), 0.0);
        let distance = to_lamp.length();
        let turned = phase(anisotropy, to_lamp.x / distance);
        scattering * turned * (-extinction * (x + distance)).exp() / (distance * distance)
    })
}

/// A lamp in endless fog before a wall.
fn lamp_in_fog(aside: f64, anisotropy: f32) -> TracedScene {
    let position = Vec3::new((LAMP * aside.cos()) as f32, (LAMP * aside.sin()) as f32, 0.0);
    let lamp = Light::Point { position, intensity: INTENSITY, range: f32::INFINITY };
    traced(vec![wall(WALL as f32)], vec![lamp], medium(anisotropy, Density::Everywhere))
}

#[test]
fn airlight_of_a_lamp_is_suns() {
    for (aside, name) in ASIDE.into_iter().zip(["fog/airlight", "fog/airlight_of_a_near_lamp"]) {
        for anisotropy in [0.0, 0.6, -0.4] {
            let expected = |anisotropy| {
                INTENSITY
                    * each_colour(|absorption, scattering| {
                        airlight(aside, anisotropy, absorption, scattering)
                    })
            };
            if anisotropy == 0.0 {
                let suns = each_colour(|absorption, scattering| sun_airlight(aside, absorption, scattering));
                assert!((expected(0.0) - INTENSITY * suns).length() < 1e-5 * expected(0.0).length());
            }
            let found = seen(&lamp_in_fog(aside, anisotropy), Vec3::ZERO, 16_384, Route::Direct);
            prove(name, found, expected(anisotropy));
            if anisotropy != 0.0 {
                found.refutes(name, expected(-anisotropy));
            }
        }
    }
}

#[test]
fn errors_fall_at_least_as_fast_as_the_root_of_the_samples() {
    let scene = lamp_in_fog(ASIDE[0], 0.0);
    let truth = f64::from(INTENSITY.y) * sun_airlight(ASIDE[0], ABSORPTION.y.into(), SCATTERING.y.into());
    let camera = Camera::look_at(Vec3::ZERO, Vec3::X);
    let shot = Shot::new(&scene, &camera, [1, 1], f32::INFINITY);
    let fog = direct(&shot);
    prove_slope("slope/fog-direct", truth, |replicate, samples| {
        fog.pixel(&shot, 0, 0, PixelSampler::new(0, 0, 7).scrambled(replicate), samples).y
    });
}

/// A box of fog half a metre above a rectangle, and the middle of the box along which it is looked through.
const ABOVE: [[f32; 3]; 2] = [[0.0, 0.5, -1.0], [3.0, 1.5, 1.0]];
const BESIDE: Vec3 = Vec3::new(-1.0, 1.0, 0.0);

fn rectangle() -> Mesh {
    level(0.0, [1.0, 2.0], [-0.5, 0.5])
}

/// Radiance of fog that is lit by the rectangle, if that sends out one unit to all sides. Half of each way
/// from the rectangle is in the fog.
fn lit_from_below(anisotropy: f32, absorption: f64, scattering: f64) -> f64 {
    let extinction = absorption + scattering;
    let at = |x: f64, on_x: f64, on_z: f64| {
        let way = DVec3::new(on_x - x, -1.0, on_z);
        let distance = way.length();
        let received = 1.0 / distance.powi(3);
        received * phase(anisotropy, way.x / distance) * (-extinction * (x + 0.5 * distance)).exp()
    };
    let from_rectangle =
        |x: f64| integral(1.0, 2.0, 40, |on_x| integral(-0.5, 0.5, 40, |on_z| at(x, on_x, on_z)));
    scattering * integral(0.0, 3.0, 120, from_rectangle)
}

#[test]
fn fog_over_a_glowing_rectangle_scatters_its_light() {
    let glow = Vec3::new(1.0, 2.0, 3.0);
    for density in both_ways(within(ABOVE[0], ABOVE[1])) {
        let scene = traced(vec![(rectangle(), matte(Vec3::ZERO, glow))], vec![], medium(0.5, density));
        let expected =
            glow * each_colour(|absorption, scattering| lit_from_below(0.5, absorption, scattering));
        prove("fog/glowing_rectangle", seen(&scene, BESIDE, 2048, Route::Direct), expected);
        assert_eq!(seen(&scene, BESIDE, 64, Route::Indirect).mean, Vec3::ZERO);
    }
}

/// The rectangle in low sunlight that passes below the fog.
fn sunlit_rectangle(albedo: Vec3, density: Density) -> TracedScene {
    let direction = Vec3::new(1.0, -0.2, 0.0).normalize();
    let sun = Light::Directional { direction, irradiance: Vec3::splat(4.0), pattern: None };
    traced(vec![(rectangle(), matte(albedo, Vec3::ZERO))], vec![sun], medium(0.5, density))
}

#[test]
fn fog_over_a_sunlit_rectangle_scatters_what_it_reflects() {
    let albedo = Vec3::new(0.8, 0.5, 0.3);
    let cosine = 0.2 / 1.04f32.sqrt();
    for density in both_ways(within(ABOVE[0], ABOVE[1])) {
        let scene = sunlit_rectangle(albedo, density.clone());
        let reflected = albedo * 4.0 * cosine / std::f32::consts::PI;
        let turned = each_colour(|absorption, scattering| lit_from_below(0.5, absorption, scattering));
        let found = seen(&scene, BESIDE, 4096, Route::Indirect);
        let name = "fog/sunlit_rectangle";
        found.proves(name, reflected * turned);
        found.refutes(name, reflected * turned * 1.05);
        // Without the cosine.
        found.refutes(name, reflected * turned / cosine);
        // Black surfaces have no part in it, and the fog's own light is another effect's.
        let black = sunlit_rectangle(Vec3::ZERO, density);
        assert_eq!(seen(&black, BESIDE, 64, Route::Indirect).mean, Vec3::ZERO);
        assert!(seen(&black, BESIDE, 64, Route::Direct).mean.min_element() > 0.0);
    }
}

#[test]
fn surfaces_that_only_fog_shines_on_are_multiple_scattering() {
    // A thin beam through the fog that ends in the black wall; what is looked at is below it and in the dark.
    let beam = Light::Spot {
        position: Vec3::new(-5.0, 1.0, 0.0),
        direction: Vec3::X,
        intensity: Vec3::splat(50.0),
        range: f32::INFINITY,
        cos_inner: 0.999,
        cos_outer: 0.998,
        slide: None,
    };
    let parts = vec![(rectangle(), matte(Vec3::ONE, Vec3::ZERO)), wall(4.0)];
    let density = Density::Within(within(ABOVE[0], ABOVE[1]));
    let scene = traced(parts, vec![beam], medium(0.3, density));
    let camera = Camera::look_at(Vec3::new(-0.5, 0.4, 0.0), Vec3::new(1.4, 0.0, 0.0));
    let shot = Shot::new(&scene, &camera, [1, 1], f32::INFINITY);
    for none in [Route::Direct, Route::Indirect, Route::Surfaces] {
        assert_eq!(MeanWithError::of(&FullPath::along(none, &shot), &shot, 256).mean, Vec3::ZERO);
    }
    let multiple = MeanWithError::of(&multiple(&shot), &shot, 4096);
    assert!(multiple.mean.cmpgt(5.0 * multiple.error).all(), "{} +- {}", multiple.mean, multiple.error);
}

#[test]
fn what_is_not_scattered_is_dimmed_as_beer_and_lambert_say() {
    let glow = Vec3::new(1.0, 2.0, 3.0);
    let (mesh, _) = wall(5.0);
    for density in both_ways(within([1.0, -1.0, -1.0], [3.0, 1.0, 1.0])) {
        let scene = traced(vec![(mesh.clone(), matte(Vec3::ZERO, glow))], vec![], medium(0.2, density));
        let expected = glow * (-(ABSORPTION + SCATTERING) * 2.0).exp();
        prove("beer_lambert/surface", seen(&scene, Vec3::ZERO, 1024, Route::Surfaces), expected);
    }
}

/// Sum of some integrators' samples, and one more with a factor.
struct Sum<'a> {
    parts: Vec<FullPath<'a>>,
    whole: FullPath<'a>,
    factor: f32,
}

impl Integrator for Sum<'_> {
    fn sample(&self, at: Vec2, stream: &mut Stream) -> Vec3 {
        let parts: Vec3 = self.parts.iter().map(|part| part.sample(at, stream)).sum();
        if self.factor == 0.0 { parts } else { parts + self.factor * self.whole.sample(at, stream) }
    }
}

const ROUTES: [Route; 4] = [Route::Surfaces, Route::Direct, Route::Indirect, Route::Multiple];

/// A room without a ceiling: coloured, with a lamp, a glowing tile, a sky, and fog from knee to head.
fn room(density: Density) -> TracedScene {
    let floor = (level(0.0, [-2.0, 2.0], [-2.0, 2.0]), matte(Vec3::new(0.8, 0.6, 0.4), Vec3::ZERO));
    let back = [(0., -2.), (0., 2.), (3., 2.), (3., -2.)].map(|(y, z)| Vec3::new(2.0, y, z));
    let back = (quad(back), matte(Vec3::new(0.3, 0.7, 0.9), Vec3::ZERO));
    let tile = (level(2.4, [0.0, 1.0], [-1.0, 0.0]), matte(Vec3::ZERO, Vec3::new(4.0, 3.0, 2.0)));
    let lamp = Light::Point {
        position: Vec3::new(-1.0, 3.0, 1.0),
        intensity: Vec3::new(6.0, 8.0, 10.0),
        range: f32::INFINITY,
    };
    let scene = traced(vec![floor, back, tile], vec![lamp], medium(0.4, density));
    let sky = Environment::uniform(Vec3::new(0.2, 0.3, 0.5));
    TracedScene::new(Scene { environment: Some(Arc::new(sky)), ..scene.scene().clone() }).expect("triangles")
}

fn room_camera() -> Camera {
    Camera::look_at(Vec3::new(-4.0, 1.5, 0.5), Vec3::new(1.0, 0.8, 0.0))
}

#[test]
fn the_three_and_dimmed_surfaces_add_up_to_full_path_tracing() {
    let bounds = within([-1.8, 0.4, -1.5], [1.8, 1.9, 1.5]);
    let smoke = Weather::smoke(2, 1.0, 0.8).grid(bounds, 12, 0.0).expect("smoke");
    for density in [Density::Within(bounds), Density::Grid(smoke)] {
        let (scene, camera) = (room(density), room_camera());
        let shot = Shot::new(&scene, &camera, [2, 3], f32::INFINITY);
        let rest = |without: Option<Route>, samples: u32| {
            let parts = ROUTES.into_iter().filter(|route| Some(*route) != without);
            let parts = parts.map(|route| FullPath::along(route, &shot)).collect();
            MeanWithError::of(&Sum { parts, whole: FullPath::new(&shot), factor: -1.0 }, &shot, samples)
        };
        rest(None, 4096).proves("fog/sum_of_routes", Vec3::ZERO);
        for without in ROUTES {
            rest(Some(without), 512).refutes("fog/sum_of_routes", Vec3::ZERO);
        }
    }
}

/// A white floor in white fog of an albedo, under an even sky.
fn furnace(albedo: f32, density: Density, sky: Vec3) -> TracedScene {
    let scattering = Vec3::new(0.5, 1.0, 2.0);
    let fog = Medium::new(scattering * (1.0 - albedo), scattering * albedo, 0.5, density).expect("a medium");
    let floor = (level(0.0, [-1.0, 1.0], [-1.0, 1.0]), matte(Vec3::ONE, Vec3::ZERO));
    let scene = traced(vec![floor], vec![], fog).scene().clone();
    let environment = Some(Arc::new(Environment::uniform(sky)));
    TracedScene::new(Scene { environment, ..scene }).expect("triangles")
}

#[test]
fn white_fog_under_an_even_sky_is_not_seen() {
    let sky = Vec3::new(1.0, 0.5, 2.0);
    let bounds = within([-1.5, -1.0, -1.2], [1.5, 1.0, 1.2]);
    let smoke = Weather::smoke(5, 0.8, 0.9).grid(bounds, 12, 0.0).expect("smoke");
    for density in [Density::Within(bounds), Density::Grid(smoke)] {
        for target in [Vec3::ZERO, Vec3::new(0.0, 0.4, 0.1)] {
            let camera = Camera::look_at(Vec3::new(-3.0, 0.8, 0.3), target);
            let measured = |albedo: f32, factor: f32| {
                let scene = furnace(albedo, density.clone(), sky);
                let shot = Shot::new(&scene, &camera, [1, 1], f32::INFINITY);
                let parts = if factor == 0.0 {
                    ROUTES.map(|route| FullPath::along(route, &shot)).into()
                } else {
                    vec![]
                };
                MeanWithError::of(&Sum { parts, whole: FullPath::new(&shot), factor }, &shot, 1024)
            };
            for factor in [0.0, 1.0] {
                measured(1.0, factor).proves("furnace/fog", sky);
                // Grey fog.
                measured(0.95, factor).refutes("furnace/fog", sky);
            }
        }
    }
}

#[test]
fn images_do_not_depend_on_the_number_of_threads() {
    let bounds = within([-1.8, 0.4, -1.5], [1.8, 1.9, 1.5]);
    let smoke = Weather::smoke(2, 1.0, 0.8).grid(bounds, 12, 0.0).expect("smoke");
    let (scene, camera) = (room(Density::Grid(smoke)), room_camera());
    for effect in [Effect::FogDirect, Effect::FogIndirect, Effect::FogMultiple, Effect::Path] {
        let image = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let shot = Shot::new(&scene, &camera, [19, 35], f32::INFINITY);
            pool.install(|| render(effect, &shot, Sampling::one(4, 3)))
        };
        assert_eq!(image(1), image(3));
    }
}
