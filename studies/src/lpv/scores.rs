//! How far images are from truth, as a whole and where the lamp lights what is seen and where it does not.

use deepshade::shared::figures::Figures;
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

/// An image's [`SCORES`]: relative squared error, FLIP, and mean over that of truth, of all and by region;
/// not finite for a region of which nothing is seen.
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

    /// Its scores by the names of figures, of what is seen.
    pub fn figures(&self) -> impl Iterator<Item = (String, f64)> + '_ {
        let seen = SCORES.iter().zip(self.scores).filter(|(_, score)| score.is_finite());
        seen.map(|((figure, _), score)| (format!("{figure}_{}", self.name), score))
    }
}

/// Means of the rows of several scenes, each over those in which there is something to see of its region.
pub fn mean<'a>(scenes: impl Iterator<Item = &'a [Row]>) -> Vec<Row> {
    let scenes: Vec<&[Row]> = scenes.collect();
    let of = |row: usize| {
        let score = |at: usize| {
            let all = scenes.iter().map(|rows| rows[row].scores[at]);
            let seen: Vec<f64> = all.filter(|score| score.is_finite()).collect();
            seen.iter().sum::<f64>() / seen.len() as f64
        };
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
        let number = |score: &f64| if score.is_finite() { format!("{score:.3}") } else { String::new() };
        let scores = row.scores.iter().map(number);
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

    #[test]
    fn scenes_that_are_lit_all_over_tell_nothing_of_the_dark() {
        let planes = |value: f32| Planes::filled(3, 1, 2, value);
        let row = |lit: [bool; 2]| Row::new("a", &planes(1.0), &planes(2.0), &lit);
        let mean_of = |rows: [Row; 2]| mean(rows.each_ref().map(std::slice::from_ref).into_iter()).remove(0);
        let names = |row: &Row| row.figures().map(|(name, _)| name).collect::<Vec<_>>();
        let one = mean_of([row([true; 2]), row([true, false])]);
        assert_eq!(&one.scores[2..], &[0.5; 3]);
        let none = mean_of([row([true; 2]), row([true; 2])]);
        assert_eq!(names(&none), ["relmse_a", "flip_a", "brightness_a", "brightness_lit_a"]);
        assert_eq!(table(&[none])[1].last(), Some(&String::new()));
    }
}
