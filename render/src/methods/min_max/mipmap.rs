//! The min/max mipmap over where the samples of a slice's light rays are lit (Chen et al. 2011, section 4):
//! from which view ray on, where they enter the medium, and to which, where they end.

/// Between which view rays the samples below a node are lit.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// Where the first and the last of them begin to be.
    begins: [f32; 2],
    /// Where the first and the last of them end.
    ends: [f32; 2],
}

/// A pyramid of nodes.
#[derive(Debug, Default)]
pub struct Mipmap {
    /// Level after level, the samples first.
    nodes: Vec<Node>,
    /// Where each level begins.
    levels: Vec<usize>,
    /// How many samples there are.
    count: usize,
}

impl Node {
    /// A sample that is lit between two view rays.
    pub const fn sample([begin, end]: [f32; 2]) -> Self {
        Self { begins: [begin; 2], ends: [end; 2] }
    }

    #[inline(always)]
    fn joined(self, other: Self) -> Self {
        Self {
            begins: [self.begins[0].min(other.begins[0]), self.begins[1].max(other.begins[1])],
            ends: [self.ends[0].min(other.ends[0]), self.ends[1].max(other.ends[1])],
        }
    }

    /// Whether all samples are lit at a view ray, or none; `None` if that differs.
    #[inline(always)]
    fn is_lit(&self, at: f32) -> Option<bool> {
        if self.begins[1] <= at && at < self.ends[0] {
            Some(true)
        } else if at >= self.ends[1] || at < self.begins[0] {
            Some(false)
        } else {
            None
        }
    }
}

impl Mipmap {
    /// Begins anew with these samples.
    #[inline(always)]
    pub fn rebuild(&mut self, samples: impl Iterator<Item = Node>) {
        self.nodes.clear();
        self.levels.clear();
        self.nodes.extend(samples);
        self.count = self.nodes.len();
        let mut level = 0..self.count;
        self.levels.push(0);
        while level.len() > 1 {
            for pair in level.clone().step_by(2) {
                let other = (pair + 1).min(level.end - 1);
                self.nodes.push(self.nodes[pair].joined(self.nodes[other]));
            }
            level = level.end..self.nodes.len();
            self.levels.push(level.start);
        }
    }

    /// Calls `run` with the first sample and the end of each run of lit samples that a view ray passes before
    /// `end`.
    #[inline(always)]
    pub fn lit_runs(&self, at: f32, end: f32, mut run: impl FnMut([f32; 2])) {
        let last = (end.ceil() as usize).min(self.count);
        let (mut sample, mut begin) = (0, None);
        while sample < last {
            let mut level = (sample.trailing_zeros() as usize).min(self.levels.len() - 1);
            let lit = loop {
                match self.nodes[self.levels[level] + (sample >> level)].is_lit(at) {
                    Some(lit) => break lit,
                    // A sample is lit or not.
                    None => level -= 1,
                }
            };
            match (lit, begin) {
                (true, None) => begin = Some(sample as f32),
                (false, Some(first)) => {
                    run([first, sample as f32]);
                    begin = None;
                }
                _ => {}
            }
            sample += 1 << level;
        }
        if let Some(first) = begin {
            run([first, end.min(self.count as f32)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn runs_are_those_of_a_walk_over_all_samples(
            samples in prop::collection::vec((0u8..6, 0u8..9), 1..80),
            at in 0f32..9.0,
            end in 0.1f32..1.0,
        ) {
            let end = end * samples.len() as f32;
            let between: Vec<[f32; 2]> =
                samples.iter().map(|(begin, end)| [f32::from(*begin), f32::from(*end)]).collect();
            let mut map = Mipmap::default();
            map.rebuild(between.iter().map(|between| Node::sample(*between)));
            let mut lit = vec![0.0; samples.len()];
            map.lit_runs(at, end, |[from, to]| {
                for (sample, lit) in lit.iter_mut().enumerate() {
                    *lit += (to.min(sample as f32 + 1.0) - from.max(sample as f32)).max(0.0);
                }
            });
            for (sample, [begin, stop]) in between.into_iter().enumerate() {
                let part = (end - sample as f32).clamp(0.0, 1.0);
                let expected = if begin <= at && at < stop { part } else { 0.0 };
                prop_assert!((lit[sample] - expected).abs() < 1e-5, "sample {sample}: {}", lit[sample]);
            }
        }
    }
}
