//! All WGSL sources.
//!
//! A shader is a prelude of constants and uniform structs, both derived from Rust, the shared files that it lists,
//! and the pass, joined as text. Adding a shader is one entry in one of the tables below this module, and one in
//! [`uniforms`] if it needs a new struct. The kernels of a network's layers on GPUs are put together in [`convolution`],
//! those of its head in [`head`].

pub mod convolution;
pub mod head;
pub mod uniforms;

use std::fmt::Write;
use uniforms::Layout;

/// Width and height of the workgroups that cover images: `TILE` in every shader.
pub const TILE: u32 = 8;

/// A WGSL source: a file of `shaders/wgsl` and what is put in front of it.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// A name that no other shader has; also the label of its pass.
    pub name: &'static str,
    /// Whole-number constants of the prelude with their defaults, besides `TILE`.
    pub constants: &'static [(&'static str, u32)],
    /// Uniform structs that it uses.
    pub uniforms: &'static [Layout],
    /// Files of `shaders/wgsl/shared` that it uses, in order.
    pub shared: &'static [&'static str],
    /// Its own text.
    pub text: &'static str,
}

impl Shader {
    /// The whole source, with the constants' defaults.
    pub fn source(&self) -> String {
        self.specialised(&[])
    }

    /// The whole source, with other values for some of the constants.
    ///
    /// # Panics
    /// If the shader has no constant of such a name.
    pub fn specialised(&self, values: &[(&str, u32)]) -> String {
        for (name, _) in values {
            let known = self.constants.iter().any(|(constant, _)| constant == name);
            assert!(known, "shader `{}` has no constant `{name}`", self.name);
        }
        let value = |name: &str| values.iter().find(|(other, _)| *other == name).map(|(_, value)| *value);
        let mut source = format!("const TILE = {TILE}u;\n");
        for (name, default) in self.constants {
            let value = value(name).unwrap_or(*default);
            writeln!(source, "const {name} = {value}u;").expect("writing to a string");
        }
        for layout in self.uniforms {
            source.push_str(&layout.declaration());
        }
        for part in self.shared.iter().chain([&self.text]) {
            source.push('\n');
            source.push_str(part);
        }
        source
    }
}

/// Writes a table: for each entry a static of that name, and `TABLE`.
macro_rules! table {
    ($($(#[$doc:meta])* $name:ident: $label:literal, file $file:literal,
       constants [$($constant:ident = $default:expr),*], uniforms [$($uniform:ident),*], shared [$($shared:literal),*];)*) => {
        $($(#[$doc])*
        pub static $name: Shader = Shader {
            name: $label,
            constants: &[$((stringify!($constant), $default)),*],
            uniforms: &[$(uniforms::$uniform::LAYOUT),*],
            shared: &[$(include_str!(concat!("../../wgsl/shared/", $shared, ".wgsl"))),*],
            text: include_str!(concat!("../../wgsl/", $file, ".wgsl")),
        };)*

        /// Every shader of this table.
        pub static TABLE: &[&Shader] = &[$(&$name),*];
    };
}

mod ceilings;
pub mod frame;
mod indirect;
mod lpv;
mod nets;
mod occlusion;
mod phosphor;
mod post;
mod surfels;
mod volume;

pub use ceilings::{COPY, FMA};
pub use indirect::{PREFILTERED_SHADE, SSGI_LIGHT};
pub use lpv::{
    LPV_APPLY, LPV_BEGIN, LPV_BEGIN_EMITTED, LPV_BORDER, LPV_CLEAR, LPV_FRESH, LPV_INJECT, LPV_LINKS,
    LPV_LIT, LPV_MARCH, LPV_MEDIA, LPV_NEST, LPV_PROPAGATE, LPV_REFLECT, LPV_SHINE, LPV_SHINE_KEPT,
    LPV_SHINE_MEDIUM,
};
pub use nets::{NET_BOTTOM, NET_DOWN, NET_FIRST, NET_IMAGE, NET_ONLY, NET_PLAIN, NET_UP};
pub use occlusion::{BLUR, GTAO_OCCLUSION, HBAO_OCCLUSION, SSDO_LIGHT};
pub use phosphor::{
    PHOSPHOR_CELLS, PHOSPHOR_FIND, PHOSPHOR_FIT, PHOSPHOR_GLASSNER, PHOSPHOR_GLASSNER_DIMMED, PHOSPHOR_SHINE,
    PHOSPHOR_SHOW, PHOSPHOR_STEP, PHOSPHOR_STEP_DIMMED,
};
pub use post::{
    FXAA_LUMA, FXAA_SMOOTH, GATHER_AREAS, GATHER_GATHER, RECONSTRUCTION_GATHER, RECONSTRUCTION_NEIGHBOURS,
    RECONSTRUCTION_TILES, RING_GATHER_COMBINE, RING_GATHER_GATHER, RING_GATHER_NEIGHBOURS,
    RING_GATHER_SHRINK, RING_GATHER_TILES, SEPARABLE_BLUR, SUBSURFACE_ENTER, SUBSURFACE_LEAVE,
};

pub use surfels::{
    AOV_FACETS, AOV_OCCLUSION, AOV_PARENTS, AOV_TRACE, BOUNCED_FILTER, BOUNCED_GLOSSY_FILTER,
    BOUNCED_GLOSSY_TRACE, BOUNCED_LIGHT, BOUNCED_SKY, BOUNCED_TRACE, GLOSS, SURFEL_BLOCKED, SURFEL_BODIES,
    SURFEL_GIVEN, SURFEL_GLOSSY, SURFEL_INDIRECT, SURFEL_LIGHT, SURFEL_OCCLUSION, SURFEL_OPEN,
    SURFEL_OPENNESS, SURFEL_REFLECT, SURFEL_SCATTER, SURFELS_BEGIN, SURFELS_DIMMED, SURFELS_GIVE_BACK,
    SURFELS_IN_WATTS, SURFELS_KEEP, SURFELS_KEEP_DIMMED, SURFELS_LEAVES, SURFELS_LIT_LEAVES, SURFELS_MEASURE,
    SURFELS_PARENTS, SURFELS_PLACE, SURFELS_RECEIVED, SURFELS_REFLECTED, SURFELS_SUM, SURFELS_TOTAL,
    SURFELS_VERTICES,
};
pub use volume::{
    EPIPOLAR_BOUNDS, EPIPOLAR_GATHER, EPIPOLAR_LINES, EPIPOLAR_MARCH, EPIPOLAR_SUMS, EPIPOLAR_TRACE,
    FOG_MARCH, FROXEL_APPLY, FROXEL_INTEGRATE, FROXEL_SCATTER, VOLUME_SHELL_ADD, VOLUME_SHELL_DIRECT,
    VOLUME_SHELL_EXPAND, VOLUME_SHELL_INTERVALS, VOLUME_SHELL_PAPER_INTERVALS, VOLUME_SHELL_PAPER_SPLAT,
    VOLUME_SHELL_REDUCE, VOLUME_SHELL_SPLAT,
};

/// Every shader.
pub fn all() -> impl Iterator<Item = &'static Shader> {
    [
        ceilings::TABLE,
        frame::TABLE,
        indirect::TABLE,
        lpv::TABLE,
        nets::TABLE,
        occlusion::TABLE,
        phosphor::TABLE,
        post::TABLE,
        surfels::TABLE,
        volume::TABLE,
    ]
    .into_iter()
    .flatten()
    .copied()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    use uniforms::Field;

    pub(crate) fn parse(source: &str) -> Result<naga::Module, String> {
        let module = naga::front::wgsl::parse_str(source).map_err(|e| e.emit_to_string(source))?;
        Validator::new(
            ValidationFlags::all(),
            Capabilities::SHADER_FLOAT16 | Capabilities::SHADER_FLOAT16_IN_FLOAT32,
        )
        .validate(&module)
        .map_err(|e| e.emit_to_string(source))?;
        Ok(module)
    }

    /// Whether naga lays a struct out as Rust does.
    pub(super) fn agrees(layout: &Layout, module: &naga::Module) -> Result<(), String> {
        let mut layouter = naga::proc::Layouter::default();
        layouter.update(module.to_ctx()).map_err(|e| e.to_string())?;
        let (handle, found) = module
            .types
            .iter()
            .find(|(_, kind)| kind.name.as_deref() == Some(layout.name))
            .ok_or_else(|| format!("no struct {}", layout.name))?;
        let naga::TypeInner::Struct { members, .. } = &found.inner else {
            return Err(format!("{} is no struct", layout.name));
        };
        if layouter[handle].size as usize != layout.size {
            return Err(format!(
                "{}: {} bytes in WGSL, {} in Rust",
                layout.name, layouter[handle].size, layout.size
            ));
        }
        if members.len() != layout.fields.len() {
            return Err(format!("{}: number of fields", layout.name));
        }
        for (member, field) in members.iter().zip(layout.fields) {
            if member.name.as_deref() != Some(field.name) || member.offset as usize != field.offset {
                return Err(format!("{}: {member:?} in WGSL, {field:?} in Rust", layout.name));
            }
        }
        Ok(())
    }

    #[test]
    fn every_shader_is_valid_and_every_struct_lies_as_in_rust() {
        assert!(all().count() > 10);
        for shader in all() {
            let module = parse(&shader.source()).map_err(|e| format!("{}: {e}", shader.name)).expect("valid");
            let stages: Vec<_> = module.entry_points.iter().map(|entry| entry.stage).collect();
            let one_pass = [
                &[naga::ShaderStage::Compute][..],
                &[naga::ShaderStage::Vertex],
                &[naga::ShaderStage::Vertex, naga::ShaderStage::Fragment],
            ];
            assert!(one_pass.contains(&&stages[..]), "{}: {stages:?}", shader.name);
            for layout in shader.uniforms {
                assert_eq!(agrees(layout, &module), Ok(()), "{}", shader.name);
            }
        }
    }

    #[test]
    fn every_name_is_given_once() {
        let names: std::collections::BTreeSet<&str> = all().map(|shader| shader.name).collect();
        assert_eq!(names.len(), all().count());
    }

    #[test]
    fn a_struct_that_lies_otherwise_is_noticed() {
        let module = parse("struct Twin { a: u32, b: vec2f, }\n var<private> twin: Twin;").expect("valid");
        let field = |name, kind, offset| Field { name, kind, offset };
        let right = [field("a", "u32", 0), field("b", "vec2f", 8)];
        let packed = [field("a", "u32", 0), field("b", "vec2f", 4)];
        let swapped = [field("b", "u32", 0), field("a", "vec2f", 8)];
        let twin = |size, fields: &'static [Field]| Layout { name: "Twin", size, fields };
        assert_eq!(agrees(&twin(16, Vec::from(right).leak()), &module), Ok(()));
        assert!(agrees(&twin(16, Vec::from(packed).leak()), &module).is_err());
        assert!(agrees(&twin(16, Vec::from(swapped).leak()), &module).is_err());
        assert!(agrees(&twin(12, Vec::from(right).leak()), &module).is_err());
        assert!(agrees(&Layout { name: "Other", ..twin(16, &[]) }, &module).is_err());
    }

    #[test]
    fn a_broken_shader_is_noticed() {
        assert!(parse("fn f() -> u32 { return 1.0; }").is_err());
        assert!(parse("@group(0) @binding(0) var<uniform> a: array<f32, 4>;").is_err(), "stride 4");
    }

    #[test]
    fn constants_take_other_values() {
        static SHADER: Shader = Shader {
            name: "test",
            constants: &[("SIZE", 3), ("GROUPS", 1)],
            uniforms: &[],
            shared: &["fn shared_part() {}\n"],
            text: "fn own() { shared_part(); }\n",
        };
        let source = SHADER.specialised(&[("GROUPS", 4)]);
        assert!(source.contains("const SIZE = 3u;\n") && source.contains("const GROUPS = 4u;\n"), "{source}");
        assert!(parse(&source).is_ok());
    }

    #[test]
    #[should_panic(expected = "no constant `SIZE`")]
    fn an_unknown_constant_is_refused() {
        let _ = BLUR.specialised(&[("SIZE", 1)]);
    }
}
