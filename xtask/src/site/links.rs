//! Links of pages that were made: those to other files of the site must lead somewhere.

use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::Path;

/// Checks that every relative link of a page leads to a file.
///
/// # Errors
/// If one does not, or there is none.
pub fn check(page: &Path) -> Result<()> {
    let html = fs::read_to_string(page).with_context(|| page.display().to_string())?;
    let folder = page.parent().context("a page's folder")?;
    let links = relative(&html);
    ensure!(!links.is_empty(), "no links");
    let missing: Vec<&str> = links.into_iter().filter(|link| !folder.join(link).is_file()).collect();
    ensure!(missing.is_empty(), "links that lead nowhere: {}", missing.join(", "));
    Ok(())
}

/// The files that a page refers to, but for other sites and places within the page.
pub fn relative(html: &str) -> Vec<&str> {
    let values = ["href=\"", "src=\""].into_iter().flat_map(|start| html.split(start).skip(1));
    let links = values.filter_map(|rest| rest.split('"').next());
    let files = links.filter(|link| !is_absolute(link)).filter_map(|link| link.split(['#', '?']).next());
    files.filter(|file| !file.is_empty()).collect()
}

/// Whether it has a scheme, such as `https:`, `mailto:` or `data:`.
fn is_absolute(link: &str) -> bool {
    link.split('/').next().is_some_and(|start| start.contains(':'))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HTML: &str = "<a href=\"a/b.html#part\">b</a> <a href=\"#here\">h</a> <img src=\"c.png?x=1\">
        <a href=\"https://example.org/d\">d</a> <link href=\"data:image/svg+xml,e\">";

    #[test]
    fn only_files_of_the_site_are_links() {
        assert_eq!(relative(HTML), ["a/b.html", "c.png"]);
    }

    #[test]
    fn a_link_that_leads_nowhere_is_named() {
        let folder = std::env::temp_dir().join(format!("deepshade-links-{}", std::process::id()));
        fs::create_dir_all(folder.join("a")).expect("made");
        let page = folder.join("page.html");
        for (file, text) in [("page.html", HTML), ("a/b.html", "")] {
            fs::write(folder.join(file), text).expect("written");
        }
        let missing = check(&page).expect_err("a picture is missing").to_string();
        fs::write(folder.join("c.png"), "").expect("written");
        let whole = check(&page);
        fs::write(&page, "no links").expect("written");
        let none = check(&page);
        fs::remove_dir_all(&folder).expect("deleted");
        assert_eq!(missing, "links that lead nowhere: c.png");
        assert!(whole.is_ok() && none.is_err());
    }
}
