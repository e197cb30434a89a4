//! The networks as a page: the table, and of each network the frames on which it is best, in the middle and
//! worst.

use super::networks::Row;
use super::score::FrameImages;
use crate::arguments;
use crate::figures::write_atomically;
use crate::report::images::{shown, write_png};
use anyhow::Result;
use askama::Template;
use std::path::Path;

/// Name of the page.
const PAGE: &str = "index.html";

#[derive(Template)]
#[template(path = "eval/page.html")]
struct Page<'a> {
    head: &'a [String],
    lines: &'a [Vec<String>],
    notes: Vec<String>,
    networks: Vec<Network<'a>>,
}

struct Network<'a> {
    name: &'a str,
    sights: Vec<(&'static str, &'a FrameImages)>,
}

/// Makes a folder ready for it, as [`arguments::page_folder`] says.
///
/// # Errors
/// As that.
pub fn make_folder(folder: &Path) -> Result<()> {
    arguments::page_folder(folder, PAGE, "deepshade eval")
}

/// Writes the page and its pictures, the page last.
///
/// # Errors
/// If a file cannot be written.
pub fn write(folder: &Path, lines: &[Vec<String>], rows: &[Row]) -> Result<()> {
    let networks: Vec<Network<'_>> = rows.iter().map(network).collect();
    for network in &networks {
        for (rank, sight) in &network.sights {
            for (name, image) in &sight.images {
                write_png(&folder.join(network.picture(rank, name)), &shown(image))?;
            }
        }
    }
    let notes =
        rows.iter().filter_map(|row| Some(format!("* {}: {}.", row.name, row.published?.incomparable?)));
    let page = Page { head: &lines[0], lines: &lines[1..], notes: notes.collect(), networks };
    write_atomically(&folder.join(PAGE), page.render()?.as_bytes())
}

/// A network's best, middle and worst frame.
fn network(row: &Row) -> Network<'_> {
    let mut sights: Vec<&FrameImages> = row.outcome.evaluation.sights.iter().collect();
    sights.sort_by(|a, b| b.ssim.total_cmp(&a.ssim));
    let ranks = match sights.len() {
        0 => Vec::new(),
        1 => vec![("best", 0)],
        2 => vec![("best", 0), ("worst", 1)],
        count => vec![("best", 0), ("median", count / 2), ("worst", count - 1)],
    };
    Network { name: &row.name, sights: ranks.into_iter().map(|(rank, at)| (rank, sights[at])).collect() }
}

impl Network<'_> {
    /// Where a picture is, in the page's folder.
    fn picture(&self, rank: &str, image: &str) -> String {
        format!("{}/{rank}.{image}.png", self.name)
    }
}
