//! Accessors: typed views of buffers, read with every bound checked (glTF 2.0, 3.6).

use super::{super::SceneError, document::File};
use gltf::{Accessor, accessor::DataType, buffer::View};
use std::fmt::Display;

/// Most elements of an accessor that has no bytes of its own but zeros, which a few bytes of JSON can ask
/// for.
const MOST_ZEROS: usize = 1 << 20;

/// Reads a component from the first bytes of a slice.
type Read<T> = fn(&[u8]) -> T;

impl File<'_> {
    /// The elements of an accessor with `N` components, integers divided by their maximum where the accessor
    /// says so. `user` says in errors what the accessor is for.
    pub fn floats<const N: usize>(
        &self,
        accessor: &Accessor<'_>,
        user: impl Display,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        let read = float_reader(accessor.data_type(), accessor.normalized());
        let elements = self.elements::<f32, N>(accessor, read).and_then(|elements| {
            let finite = elements.iter().flatten().all(|value| value.is_finite());
            finite.then_some(elements).ok_or_else(|| "holds a value that is not finite".to_owned())
        });
        elements.map_err(|what| self.accessor_error(accessor, user, &what))
    }

    /// The elements of an accessor with `N` unsigned integer components.
    pub fn integers<const N: usize>(
        &self,
        accessor: &Accessor<'_>,
        user: impl Display,
    ) -> Result<Vec<[u32; N]>, SceneError> {
        let read: Result<Read<u32>, String> = match accessor.data_type() {
            DataType::U8 => Ok(|bytes| u32::from(bytes[0])),
            DataType::U16 => Ok(|bytes| u32::from(u16::from_le_bytes(first(bytes)))),
            DataType::U32 => Ok(|bytes| u32::from_le_bytes(first(bytes))),
            other => Err(format!("has components of type {other:?} where unsigned integers are expected")),
        };
        let elements = read.and_then(|read| self.elements(accessor, read));
        elements.map_err(|what| self.accessor_error(accessor, user, &what))
    }

    /// The bytes of a buffer view; the error says what is wrong with it.
    pub fn view(&self, view: &View<'_>) -> Result<&[u8], String> {
        let end = view.offset().checked_add(view.length());
        let bytes = end.and_then(|end| self.buffers[view.buffer().index()].get(view.offset()..end));
        bytes.ok_or_else(|| format!("buffer view {} reaches past the end of its buffer", view.index()))
    }

    fn accessor_error(&self, accessor: &Accessor<'_>, user: impl Display, what: &str) -> SceneError {
        self.invalid(format!("{user}: accessor {} {what}", accessor.index()))
    }

    /// The elements of an accessor, with sparse ones put in.
    fn elements<T: Copy + Default, const N: usize>(
        &self,
        accessor: &Accessor<'_>,
        read: Read<T>,
    ) -> Result<Vec<[T; N]>, String> {
        let components = accessor.dimensions().multiplicity();
        if components != N {
            return Err(format!("has {components} components an element where {N} are expected"));
        }
        let (count, size) = (accessor.count(), accessor.data_type().size());
        let mut elements = match accessor.view() {
            Some(view) => self.strided(&view, accessor.offset(), count, size, read)?,
            None if count <= MOST_ZEROS => vec![[T::default(); N]; count],
            None => return Err(format!("asks for {count} elements without a buffer view")),
        };
        if let Some(sparse) = accessor.sparse() {
            let (indices, values) = (sparse.indices(), sparse.values());
            let index: Read<u32> = match indices.index_type().size() {
                1 => |bytes| u32::from(bytes[0]),
                2 => |bytes| u32::from(u16::from_le_bytes(first(bytes))),
                _ => |bytes| u32::from_le_bytes(first(bytes)),
            };
            let size_of_index = indices.index_type().size();
            let targets = self.strided::<_, 1>(
                &indices.view(),
                indices.offset(),
                sparse.count(),
                size_of_index,
                index,
            )?;
            let values = self.strided(&values.view(), values.offset(), sparse.count(), size, read)?;
            for ([target], value) in targets.into_iter().zip(values) {
                let slot = elements.get_mut(target as usize);
                *slot.ok_or_else(|| format!("replaces element {target} of {count}"))? = value;
            }
        }
        Ok(elements)
    }

    /// `count` elements of `N` components of `size` bytes each, from `offset` bytes into a buffer view.
    fn strided<T, const N: usize>(
        &self,
        view: &View<'_>,
        offset: usize,
        count: usize,
        size: usize,
        read: Read<T>,
    ) -> Result<Vec<[T; N]>, String> {
        let bytes = self.view(view)?;
        let stride = view.stride().unwrap_or(N * size);
        let last = count.saturating_sub(1).checked_mul(stride);
        let end = last.and_then(|last| last.checked_add(offset)?.checked_add(N * size));
        if count > 0 && end.is_none_or(|end| end > bytes.len()) {
            return Err(format!("reaches past the end of buffer view {}", view.index()));
        }
        let component = |element, component| read(&bytes[offset + element * stride + component * size..]);
        Ok((0..count).map(|element| std::array::from_fn(|index| component(element, index))).collect())
    }
}

/// How a component becomes a float. Normalised integers: glTF 2.0, 3.6.2.2 (equations in 3.11).
fn float_reader(kind: DataType, normalised: bool) -> Read<f32> {
    match (kind, normalised) {
        (DataType::F32, _) => |bytes| f32::from_le_bytes(first(bytes)),
        (DataType::U32, _) => |bytes| u32::from_le_bytes(first(bytes)) as f32,
        (DataType::I8, false) => |bytes| f32::from(bytes[0].cast_signed()),
        (DataType::U8, false) => |bytes| f32::from(bytes[0]),
        (DataType::I16, false) => |bytes| f32::from(i16::from_le_bytes(first(bytes))),
        (DataType::U16, false) => |bytes| f32::from(u16::from_le_bytes(first(bytes))),
        (DataType::I8, true) => |bytes| (f32::from(bytes[0].cast_signed()) / 127.0).max(-1.0),
        (DataType::U8, true) => |bytes| f32::from(bytes[0]) / 255.0,
        (DataType::I16, true) => |bytes| (f32::from(i16::from_le_bytes(first(bytes))) / 32_767.0).max(-1.0),
        (DataType::U16, true) => |bytes| f32::from(u16::from_le_bytes(first(bytes))) / 65_535.0,
    }
}

/// The first `N` bytes of a slice, whose length was checked for the whole accessor.
fn first<const N: usize>(bytes: &[u8]) -> [u8; N] {
    std::array::from_fn(|index| bytes[index])
}
