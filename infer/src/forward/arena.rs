//! Where feature maps lie in storage buffers: as close as their lifetimes allow.

use std::ops::RangeInclusive;

/// Room that is needed for a while.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Request {
    /// How much, bytes.
    pub bytes: u64,
    /// From when to when, both included.
    pub alive: RangeInclusive<usize>,
}

/// Room that is given: part of a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// Index of the buffer.
    pub buffer: usize,
    /// Where it begins, bytes.
    pub offset: u64,
    /// Its length, bytes.
    pub bytes: u64,
}

/// A region for each request, none overlapping another that is alive at the same time, and the buffers'
/// sizes: no more buffers than `most` bytes a buffer demand. Regions begin at multiples of `alignment`. None
/// if a request is larger than a buffer.
///
/// Large ones are placed first, each as low as it fits.
pub fn place(requests: &[Request], alignment: u64, most: u64) -> Option<(Vec<Region>, Vec<u64>)> {
    let mut order: Vec<usize> = (0..requests.len()).collect();
    order.sort_by_key(|index| std::cmp::Reverse(requests[*index].bytes));
    let mut placed: Vec<(usize, Region)> = Vec::new();
    for index in order {
        let request = &requests[index];
        if request.bytes > most {
            return None;
        }
        let beside: Vec<Region> = placed
            .iter()
            .filter(|(other, _)| meet(&requests[*other].alive, &request.alive))
            .map(|(_, region)| *region)
            .collect();
        let region = (0..).find_map(|buffer| lowest(&beside, buffer, request.bytes, alignment, most))?;
        placed.push((index, region));
    }
    placed.sort_by_key(|(index, _)| *index);
    let regions: Vec<Region> = placed.into_iter().map(|(_, region)| region).collect();
    let mut sizes = Vec::new();
    for region in &regions {
        sizes.resize(sizes.len().max(region.buffer + 1), 0);
        sizes[region.buffer] = sizes[region.buffer].max(region.offset + region.bytes);
    }
    Some((regions, sizes))
}

/// The lowest region of a buffer that overlaps none of those beside which it must lie.
fn lowest(beside: &[Region], buffer: usize, bytes: u64, alignment: u64, most: u64) -> Option<Region> {
    let taken = || beside.iter().filter(|region| region.buffer == buffer);
    let ends = taken().map(|region| (region.offset + region.bytes).next_multiple_of(alignment));
    let fits = |offset: &u64| {
        let free = |other: &Region| offset + bytes <= other.offset || other.offset + other.bytes <= *offset;
        offset + bytes <= most && taken().all(free)
    };
    let offset = ends.chain([0]).filter(fits).min()?;
    Some(Region { buffer, offset, bytes })
}

fn meet(a: &RangeInclusive<usize>, b: &RangeInclusive<usize>) -> bool {
    a.start() <= b.end() && b.start() <= a.end()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn regions_never_overlap_while_alive(
            requests in proptest::collection::vec((1u64..5000, 0usize..12, 0usize..5), 1..30),
            most in 5000u64..20_000,
        ) {
            let requests: Vec<Request> = requests
                .into_iter()
                .map(|(bytes, born, ages)| Request { bytes, alive: born..=born + ages })
                .collect();
            let (regions, sizes) = place(&requests, 256, most).expect("each fits a buffer");
            prop_assert_eq!(regions.len(), requests.len());
            for (i, a) in regions.iter().enumerate() {
                prop_assert_eq!((a.bytes, a.offset % 256), (requests[i].bytes, 0));
                prop_assert!(a.offset + a.bytes <= sizes[a.buffer] && sizes[a.buffer] <= most);
                for (j, b) in regions.iter().enumerate().skip(i + 1) {
                    let apart = a.buffer != b.buffer
                        || a.offset + a.bytes <= b.offset
                        || b.offset + b.bytes <= a.offset;
                    prop_assert!(apart || !meet(&requests[i].alive, &requests[j].alive), "{} and {}", i, j);
                }
            }
        }
    }

    #[test]
    fn room_is_used_again() {
        let request = |bytes, alive| Request { bytes, alive };
        let chain = [request(1024, 0..=1), request(512, 1..=2), request(1024, 2..=3), request(512, 3..=4)];
        let (_, sizes) = place(&chain, 256, 1 << 20).expect("fits");
        assert_eq!(sizes, [1536]);
        let (_, sizes) = place(&chain, 256, 1024).expect("fits two");
        assert_eq!(sizes, [1024, 512]);
        assert_eq!(place(&chain, 256, 1000), None);
    }
}
