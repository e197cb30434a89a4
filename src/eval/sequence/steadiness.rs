//! How calm a method's images are in a sequence, beside truth.
//!
//! Between two frames, what is seen of a surface changes by `d`. Truth's own change is known from two halves
//! of its samples, `d_a` and `d_b`, whose noise has nothing to do with each other. So the mean of `d_a d_b`
//! is that of the square of truth's change, and the mean of `(d - d_a) (d - d_b)` that of the square of the
//! change that truth does not have, both without truth's noise. The same holds of errors.

use super::moment::Moment;
use deepshade_render::metrics::ssim;
use deepshade_render::screen::reprojection::ReprojectionParameters;
use deepshade_render::screen::reprojection::reference::{Two, changes};
use deepshade_shaders::Planes;

/// What counts as beside a thing that moves, pixels.
const BESIDE: usize = 8;
/// Values behind what moves that a figure is of, at least.
const LEAST_BEHIND: usize = 256;

/// What differs from a frame to the next, and from truth.
pub(super) struct FrameChanges {
    /// Of surfaces that are seen in both frames: changes.
    changes: SquaredSums,
    /// Of pixels behind what moves: the values themselves.
    behind: SquaredSums,
    /// Structural similarity of each method's image to truth.
    ssim: Vec<f64>,
}

/// Sums of squares over pixels and channels, without truth's noise.
struct SquaredSums {
    /// Of what each method has and truth has not.
    beyond: Vec<f64>,
    /// Of truth's own values.
    own: f64,
    count: usize,
}

/// What is measured of a sequence.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Steadiness {
    /// Structural similarity to truth, the mean of all frames but the first.
    pub ssim: f64,
    /// Root mean square of the change that truth does not have, as a share of white.
    pub flicker: f64,
    /// Root mean square of the error of surfaces that stand still, beside what moved there one frame ago, as
    /// a share of white; none where next to nothing moves.
    pub ghosts: Option<f64>,
}

impl FrameChanges {
    /// Those of a frame since the one before.
    pub(super) fn of(two: Two<'_>, now: &Moment, before: &Moment) -> Self {
        let tolerance = ReprojectionParameters::default().depth_tolerance;
        let change = |(now, before): (&Planes, &Planes)| changes(two, now, before, tolerance);
        let left = left_behind(&before.moves(), &now.moves(), now.seen(), now.width());
        let taken = |image: &Planes| -> Vec<f32> {
            (0..image.channels()).flat_map(|c| left.iter().map(move |at| image.plane(c)[*at])).collect()
        };
        let changes_of_truth = [0, 1].map(|half| change((&now.truth[half], &before.truth[half])));
        let truth_behind = [0, 1].map(|half| taken(&now.truth[half]));
        Self {
            changes: SquaredSums::of(now.methods.iter().zip(&before.methods).map(change), &changes_of_truth),
            behind: SquaredSums::of(now.methods.iter().map(taken), &truth_behind),
            ssim: now.methods.iter().map(|image| ssim(image, &now.truth_mean)).collect(),
        }
    }
}

/// Pixels that show what stands still, beside those that showed what moves one frame ago.
fn left_behind(before: &[bool], now: &[bool], seen: &[bool], width: usize) -> Vec<usize> {
    let rows: Vec<bool> = before.chunks_exact(width).flat_map(|row| widened(row.iter().copied())).collect();
    let height = before.len() / width;
    let mut beside = vec![false; before.len()];
    for column in 0..width {
        let widened = widened((0..height).map(|row| rows[row * width + column]));
        widened.into_iter().enumerate().for_each(|(row, value)| beside[row * width + column] = value);
    }
    (0..before.len()).filter(|at| beside[*at] && seen[*at] && !now[*at]).collect()
}

/// Whether any value within [`BESIDE`] is true.
fn widened(values: impl Iterator<Item = bool>) -> Vec<bool> {
    let values: Vec<bool> = values.collect();
    let around = |at: usize| at.saturating_sub(BESIDE)..(at + BESIDE + 1).min(values.len());
    (0..values.len()).map(|at| values[around(at)].contains(&true)).collect()
}

impl SquaredSums {
    /// Of the values of each method, and of two halves of truth.
    fn of(methods: impl Iterator<Item = Vec<f32>>, [a, b]: &[Vec<f32>; 2]) -> Self {
        let halves = || a.iter().zip(b);
        let beyond =
            |own: Vec<f32>| own.iter().zip(halves()).map(|(own, (a, b))| product(own - a, own - b)).sum();
        Self {
            beyond: methods.map(beyond).collect(),
            own: halves().map(|(a, b)| product(*a, *b)).sum(),
            count: a.len(),
        }
    }
}

fn product(a: f32, b: f32) -> f64 {
    f64::from(a) * f64::from(b)
}

/// Sums of products of two halves may be less than nothing, which counts as nothing; none of no values.
fn root_mean(sum: f64, count: usize) -> Option<f64> {
    (count > 0).then(|| (sum / count as f64).max(0.0).sqrt())
}

impl Steadiness {
    /// That of each method in a sequence; none where no surface stays in sight.
    pub(super) fn of(all: &[FrameChanges]) -> Option<Vec<Self>> {
        let methods = all.first()?.ssim.len();
        let count = all.iter().map(|frame| frame.changes.count).sum();
        let behind = all.iter().map(|frame| frame.behind.count).sum();
        let method = |method: usize| {
            Some(Self {
                ssim: all.iter().map(|frame| frame.ssim[method]).sum::<f64>() / all.len() as f64,
                flicker: root_mean(all.iter().map(|frame| frame.changes.beyond[method]).sum(), count)?,
                ghosts: root_mean(all.iter().map(|frame| frame.behind.beyond[method]).sum(), behind)
                    .filter(|_| behind >= LEAST_BEHIND),
            })
        };
        (0..methods).map(method).collect()
    }

    /// Truth's own change in a sequence.
    pub(super) fn own_change(all: &[FrameChanges]) -> Option<f64> {
        let count = all.iter().map(|frame| frame.changes.count).sum();
        root_mean(all.iter().map(|frame| frame.changes.own).sum(), count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_shaders::random::random;

    fn noise(count: usize, seed: u32, scale: f32) -> Vec<f32> {
        (0..count).map(|i| scale * (random(i as u32, 0, seed, 0) - 0.5)).collect()
    }

    fn nothing() -> SquaredSums {
        SquaredSums { beyond: vec![0.0; 3], own: 0.0, count: 0 }
    }

    #[test]
    fn noise_of_truth_is_no_flicker_and_that_of_a_method_is() {
        const COUNT: usize = 100_000;
        let own = noise(COUNT, 1, 0.2);
        let half = |seed| own.iter().zip(noise(COUNT, seed, 0.5)).map(|(own, noise)| own + noise).collect();
        let restless = own.iter().zip(noise(COUNT, 4, 0.1)).map(|(own, noise)| own + noise).collect();
        let still = vec![0.0; COUNT];
        let changes = SquaredSums::of([own.clone(), restless, still].into_iter(), &[half(2), half(3)]);
        let all = [FrameChanges { changes, behind: nothing(), ssim: vec![1.0, 0.5, 0.0] }];
        let methods = Steadiness::of(&all).expect("surfaces");
        let truth = Steadiness::own_change(&all).expect("surfaces");
        // Numbers drawn evenly from a range have a twelfth of its square as variance.
        let even = |range: f64| range / 12f64.sqrt();
        assert!((truth - even(0.2)).abs() < 2e-3, "{truth}");
        assert!(methods[0].flicker < 0.015, "as truth changes: {:?}", methods[0]);
        assert!((methods[1].flicker - even(0.1)).abs() < 6e-3, "{:?}", methods[1]);
        assert!((methods[2].flicker - even(0.2)).abs() < 6e-3, "what stays lacks truth's change");
        assert_eq!((methods[1].ssim, methods[1].ghosts), (0.5, None), "nothing moves");
    }

    #[test]
    fn an_error_behind_what_moves_is_a_ghost() {
        let values = || vec![0.5; LEAST_BEHIND];
        let ghostly: Vec<f32> = (0..LEAST_BEHIND).map(|at| if at % 4 == 0 { 0.7 } else { 0.5 }).collect();
        let behind = SquaredSums::of([values(), ghostly].into_iter(), &[values(), values()]);
        let changes = SquaredSums { beyond: vec![0.0; 2], own: 0.0, count: 1 };
        let found =
            Steadiness::of(&[FrameChanges { changes, behind, ssim: vec![1.0; 2] }]).expect("surfaces");
        assert_eq!(found[0].ghosts, Some(0.0));
        assert!(found[1].ghosts.is_some_and(|ghosts| (ghosts - 0.1).abs() < 1e-6), "{found:?}");
    }

    #[test]
    fn behind_is_beside_where_something_was_and_stands_still_now() {
        const WIDTH: usize = 30;
        let mut before = vec![false; 30 * WIDTH];
        before[15 * WIDTH + 10] = true;
        let mut now = vec![false; 30 * WIDTH];
        now[15 * WIDTH + 11] = true;
        let left = left_behind(&before, &now, &vec![true; 30 * WIDTH], WIDTH);
        assert_eq!(left.len(), 17 * 17 - 1);
        assert!(left.contains(&(15 * WIDTH + 10)) && !left.contains(&(15 * WIDTH + 11)));
        assert!(!left.contains(&(15 * WIDTH + 19)) && left.contains(&(7 * WIDTH + 18)));
        assert_eq!(left_behind(&before, &now, &vec![false; 30 * WIDTH], WIDTH), [0usize; 0]);
    }

    #[test]
    fn where_nothing_stays_in_sight_nothing_is_measured() {
        let all = [FrameChanges { changes: nothing(), behind: nothing(), ssim: vec![0.0; 3] }];
        assert_eq!((Steadiness::of(&all), Steadiness::own_change(&all)), (None, None));
    }
}
