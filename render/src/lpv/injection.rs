//! What is in a volume before the first iteration: light that surfels reflect or emit, light of the lamps
//! that the medium scatters, and the medium itself.

use super::flight::Factors;
use super::lobe::MATTE;
use super::propagation::{Light, Volume};
use super::{Blockers, Flight, LightGrid, Scheme};
use crate::bvh::TracedScene;
use crate::path::lights::Arrival;
use crate::raster::patches::Patch;
use crate::scene::medium::POINTS;
use crate::scene::{Camera, Density, Medium};
use crate::surfels::reference::Disk;
use glam::{IVec3, Vec3, Vec4};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Nearer to a lamp than this, in cells, a point of the medium counts as that near.
const NEAREST: f32 = 0.25;

/// Places, normals and areas of disks, world space.
fn laid<'a>(disks: &'a [Disk], camera: &'a Camera) -> impl Iterator<Item = (&'a Disk, Vec3, Vec3, f32)> {
    disks.iter().map(move |disk| {
        let (point, normal) = (camera.position + camera.rotation * disk.place, camera.rotation * disk.normal);
        (disk, point, normal, PI * disk.radius * disk.radius)
    })
}

/// Sends so many watts from one side of a surface. Light begins half a cell before it, so that it lies before
/// what blocks.
fn send(light: &mut [Light], grid: &LightGrid, (point, normal): (Vec3, Vec3), power: Vec3) {
    if let Some(index) = grid.index((grid.in_cells(point) + 0.5 * normal).floor().as_ivec3()) {
        let moments = (MATTE * normal).extend(1.0);
        (0..3).for_each(|c| light[index][c] += moments * power[c]);
    }
}

/// Light that disks reflect of the lamps', and what they block and of which patch's colour.
fn surfaces(
    grid: &LightGrid,
    (disks, patches): (&[Disk], &[Patch]),
    camera: &Camera,
) -> (Vec<Light>, Blockers) {
    let (mut light, mut blockers) = (vec![Light::default(); grid.cells()], Blockers::new(grid));
    for (disk, point, normal, area) in laid(disks, camera) {
        blockers.add(point, normal, area, patches[disk.patch as usize].colour());
        for (normal, sent) in [(normal, disk.sent[0]), (-normal, disk.sent[1])] {
            send(&mut light, grid, (point, normal), PI * area * sent);
        }
    }
    (light, blockers)
}

/// What disks send from each of their sides that is outside of bodies: watts a square metre of patch, point
/// and normal.
pub fn sent_from(
    grid: &LightGrid,
    disks: &[Disk],
    camera: &Camera,
    sends: impl Fn(usize, Vec3, Vec3) -> Vec3,
) -> Vec<Light> {
    let mut light = vec![Light::default(); grid.cells()];
    for (disk, point, normal, area) in laid(disks, camera) {
        for normal in [Some(normal), disk.open.then_some(-normal)].into_iter().flatten() {
            send(&mut light, grid, (point, normal), area * sends(disk.patch as usize, point, normal));
        }
    }
    light
}

/// The first of Gauss' two points along an edge, and from there to the second, as shares of it. No surface is
/// likely to be there.
const GAUSS: [f32; 2] = [0.211_324_87, 0.577_350_26];

/// What of a cell lies in a medium's box, so that none is lost between the points of a cell that is larger
/// than it.
struct CellPart {
    low: Vec3,
    /// Edges, metres; none is below 0.
    size: Vec3,
    /// Its share of the cell.
    share: f32,
}

impl CellPart {
    fn of(grid: &LightGrid, at: IVec3, density: &Density) -> Self {
        let low = grid.low + grid.cell * at.as_vec3();
        let bounds = match density {
            Density::Everywhere => return Self { low, size: Vec3::splat(grid.cell), share: 1.0 },
            Density::Within(bounds) => *bounds,
            Density::Grid(grid) => grid.bounds(),
        };
        let (begins, ends) = (low.max(bounds.min), (low + grid.cell).min(bounds.max));
        let size = (ends - begins).max(Vec3::ZERO);
        Self { low: begins, size, share: (size / grid.cell).element_product() }
    }

    /// Eight points of it, world space.
    fn points(&self) -> impl Iterator<Item = Vec3> {
        let corner = |i: i32| IVec3::new(i & 1, i >> 1 & 1, i >> 2).as_vec3();
        (0..8).map(move |i| self.low + self.size * (GAUSS[0] + GAUSS[1] * corner(i)))
    }
}

/// Mean density of a medium in a cell.
fn density(grid: &LightGrid, index: usize, medium: &Medium) -> f32 {
    let part = CellPart::of(grid, grid.at(index), &medium.density);
    part.points().map(|point| medium.density.inside(point)).sum::<f32>() / 8.0 * part.share
}

/// What a medium does in each cell: all of it to light that is lost where it is scattered; to such as is
/// followed, if it `is_similar`, one that scatters alike in all directions, and as much less of it as keeps
/// the mean flux (van de Hulst 1980).
pub fn flights(
    grid: &LightGrid,
    medium: Option<&Medium>,
    factors: Factors,
    is_similar: bool,
) -> Vec<[Flight; 3]> {
    let Some(medium) = medium else { return vec![[Flight::by(factors, 0.0, 0.0); 3]; grid.cells()] };
    let scattering = medium.scattering * if is_similar { 1.0 - medium.anisotropy } else { 1.0 };
    let extinction = medium.absorption + scattering;
    let albedo = (scattering / extinction.max(Vec3::splat(1e-30))).clamp(Vec3::ZERO, Vec3::ONE);
    let of_cell = |index: usize| {
        let density = density(grid, index, medium);
        [0, 1, 2].map(|c| Flight::by(factors, extinction[c] * density * grid.cell, albedo[c]))
    };
    (0..grid.cells()).into_par_iter().map(of_cell).collect()
}

/// Light of the lamps that the medium in each cell scatters, with exact shadows; it goes on along the mean of
/// the phase function.
pub fn single_scattering(grid: &LightGrid, scene: &TracedScene) -> Vec<Light> {
    let Some(medium) = scene.scene().medium.as_deref() else { return vec![[Vec4::ZERO; 3]; grid.cells()] };
    let of_cell = |index: usize| {
        let mut sum = [Vec4::ZERO; 3];
        let part = CellPart::of(grid, grid.at(index), &medium.density);
        for point in part.points() {
            let density = medium.density.inside(point) * part.share;
            for light in scene.scene().shining_lights() {
                let Arrival { direction, distance, irradiance } = Arrival::new(scene.scene(), light, point);
                if irradiance == Vec3::ZERO || density == 0.0 || scene.blocked(point, direction, distance) {
                    continue;
                }
                let near = (distance / (NEAREST * grid.cell)).powi(2).min(1.0);
                let passed = medium.passed_share(point, direction, distance, POINTS);
                let power =
                    irradiance * passed * medium.scattering * (near * density * grid.cell.powi(3) / 8.0);
                let moments = (-direction * medium.anisotropy).extend(1.0);
                (0..3).for_each(|c| sum[c] += moments * power[c]);
            }
        }
        sum
    };
    (0..grid.cells()).into_par_iter().map(of_cell).collect()
}

/// Light that the medium in each cell sends by itself, alike in all directions: `sent` is the radiance that
/// it would have at a point where nothing is seen through it. What scatters light sends none of its own.
pub fn sent_by_medium(grid: &LightGrid, medium: &Medium, sent: impl Fn(Vec3) -> Vec3 + Sync) -> Vec<Light> {
    let of_cell = |index: usize| {
        let part = CellPart::of(grid, grid.at(index), &medium.density);
        let all: Vec3 = part.points().map(|point| medium.density.inside(point) * sent(point)).sum();
        let power = all * medium.absorption * (0.5 * PI * part.share * grid.cell.powi(3));
        [0, 1, 2].map(|c| Vec4::W * power[c])
    };
    (0..grid.cells()).into_par_iter().map(of_cell).collect()
}

/// What the medium in each cell scatters of light whose flux and energy times lengths of ways, watts times
/// cells, are known; a grid's medium scatters alike in all directions.
pub fn scattered(grid: &LightGrid, medium: Option<&Medium>, ways: &[Light]) -> Vec<Light> {
    let Some(medium) = medium else { return vec![Light::default(); grid.cells()] };
    let scattering = medium.scattering * (1.0 - medium.anisotropy) * grid.cell;
    let of_cell = |index: usize| {
        let density = density(grid, index, medium);
        [0, 1, 2].map(|c| Vec4::W * (ways[index][c].w * scattering[c] * density))
    };
    (0..grid.cells()).into_par_iter().map(of_cell).collect()
}

/// A scene's volume, filled with such a medium, and the light that its disks, of such patches, reflect.
pub fn volume(
    (grid, scheme): (LightGrid, Scheme),
    (medium, is_similar): (Option<&Medium>, bool),
    disks: (&[Disk], &[Patch]),
    camera: &Camera,
) -> (Volume, Vec<Light>) {
    let (light, blockers) = surfaces(&grid, disks, camera);
    let flights = flights(&grid, medium, scheme.factors, is_similar);
    let (passing, reflectances) = (blockers.passing(), blockers.reflectances());
    (Volume { grid, flights, passing, reflectances, scheme }, light)
}
