//! Volumes in plain Rust, filled with a scene's light, which has been handed on, and what it is at a point.

use super::LpvParameters;
use super::passes::{Filled, Shines, surfel_settings};
use crate::bvh::TracedScene;
use crate::lpv::LightGrid;
use crate::lpv::injection::{self, sent_by_medium, sent_from, single_scattering, volume};
use crate::lpv::lobe::irradiance;
use crate::lpv::propagation::{CellFluence, Field, Kinds, Light, Volume};
use crate::lpv::scheme::Lookup;
use crate::lpv::sides::Begun;
use crate::lpv::sky::Sky;
use crate::methods::phosphor::cells::PlainCells;
use crate::path::phosphor::Afterglow;
use crate::raster::geometry::draws_of;
use crate::raster::patches::{self, Emission, Patch};
use crate::scene::Medium;
use crate::screen::View;
use crate::surfels::SurfelLight;
use crate::surfels::reference::{self as surfels, Disk};
use glam::{IVec3, Mat3, Vec3, Vec4Swizzles};
use std::f32::consts::PI;

/// A volume whose light has been handed on.
pub struct LitVolume {
    grid: LightGrid,
    lookup: Lookup,
    shown: CellFluence,
    /// Whether it is in a coarser one.
    is_nested: bool,
}

/// The volume around a scene, and finer ones in it.
pub struct LitVolumes(pub Vec<LitVolume>);

/// How far outside of a grid a medium is looked for, metres, and at how many points.
const OUTSIDE: f32 = 1e5;
const POINTS: u32 = 8;

/// What a cell behind a surface counts at least.
const LEAST_SEEN: f32 = 1e-3;

/// What of a scene fills its volumes.
struct VolumeSource<'a> {
    scene: &'a TracedScene,
    patches: Vec<Patch>,
    disks: Vec<Disk>,
    /// Radiance of each patch by itself, if any has some.
    shines: Option<Vec<Vec3>>,
    /// The cells of a medium that gives back light, if it does.
    cells: Option<PlainCells<'a>>,
    /// The sky, if it shines.
    sky: Option<Sky>,
    view: &'a View,
    parameters: LpvParameters,
    filled: Filled,
    reach: f32,
}

/// A volume, and the same of light that the scene sends by itself, if it does.
struct Level {
    light: LitVolume,
    emission: Option<LitVolume>,
}

impl LitVolumes {
    /// Those of a scene, of light that goes no farther than `reach`, metres.
    pub fn new(
        scene: &TracedScene,
        parameters: LpvParameters,
        view: &View,
        filled: Filled,
        reach: f32,
    ) -> Self {
        let [light, _] = Self::with_emission(scene, parameters, view, filled, reach);
        light
    }

    /// The same, and those of light that the scene and the sky send by themselves, on its way to what turns
    /// it: none where there is no such light.
    pub fn with_emission(
        scene: &TracedScene,
        parameters: LpvParameters,
        view: &View,
        filled: Filled,
        reach: f32,
    ) -> [Self; 2] {
        let grids = parameters.grids(filled, scene.scene().bounds(), view.camera.position);
        let patches = patches::of_scene(scene.scene(), SurfelLight::reflectance(Some(filled.lit())));
        let cell = parameters.finest_cell(filled, scene.scene().bounds());
        let disks = disks(scene, &patches, cell, view, filled);
        let shines = shines(scene, &patches, filled);
        let cells = cells(scene, cell, filled);
        let environment = scene.scene().environment.as_deref();
        let sky = environment.filter(|_| filled.shines(scene.scene()).sky).map(Sky::new);
        let source =
            VolumeSource { scene, patches, disks, shines, cells, sky, view, parameters, filled, reach };
        let mut levels: Vec<Level> = Vec::new();
        for grid in &grids {
            let level = source.level(*grid, levels.last());
            levels.push(level);
        }
        let mut volumes = [Self(Vec::new()), Self(Vec::new())];
        for Level { light, emission } in levels {
            volumes[0].0.push(light);
            volumes[1].0.extend(emission);
        }
        volumes
    }

    /// Irradiance on one side of a surface.
    pub fn irradiance(&self, point: Vec3, normal: Vec3) -> Vec3 {
        let finer = |below: Vec3, volume: &LitVolume| {
            below.lerp(volume.irradiance(point, normal), volume.share_of(point))
        };
        self.0.iter().fold(Vec3::ZERO, finer)
    }
}

impl VolumeSource<'_> {
    /// One of the volumes, in a coarser one if there is one.
    fn level(&self, grid: LightGrid, outside: Option<&Level>) -> Level {
        let (scene, scheme) = (self.scene.scene(), self.parameters.scheme);
        let (surfels, camera) = ((&self.disks[..], &self.patches[..]), &self.view.camera);
        let kinds = self.filled.kinds();
        let medium = scene.medium.as_deref().filter(|_| self.filled.has_medium());
        let (volume, mut reflected) = volume((grid, scheme), (medium, kinds.scattered), surfels, camera);
        let mut scattered = if kinds.scattered { single_scattering(&grid, self.scene) } else { Vec::new() };
        let mut emission = None;
        let by_itself = match self.filled.begins_as_emitted() {
            true => Some(std::mem::replace(&mut reflected, vec![Light::default(); grid.cells()])),
            false => self.sent_by_itself(&grid),
        };
        if let Some(light) = by_itself {
            let field = match &self.sky {
                Some(sky) => {
                    let passes = |point, way| passed(medium, kinds.scattered, point, way);
                    Field::steady(scheme, Begun::under(&volume, &light, sky, passes))
                }
                None => Field::new(&volume, Kinds::ONE, &light, &[]),
            };
            let outside = outside.and_then(|outside| outside.emission.as_ref());
            let emitted = self.handed_on(&volume, field, outside, f32::MAX);
            let colour = |patch: usize| self.patches[patch].colour();
            let reflects = |patch, point, normal| colour(patch) * emitted.irradiance(point, normal);
            add(&mut reflected, &sent_from(&grid, &self.disks, camera, reflects));
            let medium = scene.medium.as_deref();
            add(&mut scattered, &injection::scattered(&grid, medium, &emitted.shown.by_medium));
            emission = Some(emitted);
        }
        let outside = outside.map(|outside| &outside.light);
        let field = Field::new(&volume, kinds, &reflected, &scattered);
        Level { light: self.handed_on(&volume, field, outside, self.reach), emission }
    }

    /// Light that surfaces and the medium send by themselves, if any do.
    fn sent_by_itself(&self, grid: &LightGrid) -> Option<Vec<Light>> {
        let of_surfaces = self
            .shines
            .as_ref()
            .map(|shines| sent_from(grid, &self.disks, &self.view.camera, |patch, _, _| PI * shines[patch]));
        let of_medium = self.cells.as_ref();
        let of_medium = of_medium.map(|cells| sent_by_medium(grid, cells.medium, |point| cells.sent(point)));
        match (of_surfaces, of_medium) {
            (Some(mut light), Some(more)) => {
                add(&mut light, &more);
                Some(light)
            }
            (of_surfaces, of_medium) => {
                let none = || vec![Light::default(); grid.cells()];
                of_surfaces.or(of_medium).or_else(|| self.sky.map(|_| none()))
            }
        }
    }

    /// Light after all iterations, but for those beyond a reach.
    fn handed_on(&self, volume: &Volume, field: Field, outside: Option<&LitVolume>, reach: f32) -> LitVolume {
        let mut field = match outside {
            Some(outside) => field.nested(volume, (&outside.grid, &outside.shown.by_surfaces)),
            None => field,
        };
        let within = |iteration: &usize| (*iteration as f32) * volume.grid.cell < reach;
        field.iterate(volume, (0..self.parameters.iterations).filter(within).count());
        let (grid, lookup) = (volume.grid, volume.scheme.lookup);
        LitVolume { grid, lookup, shown: field.shown, is_nested: outside.is_some() }
    }
}

impl LitVolume {
    /// What of a point's light is its, and not a coarser one's.
    fn share_of(&self, point: Vec3) -> f32 {
        if self.is_nested { self.grid.share_of(point) } else { 1.0 }
    }

    /// Fluence of a cell, of each colour the flux in a column, and over all directions.
    fn of_cell(&self, at: IVec3) -> (Mat3, Vec3) {
        let light = &self.shown.by_medium[self.grid.index(at).expect("it is clamped")];
        (
            Mat3::from_cols(light[0].xyz(), light[1].xyz(), light[2].xyz()),
            Vec3::from([0, 1, 2].map(|c| light[c].w)),
        )
    }

    /// Cells at each end of an axis that are not looked at: what a coarser volume hands over in them is not
    /// all of their light.
    fn unseen(&self) -> i32 {
        i32::from(self.is_nested)
    }

    /// The eight cells around a point, with their trilinear weights.
    fn taps(&self, point: Vec3) -> impl Iterator<Item = (IVec3, f32)> + '_ {
        let size = self.grid.size;
        let unseen = Vec3::splat(self.unseen() as f32);
        let at = (self.grid.in_cells(point) - 0.5).clamp(unseen, size.as_vec3() - 1.0 - unseen);
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
    pub fn irradiance(&self, point: Vec3, normal: Vec3) -> Vec3 {
        let cell = self.grid.cell;
        if self.lookup == Lookup::Within {
            let (unseen, at) = (IVec3::splat(self.unseen()), self.grid.in_cells(point).floor().as_ivec3());
            let at = at.clamp(unseen, self.grid.size - 1 - unseen);
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
    pub fn scattered_along(&self, point: Vec3, direction: Vec3, anisotropy: f32) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for (at, weight) in self.taps(point) {
            let (flux, all) = self.of_cell(at);
            sum += weight * (all + 3.0 * anisotropy * (flux.transpose() * direction));
        }
        sum.max(Vec3::ZERO) / (4.0 * PI * self.grid.cell * self.grid.cell)
    }

    /// Where a ray is in the grid's box and a span.
    pub fn span(&self, origin: Vec3, direction: Vec3, [begins, ends]: [f32; 2]) -> [f32; 2] {
        let along = Vec3::select(direction.abs().cmplt(Vec3::splat(1e-12)), Vec3::splat(1e-12), direction);
        let high = self.grid.low + self.grid.cell * self.grid.size.as_vec3();
        let (a, b) = ((self.grid.low - origin) / along, (high - origin) / along);
        let begins = begins.max(a.min(b).max_element());
        [begins, begins.max(ends.min(a.max(b).min_element()))]
    }
}

/// What of light passes a medium from a point on, which `is_similar` as that of cells is.
fn passed(medium: Option<&Medium>, is_similar: bool, point: Vec3, way: Vec3) -> Vec3 {
    let Some(medium) = medium else { return Vec3::ONE };
    let ahead = if is_similar { medium.anisotropy * medium.scattering } else { Vec3::ZERO };
    (-(medium.extinction() - ahead) * medium.passed_density(point, way, OUTSIDE, POINTS)).exp()
}

/// Adds light to that of the same cells, if they have any.
fn add(light: &mut [Light], more: &[Light]) {
    light.iter_mut().zip(more).for_each(|(light, more)| (0..3).for_each(|c| light[c] += more[c]));
}

/// Radiance that patches emit and, in a medium, give back of what they kept.
fn shines(scene: &TracedScene, patches: &[Patch], filled: Filled) -> Option<Vec<Vec3>> {
    let Shines { emits, gives_back, .. } = filled.shines(scene.scene());
    let emissions = emits.then(|| patches::emissions(scene.scene(), &draws_of(scene.scene())));
    let emitted = emissions.map(|all| all.into_iter().map(Emission::radiance).collect::<Vec<_>>());
    let given = gives_back.then(|| surfels::given_back(scene, patches));
    match (emitted, given) {
        (Some(emitted), Some(given)) => Some(emitted.iter().zip(given).map(|(a, b)| *a + b).collect()),
        (emitted, given) => emitted.or(given),
    }
}

/// The cells, of such an edge, of a medium that gives back light that it kept.
fn cells(scene: &TracedScene, edge: f32, filled: Filled) -> Option<PlainCells<'_>> {
    let gives_back = filled.shines(scene.scene()).medium_gives_back;
    gives_back.then(|| PlainCells::new(scene, &Afterglow::new(scene).by_lamps(), edge)).flatten()
}

/// The surfels of a scene, as many as cells of such an edge want, with their light.
fn disks(scene: &TracedScene, patches: &[Patch], cell: f32, view: &View, filled: Filled) -> Vec<Disk> {
    let vertices = surfels::vertices(scene.scene().meshes.iter(), &view.camera);
    let settings = surfel_settings(cell, scene.scene().bounds());
    let amounts = surfels::amounts(patches, &vertices, &settings);
    let disks = surfels::disks(patches, &vertices, &amounts, &settings);
    surfels::lit(scene, disks, patches, &view.camera, filled.lit())
}
