//! The report's figures as a Markdown file, for wherever a page cannot go.

use super::folder::DESCRIPTION;
use super::record::FrameRecord;
use super::summary::{COLUMNS, lines, remarks};
use super::{Report, times};
use crate::table;
use deepshade_shaders::Effect;

/// The file: for each effect its means, then scene by scene, then frame by frame, where these differ.
pub fn text(report: &Report) -> String {
    let mut text = vec![
        "# Comparison".to_owned(),
        String::new(),
        format!(
            "Quality {}. `deepshade compare --config {DESCRIPTION} --out FOLDER` makes it again.",
            report.quality
        ),
    ];
    for effect in report.effects() {
        let (frames, scenes) = (report.frames_of(effect), report.scenes_of(effect));
        let plural = if frames.len() == 1 { "" } else { "s" };
        text.extend([String::new(), format!("## {} (`{effect}`)", effect.definition().title), String::new()]);
        text.push(format!("On {} frame{plural}:", frames.len()));
        text.push(String::new());
        let means = lines(effect, &frames);
        let device = times::device(&means);
        text.extend(table(effect, None, &[("", frames.clone())], device));
        text.extend(remarks(effect, &frames).into_iter().flat_map(|said| [String::new(), said]));
        if scenes.len() > 1 {
            text.extend([String::new(), "By scene:".to_owned(), String::new()]);
            text.extend(table(effect, Some("scene"), &scenes, device));
        }
        if frames.len() > scenes.len() {
            let of_frame = |frame| (frame_name(frame), vec![frame]);
            let frames: Vec<(&str, Vec<&FrameRecord>)> = frames.into_iter().map(of_frame).collect();
            text.extend([String::new(), "By frame:".to_owned(), String::new()]);
            text.extend(table(effect, Some("frame"), &frames, device));
        }
    }
    text.push(String::new());
    text.join("\n")
}

fn frame_name(frame: &FrameRecord) -> &str {
    &frame.name
}

/// A table of groups of frames, whose names are a column where there is a name for it, with the times of a
/// device.
fn table(
    effect: Effect,
    column: Option<&str>,
    groups: &[(&str, Vec<&FrameRecord>)],
    device: Option<&str>,
) -> Vec<String> {
    let row = |group: &str, name: &str, cells: [String; 5]| {
        let group = column.map(|_| group.to_owned());
        let cells = group.into_iter().chain([name.to_owned()]).chain(cells);
        cells.map(|cell| cell.replace('|', "\\|")).collect()
    };
    let mut rows: Vec<Vec<String>> =
        vec![row(column.unwrap_or_default(), "method", COLUMNS.map(str::to_owned))];
    for (group, frames) in groups {
        let lines = lines(effect, frames);
        rows.extend(lines.iter().map(|line| row(group, &line.name, line.cells(device))));
    }
    table::markdown(&rows)
}
