//! What the plain versions of screen methods read of the surface seen at each pixel: `shared/surface.wgsl` in
//! Rust.

use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes, shows_surface};
use glam::{IVec2, Vec3};
use rayon::prelude::*;

/// Position, normal and validity of every pixel.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// [`Attribute::Position`], `[3, height, width]`, camera space, metres.
    pub position: Planes,
    /// [`Attribute::Normal`], `[3, height, width]`, camera space.
    pub normal: Planes,
    /// [`Attribute::Valid`], `[1, height, width]`, or a mask that tells more than one kind of surface apart.
    pub valid: Planes,
}

impl Surface {
    /// The surface that a g-buffer holds.
    ///
    /// # Errors
    /// If the g-buffer lacks position, normal or validity.
    pub fn of(gbuffer: &GBuffer) -> Result<Self, MissingAttribute> {
        Ok(Self {
            height: gbuffer.height(),
            width: gbuffer.width(),
            position: gbuffer.select(&[Attribute::Position])?,
            normal: gbuffer.select(&[Attribute::Normal])?,
            valid: gbuffer.select(&[Attribute::Valid])?,
        })
    }

    /// The planes of positions: x, y, z.
    pub fn position_planes(&self) -> [&[f32]; 3] {
        [0, 1, 2].map(|axis| self.position.plane(axis))
    }

    /// The planes of normals: x, y, z.
    pub fn normal_planes(&self) -> [&[f32]; 3] {
        [0, 1, 2].map(|axis| self.normal.plane(axis))
    }

    /// Whether a pixel is inside the image.
    pub fn contains(&self, at: IVec2) -> bool {
        at.cmpge(IVec2::ZERO).all() && (at.x as usize) < self.width && (at.y as usize) < self.height
    }

    /// Where the surface is, camera space, metres.
    pub fn position_at(&self, at: IVec2) -> Vec3 {
        vector(&self.position, at)
    }

    /// Its unit normal, camera space.
    pub fn normal_at(&self, at: IVec2) -> Vec3 {
        vector(&self.normal, at)
    }

    /// Whether there is one.
    pub fn valid_at(&self, at: IVec2) -> bool {
        shows_surface(self.valid.at(0, at.y as usize, at.x as usize))
    }

    /// Whether there is one of the same kind as at another pixel.
    pub fn is_alike(&self, at: IVec2, other: IVec2) -> bool {
        let kind = |at: IVec2| (self.valid.at(0, at.y as usize, at.x as usize) + 0.5).floor();
        self.valid_at(at) && kind(at) == kind(other)
    }

    /// An image of `value`, `[channels, height, width]`, where a surface is seen and of `background`
    /// elsewhere.
    pub fn image<const CHANNELS: usize>(
        &self,
        background: f32,
        value: impl Fn(IVec2) -> [f32; CHANNELS] + Sync,
    ) -> Planes {
        let (height, width) = (self.height, self.width);
        let pixels: Vec<[f32; CHANNELS]> = (0..height * width)
            .into_par_iter()
            .map(|index| {
                let pixel = IVec2::new((index % width) as i32, (index / width) as i32);
                if self.valid_at(pixel) { value(pixel) } else { [background; CHANNELS] }
            })
            .collect();
        Planes::from_fn(CHANNELS, height, width, |c, y, x| pixels[y * width + x][c])
    }
}

/// Three planes at a pixel.
pub fn vector(planes: &Planes, at: IVec2) -> Vec3 {
    let component = |channel| planes.at(channel, at.y as usize, at.x as usize);
    Vec3::new(component(0), component(1), component(2))
}
