//! What a file holds compressed is decoded once, when it is opened, into buffers and views as any other, so
//! that nothing else knows of it.

mod draco;
mod meshopt;

pub(super) use meshopt::unread;

use crate::scene::memory;
use gltf::json::{Buffer, Index, Root, buffer::View};

/// Bytes that any file may decode to.
const ALWAYS: usize = 32 << 20;
/// Bytes that a file may decode to beyond these for each byte of its buffers. Meshes come to some tens.
const PER_BYTE: usize = 256;

/// Decodes all that is compressed in a valid file with its buffers; the error says what is wrong with it.
pub(super) fn unpack(root: Root, buffers: Vec<Vec<u8>>) -> Result<(Root, Vec<Vec<u8>>), String> {
    let mut unpacking = Unpacking::new(root, buffers);
    meshopt::unpack(&mut unpacking)?;
    draco::unpack(&mut unpacking)?;
    Ok((unpacking.root, unpacking.buffers))
}

/// A file that is being decoded.
struct Unpacking {
    root: Root,
    buffers: Vec<Vec<u8>>,
    /// Bytes that may still be decoded: a kilobyte can be made to stand for gigabytes.
    left: usize,
}

impl Unpacking {
    fn new(root: Root, buffers: Vec<Vec<u8>>) -> Self {
        let held: usize = buffers.iter().map(Vec::len).sum();
        let available = usize::try_from(memory::available()).unwrap_or(usize::MAX);
        let left = held.saturating_mul(PER_BYTE).saturating_add(ALWAYS).min(available);
        Self { root, buffers, left }
    }

    /// Counts bytes that are decoded.
    fn take(&mut self, bytes: usize) -> Result<(), String> {
        let left = self.left.checked_sub(bytes);
        self.left = left.ok_or("decodes to more than a file of this size may")?;
        Ok(())
    }

    /// Some bytes of a buffer.
    fn bytes(&self, buffer: usize, offset: usize, length: usize) -> Result<&[u8], String> {
        let held = self.buffers.get(buffer).ok_or_else(|| format!("there is no buffer {buffer}"))?;
        let bytes = offset.checked_add(length).and_then(|end| held.get(offset..end));
        bytes.ok_or_else(|| {
            format!("{length} bytes from {offset} on, in the {} of buffer {buffer}", held.len())
        })
    }

    /// Adds a buffer.
    fn add_buffer(&mut self, bytes: Vec<u8>) -> Index<Buffer> {
        let index = Index::new(self.buffers.len() as u32);
        self.root.buffers.push(Buffer {
            byte_length: bytes.len().into(),
            name: None,
            uri: None,
            extensions: None,
            extras: None,
        });
        self.buffers.push(bytes);
        index
    }

    /// Adds a buffer and a view of all of it.
    fn add_view(&mut self, bytes: Vec<u8>) -> Index<View> {
        let (byte_length, buffer) = (bytes.len().into(), self.add_buffer(bytes));
        let index = Index::new(self.root.buffer_views.len() as u32);
        self.root.buffer_views.push(View {
            buffer,
            byte_length,
            byte_offset: None,
            byte_stride: None,
            name: None,
            target: None,
            extensions: None,
            extras: None,
        });
        index
    }
}
