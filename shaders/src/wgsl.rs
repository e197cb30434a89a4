//! The one table of WGSL sources.
//!
//! A shader is a prelude of constants and uniform structs, both derived from Rust, the shared files that it lists,
//! and the pass, joined as text. Adding a shader is one entry in the table at the end of this file, and one in
//! [`uniforms`] if it needs a new struct. The kernels of a network's layers on GPUs are put together in [`convolution`].

pub mod convolution;
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

/// Writes the table: for each entry a static of that name, and `ALL`.
macro_rules! table {
    ($($(#[$doc:meta])* $name:ident: $label:literal, file $file:literal,
       constants [$($constant:ident = $default:expr),*], uniforms [$($uniform:ident),*], shared [$($shared:literal),*];)*) => {
        $($(#[$doc])*
        pub static $name: Shader = Shader {
            name: $label,
            constants: &[$((stringify!($constant), $default)),*],
            uniforms: &[$(uniforms::$uniform::LAYOUT),*],
            shared: &[$(include_str!(concat!("../wgsl/shared/", $shared, ".wgsl"))),*],
            text: include_str!(concat!("../wgsl/", $file, ".wgsl")),
        };)*

        /// Every shader.
        pub static ALL: &[&Shader] = &[$(&$name),*];
    };
}

table! {
    /// Horizon-based ambient occlusion before its blur.
    HBAO_OCCLUSION: "hbao.occlusion", file "methods/hbao/occlusion",
        constants [], uniforms [Hbao], shared ["random", "surface"];
    /// One direction of horizon-based ambient occlusion's blur.
    HBAO_BLUR: "hbao.blur", file "methods/hbao/blur", constants [], uniforms [HbaoBlur], shared ["surface"];
    /// A network's first layer.
    NET_FIRST: "net.first", file "net/feature_map_pooled", constants [KERNEL = 3], uniforms [NetLayer],
        shared ["net_features", "net_layer", "net_window", "net_planes", "net_input", "net_single", "net_pool"];
    /// A network's further layers on the way down.
    NET_DOWN: "net.down", file "net/feature_map_pooled", constants [KERNEL = 3], uniforms [NetLayer],
        shared ["net_features", "net_layer", "net_pooled", "net_single", "net_pool"];
    /// A network's coarsest layer.
    NET_BOTTOM: "net.bottom", file "net/feature_map", constants [KERNEL = 3], uniforms [NetLayer],
        shared ["net_features", "net_layer", "net_pooled", "net_single"];
    /// A network's layers on the way up.
    NET_UP: "net.up", file "net/feature_map", constants [KERNEL = 3], uniforms [NetLayer],
        shared ["net_features", "net_layer", "net_joined"];
    /// A network's last layer.
    NET_IMAGE: "net.image", file "net/image", constants [KERNEL = 3], uniforms [NetLayer],
        shared ["net_image", "net_layer", "net_window", "net_joined"];
    /// The first layer of a network of one level.
    NET_ONLY: "net.only", file "net/feature_map", constants [KERNEL = 3], uniforms [NetLayer],
        shared ["net_features", "net_layer", "net_window", "net_planes", "net_input", "net_single"];
    /// The last layer of a network of one level.
    NET_PLAIN: "net.plain", file "net/image", constants [KERNEL = 3], uniforms [NetLayer],
        shared ["net_image", "net_layer", "net_window", "net_pooled", "net_single"];
    /// Memory's speed: a copy.
    COPY: "ceilings.copy", file "ceilings/copy", constants [], uniforms [], shared [];
    /// Arithmetic's speed: multiplications with additions.
    FMA: "ceilings.fma", file "ceilings/fma", constants [TURNS = 256], uniforms [], shared [];
    /// The yardstick's convolution.
    NAIVE_CONVOLUTION: "naive.convolution", file "naive/convolution", constants [], uniforms [NaiveLayer], shared [];
    /// The yardstick's leaky ReLU.
    NAIVE_ACTIVATION: "naive.activation", file "naive/activation", constants [], uniforms [NaiveLayer], shared [];
    /// The yardstick's means of 2x2 pixels.
    NAIVE_POOLING: "naive.pooling", file "naive/pooling", constants [], uniforms [NaiveLayer], shared [];
    /// The yardstick's bilinear doubling.
    NAIVE_DOUBLING: "naive.doubling", file "naive/doubling", constants [], uniforms [NaiveLayer], shared [];
    /// The yardstick's concatenation.
    NAIVE_CONCATENATION: "naive.concatenation", file "naive/concatenation", constants [], uniforms [NaiveLayer], shared [];
}

#[cfg(test)]
mod tests {
    use super::*;
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    use uniforms::Field;

    pub(super) fn parse(source: &str) -> Result<naga::Module, String> {
        let module = naga::front::wgsl::parse_str(source).map_err(|e| e.emit_to_string(source))?;
        Validator::new(ValidationFlags::all(), Capabilities::SHADER_FLOAT16)
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
        assert!(!ALL.is_empty());
        for shader in ALL {
            let module = parse(&shader.source()).map_err(|e| format!("{}: {e}", shader.name)).expect("valid");
            assert_eq!(module.entry_points.len(), 1, "{}", shader.name);
            for layout in shader.uniforms {
                assert_eq!(agrees(layout, &module), Ok(()), "{}", shader.name);
            }
        }
    }

    #[test]
    fn every_name_is_given_once() {
        let names: std::collections::BTreeSet<&str> = ALL.iter().map(|shader| shader.name).collect();
        assert_eq!(names.len(), ALL.len());
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
        let _ = HBAO_BLUR.specialised(&[("SIZE", 1)]);
    }
}
