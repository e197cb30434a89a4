//! The networks as a page: the table, error against time of each effect, what networks are ahead of their
//! rivals by, and of each network the frames on which it is best, in the middle and worst.

use super::curve::{self, Curves};
use super::networks::Row;
use super::score::{Evaluation, FrameImages};
use super::sets::ARTISTS;
use super::tables::differences;
use crate::arguments;
use crate::figures::write_atomically;
use crate::report::images::{shown, write_png};
use anyhow::Result;
use askama::Template;
use deepshade_shaders::Effect;
use std::path::{Path, PathBuf};

/// Name of the page.
const PAGE: &str = "index.html";

#[derive(Template)]
#[template(path = "eval/page.html")]
struct Page<'a> {
    head: &'a [String],
    lines: &'a [Vec<String>],
    charts: Vec<Chart>,
    pairs: Vec<Vec<String>>,
    networks: Vec<Network<'a>>,
}

/// Error against time of an effect.
struct Chart {
    title: String,
    svg: String,
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
    let (charts, pairs) = (charts(rows), pairs(rows));
    let page = Page { head: &lines[0], lines: &lines[1..], charts, pairs, networks };
    write_atomically(&folder.join(PAGE), page.render()?.as_bytes())
}

/// A chart of each effect and test sets, with all networks of both and their rivals, and one of its artists'
/// scenes. What logarithmic axes cannot show has none.
fn charts(rows: &[Row]) -> Vec<Chart> {
    let mut kinds: Vec<(Effect, &[PathBuf])> = Vec::new();
    for row in rows {
        let kind = (row.effect, row.sets.as_slice());
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    kinds.into_iter().flat_map(|kind| charts_of(rows, kind)).collect()
}

fn charts_of(rows: &[Row], (effect, sets): (Effect, &[PathBuf])) -> Vec<Chart> {
    let of_kind: Vec<&Row> = rows.iter().filter(|row| row.effect == effect && row.sets == sets).collect();
    let names: Vec<&str> = of_kind.iter().map(|row| row.name.as_str()).collect();
    let all: Vec<Curves<'_>> = of_kind.iter().map(|row| row.curves(&row.outcome.evaluation)).collect();
    let artists: Vec<_> = of_kind.iter().filter_map(|row| row.artists()).collect();
    let chart = |(of, curves): (&str, Vec<Curves<'_>>)| {
        let title = format!("{effect} ({}), {of}", names.join(", "));
        match curve::svg(&title, effect, &curves) {
            Ok(svg) => Some(Chart { svg, title }),
            Err(error) => {
                note!("{title}: not drawn, {error:#}");
                None
            }
        }
    };
    let both = [("all test sets but artists' scenes", all), ("artists' scenes", artists)];
    both.into_iter().filter(|(_, curves)| !curves.is_empty()).filter_map(chart).collect()
}

impl Row {
    /// Those of artists' scenes, where they are not all that there is.
    fn artists(&self) -> Option<Curves<'_>> {
        let sets = &self.outcome.sets;
        let set = sets.iter().find(|set| set.name == ARTISTS).filter(|_| sets.len() > 1)?;
        Some(self.curves(&set.evaluation))
    }

    fn curves<'a>(&'a self, evaluation: &'a Evaluation) -> Curves<'a> {
        Curves { network: &self.name, rivals: &self.outcome.rivals, evaluation }
    }
}

/// A head, and a row a network and test set: what it is ahead of its rival by.
fn pairs(rows: &[Row]) -> Vec<Vec<String>> {
    let mut pairs: Vec<Vec<String>> = Vec::new();
    for row in rows {
        let named = |first: &str, line: Vec<String>| [vec![first.to_owned()], line].concat();
        let mut lines = differences(&row.outcome.pairs()).into_iter();
        let head = lines.next().map(|head| named("network", head));
        pairs.extend(head.filter(|_| pairs.is_empty()));
        pairs.extend(lines.map(|line| named(&row.name, line)));
    }
    pairs
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
