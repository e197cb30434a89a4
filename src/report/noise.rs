//! Which methods cannot be told apart, since truth differs from itself by more than they do.

use super::summary::{Kind, Line};

/// What truth's own noise takes of a method's SSIM, from the SSIM of truth's halves. What SSIM lacks of 1 is
/// as the variance of a difference where that is small. Halves have twice truth's variance each, so their
/// difference has four times that of truth beside what it would be without noise.
fn of_truth(ceiling: f64) -> f64 {
    (1.0 - ceiling) / 4.0
}

/// Groups of methods, given by name and SSIM, of which no two differ by as much as truth's own noise. Every
/// two that are so near are together in a group, so that groups may overlap; none is a part of another. The
/// best come first.
pub fn alike<'a>(scores: &[(&'a str, f64)], ceiling: f64) -> Vec<Vec<&'a str>> {
    let mut sorted: Vec<(&str, f64)> = scores.iter().copied().filter(|(_, ssim)| ssim.is_finite()).collect();
    sorted.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut groups: Vec<Vec<&str>> = Vec::new();
    let mut end_of_last = 0;
    for (first, (_, best)) in sorted.iter().enumerate() {
        let near = sorted[first..].iter().take_while(|(_, ssim)| best - ssim < of_truth(ceiling)).count();
        if near > 1 && first + near > end_of_last {
            end_of_last = first + near;
            groups.push(sorted[first..end_of_last].iter().map(|(name, _)| *name).collect());
        }
    }
    groups
}

/// That in a sentence, with what makes truth's noise less; `None` where all are told apart.
pub fn in_words(scores: &[(&str, f64)], ceiling: f64) -> Option<String> {
    let groups: Vec<String> = alike(scores, ceiling).into_iter().map(|names| names.join(" and ")).collect();
    (!groups.is_empty()).then(|| {
        format!(
            "within truth's noise, {:.3} of SSIM: {}; truth has less of it with a smaller --error or more \
             --samples",
            of_truth(ceiling),
            groups.join("; ")
        )
    })
}

/// As [`in_words`], of the lines of a table.
pub fn said(lines: &[Line]) -> Option<String> {
    let ceiling = lines.iter().find(|line| line.kind == Kind::Ceiling)?.scores.ssim;
    let methods = lines.iter().filter(|line| line.kind == Kind::Method);
    let scores: Vec<(&str, f64)> = methods.map(|line| (line.name.as_str(), line.scores.ssim)).collect();
    in_words(&scores, ceiling)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_that_differ_by_less_than_truths_noise_are_not_told_apart() {
        let scores = [("hbao", 0.90), ("learned", 0.95), ("gtao", 0.94), ("ssao", 0.80), ("aov", 0.925)];
        assert_eq!(alike(&scores, 0.98), Vec::<Vec<&str>>::new(), "truth is sharp enough for all");
        // `gtao` is as near to the one below it as to the one above.
        assert_eq!(alike(&scores, 0.92), [["learned", "gtao"], ["gtao", "aov"]]);
        // A group reaches as far below its best as the noise, so that any two of it are within the noise.
        assert_eq!(alike(&scores, 0.88), [vec!["learned", "gtao", "aov"], vec!["aov", "hbao"]]);
        assert_eq!(alike(&scores, 0.76), [vec!["learned", "gtao", "aov", "hbao"]]);
        assert_eq!(alike(&[("a", 0.9), ("b", 0.9)], 1.0), Vec::<Vec<&str>>::new(), "truth has no noise");
        assert_eq!(alike(&[("a", f64::NAN), ("b", 0.9)], 0.5), Vec::<Vec<&str>>::new());
    }

    #[test]
    fn what_is_within_noise_is_said_with_the_option_that_lessens_it() {
        let said = in_words(&[("gtao", 0.95), ("hbao", 0.94)], 0.6).expect("within noise");
        assert!(said.starts_with("within truth's noise, 0.100 of SSIM: gtao and hbao"), "{said}");
        assert!(said.contains("--error"), "{said}");
        assert_eq!(in_words(&[("gtao", 0.95), ("hbao", 0.94)], 0.97), None);
    }
}
