//! Structs that Rust fills and WGSL reads. A struct of a WGSL file that is documented, by `///`, is one of
//! them:
//! `build.rs` collects them. A test has naga confirm that both put every field at the same offset.

/// How a struct lies in memory.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// Name of the struct, in Rust and in WGSL.
    pub name: &'static str,
    /// Its size, bytes.
    pub size: usize,
    /// Its fields in order.
    pub fields: &'static [Field],
}

/// One field of a struct.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Name of the field, in Rust and in WGSL.
    pub name: &'static str,
    /// Its type in WGSL.
    pub kind: &'static str,
    /// Bytes from the beginning of the struct.
    pub offset: usize,
}

/// A struct that a pass reads.
pub trait Uniform: bytemuck::Pod {
    /// How it lies in memory.
    const LAYOUT: Layout;
}

/// Four numbers, which WGSL wants at multiples of 16 bytes.
#[allow(non_camel_case_types, reason = "the name that WGSL has for it")]
type vec4f = [f32; 4];

/// Declares structs with their layouts, and a list of these. A field's type is `f32`, `u32`, `i32`
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
        }

        impl Uniform for $name {
            const LAYOUT: Layout = Self::LAYOUT;
        })*

        /// How each of them lies in memory.
        #[cfg(test)]
        pub(super) const LAYOUTS: &[Layout] = &[$($name::LAYOUT),*];
    };
}

include!(concat!(env!("OUT_DIR"), "/uniforms.rs"));
