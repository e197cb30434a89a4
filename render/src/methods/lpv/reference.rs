//! Light propagation volumes in plain Rust, with exact shadows: what the passes of `methods/lpv` do.

use super::Parameters;
use super::passes::{Filled, Pixel, surfel_settings};
use crate::bvh::TracedScene;
use crate::lpv::LightGrid;
use crate::lpv::injection::{single_scattering, volume};
use crate::lpv::lobe::irradiance;
use crate::lpv::propagation::{Field, Shown};
use crate::lpv::scheme::Lookup;
use crate::methods::picture::every_pixel;
use crate::methods::single_scattering::mean_decay;
use crate::scene::Medium;
use crate::screen::View;
use crate::surfels::{Patch, patches, reference as surfels};
use deepshade_shaders::random::random;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes, shows_surface};
use glam::{IVec3, Mat3, UVec2, Vec2, Vec3, Vec4Swizzles};
use std::f32::consts::PI;

/// A volume whose light has been handed on.
pub struct LitVolume {
    grid: LightGrid,
    lookup: Lookup,
    shown: Shown,
}

/// What a cell behind a surface counts at least.
const LEAST_SEEN: f32 = 1e-3;
/// What `apply.wgsl` calls so.
const TOLERANCE: f32 = 0.02;
const LEAST: f32 = 1e-4;
const POINTS: u32 = 16;

/// Place, normal and diffuse colour of a surface, world space.
type Seen = [Vec3; 3];

impl LitVolume {
    /// That of a scene, of light that goes no farther than `reach`, metres.
    pub fn new(scene: &TracedScene, parameters: Parameters, view: &View, filled: Filled, reach: f32) -> Self {
        let bounds = scene.scene().bounds();
        let grid = LightGrid::around(bounds, parameters.cells);
        let patches = patches::of_scene(scene.scene());
        let (disks, medium) = (disks(scene, &patches, &grid, view, filled), filled != Filled::Clear);
        let scheme = parameters.scheme;
        let (volume, reflected) =
            volume((grid, scheme), scene.scene(), (&disks, &patches), &view.camera, medium);
        let kinds = filled.kinds();
        let scattered = if kinds.scattered { single_scattering(&grid, scene) } else { Vec::new() };
        let mut field = Field::new(scheme, kinds, &reflected, &scattered);
        let within = |iteration: &usize| (*iteration as f32) * grid.cell < reach;
        (0..parameters.iterations).filter(within).for_each(|_| field.step(&volume));
        Self { grid, lookup: scheme.lookup, shown: field.shown }
    }

    /// Fluence of a cell, of each colour the flux in a column, and over all directions.
    fn of_cell(&self, at: IVec3) -> (Mat3, Vec3) {
        let light = &self.shown.by_medium[self.grid.index(at).expect("it is clamped")];
        (
            Mat3::from_cols(light[0].xyz(), light[1].xyz(), light[2].xyz()),
            Vec3::from([0, 1, 2].map(|c| light[c].w)),
        )
    }

    /// The eight cells around a point, with their trilinear weights.
    fn taps(&self, point: Vec3) -> impl Iterator<Item = (IVec3, f32)> + '_ {
        let size = self.grid.size;
        let at = (self.grid.in_cells(point) - 0.5).clamp(Vec3::ZERO, size.as_vec3() - 1.0);
        let low = at.floor().min((size.as_vec3() - 2.0).max(Vec3::ZERO));
        (0..8).map(move |i| {
            let corner = IVec3::new(i & 1, i >> 1 & 1, i >> 2);
            let weights = Vec3::select(corner.cmpeq(IVec3::ONE), at - low, 1.0 - (at - low));
            ((low.as_ivec3() + corner).min(size - 1), weights.element_product())
        })
    }

    /// Irradiance of the light of one cell.
    fn irradiance_of_cell(&self, at: IVec3, normal: Vec3) -> Vec3 {
        let light = &self.shown.by_surfaces[self.grid.index(at).expect("it is clamped")];
        Vec3::from(light.map(|moments| irradiance(moments, normal))) / (self.grid.cell * self.grid.cell)
    }

    /// Irradiance on one side of a surface.
    fn irradiance(&self, point: Vec3, normal: Vec3) -> Vec3 {
        let cell = self.grid.cell;
        if self.lookup == Lookup::Within {
            let at = self.grid.in_cells(point).floor().as_ivec3().clamp(IVec3::ZERO, self.grid.size - 1);
            return self.irradiance_of_cell(at, normal);
        }
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for (at, weight) in self.taps(point + 0.5 * cell * normal) {
            let before = ((self.grid.middle(at) - point).dot(normal) / (0.25 * cell)).clamp(0.0, 1.0);
            let weight = weight * before.max(LEAST_SEEN);
            sum += weight * self.irradiance_of_cell(at, normal);
            weights += weight;
        }
        sum / weights
    }

    /// Radiance that a metre of density 1 sends along a direction, over its scattering coefficient.
    fn scattered_along(&self, point: Vec3, direction: Vec3, anisotropy: f32) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for (at, weight) in self.taps(point) {
            let (flux, all) = self.of_cell(at);
            sum += weight * (all + 3.0 * anisotropy * (flux.transpose() * direction));
        }
        sum.max(Vec3::ZERO) / (4.0 * PI * self.grid.cell * self.grid.cell)
    }

    /// Where a ray is in the grid's box and a span.
    fn span(&self, origin: Vec3, direction: Vec3, [begins, ends]: [f32; 2]) -> [f32; 2] {
        let along = Vec3::select(direction.abs().cmplt(Vec3::splat(1e-12)), Vec3::splat(1e-12), direction);
        let high = self.grid.low + self.grid.cell * self.grid.size.as_vec3();
        let (a, b) = ((self.grid.low - origin) / along, (high - origin) / along);
        let begins = begins.max(a.min(b).max_element());
        [begins, begins.max(ends.min(a.max(b).min_element()))]
    }
}

/// The surfels of a scene, as many as a grid wants, with their light.
fn disks(
    scene: &TracedScene,
    patches: &[Patch],
    grid: &LightGrid,
    view: &View,
    filled: Filled,
) -> Vec<surfels::Disk> {
    let vertices = surfels::vertices(scene.scene().meshes.iter(), &view.camera);
    let settings = surfel_settings(grid, scene.scene().bounds());
    let amounts = surfels::amounts(patches, &vertices, &settings, view);
    let disks = surfels::disks(patches, &vertices, &amounts, &settings);
    surfels::lit(scene, disks, &view.camera, filled.lit())
}

/// Place, normal and, if it is asked for, diffuse colour of the surface of each pixel, world space; none where none is
/// seen.
fn seen(gbuffer: &GBuffer, view: &View, colour: bool) -> Result<Vec<Option<Seen>>, MissingAttribute> {
    let of = |attribute| gbuffer.select(&[attribute]);
    let (position, normal, valid) = (of(Attribute::Position)?, of(Attribute::Normal)?, of(Attribute::Valid)?);
    let diffuse = if colour { Some(of(Attribute::Diffuse)?) } else { None };
    let camera = &view.camera;
    let pixel = |i: usize| {
        let vector = |planes: &Planes| Vec3::from([0, 1, 2].map(|c| planes.plane(c)[i]));
        shows_surface(valid.plane(0)[i]).then(|| {
            let point = camera.position + camera.rotation * vector(&position);
            [point, camera.rotation * vector(&normal), diffuse.as_ref().map_or(Vec3::ONE, vector)]
        })
    };
    Ok((0..view.height * view.width).map(pixel).collect())
}

/// Irradiance over pi, `[3, height, width]`.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn lit(gbuffer: &GBuffer, volume: &LitVolume, view: &View) -> Result<Planes, MissingAttribute> {
    let seen = seen(gbuffer, view, false)?;
    let light = |surface: &Option<Seen>| {
        surface.map_or(Vec3::ZERO, |[point, normal, _]| volume.irradiance(point, normal) / PI)
    };
    let pixels: Vec<Vec3> = seen.iter().map(light).collect();
    Ok(Planes::from_fn(3, view.height, view.width, |c, y, x| pixels[y * view.width + x][c]))
}

/// The medium in front of each pixel and the surface behind it, as far as they are shown: radiance, `[3, height,
/// width]`.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn shade(
    gbuffer: &GBuffer,
    volume: &LitVolume,
    medium: &Medium,
    parameters: Parameters,
    (shown, view): (Pixel, &View),
) -> Result<Planes, MissingAttribute> {
    let seen = seen(gbuffer, view, true)?;
    let marched = Marched::new(&seen, volume, medium, parameters, view);
    let pixels = every_pixel(view.height, view.width, |pixel| {
        let pixel = pixel.as_uvec2();
        let scattered = if shown.medium { marched.before(pixel) } else { Vec3::ZERO };
        let surface = seen[(pixel.y as usize) * view.width + pixel.x as usize].filter(|_| shown.surface);
        scattered + surface.map_or(Vec3::ZERO, |surface| lit_through(volume, medium, surface, view))
    });
    Ok(Planes::from_fn(3, view.height, view.width, |c, y, x| pixels[y * view.width + x][c]))
}

/// What a surface sends to the eye through the medium.
fn lit_through(volume: &LitVolume, medium: &Medium, [point, normal, diffuse]: Seen, view: &View) -> Vec3 {
    let way = point - view.camera.position;
    let passed = medium.passed_share(view.camera.position, way.normalize(), way.length(), POINTS);
    passed * diffuse / PI * volume.irradiance(point, normal)
}

/// What the medium scatters in front of one pixel of some.
struct Marched {
    scale: u32,
    size: UVec2,
    scattered: Vec<Vec3>,
    /// How far away the surfaces of all pixels are, metres.
    distances: Vec<f32>,
    width: usize,
}

impl Marched {
    fn new(
        seen: &[Option<Seen>],
        volume: &LitVolume,
        medium: &Medium,
        Parameters { steps, scale, .. }: Parameters,
        view: &View,
    ) -> Self {
        let eye = view.camera.position;
        let distance = |surface: &Option<Seen>| surface.map_or(1e30, |[point, ..]| point.distance(eye));
        let distances: Vec<f32> = seen.iter().map(distance).collect();
        let [rows, columns] = [view.height, view.width].map(|edge| edge.div_ceil(scale));
        let scattered = every_pixel(rows, columns, |small| {
            let pixel = small.as_uvec2() * scale as u32;
            let reach = distances[pixel.y as usize * view.width + pixel.x as usize];
            march(volume, medium, steps, (pixel, reach), view)
        });
        let size = UVec2::new(columns as u32, rows as u32);
        Self { scale: scale as u32, size, scattered, distances, width: view.width }
    }

    fn distance(&self, pixel: UVec2) -> f32 {
        self.distances[pixel.y as usize * self.width + pixel.x as usize]
    }

    /// In front of a pixel, from those around it whose surfaces are as far away.
    fn before(&self, pixel: UVec2) -> Vec3 {
        let (low, reach) = (pixel / self.scale, self.distance(pixel));
        let part = (pixel - low * self.scale).as_vec2() / self.scale as f32;
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for corner in [UVec2::ZERO, UVec2::X, UVec2::Y, UVec2::ONE] {
            let tap = (low + corner).min(self.size - 1);
            let near = Vec2::select(corner.cmpeq(UVec2::ONE), part, 1.0 - part).element_product();
            let off = (self.distance(tap * self.scale) - reach) / (TOLERANCE * reach);
            let weight = near * (1.0 / (1.0 + off * off)).max(LEAST);
            sum += weight * self.scattered[(tap.y * self.size.x + tap.x) as usize];
            weights += weight;
        }
        sum / weights
    }
}

/// What the medium scatters to the eye in front of a pixel, up to a distance.
fn march(volume: &LitVolume, medium: &Medium, steps: u32, (pixel, reach): (UVec2, f32), view: &View) -> Vec3 {
    let (eye, extinction) = (view.camera.position, medium.extinction());
    let direction = view.camera.direction(pixel.as_vec2() + 0.5, view.height, view.width);
    let [begins, ends] = medium.seen_span(eye, direction, reach);
    let [begins, ends] = volume.span(eye, direction, [begins, begins.max(ends)]);
    let step = (ends - begins) / steps as f32;
    let shift = random(pixel.x, pixel.y, view.seed, 0);
    let mut passed = medium.passed_share(eye, direction, begins, 8);
    let mut sum = Vec3::ZERO;
    for i in 0..steps {
        let point = eye + direction * (begins + (i as f32 + shift) * step);
        let here = medium.density.inside(point) * step;
        let scattered = volume.scattered_along(point, -direction, medium.anisotropy);
        sum += passed * mean_decay(extinction * here) * here * scattered;
        passed *= (-extinction * here).exp();
    }
    sum * medium.scattering
}
