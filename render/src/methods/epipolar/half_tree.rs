//! The partial-sum half-tree (Baran et al. 2010, section 5, after Fenwick 1994): prefix sums of a list that changes, in
//! logarithmic time each.
//!
//! A node is the sum of its two children. Sums from the first element on never ask a right child above the leaves, so
//! that only left ones are kept, and all leaves, which the last, fractional element needs: 1.5 vectors an element, in one
//! array.

/// Prefix sums of vectors.
#[derive(Debug, Default)]
pub struct HalfTree<const W: usize> {
    /// All leaves, then the left nodes of each level, upwards.
    nodes: Vec<[f32; W]>,
    /// Where the nodes of each level begin of which only left ones are kept.
    starts: Vec<usize>,
}

impl<const W: usize> HalfTree<W> {
    /// Begins anew with these elements.
    #[inline(always)]
    pub fn rebuild(&mut self, elements: &[[f32; W]]) {
        self.lay_out(elements.len().next_power_of_two());
        for (index, element) in elements.iter().enumerate() {
            self.nodes[index] = *element;
            // A right child completes its parent, and that its own if it is a right child, too.
            let (mut sum, mut level) = (*element, 0);
            while index >> level & 1 == 1 {
                add(&mut sum, &self.nodes[self.left_child(level, index)]);
                level += 1;
            }
            let left = self.left_child(level, index);
            self.nodes[left] = sum;
        }
    }

    /// Adds to an element. At every level there is a node to write, to which nothing is added if the element is on the
    /// right: no branch is to be guessed.
    #[inline(always)]
    pub fn add(&mut self, index: usize, change: &[f32; W]) {
        add(&mut self.nodes[index], change);
        let mut pair = index >> 1;
        for start in &self.starts {
            let on_left = (!pair & 1) as f32;
            pair >>= 1;
            for (sum, change) in self.nodes[start + pair].iter_mut().zip(change) {
                *sum += change * on_left;
            }
        }
    }

    /// Sum of the first `end` elements, a part of the one behind them included where `end` is no whole number.
    #[inline(always)]
    pub fn sum_before(&self, end: f32) -> [f32; W] {
        let whole = end as usize;
        let mut sum = self.nodes[whole].map(|leaf| leaf * (end - whole as f32));
        let mut bits = whole;
        while bits != 0 {
            let level = bits.trailing_zeros() as usize;
            add(&mut sum, &self.nodes[self.left_child(level, whole - 1)]);
            bits &= bits - 1;
        }
        sum
    }

    /// Where the left child is whose parent, one above `level`, an element is below.
    #[inline(always)]
    fn left_child(&self, level: usize, element: usize) -> usize {
        let pair = element >> (level + 1);
        if level == 0 { 2 * pair } else { self.starts[level - 1] + pair }
    }

    #[inline(always)]
    fn lay_out(&mut self, leaves: usize) {
        self.starts.clear();
        let mut end = leaves;
        for level in 1..=leaves.trailing_zeros() {
            self.starts.push(end);
            end += (leaves >> (level + 1)).max(1);
        }
        // One leaf more for sums that end at the last one's end.
        self.nodes.resize(end + 1, [0.0; W]);
    }
}

#[inline(always)]
fn add<const W: usize>(sum: &mut [f32; W], other: &[f32; W]) {
    for (sum, other) in sum.iter_mut().zip(other) {
        *sum += other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn sums_are_those_of_a_list_after_any_changes(
            elements in prop::collection::vec(-8i32..8, 1..70),
            changes in prop::collection::vec((0usize..70, -8i32..8), 0..90),
            end in 0f32..1.0,
        ) {
            // Small whole numbers, so that sums in any order are the same.
            let vector = |value: i32| [value as f32, (3 * value + 1) as f32];
            let mut list: Vec<[f32; 2]> = elements.iter().map(|value| vector(*value)).collect();
            let mut tree = HalfTree::default();
            // The tree keeps nothing of what it held before.
            tree.rebuild(&[[5.0, 7.0]; 90]);
            tree.rebuild(&list);
            for (index, change) in changes {
                let index = index % list.len();
                tree.add(index, &vector(change));
                add(&mut list[index], &vector(change));
            }
            let end = end * list.len() as f32;
            let whole = end as usize;
            let mut expected = list[whole].map(|leaf| leaf * (end - whole as f32));
            list[..whole].iter().for_each(|element| add(&mut expected, element));
            let found = tree.sum_before(end);
            for (found, expected) in found.iter().zip(expected) {
                prop_assert!((found - expected).abs() < 1e-3, "{found} is not {expected}");
            }
        }
    }

    #[test]
    fn it_takes_one_and_a_half_vectors_an_element() {
        let mut tree = HalfTree::default();
        tree.rebuild(&vec![[1.0]; 4096]);
        assert!(tree.nodes.len() <= 4096 * 3 / 2 + 2, "{}", tree.nodes.len());
        assert_eq!(tree.sum_before(4095.5), [4095.5]);
    }
}
