//! All WGSL sources.
//!
//! A shader is a file of `shaders/wgsl` and what that file says that it needs ([`import`]), behind constants
//! from Rust. [`Shader::at`] names it by its path, which is also the label of its pass. A struct that it
//! documents is one of [`uniforms`] in Rust. The kernels of a network's layers on GPUs are put together in
//! [`convolution`], those of its head in [`head`], what makes its input and its image of a frame in
//! [`net_input`] and [`net_image`]. Which line of which file a line of a source is, [`source_line`] tells.

pub mod attributes;
pub mod convolution;
pub mod head;
mod import;
pub mod net_image;
pub mod net_input;
mod source_line;
pub mod uniforms;

pub(crate) use source_line::located;

use import::Product;
use std::fmt::Write;

/// Width and height of the workgroups that cover images: `TILE` in every shader.
pub const TILE: u32 = 8;

/// A WGSL source: a file of `shaders/wgsl` with all that it imports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Shader {
    file: &'static str,
}

impl Shader {
    /// That of a file, as others would import it: `methods/gtao/occlusion`.
    ///
    /// # Panics
    /// If there is no such file; in a constant, the program does not compile.
    pub const fn at(file: &'static str) -> Self {
        assert!(import::is_file(file), "no such file in shaders/wgsl");
        Self { file }
    }

    /// The label of its pass: the file without `methods`, `gtao.occlusion`.
    pub fn name(self) -> String {
        self.file.trim_start_matches("methods/").replace('/', ".")
    }

    fn product(self) -> Product {
        Product::of(&[self.file])
    }

    /// The whole source, with the constants' defaults.
    pub fn source(self) -> String {
        self.specialised(&[])
    }

    /// The whole source, with other values for some of the constants.
    ///
    /// # Panics
    /// If the shader has no constant of such a name.
    pub fn specialised(self, values: &[(&str, u32)]) -> String {
        let product = self.product();
        self.prelude(&product, values) + &product.text
    }

    fn prelude(self, product: &Product, values: &[(&str, u32)]) -> String {
        for (name, _) in values {
            let known = product.constants.iter().any(|constant| constant.name == *name);
            assert!(known, "shader `{}` has no constant `{name}`", self.file);
        }
        let value = |name: &str| values.iter().find(|(other, _)| *other == name).map(|(_, value)| *value);
        let mut prelude = format!("const TILE = {TILE}u;\n");
        for constant in &product.constants {
            let value = value(constant.name).unwrap_or(constant.default);
            writeln!(prelude, "const {} = {value}u;", constant.name).expect("writing to a string");
        }
        prelude
    }
}

/// Every shader: what has an entry point, is no part of another, and needs nothing that Rust writes.
pub fn all() -> impl Iterator<Item = Shader> {
    import::roots().filter(|file| Product::of(&[file]).is_whole()).map(|file| Shader { file })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    use uniforms::{Field, Layout};

    pub(crate) fn parse(source: &str) -> Result<naga::Module, String> {
        let module =
            naga::front::wgsl::parse_str(source).map_err(|e| located(&e.emit_to_string(source), source))?;
        Validator::new(
            ValidationFlags::all(),
            Capabilities::SHADER_FLOAT16 | Capabilities::SHADER_FLOAT16_IN_FLOAT32,
        )
        .validate(&module)
        .map_err(|e| located(&e.emit_to_string(source), source))?;
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
        assert!(all().count() > 100);
        for shader in all() {
            let module = parse(&shader.source()).map_err(|e| format!("{}: {e}", shader.file)).expect("valid");
            let stages: Vec<_> = module.entry_points.iter().map(|entry| entry.stage).collect();
            let one_pass = [
                &[naga::ShaderStage::Compute][..],
                &[naga::ShaderStage::Vertex],
                &[naga::ShaderStage::Vertex, naga::ShaderStage::Fragment],
            ];
            assert!(one_pass.contains(&&stages[..]), "{}: {stages:?}", shader.file);
            let has = |layout: &&Layout| {
                module.types.iter().any(|(_, kind)| kind.name.as_deref() == Some(layout.name))
            };
            for layout in uniforms::LAYOUTS.iter().filter(has) {
                assert_eq!(agrees(layout, &module), Ok(()), "{}", shader.file);
            }
        }
    }

    #[test]
    fn names_are_paths_and_given_once() {
        assert_eq!(Shader::at("methods/gtao/occlusion").name(), "gtao.occlusion");
        assert_eq!(Shader::at("frame/light").name(), "frame.light");
        let names: std::collections::BTreeSet<String> = all().map(Shader::name).collect();
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
    fn an_error_is_said_with_its_place_in_a_file() {
        let (source, wrong) =
            (Shader::at("methods/blur/smooth").source(), "fn surface_valid(index: u32) -> bool {");
        assert!(source.contains(wrong));
        let said =
            parse(&source.replace(wrong, "fn surface_valid(index: u32) -> boot {")).expect_err("wrong");
        let text = include_str!("../wgsl/shared/surface_valid.wgsl");
        let line = text.lines().position(|line| line == wrong).expect("the line") + 1;
        assert!(said.contains(&format!("shaders/wgsl/shared/surface_valid.wgsl:{line}\n")), "{said}");
    }

    /// Shaders that all files are part of.
    fn sources() -> Vec<String> {
        let attributes = attributes::attributes_source(&[crate::Attribute::Depth]);
        let sources: Vec<String> = all().map(Shader::source).chain([attributes]).collect();
        let nets = [convolution::tests::sources(), head::tests::sources()];
        let frames = [net_input::tests::sources(), net_image::tests::sources()];
        [sources, nets.concat(), frames.concat()].concat()
    }

    /// The first variable that is declared within a loop or a branch, and that a browser may leave as it was
    /// the last time: Chromium's compiler (Tint) sets one without a value to zero once, not each time.
    fn kept_variable(source: &str) -> Option<&str> {
        let is_within = |line: &&str| line.starts_with("        ") && line.trim_start().starts_with("var ");
        let code = source.lines().map(|line| line.split("//").next().unwrap_or_default());
        code.filter(is_within).find(|line| line.trim_end().ends_with(';') && !line.contains('='))
    }

    #[test]
    fn variables_within_loops_begin_with_a_value() {
        for source in sources() {
            let files: Vec<_> = source_line::files(&source).collect();
            assert_eq!(kept_variable(&source), None, "{files:?}");
        }
        let within = |line: &str| format!("    for (;;) {{\n        {line}\n    }}");
        assert!(kept_variable(&within("var sums: array<u32, 2>; // = 0")).is_some());
        assert!(kept_variable(&within("var sums = array<u32, 2>();")).is_none());
        assert!(kept_variable("    var sums: array<u32, 2>;").is_none(), "it is there once");
    }

    #[test]
    fn every_file_is_part_of_something() {
        let sources = sources();
        assert!(sources.iter().all(|source| !source.lines().any(|line| line.trim_start().starts_with('#'))));
        let parts: std::collections::BTreeSet<&str> =
            sources.iter().flat_map(|source| source_line::files(source)).collect();
        assert_eq!(parts.into_iter().collect::<Vec<_>>(), import::files().collect::<Vec<_>>());
    }

    #[test]
    fn constants_take_other_values() {
        let source = Shader::at("methods/lpv/shine_kept").specialised(&[("UNIT", 4)]);
        assert!(source.starts_with("const TILE = 8u;\n"), "{source}");
        assert!(source.contains("const HEIGHT = 8u;\n") && source.contains("const UNIT = 4u;\n"), "{source}");
        assert!(parse(&source).is_ok());
    }

    #[test]
    #[should_panic(expected = "no constant `SIZE`")]
    fn an_unknown_constant_is_refused() {
        let _ = Shader::at("methods/blur/smooth").specialised(&[("SIZE", 1)]);
    }
}
