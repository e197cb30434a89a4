//! What a file must not say anywhere, shown or not, beyond what the validator of the crate `gltf` looks at
//! (glTF 2.0, chapter of each check in parentheses). A file that breaks these was damaged or made wrongly,
//! and is told so by name.

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::buffer::View;
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
    accessors(root)?;
    indices(root)?;
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

/// Accessors are within their views, and replace no more elements than they have (5.1, 5.2).
fn accessors(root: &Root) -> Result<(), String> {
    for (index, accessor) in root.accessors.iter().enumerate() {
        let count = accessor.count.0;
        if let Some(sparse) = accessor.sparse.as_ref().filter(|sparse| sparse.count.0 > count) {
            return Err(format!("accessors[{index}].sparse: {} for {count} elements", sparse.count.0));
        }
        let (Some(view), Checked::Valid(component), Checked::Valid(kind)) =
            (accessor.buffer_view, &accessor.component_type, &accessor.type_)
        else {
            continue;
        };
        let size = (kind.multiplicity() * component.0.size()) as u64;
        let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
        let held = &root.buffer_views[view.value()];
        let step = held.byte_stride.map_or(size, |stride| stride.0 as u64);
        let last = count.checked_sub(1).map_or(Some(0), |steps| steps.checked_mul(step));
        let end = last.and_then(|last| last.checked_add(size)?.checked_add(offset));
        if count > 0 && end.is_none_or(|end| end > held.byte_length.0) {
            return Err(format!("accessor {index} reaches past the end of buffer view {view}"));
        }
    }
    Ok(())
}

/// Indices of triangles lie side by side (3.6.2.1).
fn indices(root: &Root) -> Result<(), String> {
    for (index, mesh) in root.meshes.iter().enumerate() {
        for (part, primitive) in mesh.primitives.iter().enumerate() {
            let accessor = primitive.indices.map(|indices| &root.accessors[indices.value()]);
            packed(root, accessor.and_then(|accessor| accessor.buffer_view))
                .map_err(|what| format!("meshes[{index}].primitives[{part}].indices: {what}"))?;
        }
    }
    Ok(())
}

/// Every image has bytes, which lie side by side (5.18).
fn images(root: &Root) -> Result<(), String> {
    for (index, image) in root.images.iter().enumerate() {
        if image.uri.is_none() && image.buffer_view.is_none() {
            return Err(format!("images[{index}]: neither a URI nor a buffer view"));
        }
        packed(root, image.buffer_view).map_err(|what| format!("images[{index}]: {what}"))?;
    }
    Ok(())
}

/// Whether a view has no steps, which only what vertices have may have.
fn packed(root: &Root, view: Option<Index<View>>) -> Result<(), String> {
    match view {
        Some(view) if root.buffer_views[view.value()].byte_stride.is_some() => {
            Err(format!("buffer view {view} has a stride"))
        }
        _ => Ok(()),
    }
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
