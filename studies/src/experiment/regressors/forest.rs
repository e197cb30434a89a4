//! A random forest on patches (Breiman 2001; thesis 7.5.5), grown by the crate `smartcore`.

use super::patches::{Examples, Frames, patches_of_rows};
use anyhow::{Result, ensure};
use deepshade_shaders::Planes;
use rayon::prelude::*;
use smartcore::ensemble::random_forest_regressor::{RandomForestRegressor, RandomForestRegressorParameters};
use smartcore::linalg::basic::matrix::DenseMatrix;

/// Least examples of a leaf, as in the thesis.
const LEAST_OF_A_LEAF: usize = 5;

/// A forest of one tree: the crate grows the trees of a forest one after the other.
type Tree = RandomForestRegressor<f32, f32, DenseMatrix<f32>, Vec<f32>>;

/// How a forest is grown.
#[derive(Clone, Copy, Debug)]
pub struct Growth {
    /// Trees.
    pub trees: usize,
    /// Examples that each tree's own are drawn from, with replacement, as many as there are.
    pub examples: usize,
    /// Seed of examples and trees.
    pub seed: u64,
}

/// A grown forest.
pub struct Forest {
    trees: Vec<Tree>,
    edge: usize,
    channels: usize,
}

impl Forest {
    /// Grows a forest on patches of `edge` x `edge` pixels, odd. Every split chooses among all numbers of a
    /// patch.
    ///
    /// # Errors
    /// If a tree cannot be grown, as from too few examples.
    pub fn grow(frames: &Frames, edge: usize, growth: Growth) -> Result<Self> {
        let Examples { patches, targets } = frames.examples(edge, growth.examples, growth.seed, 0);
        let patches = matrix(patches, growth.examples)?;
        let tree = |index: usize| -> Result<Tree> {
            let parameters = RandomForestRegressorParameters::default()
                .with_n_trees(1)
                .with_m(frames.patch_len(edge))
                .with_min_samples_leaf(LEAST_OF_A_LEAF)
                .with_seed(growth.seed.wrapping_add(index as u64));
            Ok(Tree::fit(&patches, &targets, parameters)?)
        };
        let trees = (0..growth.trees).into_par_iter().map(tree).collect::<Result<_>>()?;
        Ok(Self { trees, edge, channels: frames.channels() })
    }

    /// What its first `trees` trees make of a network's input, pixel by pixel: `[channels, height, width]` to
    /// `[1, height, width]`.
    ///
    /// # Errors
    /// If the input has other channels than those that it was grown for.
    pub fn image(&self, input: &Planes, trees: usize) -> Result<Planes> {
        let (grown, found) = (self.channels, input.channels());
        ensure!(grown == found, "the random forest was grown for {grown} channels, not for {found}");
        let trees = &self.trees[..trees.min(self.trees.len())];
        let row = |y: usize| -> Result<Vec<f32>> {
            let patches = matrix(patches_of_rows(input, self.edge, y..y + 1), input.width())?;
            let mut sums = vec![0.0; input.width()];
            for tree in trees {
                let values = tree.predict(&patches)?;
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value / trees.len() as f32);
            }
            Ok(sums)
        };
        let rows: Vec<Vec<f32>> = (0..input.height()).into_par_iter().map(row).collect::<Result<_>>()?;
        Ok(Planes::from_data(1, input.height(), input.width(), rows.concat()))
    }
}

/// Numbers as so many rows.
fn matrix(numbers: Vec<f32>, rows: usize) -> Result<DenseMatrix<f32>> {
    let columns = numbers.len() / rows;
    Ok(DenseMatrix::new(rows, columns, numbers, false)?)
}

#[cfg(test)]
mod tests {
    use super::super::patches::tests::{error, noise};
    use super::*;

    #[test]
    fn more_trees_are_closer_and_the_first_ones_are_the_same() {
        let (frames, input, target) = noise();
        let growth = Growth { trees: 8, examples: 700, seed: 1 };
        let forest = Forest::grow(&frames, 3, growth).expect("grows");
        let image = |trees| forest.image(&input, trees).expect("an image");
        let errors = [8, 1].map(|trees| error(&image(trees), &target));
        assert!(errors[0] < errors[1] && errors[0] < 0.05, "{errors:?}");
        let lone = Forest::grow(&frames, 3, Growth { trees: 1, ..growth }).expect("grows");
        assert_eq!(lone.image(&input, 1).expect("an image"), image(1));
    }

    #[test]
    fn an_input_of_other_channels_is_refused() {
        let (frames, _, _) = noise();
        let forest = Forest::grow(&frames, 3, Growth { trees: 1, examples: 50, seed: 1 }).expect("grows");
        let error = forest.image(&Planes::filled(2, 4, 4, 0.0), 1).expect_err("refused").to_string();
        assert!(error.contains("1 channels") && error.contains('2'), "{error}");
    }
}
