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
pub enum MapLayout {
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

impl MapLayout {
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

    /// Room in storage buffers, of which a device allows so many bytes each and to be bound so many at a
    /// time; none if a map is larger.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::maps::maps;
    use crate::{ChannelOrder, NetSpec, Reach};
    use proptest::prelude::*;

    const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

    /// The maps of a random network on a random image.
    fn sized() -> impl Strategy<Value = Vec<SizedMap>> {
        (1usize..7, 1usize..5, 1usize..5, 1usize..5).prop_map(|(levels, u0, rows, columns)| {
            let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH)
                .reshaped(|net| (net.levels, net.u0) = (levels, 4 * u0));
            let whole = [rows, columns].map(|size| size * spec.alignment());
            let sized = |map: Map| SizedMap {
                blocks: map.channels.div_ceil(BLOCK),
                frame: whole.map(|size| size >> map.level),
                map,
            };
            maps(&spec.layers()).into_iter().map(sized).collect()
        })
    }

    /// Whether two maps are needed at the same time.
    fn meet(a: &SizedMap, b: &SizedMap) -> bool {
        a.map.born <= b.map.dies && b.map.born <= a.map.dies
    }

    proptest! {
        #[test]
        fn maps_that_are_needed_at_the_same_time_lie_apart(maps in sized()) {
            let arena = MapLayout::in_arena(&maps, 4, &wgpu::Limits::default()).expect("small enough");
            let textures = MapLayout::in_textures(&maps);
            let both = (&arena, &textures);
            let (MapLayout::Arena { regions, .. }, MapLayout::Textures { of_map, sizes }) = both else {
                return Err(TestCaseError::fail("one is an arena, the other textures"));
            };
            let alone: u64 = maps.iter().map(|sized| 4 * sized.elements() as u64 + 256).sum();
            prop_assert!(arena.bytes() <= alone);
            for (i, a) in maps.iter().enumerate() {
                prop_assert_eq!(sizes[of_map[i]][1..].to_vec(), a.frame.to_vec());
                prop_assert!(sizes[of_map[i]][0] >= a.blocks);
                for (j, b) in maps.iter().enumerate().skip(i + 1).filter(|(_, b)| meet(a, b)) {
                    let apart = regions[i].offset + regions[i].bytes <= regions[j].offset
                        || regions[j].offset + regions[j].bytes <= regions[i].offset;
                    prop_assert!(apart && of_map[i] != of_map[j], "{:?} and {:?}", a.map.id, b.map.id);
                }
            }
        }
    }

    #[test]
    fn a_map_beyond_a_binding_has_no_room() {
        let limits = wgpu::Limits::default();
        let map = maps(&NetSpec::ao(ChannelOrder::Interleaved, REACH).layers()).remove(0);
        let sized = |rows| vec![SizedMap { blocks: 2, frame: [rows, 4096], map: map.clone() }];
        assert!(MapLayout::in_arena(&sized(1024), 4, &limits).is_some(), "128 MiB");
        assert_eq!(MapLayout::in_arena(&sized(1025), 4, &limits), None);
        assert!(MapLayout::in_arena(&sized(1025), 2, &limits).is_some());
    }
}
