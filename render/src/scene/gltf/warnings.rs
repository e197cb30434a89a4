//! What of a glTF file is left out or may be meant otherwise, in sentences that name the file and the thing.

use super::document::{File, SUPPORTED_EXTENSIONS};
use super::instances::has_positions;
use super::texture::TextureList;
use crate::scene::{Material, Mesh};

/// The warnings about a file of which these meshes and materials were read.
pub(super) fn warnings(
    file: &File<'_>,
    textures: &TextureList,
    meshes: &[Mesh],
    materials: &[Material],
) -> Vec<String> {
    let extensions = unsupported_extensions(file).into_iter();
    let all = extensions.chain(without_positions(file)).chain(textures.without_image(file));
    let all = all.chain(textures.placed_otherwise());
    all.chain(only_metals(meshes, materials)).map(|what| format!("{}: {what}", file.path.display())).collect()
}

/// Extensions that a file uses without requiring them, and that are not supported.
fn unsupported_extensions(file: &File<'_>) -> Option<String> {
    let used = file.document.as_json().extensions_used.iter().map(String::as_str);
    let unknown: Vec<&str> = used.filter(|name| !SUPPORTED_EXTENSIONS.contains(name)).collect();
    let (last, others) = unknown.split_last()?;
    Some(match others {
        [] => format!("uses {last}, which is not supported: what it adds is not shown"),
        _ => format!(
            "uses {} and {last}, which are not supported: what they add is not shown",
            others.join(", ")
        ),
    })
}

/// Primitives of which nobody knows where they are.
fn without_positions<'a>(file: &'a File<'_>) -> impl Iterator<Item = String> + 'a {
    file.document.meshes().flat_map(|mesh| {
        let name = mesh.name().map_or_else(|| mesh.index().to_string(), |name| format!("`{name}`"));
        let unplaced = mesh.primitives().filter(|primitive| !has_positions(primitive));
        let said = unplaced.map(|primitive| {
            format!("primitive {} of mesh {name} has no POSITION and is left out", primitive.index())
        });
        said.collect::<Vec<_>>()
    })
}

/// Metals have no diffuse colour, so that effects of diffuse light are black where there is nothing else.
/// glTF's default is a metal, which exporters rarely mean.
fn only_metals(meshes: &[Mesh], materials: &[Material]) -> Option<String> {
    let is_metal = |mesh: &Mesh| {
        let material = &materials[mesh.material.0 as usize];
        material.metallic == 1.0 && material.metallic_roughness_texture.is_none()
    };
    let metals = !meshes.is_empty() && meshes.iter().all(is_metal);
    metals.then(|| {
        let why = "metallicFactor is 1 or left out";
        format!("all surfaces are metals ({why}): they reflect no diffuse light, and gi is black")
    })
}
