//! Primitives compressed by KHR_draco_mesh_compression. What the stream holds counts: its numbers of vertices
//! and triangles and the types of its values take the place of those that the accessors state.

use super::Unpacking;
use draco_core::{DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder, PointAttribute, PointIndex};
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::View;
use gltf::json::mesh::{Mode, Primitive};
use gltf::json::validation::Checked;
use gltf::json::{Accessor, Index};
use serde::Deserialize;
use std::collections::BTreeMap;

const EXTENSION: &str = "KHR_draco_mesh_compression";

/// Bytes of a triangle's indices.
const TRIANGLE: usize = 12;

/// Where a primitive's stream is, and the numbers of its attributes in it.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Packed {
    buffer_view: usize,
    attributes: BTreeMap<String, u32>,
}

/// Decodes all compressed primitives, whose accessors become new ones.
pub(super) fn unpack(unpacking: &mut Unpacking) -> Result<(), String> {
    for mesh in 0..unpacking.root.meshes.len() {
        for part in 0..unpacking.root.meshes[mesh].primitives.len() {
            let mut primitive = unpacking.root.meshes[mesh].primitives[part].clone();
            unpack_primitive(unpacking, &mut primitive)
                .map_err(|what| format!("meshes[{mesh}].primitives[{part}]: {EXTENSION}: {what}"))?;
            unpacking.root.meshes[mesh].primitives[part] = primitive;
        }
    }
    Ok(())
}

/// Gives a primitive what its stream holds, if it has one.
fn unpack_primitive(unpacking: &mut Unpacking, primitive: &mut Primitive) -> Result<(), String> {
    let said = primitive.extensions.as_ref().and_then(|extensions| extensions.others.get(EXTENSION));
    let Some(said) = said else { return Ok(()) };
    let packed = Packed::deserialize(said).map_err(|error| error.to_string())?;
    let mesh = decode(unpacking, packed.buffer_view)?;
    for (semantic, index) in &mut primitive.attributes {
        let name = semantic.to_string();
        let Some(id) = packed.attributes.get(&name) else { continue };
        let attribute = mesh.attribute_by_unique_id(*id);
        let attribute = attribute.ok_or_else(|| format!("{name}: the stream has no attribute {id}"))?;
        let accessor = unpacking.root.accessors[index.value()].clone();
        *index =
            add_attribute(unpacking, accessor, &mesh, attribute).map_err(|what| format!("{name}: {what}"))?;
    }
    primitive.indices = Some(add_indices(unpacking, &mesh)?);
    primitive.mode = Checked::Valid(Mode::Triangles);
    Ok(())
}

/// The mesh of a buffer view's stream.
fn decode(unpacking: &mut Unpacking, view: usize) -> Result<Mesh, String> {
    let found = unpacking.root.buffer_views.get(view);
    let View { buffer, byte_offset, byte_length, .. } =
        found.ok_or_else(|| format!("there is no buffer view {view}"))?;
    let offset = byte_offset.map_or(0, |offset| offset.0 as usize);
    let bytes = unpacking.bytes(buffer.value(), offset, byte_length.0 as usize)?;
    let limits = DecodeLimits::default()
        .with_max_faces((unpacking.left / TRIANGLE) as u64)
        .with_max_decoded_bytes(unpacking.left as u64);
    let mut mesh = Mesh::new();
    let decoded = MeshDecoder::new().decode(&mut DecoderBuffer::new(bytes).with_limits(limits), &mut mesh);
    decoded.map_err(|error| error.to_string())?;
    let attributes = (0..mesh.num_attributes()).map(|index| mesh.attribute(index).buffer().data().len());
    unpacking.take(attributes.sum())?;
    Ok(mesh)
}

/// Adds an accessor of an attribute's values, one for each vertex, in place of one without them.
fn add_attribute(
    unpacking: &mut Unpacking,
    accessor: Accessor,
    mesh: &Mesh,
    attribute: &PointAttribute,
) -> Result<Index<Accessor>, String> {
    let components = usize::from(attribute.num_components());
    let stated = match accessor.type_ {
        Checked::Valid(kind) => kind.multiplicity(),
        Checked::Invalid => 0,
    };
    if components != stated {
        return Err(format!("the stream has {components} components an element, the accessor {stated}"));
    }
    let kind = component_type(attribute.data_type())?;
    let size = components * kind.size();
    unpacking.take(mesh.num_points().checked_mul(size).ok_or("too many values")?)?;
    let view = unpacking.add_view(values(mesh, attribute, size).ok_or("a vertex has no value")?);
    Ok(add_accessor(unpacking, Accessor { count: mesh.num_points().into(), ..over(accessor, view, kind) }))
}

/// The values of all vertices, of `size` bytes each.
fn values(mesh: &Mesh, attribute: &PointAttribute, size: usize) -> Option<Vec<u8>> {
    let held = attribute.buffer().data();
    let mut bytes = Vec::with_capacity(mesh.num_points() * size);
    for point in 0..mesh.num_points() as u32 {
        let begin = (attribute.mapped_index(PointIndex(point)).0 as usize).checked_mul(size)?;
        bytes.extend_from_slice(held.get(begin..)?.get(..size)?);
    }
    Some(bytes)
}

/// Adds an accessor of a mesh's indices.
fn add_indices(unpacking: &mut Unpacking, mesh: &Mesh) -> Result<Index<Accessor>, String> {
    unpacking.take(mesh.num_faces().checked_mul(TRIANGLE).ok_or("too many triangles")?)?;
    let bytes = mesh.faces().iter().flatten().flat_map(|corner| corner.0.to_le_bytes()).collect();
    let view = unpacking.add_view(bytes);
    Ok(add_accessor(
        unpacking,
        Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: (3 * mesh.num_faces()).into(),
            component_type: Checked::Valid(GenericComponentType(ComponentType::U32)),
            type_: Checked::Valid(Type::Scalar),
            normalized: false,
            min: None,
            max: None,
            sparse: None,
            name: None,
            extensions: None,
            extras: None,
        },
    ))
}

/// An accessor over another view, of components of another type.
fn over(accessor: Accessor, view: Index<View>, kind: ComponentType) -> Accessor {
    let component_type = Checked::Valid(GenericComponentType(kind));
    Accessor { buffer_view: Some(view), byte_offset: None, component_type, sparse: None, ..accessor }
}

fn add_accessor(unpacking: &mut Unpacking, accessor: Accessor) -> Index<Accessor> {
    unpacking.root.accessors.push(accessor);
    Index::new(unpacking.root.accessors.len() as u32 - 1)
}

/// The type of glTF's that has the same bytes.
fn component_type(kind: DataType) -> Result<ComponentType, String> {
    match kind {
        DataType::Int8 => Ok(ComponentType::I8),
        DataType::Uint8 => Ok(ComponentType::U8),
        DataType::Int16 => Ok(ComponentType::I16),
        DataType::Uint16 => Ok(ComponentType::U16),
        DataType::Uint32 => Ok(ComponentType::U32),
        DataType::Float32 => Ok(ComponentType::F32),
        other => Err(format!("values of type {other:?}, which glTF does not have")),
    }
}
