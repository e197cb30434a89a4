//! Laying surfels out, in plain Rust: what the passes of `shaders/wgsl/surfels` do, without a tree.

use super::{MOST, Surfel, SurfelDensity, SurfelLight};
use crate::bvh::TracedScene;
use crate::path::lights::Arrival;
use crate::path::phosphor::Afterglow;
use crate::raster::geometry::draws_of;
use crate::raster::patches::{self, Emission, Patch, Reflectance};
use crate::scene::medium::POINTS;
use crate::scene::{Camera, Medium, Mesh, Scene};
use crate::screen::View;
use deepshade_shaders::random::random;
use deepshade_shaders::wgsl::uniforms;
use glam::{Mat3, Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::PI;

/// A patch gets no more surfels; each is larger then.
const MOST_A_PATCH: f32 = 4096.0;
/// How far a surfel's chance has to rise above its threshold until it is as large as it gets, as a share.
const RISE: f32 = 0.25;
/// One over the plastic number, and over its square.
const STRIDE: Vec2 = Vec2::new(0.754_877_7, 0.569_840_3);

/// How far a point is lifted off its own surface before light is looked for, over the scene's diagonal.
const LIFT: f32 = 1e-5;

/// A disk in camera space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    /// Its middle, metres.
    pub place: Vec3,
    /// Metres.
    pub radius: f32,
    /// Unit vector.
    pub normal: Vec3,
    /// Whether its back is seen too, since its surface is no closed one.
    pub open: bool,
    /// Index of the patch that it stands for a part of.
    pub patch: u32,
    /// Radiance on the side of the normal and on the other; black until it is [`lit`].
    pub sent: [Vec3; 2],
}

impl From<Surfel> for Disk {
    /// It as part of the first patch, and black.
    fn from(surfel: Surfel) -> Self {
        let (place, radius) = (Vec3::from_array(surfel.place), surfel.radius());
        let (normal, open) = (surfel.normal(), surfel.is_open());
        Self { place, radius, normal, open, patch: 0, sent: [Vec3::ZERO; 2] }
    }
}

/// A patch as a camera sees it.
struct Laid {
    corners: Mat3,
    weights: Mat3,
    area: f32,
    radius: f32,
}

impl Laid {
    fn new(patch: &Patch, vertices: &[Vec3], settings: &uniforms::Surfels) -> Self {
        let [a, b, c] = patch.corners.map(|corner| vertices[corner as usize]);
        let [x, y, z] = patch.weights();
        let (corners, weights) = (Mat3::from_cols(a, b, c), Mat3::from_cols(x, y, z));
        let area = 0.5 * (b - a).cross(c - a).length() * (-2.0 * patch.halvings() as f32).exp2();
        let middle = corners * (weights * Vec3::splat(1.0 / 3.0));
        let aside = outside(middle, settings).max(0.0);
        let radius = settings.slope * ((middle.z + settings.near).abs() + settings.near + aside);
        Self { corners, weights, area, radius: radius.max((area / (PI * MOST_A_PATCH)).sqrt()) }
    }

    fn middle(&self) -> Vec3 {
        self.corners * (self.weights * Vec3::splat(1.0 / 3.0))
    }

    /// How far a corner of the patch is from its middle at most.
    fn extent(&self) -> f32 {
        let at = self.corners * self.weights;
        [at.x_axis, at.y_axis, at.z_axis]
            .map(|corner| corner.distance(self.middle()))
            .into_iter()
            .fold(0.0, f32::max)
    }

    fn normal(&self) -> Vec3 {
        let Mat3 { x_axis, y_axis, z_axis } = self.corners;
        (y_axis - x_axis).cross(z_axis - x_axis).normalize()
    }

    /// The triangle's corners, moved towards its middle by the radius of a surfel.
    fn inset(&self) -> Mat3 {
        let middle = self.corners * Vec3::splat(1.0 / 3.0);
        let inwards = |corner: Vec3| {
            let way = middle - corner;
            corner + way * (self.radius / way.length().max(1e-30)).min(1.0)
        };
        let Mat3 { x_axis, y_axis, z_axis } = self.corners;
        Mat3::from_cols(inwards(x_axis), inwards(y_axis), inwards(z_axis))
    }
}

/// The share of a surfel that a patch of `share` of one gets, at a threshold from 0 to 1: 0 below it, rising
/// above it, and 1 for all thresholds where the share is 1. Its mean over all thresholds is the share.
pub fn roulette(share: f32, threshold: f32) -> f32 {
    let risen = 1.0 + RISE;
    let largest = 1.0 / ((risen.ln() + 1.0 / risen - 1.0) / RISE + 1.0 / risen);
    let chance = risen * share;
    let size = largest * ((chance / threshold.max(1e-9) - 1.0) / RISE).clamp(0.0, 1.0);
    let mean = match chance > 1.0 {
        true => largest * (((risen / chance).ln() + 1.0 / risen - 1.0 / chance) / RISE + 1.0 / risen),
        false => 1.0,
    };
    share * size / (chance * mean)
}

/// Steps of the golden ratio: of patches that follow one another, and so lie together, always about the same
/// share has a surfel.
fn threshold(index: u32) -> f32 {
    (index.wrapping_mul(2_654_435_769) >> 8) as f32 / (1 << 24) as f32
}

/// How far a point of camera space is outside of what is seen, metres; negative inside.
pub fn outside(point: Vec3, settings: &uniforms::Surfels) -> f32 {
    let slopes = Vec2::new(settings.slope_x, settings.slope_y);
    let beyond = (point.truncate().abs() * slopes + point.z) / (Vec2::ONE + slopes * slopes).map(f32::sqrt);
    beyond.max_element()
}

/// How many surfels each patch gets; the last one is the fraction of one.
pub fn amounts(patches: &[Patch], vertices: &[Vec3], settings: &uniforms::Surfels) -> Vec<f32> {
    let matters = |middle: Vec3, reach: f32| -middle.z > -reach && outside(middle, settings) < reach;
    let amount = |(index, patch): (usize, &Patch)| {
        let laid = Laid::new(patch, vertices, settings);
        let share = laid.area / (PI * laid.radius * laid.radius);
        let there = share > 0.0 && share < 2.0 * MOST_A_PATCH;
        match there && matters(laid.middle(), laid.extent() + settings.reach) {
            true if share < 1.0 => roulette(share, threshold(index as u32)),
            true => share,
            false => 0.0,
        }
    };
    patches.par_iter().enumerate().map(amount).collect()
}

/// The disks of all patches, in their order, however many they are; no more than [`MOST`] where a frame has
/// room for that many only.
pub fn disks(
    patches: &[Patch],
    vertices: &[Vec3],
    amounts: &[f32],
    settings: &uniforms::Surfels,
) -> Vec<Disk> {
    let count: usize = amounts.iter().map(|amount| amount.ceil() as usize).sum();
    let spread = count as f32 / count.min(MOST) as f32;
    let laid = |(index, (patch, amount)): (usize, (&Patch, &f32))| {
        let it = Laid::new(patch, vertices, settings);
        let (patch, amount, index) = (*patch, *amount, index as u32);
        (0..amount.ceil() as u32).map(move |number| {
            let offset = [1, 2].map(|dimension| random(index, 0, 0, dimension));
            let at = (Vec2::from(offset) + STRIDE * (number + 1) as f32).fract();
            let at = if at.x + at.y > 1.0 { Vec2::ONE - at } else { at };
            let weights = it.weights * Vec3::new(1.0 - at.x - at.y, at.x, at.y);
            let share = (amount - number as f32).clamp(0.0, 1.0) * patch.coverage();
            Disk {
                patch: index,
                ..Disk::from(Surfel::new(
                    it.inset() * weights,
                    it.normal(),
                    patch.is_open(),
                    it.radius * (share * spread).sqrt(),
                    random(index, number, 0, 4),
                ))
            }
        })
    };
    let wanted: Vec<Disk> = patches.par_iter().zip(amounts).enumerate().flat_map_iter(laid).collect();
    if wanted.len() <= MOST {
        return wanted;
    }
    let rest = ((wanted.len() % MOST) << 12) / MOST;
    let begin = |index: usize| index * (wanted.len() / MOST) + ((index * rest) >> 12);
    let chosen = |index: usize| {
        let count = (begin(index + 1) - begin(index)) as f32;
        wanted[begin(index) + (random(index as u32, 0, 0, 3) * count) as usize]
    };
    (0..MOST).map(chosen).collect()
}

/// All vertices of a scene in camera space, in the order in which meshes are drawn.
pub fn vertices<'a>(meshes: impl IntoIterator<Item = &'a Mesh>, camera: &Camera) -> Vec<Vec3> {
    let turned = camera.rotation.transpose();
    let in_camera = |mesh: &'a Mesh| mesh.positions.iter().map(move |at| turned * (*at - camera.position));
    meshes.into_iter().flat_map(in_camera).collect()
}

/// The surfels of a scene that stays, for a view.
pub fn surfels(scene: &Scene, parameters: &SurfelDensity, view: &View) -> Vec<Disk> {
    patches_and_disks(scene, (parameters, Reflectance::Diffuse), view).1
}

/// The surfels of a scene that stays, for a view, with the light that they send, if any.
pub fn laid(
    scene: &TracedScene,
    parameters: &SurfelDensity,
    view: &View,
    light: Option<SurfelLight>,
) -> Vec<Disk> {
    let reflectance = SurfelLight::reflectance(light);
    let (patches, disks) = patches_and_disks(scene.scene(), (parameters, reflectance), view);
    match light {
        Some(light) => lit(scene, disks, &patches, &view.camera, light),
        None => disks,
    }
}

/// The patches of a scene, of which those without a surfel are not painted, and their surfels.
fn patches_and_disks(
    scene: &Scene,
    (parameters, reflectance): (&SurfelDensity, Reflectance),
    view: &View,
) -> (Vec<Patch>, Vec<Disk>) {
    let (vertices, settings) = (vertices(scene.meshes.iter(), &view.camera), parameters.settings(view));
    let mut all = Vec::new();
    let patches = patches::painted_where(scene, reflectance, |patches| {
        all = amounts(patches, &vertices, &settings);
        all.iter().map(|amount| *amount > 0.0).collect()
    });
    let disks = disks(&patches, &vertices, &all, &settings);
    (patches, disks)
}

/// Radiance that each of a scene's patches gives back of what it kept at its middle.
pub fn given_back(scene: &TracedScene, patches: &[Patch]) -> Vec<Vec3> {
    let (afterglow, origins) = (Afterglow::new(scene).by_lamps(), patches::origins(scene.scene()));
    let kept = |(patch, [mesh, triangle]): (&Patch, [usize; 2])| {
        let middle = patch.weights().into_iter().sum::<Vec3>() / 3.0;
        afterglow.emission_at(mesh, triangle, middle.to_array())
    };
    patches.par_iter().zip(origins).map(kept).collect()
}

/// Disks that send what their patches kept at their middles.
fn giving_back(scene: &TracedScene, disks: Vec<Disk>, patches: &[Patch]) -> Vec<Disk> {
    let given = given_back(scene, patches);
    let kept = |disk: Disk| {
        let front = given[disk.patch as usize];
        Disk { sent: [front, if disk.open { front } else { Vec3::ZERO }], ..disk }
    };
    disks.into_iter().map(kept).collect()
}

/// Disks of patches that send light of a scene's lamps, with exact shadows.
pub fn lit(
    scene: &TracedScene,
    disks: Vec<Disk>,
    patches: &[Patch],
    camera: &Camera,
    lit: SurfelLight,
) -> Vec<Disk> {
    let medium = match lit {
        SurfelLight::Kept => return giving_back(scene, disks, patches),
        SurfelLight::Dimmed { is_grey: true } => scene.scene().medium.as_deref().map(Medium::in_grey),
        SurfelLight::Dimmed { is_grey: false } | SurfelLight::DimmedAndEmitted => {
            scene.scene().medium.as_deref().cloned()
        }
        SurfelLight::Reflected | SurfelLight::Received | SurfelLight::Emitted => None,
    };
    let emissions = match lit {
        SurfelLight::DimmedAndEmitted | SurfelLight::Emitted => {
            patches::emissions(scene.scene(), &draws_of(scene.scene()))
        }
        SurfelLight::Kept | SurfelLight::Dimmed { .. } | SurfelLight::Reflected | SurfelLight::Received => {
            Vec::new()
        }
    };
    let light = |disk: Disk| {
        let (point, normal) = (camera.position + camera.rotation * disk.place, camera.rotation * disk.normal);
        let mut received = [Vec3::ZERO; 2];
        let lamps = scene.scene().shining_lights().filter(|_| lit != SurfelLight::Emitted);
        for light in lamps {
            let Arrival { direction, distance, irradiance } = Arrival::new(scene.scene(), light, point);
            let cosine = normal.dot(direction);
            let passed = match &medium {
                Some(medium) => medium.passed_share(point, direction, distance, POINTS),
                None => Vec3::ONE,
            };
            let lifted = point + normal * cosine.signum() * LIFT * scene.diagonal();
            if irradiance != Vec3::ZERO && !scene.blocked(lifted, direction, distance) {
                received[usize::from(cosine < 0.0)] += irradiance * passed * cosine.abs();
            }
        }
        // Of what is received all is told, as white would send it.
        let colour =
            if lit == SurfelLight::Received { Vec3::ONE } else { patches[disk.patch as usize].colour() };
        let emitted = emissions.get(disk.patch as usize).copied().map_or(Vec3::ZERO, Emission::radiance);
        let behind = if disk.open { emitted } else { Vec3::ZERO };
        let [front, back] = received.map(|received| received * colour / PI);
        Disk { sent: [front + emitted, back + behind], ..disk }
    };
    disks.into_par_iter().map(light).collect()
}
