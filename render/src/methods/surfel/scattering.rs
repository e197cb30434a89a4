//! Subsurface scattering by surfels (thesis 4.3, "Multiple Scattering"): what surfels give through the body,
//! each by its light, its area and its distance (Jensen and Buhler 2002, "A rapid hierarchical rendering
//! technique for translucent materials").
//!
//! The profile is that of Christensen and Burley 2015, fitted to random walks, in place of the dipole:
//! through a slab of white wax one mean free path thick the dipole lets 0.81 of the light, the profile 0.62,
//! and truth 0.55. What surfels do not give stays with the pixel's own light, `E`. Those on its side of the
//! body, with shares `n` of the profile, mix with it: `M = E (1 - sum of n) + sum of n E_i`. Those on the far
//! side of a thin body give with shares `f` the light that goes through, and take as much of what would come
//! back: `M (1 - sum of f) + sum of f E_i`. So even light stays as it is, whatever the surfels. The shares of
//! a side are more than all of the profile where there are layers one behind the other, and here and there by
//! the noise of coarse levels: they are divided by their sum then. Surfels nearer than one is large are left
//! to the pixel.
//!
//! A pixel's own object gives and no other, from its far side too; of closed surfaces those that are met from
//! within. Levels are blurred within each object. The paper bounds the reach by what a surfel sends; here it
//! is where the receiver's profile ends, [`SUPPORT`].
//!
//! Limits. A sheet without thickness lets through all that falls on its other side. Between two points of a
//! body nothing is in the way. What is absorbed is that of a half space, of thin bodies and ridges less in
//! truth, which are too dark therefore. Between levels lie twelve channels: beyond 2.7 million pixels they
//! are more than devices bind that allow 128 MiB. Light farther than [`SUPPORT`] lengths or the effect's
//! radius is left to the pixel.
//!
//! It is no method for [`Effect::Sss`], whose truth knows what the image shows and nothing else: what surfels
//! know beyond that would count as an error.

use super::around::Ending;
use super::reference::{self, Receiver, Shade};
use super::{SurfelParameters, passes::Shading};
use crate::methods::Surface;
use crate::methods::disks::{DiskEffect, Plain};
use crate::methods::surface::vector;
use crate::path::sss::profile;
use crate::raster::patches::{self, Reflectance};
use crate::surfels::reference::Disk;
use crate::surfels::{SurfelLight, Tree};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::{Attribute, Effect, MissingAttribute, Planes};
use glam::{IVec2, Vec3};
use std::f32::consts::PI;

/// Beyond so many lengths less than a thousandth of the profile is left: `3 exp(-r / (3 d)) / 4`.
pub const SUPPORT: f32 = 19.9;
/// A closed surface is met from within if that is so from below the pixel's: so far, over the distance, and
/// over the height above it, that what lies in a plane or a hollow is.
const BELOW_PLANE: f32 = 0.02;
const BELOW_HOLLOW: f32 = 3.0;

/// The effect `subsurface`.
pub const SCATTERING: DiskEffect<SurfelParameters> = DiskEffect {
    effect: Effect::Subsurface,
    attributes: &[
        Attribute::Position,
        Attribute::Normal,
        Attribute::MeanFreePath,
        Attribute::Diffuse,
        Attribute::ObjectId,
        Attribute::DiffuseLight,
        Attribute::Valid,
    ],
    lit: Some(SurfelLight::Received),
    passes: Shading {
        tree: Tree::All,
        splat: Shader::at("methods/surfel/given"),
        add: Shader::at("methods/surfel/indirect"),
        channels: 12,
        ending: Ending::Scattered,
    },
    plain,
    on_processor: None,
};

/// The image in plain Rust.
fn plain(plain: &Plain<'_, SurfelParameters>, disks: &[Disk]) -> Result<Planes, MissingAttribute> {
    let seen = |attribute| plain.gbuffer.select(&[attribute]);
    let (lengths, colours) = (seen(Attribute::MeanFreePath)?, seen(Attribute::Diffuse)?);
    let (objects, own) = (seen(Attribute::ObjectId)?, seen(Attribute::DiffuseLight)?);
    let scales = |at| vector(&lengths, at).max(Vec3::ZERO) / shape(vector(&colours, at));

    let patches = patches::of_scene(plain.scene.scene(), Reflectance::Diffuse);
    let gives = |disk: &Disk, _: f32, way: Vec3, Receiver { pixel, normal }: Receiver| {
        let object = objects.at(0, pixel.y as usize, pixel.x as usize);
        let is_own = object == patches[disk.patch as usize].object as f32;
        match is_own && met_from_within(disk, way, normal) {
            true => given(disk, way, normal, scales(pixel)),
            false => [0.0; 12],
        }
    };
    let reach = |at| SUPPORT * scales(at).max_element();
    let shade = Shade { reach: &reach, of: &gives };
    let mask = Planes::from_fn(1, plain.surface.height, plain.surface.width, |_, y, x| {
        let enters =
            plain.surface.valid.at(0, y, x) > 0.5 && scales(IVec2::new(x as i32, y as i32)) != Vec3::ZERO;
        if enters { objects.at(0, y, x) + 1.0 } else { 0.0 }
    });
    let bodies = Surface { valid: mask, ..plain.surface.clone() };
    let sums = reference::sums(&bodies, disks, shade, plain.parameters, plain.view);
    Ok(plain.surface.image(0.0, |at| {
        let [x, y] = [at.x as usize, at.y as usize];
        std::array::from_fn::<f32, 3, _>(|c| {
            let side =
                |first: usize| Side { light: sums.at(first + c, y, x), share: sums.at(first + c + 3, y, x) };
            scattered(own.at(c, y, x), colours.at(c, y, x), side(0), side(6))
        })
    }))
}

/// The mean free path over the profile's length, below a surface of a colour that light enters evenly
/// (Christensen and Burley 2015, equation 6).
pub fn shape(colour: Vec3) -> Vec3 {
    let off = colour - 0.8;
    1.9 - colour + 3.5 * off * off
}

/// Whether a disk that the way leads to is met from within its body, below a surface with a normal; of a
/// surface that is not closed every disk is.
pub fn met_from_within(disk: &Disk, way: Vec3, normal: Vec3) -> bool {
    let below = BELOW_PLANE * way.length() + BELOW_HOLLOW * way.dot(normal).max(0.0);
    disk.open || (way + below * normal).dot(disk.normal) >= 0.0
}

/// What surfels on one side of a body give of one colour, irradiance over pi; those that face as the pixel
/// does, or those that do not.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// By the profile.
    pub light: f32,
    /// What of the profile they have.
    pub share: f32,
}

impl Side {
    /// It without what it has beyond all of the profile.
    fn bounded(self) -> Self {
        let most = self.share.max(1.0);
        Self { light: self.light / most, share: self.share / most }
    }
}

/// Scattered light of one colour: a pixel's own, and what both sides of its body give, that of its own side
/// first.
pub fn scattered(own: f32, colour: f32, near: Side, far: Side) -> f32 {
    let [near, far] = [near.bounded(), far.bounded()];
    let above = own * (1.0 - near.share) + colour * near.light;
    above * (1.0 - far.share) + colour * far.light
}

/// What of a disk lies on the other side of a pixel's body: of a closed one what faces another way, of
/// sheets, whose triangles may face either, what lies below the pixel by more than it is large.
fn far_share(disk: &Disk, way: Vec3, normal: Vec3) -> f32 {
    let averted = 0.5 - 2.0 * normal.dot(disk.normal);
    let below = -way.dot(normal) / disk.radius.max(1e-20) - 0.5;
    if disk.open { below } else { averted }.clamp(0.0, 1.0)
}

/// What a disk gives a pixel with a normal: light, and the shares of the profile that it comes by, as one of
/// the pixel's side, then as one of the other. What is nearer than it is large is the pixel's own. No light
/// falls on the inside of a body, so what falls on front and back is one.
pub fn given(disk: &Disk, way: Vec3, normal: Vec3, scales: Vec3) -> [f32; 12] {
    let mut sides = [0.0; 12];
    let distance = way.length();
    if distance > disk.radius {
        let area = PI * disk.radius * disk.radius;
        let share = scales.map(|d| if d > 0.0 { area * profile(distance, d) } else { 0.0 });
        let light = share * (disk.sent[0] + disk.sent[1]);
        let far = far_share(disk, way, normal);
        for (side, part) in sides.chunks_exact_mut(6).zip([1.0 - far, far]) {
            side[..3].copy_from_slice(&(part * light).to_array());
            side[3..].copy_from_slice(&(part * share).to_array());
        }
    }
    sides
}
