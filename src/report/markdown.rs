//! The report's figures as a Markdown file, for wherever a page cannot go.

use super::folder::DESCRIPTION;
use super::record::FrameRecord;
use super::summary::{COLUMNS, Line, lines, said_behind};
use super::{Report, title};
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
        text.extend([String::new(), format!("## {} (`{effect}`)", title(effect)), String::new()]);
        text.push(format!("On {} frame{plural}:", frames.len()));
        text.push(String::new());
        text.extend(table(effect, None, &[("", frames.clone())]));
        text.extend(said_behind(effect, &frames).into_iter().flat_map(|said| [String::new(), said]));
        if scenes.len() > 1 {
            text.extend([String::new(), "By scene:".to_owned(), String::new()]);
            text.extend(table(effect, Some("scene"), &scenes));
        }
        if frames.len() > scenes.len() {
            let of_frame = |frame| (frame_name(frame), vec![frame]);
            let frames: Vec<(&str, Vec<&FrameRecord>)> = frames.into_iter().map(of_frame).collect();
            text.extend([String::new(), "By frame:".to_owned(), String::new()]);
            text.extend(table(effect, Some("frame"), &frames));
        }
    }
    text.push(String::new());
    text.join("\n")
}

fn frame_name(frame: &FrameRecord) -> &str {
    &frame.name
}

/// A table of groups of frames, whose names are a column where there is a name for it.
fn table(effect: Effect, column: Option<&str>, groups: &[(&str, Vec<&FrameRecord>)]) -> Vec<String> {
    let row = |group: &str, name: String, cells: [String; 5], device: String| {
        let group = column.map(|_| group.to_owned());
        group
            .into_iter()
            .chain([name])
            .chain(cells)
            .chain([device])
            .map(|cell| cell.replace('|', "\\|"))
            .collect()
    };
    let mut rows: Vec<Vec<String>> = vec![row(
        column.unwrap_or_default(),
        "method".to_owned(),
        COLUMNS.map(str::to_owned),
        "on".to_owned(),
    )];
    for (group, frames) in groups {
        let line = |line: Line| {
            let cells = line.cells();
            row(group, line.name, cells, line.device)
        };
        rows.extend(lines(effect, frames).into_iter().map(line));
    }
    table::markdown(&rows)
}
