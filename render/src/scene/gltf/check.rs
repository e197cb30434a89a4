//! What a file must not say anywhere, shown or not, beyond what the validator of the crate `gltf` looks at (glTF 2.0, chapter
//! of each check in parentheses). A file that breaks these was damaged or made wrongly, and is told so by name.

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::camera::Type as Projection;
use gltf::json::validation::Checked;
use gltf::json::{Index, Node, Root};

/// Checks the chunks of a .glb file: all lengths are multiples of four (4.4.3).
pub(super) fn chunks(bytes: &[u8]) -> Result<(), String> {
    let mut rest = bytes.get(12..).filter(|_| bytes.starts_with(b"glTF")).unwrap_or_default();
    while let Some((length, after)) = rest.split_first_chunk::<4>() {
        let length = u32::from_le_bytes(*length);
        if !length.is_multiple_of(4) {
            return Err(format!("is binary glTF with a chunk of {length} bytes, no multiple of 4"));
        }
        rest = after.get(4 + length as usize..).unwrap_or_default();
    }
    Ok(())
}

/// Checks what needs no buffer. Indices have been validated.
pub(super) fn structure(root: &Root) -> Result<(), String> {
    extensions(root)?;
    views(root)?;
    images(root)?;
    cameras(root)?;
    weights(root)?;
    skins(root)
}

/// No extension is listed twice (5.17).
fn extensions(root: &Root) -> Result<(), String> {
    for (list, names) in
        [("extensionsUsed", &root.extensions_used), ("extensionsRequired", &root.extensions_required)]
    {
        let twice = names.iter().enumerate().find(|(index, name)| names[..*index].contains(name));
        if let Some((_, name)) = twice {
            return Err(format!("{list}: {name} is listed twice"));
        }
    }
    Ok(())
}

/// Views are within their buffers, and steps within their views (5.11).
fn views(root: &Root) -> Result<(), String> {
    for (index, view) in root.buffer_views.iter().enumerate() {
        let offset = view.byte_offset.map_or(0, |offset| offset.0);
        let held = root.buffers[view.buffer.value()].byte_length.0;
        if offset.checked_add(view.byte_length.0).is_none_or(|end| end > held) {
            let (length, buffer) = (view.byte_length.0, view.buffer.value());
            return Err(format!(
                "bufferViews[{index}]: {length} bytes from {offset} on, in the {held} of buffer {buffer}"
            ));
        }
        let length = view.byte_length.0;
        if let Some(stride) = view.byte_stride.filter(|stride| stride.0 > length as usize) {
            return Err(format!("bufferViews[{index}].byteStride: {} in a view of {length} bytes", stride.0));
        }
    }
    Ok(())
}

/// Every image has bytes (5.18).
fn images(root: &Root) -> Result<(), String> {
    let empty = root.images.iter().position(|image| image.uri.is_none() && image.buffer_view.is_none());
    empty.map_or(Ok(()), |index| Err(format!("images[{index}]: neither a URI nor a buffer view")))
}

/// Cameras see something (5.13).
fn cameras(root: &Root) -> Result<(), String> {
    for (index, camera) in root.cameras.iter().enumerate() {
        if let (Checked::Valid(Projection::Orthographic), Some(lens)) = (camera.type_, &camera.orthographic)
            && (lens.xmag == 0.0 || lens.ymag == 0.0)
        {
            return Err(format!("cameras[{index}]: a magnification of {} by {}", lens.xmag, lens.ymag));
        }
    }
    Ok(())
}

/// A node has a weight for each morph target of its mesh, or none (5.25).
fn weights(root: &Root) -> Result<(), String> {
    for (index, node) in root.nodes.iter().enumerate() {
        let Some(weights) = &node.weights else { continue };
        let mesh = node.mesh.map(|mesh| &root.meshes[mesh.value()]);
        let targets = mesh.map_or(0, |mesh| {
            mesh.primitives.iter().map(|part| part.targets.as_ref().map_or(0, Vec::len)).max().unwrap_or(0)
        });
        if weights.len() != targets {
            return Err(format!("nodes[{index}].weights: {} for {targets} morph targets", weights.len()));
        }
    }
    Ok(())
}

/// Inverse bind matrices are matrices of floats, and the skeleton's root is above all joints (5.28).
fn skins(root: &Root) -> Result<(), String> {
    let parents = parents(&root.nodes);
    for (index, skin) in root.skins.iter().enumerate() {
        if let Some(matrices) = skin.inverse_bind_matrices {
            let accessor = &root.accessors[matrices.value()];
            let floats =
                matches!(accessor.component_type, Checked::Valid(kind) if kind.0 == ComponentType::F32);
            if !floats || accessor.type_ != Checked::Valid(Type::Mat4) {
                let accessor = matrices.value();
                return Err(format!("skins[{index}]: accessor {accessor} holds no matrices of floats"));
            }
        }
        let Some(skeleton) = skin.skeleton else { continue };
        if let Some(joint) = skin.joints.iter().find(|joint| !is_below(&parents, **joint, skeleton)) {
            let (joint, skeleton) = (joint.value(), skeleton.value());
            return Err(format!("skins[{index}].skeleton: node {skeleton} is not above joint {joint}"));
        }
    }
    Ok(())
}

/// The parent of each node; of one that has several, the last.
fn parents(nodes: &[Node]) -> Vec<Option<usize>> {
    let mut parents = vec![None; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        node.children.iter().flatten().for_each(|child| parents[child.value()] = Some(index));
    }
    parents
}

/// Whether a node is another or below it. A chain that is longer than there are nodes goes around.
fn is_below(parents: &[Option<usize>], node: Index<Node>, above: Index<Node>) -> bool {
    let chain = std::iter::successors(Some(node.value()), |node| parents[*node]);
    chain.take(parents.len()).any(|node| node == above.value())
}
