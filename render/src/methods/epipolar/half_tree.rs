//! The partial-sum half-tree (Baran et al. 2010, section 5, after Fenwick 1994): prefix sums of a list that
//! changes, in logarithmic time each.
//!
//! A node is the sum of its two children. Sums from the first element on never ask a right child above the
//! leaves, so that only left ones are kept, and all leaves, which the last, fractional element needs: 1.5
//! vectors an element, in one array.

/// Prefix sums of vectors.
#[derive(Debug, Default)]
pub struct HalfTree<const W: usize> {
    /// All leaves, then the left nodes of each level, upwards.
    nodes: Vec<[f32; W]>,
    /// Where the nodes of each level begin of which only left ones are kept.
    starts: Vec<usize>,
    /// Sums of one level, while the tree is built.
    sums: Vec<[f32; W]>,
}

impl<const W: usize> HalfTree<W> {
    /// Begins anew with `count` elements.
    #[inline(always)]
    pub fn rebuild(&mut self, count: usize, element: impl Fn(usize) -> [f32; W]) {
        let leaves = count.next_power_of_two();
        self.lay_out(leaves);
        let (filled, empty) = self.nodes[..leaves].split_at_mut(count);
        filled.iter_mut().enumerate().for_each(|(index, leaf)| *leaf = element(index));
        empty.fill([0.0; W]);
        self.sums.clear();
        self.sums.extend(self.nodes[..leaves].as_chunks().0.iter().map(|[left, right]| sum(left, right)));
        for (level, start) in self.starts.iter().enumerate() {
            let pairs = leaves >> (level + 2);
            for pair in 0..pairs {
                let [left, right] = [self.sums[2 * pair], self.sums[2 * pair + 1]];
                self.nodes[start + pair] = left;
                self.sums[pair] = sum(&left, &right);
            }
            if pairs == 0 {
                self.nodes[*start] = self.sums[0];
            }
        }
    }

    /// Adds to an element. At every level there is a node to write, to which nothing is added if the element
    /// is on the right: no branch is to be guessed.
    #[inline(always)]
    pub fn add(&mut self, index: usize, change: &[f32; W]) {
        self.nodes[index] = sum(&self.nodes[index], change);
        let mut pair = index >> 1;
        for start in &self.starts {
            let on_left = (!pair & 1) as f32;
            pair >>= 1;
            let node = &mut self.nodes[start + pair];
            *node = sum(node, &change.map(|change| change * on_left));
        }
    }

    /// Sum of the first `end` elements, a part of the one behind them included where `end` is no whole
    /// number.
    #[inline(always)]
    pub fn sum_before(&self, end: f32) -> [f32; W] {
        let whole = end as usize;
        let part = end - whole as f32;
        let last = (whole & 1) as f32;
        let mut pair = whole >> 1;
        let (leaf, left) = (&self.nodes[whole], &self.nodes[2 * pair]);
        // Two sums, so that an addition need not wait for the one before it.
        let mut totals = [leaf.map(|leaf| leaf * part), left.map(|left| left * last)];
        for (level, start) in self.starts.iter().enumerate() {
            let on_right = (pair & 1) as f32;
            pair >>= 1;
            let total = &mut totals[level % 2];
            *total = sum(total, &self.nodes[start + pair].map(|node| node * on_right));
        }
        sum(&totals[0], &totals[1])
    }

    #[inline(always)]
    fn lay_out(&mut self, leaves: usize) {
        self.starts.clear();
        let mut end = leaves;
        for level in 1..=leaves.trailing_zeros() {
            self.starts.push(end);
            end += (leaves >> (level + 1)).max(1);
        }
        // Behind a single leaf is the one that a sum of all elements asks for nothing.
        self.nodes.resize(end + 1, [0.0; W]);
    }
}

/// Sum of two vectors.
#[inline(always)]
fn sum<const W: usize>(a: &[f32; W], b: &[f32; W]) -> [f32; W] {
    std::array::from_fn(|i| a[i] + b[i])
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
            end in 0f32..=1.0,
        ) {
            // Small whole numbers, so that sums in any order are the same.
            let vector = |value: i32| [value as f32, (3 * value + 1) as f32];
            let mut list: Vec<[f32; 2]> = elements.iter().map(|value| vector(*value)).collect();
            let mut tree = HalfTree::default();
            // The tree keeps nothing of what it held before.
            tree.rebuild(90, |_| [5.0, 7.0]);
            tree.rebuild(list.len(), |index| list[index]);
            for (index, change) in changes {
                let index = index % list.len();
                tree.add(index, &vector(change));
                list[index] = sum(&list[index], &vector(change));
            }
            let end = end * list.len() as f32;
            let whole = end as usize;
            let behind = list.get(whole).copied().unwrap_or_default();
            let mut expected = behind.map(|leaf| leaf * (end - whole as f32));
            list[..whole].iter().for_each(|element| expected = sum(&expected, element));
            let found = tree.sum_before(end);
            for (found, expected) in found.iter().zip(expected) {
                prop_assert!((found - expected).abs() < 1e-3, "{found} is not {expected}");
            }
        }
    }

    #[test]
    fn it_takes_one_and_a_half_vectors_an_element() {
        let mut tree = HalfTree::default();
        tree.rebuild(4096, |_| [1.0]);
        assert!(tree.nodes.len() <= 4096 * 3 / 2 + 2, "{}", tree.nodes.len());
        assert_eq!([tree.sum_before(4095.5), tree.sum_before(4096.0)], [[4095.5], [4096.0]]);
    }
}
