//! Uniform structs that Rust fills and WGSL reads. The WGSL declaration is derived from the Rust struct; a test has
//! naga confirm that both put every field at the same offset.

/// How a uniform struct lies in memory.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// Name of the struct, in Rust and in WGSL.
    pub name: &'static str,
    /// Its size, bytes.
    pub size: usize,
    /// Its fields in order.
    pub fields: &'static [Field],
}

/// One field of a uniform struct.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Name of the field, in Rust and in WGSL.
    pub name: &'static str,
    /// Its type in WGSL.
    pub kind: &'static str,
    /// Bytes from the beginning of the struct.
    pub offset: usize,
}

impl Layout {
    /// The struct in WGSL.
    pub fn declaration(&self) -> String {
        let fields: Vec<String> =
            self.fields.iter().map(|f| format!("    {}: {},\n", f.name, f.kind)).collect();
        format!("struct {} {{\n{}}}\n", self.name, fields.concat())
    }
}

/// Four numbers, which WGSL wants at multiples of 16 bytes.
#[allow(non_camel_case_types, reason = "the name that WGSL has for it")]
pub(crate) type vec4f = [f32; 4];

/// Declares uniform structs with their layouts, and a list of these. A field's type is `f32`, `u32`, `i32`
/// or `vec4f`, each the same in WGSL.
macro_rules! uniforms {
    ($($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $kind:ident,)* })*) => {
        $($(#[$doc])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
        pub struct $name {
            $($(#[$field_doc])* pub $field: $kind,)*
        }

        impl $name {
            /// How it lies in memory.
            pub const LAYOUT: Layout = Layout {
                name: stringify!($name),
                size: size_of::<Self>(),
                fields: &[$(Field {
                    name: stringify!($field),
                    kind: stringify!($kind),
                    offset: std::mem::offset_of!(Self, $field),
                }),*],
            };
        })*

        /// How each of them lies in memory.
        pub(super) const LAYOUTS: &[Layout] = &[$($name::LAYOUT),*];
    };
}

mod frame;
mod indirect;
mod nets;
mod occlusion;
mod phosphor;
mod post;
mod surfels;
mod volume;

pub use frame::{Chosen, FrameView, LightRecord, MaterialRecord, Pose, Reprojection, Upsampling, Wipe};
pub use indirect::Prefiltered;
pub use nets::{NetFrame, NetLayer};
pub use occlusion::{Blur, Hbao, Slices, Ssdo};
pub use phosphor::{GlowCells, GlowLevel, GlowSamples, GlowStretch, GlowTile, PaintState};
pub use post::{Fxaa, Gather, Reconstruction, RingGather, Separable};
pub use surfels::{
    BounceWindow, Bounces, FacetRays, FacetSlice, FacetSum, LevelSum, SplatLevel, Surfels, TreeLevel,
};
pub use volume::{
    Epipolar, FogMarch, Froxels, Intervals, Iteration, LightGrid, Marching, MediumRecord, OfLamp,
    Propagation, Pyramid, SplatPart, VolumeShell,
};

/// How all of them lie in memory.
pub(super) const ALL: &[&[Layout]] = &[
    frame::LAYOUTS,
    indirect::LAYOUTS,
    nets::LAYOUTS,
    occlusion::LAYOUTS,
    phosphor::LAYOUTS,
    post::LAYOUTS,
    surfels::LAYOUTS,
    volume::LAYOUTS,
];
