//! What figures are called where there are several networks.

use super::score::Evaluation;
use crate::figures::Figures;
use crate::methods::LEARNED;
use deepshade_render::methods::Quality;
use std::path::Path;

/// The name of a network's folder.
pub fn name_of(folder: &Path) -> String {
    folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy().into_owned()
}

/// The name that figures have for the network in a folder.
pub fn figure_name(folder: &Path) -> String {
    name_of(folder).replace('-', "_")
}

/// The figures of a network: `ssim_<network>`, `ssim_<network>_<rival>`, `ceiling_<network>`,
/// `frames_<network>`, ...
pub fn set_figures(figures: &mut Figures, network: &str, evaluation: &Evaluation) {
    for (name, estimate) in evaluation.estimates() {
        figures.set(&of_network(network, name), estimate.mean);
    }
    figures.set(&format!("frames_{network}"), evaluation.frames as f64);
    figures.set(&format!("frames_of_flip_{network}"), evaluation.frames_of_flip() as f64);
}

/// What a figure of an evaluation is called where there are several networks.
pub fn of_network(network: &str, figure: &str) -> String {
    match figure.split_once('_') {
        Some((metric, LEARNED)) => format!("{metric}_{network}"),
        Some((_, "ceiling")) => format!("ceiling_{network}"),
        Some((metric, method)) => format!("{metric}_{network}_{method}"),
        None => format!("{figure}_{network}"),
    }
}

/// What a figure is called that is of one test set. Where the set is called like a quality, figures of the
/// methods that have their `plain` name at the default one say that, too: `ssim_gtao_medium` is of a quality,
/// `ssim_gtao_high_medium` of a set.
pub fn of_set(figure: &str, set: &str, plain: &[&str]) -> String {
    let is_quality = Quality::ALL.into_iter().any(|quality| quality.name() == set);
    let (_, method) = figure.split_once('_').unwrap_or_default();
    match is_quality && plain.contains(&method) {
        true => format!("{figure}_{}_{set}", Quality::default().name()),
        false => format!("{figure}_{set}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_sets_are_told_from_those_of_qualities() {
        let plain = ["gtao", "bounced_z"];
        for (figure, set, expected) in [
            ("ssim_learned", "small", "ssim_learned_small"),
            ("ssim_gtao", "artists", "ssim_gtao_artists"),
            ("ssim_learned", "medium", "ssim_learned_medium"),
            ("ssim_gtao", "medium", "ssim_gtao_high_medium"),
            ("ms_bounced_z", "medium", "ms_bounced_z_high_medium"),
            ("ssim_gtao_medium", "medium", "ssim_gtao_medium_medium"),
            ("ssim_white", "medium", "ssim_white_medium"),
        ] {
            assert_eq!(of_set(figure, set, &plain), expected);
        }
    }

    #[test]
    fn figures_of_networks_have_names_of_their_own() {
        let names = ["ssim_learned", "ssim_ring_gather", "ssim_ceiling", "ms_learned", "ms_fxaa_low"];
        let expected = [
            "ssim_motion_blur",
            "ssim_motion_blur_ring_gather",
            "ceiling_motion_blur",
            "ms_motion_blur",
            "ms_motion_blur_fxaa_low",
        ];
        assert_eq!(names.map(|name| of_network("motion_blur", name)), expected);
    }
}
