//! How much room feature maps take, and where each lies.

use super::arena::{self, Region, Request};
use super::maps::{Map, MapId};
use super::packing::BLOCK;

/// A feature map of a certain size.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SizedMap {
    /// Which one, and when.
    pub map: Map,
    /// Blocks of four channels, with what the kernel writes beyond the last channel.
    pub blocks: usize,
    /// Rows and columns.
    pub frame: [usize; 2],
}

/// Where feature maps lie.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Room {
    /// In texture arrays of four 32-bit floats a texel, `[blocks, rows, columns]`.
    Textures {
        /// Index of each map's texture.
        of_map: Vec<usize>,
        /// Their sizes.
        sizes: Vec<[usize; 3]>,
    },
    /// In regions of storage buffers, `[blocks, rows, columns, 4]`.
    Arena {
        /// Each map's region.
        regions: Vec<Region>,
        /// The buffers' sizes, bytes.
        sizes: Vec<u64>,
    },
}

impl SizedMap {
    /// Elements, `[blocks, rows, columns, 4]`.
    pub const fn elements(&self) -> usize {
        self.blocks * self.frame[0] * self.frame[1] * BLOCK
    }
}

impl Room {
    /// Room in textures: a map takes one of its frame whose map is not needed any more, where there is one.
    pub fn in_textures(maps: &[SizedMap]) -> Self {
        let mut sizes: Vec<[usize; 3]> = Vec::new();
        let mut needed_until: Vec<usize> = Vec::new();
        let mut of_map = Vec::new();
        for SizedMap { map, blocks, frame } in maps {
            let free = |index: &usize| sizes[*index][1..] == frame[..] && needed_until[*index] < map.born;
            let index = (0..sizes.len()).find(free).unwrap_or_else(|| {
                sizes.push([0, frame[0], frame[1]]);
                needed_until.push(0);
                sizes.len() - 1
            });
            sizes[index][0] = sizes[index][0].max(*blocks);
            needed_until[index] = map.dies;
            of_map.push(index);
        }
        Self::Textures { of_map, sizes }
    }

    /// Room in storage buffers, of which a device allows so many bytes each and to be bound so many at a time; none if
    /// a map is larger.
    pub fn in_arena(maps: &[SizedMap], scalar: usize, limits: &wgpu::Limits) -> Option<Self> {
        let request = |sized: &SizedMap| Request {
            bytes: (sized.elements() * scalar) as u64,
            alive: sized.map.born..=sized.map.dies,
        };
        let requests: Vec<Request> = maps.iter().map(request).collect();
        if requests.iter().any(|request| request.bytes > limits.max_storage_buffer_binding_size) {
            return None;
        }
        let alignment = u64::from(limits.min_storage_buffer_offset_alignment);
        let (regions, sizes) = arena::place(&requests, alignment, limits.max_buffer_size)?;
        Some(Self::Arena { regions, sizes })
    }

    /// All bytes.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Textures { sizes, .. } => {
                sizes.iter().map(|[blocks, rows, columns]| (blocks * rows * columns * 16) as u64).sum()
            }
            Self::Arena { sizes, .. } => sizes.iter().sum(),
        }
    }
}

/// Index of a map in a list of them.
pub fn position(maps: &[SizedMap], id: MapId) -> usize {
    maps.iter().position(|sized| sized.map.id == id).expect("every layer that a layer reads has a map")
}
