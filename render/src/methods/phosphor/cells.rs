//! Light that a medium keeps: states in the cells of a grid over its box, lit by the lamps' shadow maps
//! through the medium, and a march that shows them (thesis, Figure 8.17).

use crate::bvh::TracedScene;
use crate::path::phosphor::Afterglow;
use crate::path::phosphor::in_medium::seen_through;
use crate::raster::World;
use crate::raster::light::shadow_sampler;
use crate::scene::{Bounds, Density, Glow, Medium, Scene};
use crate::screen::{Device, GpuGBuffer, MethodStep, PassDispatch};
use deepshade_glow::paint::{MOST_STATES, Paint};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::uniforms::GlowCells;
use deepshade_shaders::wgsl::{Shader, TILE};
use glam::{UVec3, Vec3};
use rayon::prelude::*;

/// Texels of a surface that a cell is long.
const TEXELS: f32 = 4.0;
/// Cells along an axis, at most.
const MOST: f32 = 96.0;

/// The length of a cell where `texels` lie along a scene's diagonal, metres.
pub fn edge(scene: &Scene, texels: u32) -> f32 {
    TEXELS * scene.bounds().diagonal() / texels as f32
}

/// A grid of cells over a box.
#[derive(Clone, Copy, Debug)]
struct Lattice {
    bounds: Bounds,
    size: UVec3,
}

impl Lattice {
    /// That of a scene's medium, with cells of about such an edge, metres; none where there is no medium.
    fn of(scene: &Scene, edge: f32) -> Option<Self> {
        let bounds = match &scene.medium.as_deref()?.density {
            Density::Everywhere => scene.bounds(),
            Density::Within(bounds) => *bounds,
            Density::Grid(grid) => grid.bounds(),
        };
        let size = (bounds.size() / edge).ceil().clamp(Vec3::splat(2.0), Vec3::splat(MOST)).as_uvec3();
        Some(Self { bounds, size })
    }

    const fn count(&self) -> usize {
        (self.size.x * self.size.y * self.size.z) as usize
    }

    fn middle(&self, cell: usize) -> Vec3 {
        let (cell, UVec3 { x, y, .. }) = (cell as u32, self.size);
        let at = UVec3::new(cell % x, cell / x % y, cell / (x * y)).as_vec3();
        self.bounds.min + (at + 0.5) / self.size.as_vec3() * self.bounds.size()
    }

    fn record(&self) -> GlowCells {
        let four = |v: Vec3| v.extend(0.0).to_array();
        GlowCells {
            low: four(self.bounds.min),
            high: four(self.bounds.max),
            cells: four(self.size.as_vec3()),
        }
    }

    /// The cells around a point with their weights, trilinear between their middles.
    fn around(&self, point: Vec3) -> impl Iterator<Item = (usize, f32)> {
        let size = self.size;
        let at = (point - self.bounds.min) / self.bounds.size() * size.as_vec3() - 0.5;
        let within = at.clamp(Vec3::ZERO, size.as_vec3() - 1.0);
        let low = within.as_uvec3();
        let part = within - low.as_vec3();
        (0..8u32).map(move |i| {
            let corner = UVec3::new(i & 1, i >> 1 & 1, i >> 2);
            let weights = corner.as_vec3() * part + (1.0 - corner.as_vec3()) * (1.0 - part);
            let cell = (low + corner).min(size - 1);
            (((cell.z * size.y + cell.y) * size.x + cell.x) as usize, weights.element_product())
        })
    }
}

/// The cells of a medium on the GPU.
#[derive(Debug)]
pub struct Cells {
    lattice: Lattice,
    /// [`GlowCells`].
    pub record: wgpu::Buffer,
    /// `[2, cells, states]` f32: shares, and what rounding has left of their changes.
    pub states: wgpu::Buffer,
}

impl Cells {
    /// Those of a world with a medium, of about such an edge, metres; none of another.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(device: &Device, world: &World, edge: f32) -> Result<Option<Self>, GpuError> {
        let Some(lattice) = Lattice::of(world.scene(), edge) else { return Ok(None) };
        let numbers = 2 * lattice.count() * world.glow.states();
        Ok(Some(Self {
            lattice,
            record: gpu::uniform(device, "phosphor.cells", &lattice.record())?,
            states: gpu::empty::<f32>(device, "phosphor.cell_states", numbers)?,
        }))
    }

    /// The passes that move their states on by the time since the frame before, of a medium with a paint,
    /// exactly or by so many steps of Euler's scheme.
    ///
    /// # Errors
    /// If the device refuses.
    pub fn steps(&self, device: &Device, world: &World, euler: u32) -> Result<Vec<MethodStep>, GpuError> {
        let glow = &world.glow;
        let own =
            [("LIGHTS", world.gpu_lights.charging as u32), paint(glow.glow()), ("MEDIUM", world.medium.kind)];
        let constants = [&glow.constants()[..], &own].concat();
        let sampler = shadow_sampler(device);
        let first = [&glow.paints, &self.record, &glow.since].map(|buffer| buffer.as_entire_binding());
        let mut resources: Vec<_> = (0..).zip(first.into_iter().chain(world.lamps(&sampler))).collect();
        resources.push((8, self.states.as_entire_binding()));
        resources.push((11, world.medium.record.as_entire_binding()));
        resources.push((12, wgpu::BindingResource::TextureView(&world.medium.densities)));
        let shader = (Shader::at("methods/phosphor/cells"), &constants[..]);
        glow.moving_on(device, shader, euler, &resources, (self.lattice.count(), &self.states))
    }

    /// The constants of passes that look up what they send.
    pub fn constants(world: &World) -> [(&'static str, u32); 4] {
        let glow = &world.glow;
        let states = ("STATES", glow.states() as u32);
        [states, glow.paint_states(), paint(glow.glow()), ("MEDIUM", world.medium.kind)]
    }

    /// The pass that shows them in an image of surfaces.
    ///
    /// # Errors
    /// If the device refuses.
    pub fn shine(
        &self,
        device: &Device,
        world: &World,
        gbuffer: &GpuGBuffer,
        [view, image]: [&wgpu::Buffer; 2],
    ) -> Result<MethodStep, GpuError> {
        let glow = &world.glow;
        let pass = device.pass(Shader::at("methods/phosphor/shine"), &Self::constants(world))?;
        let [valid, position] = [Attribute::Valid, Attribute::Position].map(|a| gbuffer.buffer(a));
        let buffers =
            [&glow.paints, &self.record, view, &world.medium.record, valid, position, &self.states, image];
        let mut resources: Vec<_> = buffers.map(|buffer| buffer.as_entire_binding()).into();
        resources.push(wgpu::BindingResource::TextureView(&world.medium.densities));
        let pass = pass.bind(device, &resources)?;
        let workgroups = gpu::groups(gbuffer.height(), gbuffer.width(), TILE).into();
        Ok(MethodStep { step: PassDispatch { pass, workgroups }, writes: vec![image.clone()] })
    }
}

/// Which of the paints the medium's is: the last. Without one all states stay 0.
fn paint(glow: &Glow) -> (&'static str, u32) {
    ("PAINT", glow.paints().count().saturating_sub(1) as u32)
}

/// The plain version: what a ray brings through cells whose shares are closed forms.
pub struct PlainCells<'a> {
    /// The medium.
    pub medium: &'a Medium,
    paint: Option<&'a Paint>,
    lattice: Lattice,
    shares: Vec<[f32; MOST_STATES]>,
}

impl<'a> PlainCells<'a> {
    /// Those of a scene, of about such an edge, metres; none where it has no medium.
    pub fn new(scene: &'a TracedScene, afterglow: &Afterglow<'_>, edge: f32) -> Option<Self> {
        let lattice = Lattice::of(scene.scene(), edge)?;
        let medium = scene.scene().medium.as_deref()?;
        let paint = Glow::of(scene.scene()).medium.as_ref();
        let share = |cell: usize| {
            paint.map_or([0.0; MOST_STATES], |paint| afterglow.shares_in_medium(lattice.middle(cell), paint))
        };
        let shares = (0..lattice.count()).into_par_iter().map(share).collect();
        Some(Self { medium, paint, lattice, shares })
    }

    /// What the cells around a point send.
    pub fn sent(&self, point: Vec3) -> Vec3 {
        let Some(paint) = self.paint else { return Vec3::ZERO };
        let around = self.lattice.around(point);
        around.map(|(cell, weight)| weight * paint.emission(&self.shares[cell])).sum()
    }

    /// What is seen along a ray with a surface at its end.
    pub fn seen(&self, ray: (Vec3, Vec3, f32), surface: Vec3) -> Vec3 {
        seen_through((self.medium, self.paint), ray, surface, |point, _| self.sent(point))
    }
}
