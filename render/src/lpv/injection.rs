//! What is in a volume before the first iteration: light that surfels reflect, light of the lamps that the medium
//! scatters, and the medium itself.

use super::flight::Factors;
use super::lobe::MATTE;
use super::propagation::{Light, Volume};
use super::{Blockers, Flight, LightGrid, Scheme};
use crate::bvh::TracedScene;
use crate::path::lights::Arrival;
use crate::scene::{Camera, Density, Medium, Scene};
use crate::surfels::Patch;
use crate::surfels::reference::{Disk, POINTS};
use glam::{IVec3, Vec3, Vec4};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Nearer to a lamp than this, in cells, a point of the medium counts as that near.
const NEAREST: f32 = 0.25;

/// Light that disks reflect, and what they block and of which patch's colour. Light begins half a cell before its disk,
/// so that it lies before what blocks.
fn surfaces(
    grid: &LightGrid,
    (disks, patches): (&[Disk], &[Patch]),
    camera: &Camera,
) -> (Vec<Light>, Blockers) {
    let (mut light, mut blockers) = (vec![[Vec4::ZERO; 3]; grid.cells()], Blockers::new(grid));
    for disk in disks {
        let (point, normal) = (camera.position + camera.rotation * disk.place, camera.rotation * disk.normal);
        let area = PI * disk.radius * disk.radius;
        blockers.add(point, normal, area, patches[disk.patch as usize].colour());
        for (normal, sent) in [(normal, disk.sent[0]), (-normal, disk.sent[1])] {
            let at = (grid.in_cells(point) + 0.5 * normal).floor().as_ivec3();
            let Some(index) = grid.index(at) else { continue };
            let moments = (MATTE * normal).extend(1.0);
            (0..3).for_each(|c| light[index][c] += moments * (PI * area * sent[c]));
        }
    }
    (light, blockers)
}

/// The first of Gauss' two points along an edge, and from there to the second, as shares of it. No surface is likely to be there.
const GAUSS: [f32; 2] = [0.211_324_87, 0.577_350_26];

/// What of a cell lies in a medium's box, so that none is lost between the points of a cell that is larger than it.
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

/// What a medium does in each cell: by similarity one that scatters alike in all directions, and as much less of it as
/// keeps the mean flux (van de Hulst 1980).
pub fn flights(grid: &LightGrid, medium: Option<&Medium>, factors: Factors) -> Vec<[Flight; 3]> {
    let Some(medium) = medium else { return vec![[Flight::by(factors, 0.0, 0.0); 3]; grid.cells()] };
    let scattering = medium.scattering * (1.0 - medium.anisotropy);
    let extinction = medium.absorption + scattering;
    let albedo = (scattering / extinction.max(Vec3::splat(1e-30))).clamp(Vec3::ZERO, Vec3::ONE);
    let of_cell = |index: usize| {
        let part = CellPart::of(grid, grid.at(index), &medium.density);
        let density = part.points().map(|point| medium.density.inside(point)).sum::<f32>() / 8.0 * part.share;
        [0, 1, 2].map(|c| Flight::by(factors, extinction[c] * density * grid.cell, albedo[c]))
    };
    (0..grid.cells()).into_par_iter().map(of_cell).collect()
}

/// Light of the lamps that the medium in each cell scatters, with exact shadows; it goes on along the mean of the phase
/// function.
pub fn single_scattering(grid: &LightGrid, scene: &TracedScene) -> Vec<Light> {
    let Some(medium) = scene.scene().medium.as_deref() else { return vec![[Vec4::ZERO; 3]; grid.cells()] };
    let of_cell = |index: usize| {
        let mut sum = [Vec4::ZERO; 3];
        let part = CellPart::of(grid, grid.at(index), &medium.density);
        for point in part.points() {
            let density = medium.density.inside(point) * part.share;
            for light in &scene.scene().lights {
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

/// A scene's volume, and the light that its disks, of such patches, reflect; where it is not filled, nothing is between
/// surfaces.
pub fn volume(
    (grid, scheme): (LightGrid, Scheme),
    scene: &Scene,
    disks: (&[Disk], &[Patch]),
    camera: &Camera,
    filled: bool,
) -> (Volume, Vec<Light>) {
    let (light, blockers) = surfaces(&grid, disks, camera);
    let flights = flights(&grid, scene.medium.as_deref().filter(|_| filled), scheme.factors);
    let (passing, reflectances) = (blockers.passing(&grid), blockers.reflectances(&grid));
    (Volume { grid, flights, passing, reflectances, scheme }, light)
}
