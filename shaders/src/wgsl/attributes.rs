//! The pass that writes a g-buffer's attributes, put together for those that are asked for.

use crate::Attribute;
use crate::wgsl::Shader;
use std::fmt::Write;

/// Most attributes that one pass writes: WebGPU guarantees eight storage buffers, and two are read.
pub const ATTRIBUTES_A_PASS: usize = 6;

/// Binding of the first buffer that is written.
const FIRST_OUTPUT: usize = 6;

/// Everything but what is generated.
const ATTRIBUTES: Shader = Shader::at("frame/attributes");

/// The source of a pass that writes these attributes, the first into binding 6, the next into 7, and so on.
///
/// # Panics
/// If there are more than [`ATTRIBUTES_A_PASS`], or light is among them, which has a pass of its own.
pub fn attributes_source(attributes: &[Attribute]) -> String {
    assert!(attributes.len() <= ATTRIBUTES_A_PASS, "{} attributes in one pass", attributes.len());
    let product = ATTRIBUTES.product();
    let mut source = ATTRIBUTES.prelude(&product, &[]);
    let mut body = String::new();
    for (index, attribute) in attributes.iter().enumerate() {
        let binding = FIRST_OUTPUT + index;
        writeln!(
            source,
            "@group(0) @binding({binding}) var<storage, read_write> planes_{index}: array<f32>;"
        )
        .expect("writing to a string");
        let value = value(*attribute);
        writeln!(body, "    let value_{index} = {value};").expect("writing to a string");
        for component in 0..attribute.width() {
            let part = if attribute.width() == 1 { String::new() } else { format!("[{component}]") };
            writeln!(
                body,
                "    planes_{index}[pixel + {component}u * pixels] = select(0.0, value_{index}{part}, seen.valid);"
            )
            .expect("writing to a string");
        }
    }
    write!(source, "\nfn write_all(seen: Seen, pixel: u32, pixels: u32) {{\n{body}}}\n")
        .expect("writing to a string");
    source + &product.text
}

/// The expression of an attribute of `seen`.
fn value(attribute: Attribute) -> &'static str {
    match attribute {
        Attribute::Position => "seen.position",
        Attribute::Normal => "to_view(seen.normal, view)",
        Attribute::WorldNormal => "seen.normal",
        Attribute::Depth => "seen.depth",
        Attribute::FocalDistance => "focal_distance(seen)",
        Attribute::CircleOfConfusion => "view.blur * abs(focal_distance(seen)) / seen.depth",
        Attribute::Blurriness => "view.blur * focal_distance(seen)",
        Attribute::ToCamera => "seen.to_camera",
        Attribute::Diffuse => "seen.diffuse",
        Attribute::Specular => "seen.specular",
        Attribute::Glossiness => "1.0 - seen.roughness",
        Attribute::MeanFreePath => "seen.mean_free_path",
        Attribute::Motion => "polar(seen.movement)",
        Attribute::ObjectId => "f32(seen.mesh % OBJECT_IDS)",
        Attribute::Emission => "seen.emission",
        Attribute::Valid => "1.0",
        Attribute::Light | Attribute::DiffuseLight => unreachable!("light has a pass of its own"),
        Attribute::Openness
        | Attribute::RawOpenness
        | Attribute::Estimate
        | Attribute::Relief
        | Attribute::PixelRadius
        | Attribute::Border
        | Attribute::SignedCircle
        | Attribute::Movement
        | Attribute::FreePathPixels => unreachable!("no scene has it"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wgsl::tests::parse;

    #[test]
    fn a_pass_can_be_made_of_any_attributes() {
        let light = [Attribute::Light, Attribute::DiffuseLight];
        let others: Vec<Attribute> = Attribute::ALL.into_iter().filter(|a| !light.contains(a)).collect();
        for chosen in others.chunks(ATTRIBUTES_A_PASS) {
            assert!(
                parse(&attributes_source(chosen)).is_ok(),
                "{chosen:?}: {:?}",
                parse(&attributes_source(chosen))
            );
        }
        assert_eq!(parse(&attributes_source(&others[..1])).map(|module| module.entry_points.len()), Ok(1));
    }
}
