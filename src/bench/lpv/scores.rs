//! How far images are from truth, as a whole and where the lamp lights what is seen and where it does not.

use crate::figures::Figures;
use deepshade_render::metrics::{exposed, exposure, flip, relative_mse};
use deepshade_shaders::{Effect, Planes};

/// How each score is called, in figures and in tables.
const SCORES: [(&str, &str); 5] = [
    ("relmse", "relMSE"),
    ("flip", "FLIP"),
    ("brightness", "brightness"),
    ("brightness_lit", "where the lamp shines"),
    ("brightness_dark", "where it does not"),
];

/// An image's [`SCORES`]: relative squared error, FLIP, and mean over that of truth, of all and by region.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What is shown.
    pub name: String,
    /// In the order of [`SCORES`].
    pub scores: [f64; SCORES.len()],
}

impl Row {
    /// Those of an image; `lit` says of which pixels the lamp lights the surface.
    pub fn new(name: &str, image: &Planes, truth: &Planes, lit: &[bool]) -> Self {
        let exposure = exposure(Effect::Path, truth);
        let sum = |image: &Planes, is_of: &dyn Fn(usize) -> bool| -> f64 {
            let of_pixel = |(at, value): (usize, &f32)| is_of(at % lit.len()).then_some(f64::from(*value));
            image.data().iter().enumerate().filter_map(of_pixel).sum()
        };
        let brightness = |is_of: &dyn Fn(usize) -> bool| sum(image, is_of) / sum(truth, is_of);
        let (shown, wanted) = (exposed(image, exposure), exposed(truth, exposure));
        let scores = [
            relative_mse(&shown, &wanted),
            flip(&shown, &wanted),
            brightness(&|_| true),
            brightness(&|at| lit[at]),
            brightness(&|at| !lit[at]),
        ];
        Self { name: name.to_owned(), scores }
    }

    /// Its scores by the names of figures.
    pub fn figures(&self) -> impl Iterator<Item = (String, f64)> + '_ {
        SCORES.iter().zip(self.scores).map(|((figure, _), score)| (format!("{figure}_{}", self.name), score))
    }
}

/// Means of the rows of several scenes.
pub fn mean<'a>(scenes: impl Iterator<Item = &'a [Row]>) -> Vec<Row> {
    let scenes: Vec<&[Row]> = scenes.collect();
    let of = |row: usize| {
        let score =
            |at: usize| scenes.iter().map(|rows| rows[row].scores[at]).sum::<f64>() / scenes.len() as f64;
        Row { name: scenes[0][row].name.clone(), scores: std::array::from_fn(score) }
    };
    (0..scenes.first().map_or(0, |rows| rows.len())).map(of).collect()
}

/// Sets figures of rows.
pub fn set(rows: &[Row], figures: &mut Figures) {
    rows.iter().flat_map(Row::figures).for_each(|(name, score)| figures.set(&name, score));
}

/// Rows of a table.
pub fn table(rows: &[Row]) -> Vec<Vec<String>> {
    let head = std::iter::once("shown").chain(SCORES.iter().map(|(_, name)| *name)).map(str::to_owned);
    let line = |row: &Row| {
        let scores = row.scores.iter().map(|score| format!("{score:.3}"));
        std::iter::once(row.name.replace('_', " ")).chain(scores).collect()
    };
    std::iter::once(head.collect()).chain(rows.iter().map(line)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brightness_is_told_by_region_and_averaged_over_scenes() {
        let planes = |value: [f32; 2]| Planes::from_fn(3, 1, 2, |_, _, x| value[x]);
        let row = |image| Row::new("a", &planes(image), &planes([1.0, 4.0]), &[false, true]);
        let (exact, half) = (row([1.0, 4.0]), row([2.0, 2.0]));
        assert!(exact.scores[0] == 0.0 && half.scores[0] > 0.0);
        assert_eq!((&exact.scores[2..], &half.scores[2..]), (&[1.0, 1.0, 1.0][..], &[0.8, 0.5, 2.0][..]));
        let mean = mean([&[exact][..], &[half][..]].into_iter());
        assert_eq!(&mean[0].scores[2..], &[0.9, 0.75, 1.5]);
        assert_eq!(mean[0].figures().last(), Some(("brightness_dark_a".to_owned(), 1.5)));
    }
}
