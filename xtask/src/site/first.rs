//! The first page, which leads to the others.

/// The page, with a place for the list of networks.
const PAGE: &str = include_str!("index.html");
const PLACE: &str = "{networks}";

/// The page, with all these networks.
pub fn page(networks: &[String]) -> String {
    let items: Vec<String> = networks.iter().map(|name| item(name)).collect();
    PAGE.replace(PLACE, &items.join("\n"))
}

fn item(name: &str) -> String {
    let folder = format!("networks/{name}");
    format!(
        "<li><a href=\"{folder}/card.html\">{name}</a>: <a href=\"{folder}/model.onnx\">ONNX</a>, \
         <a href=\"{folder}/weights.safetensors\">weights</a></li>"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::root;
    use crate::site::{library, links};
    use crate::web;

    /// Whether the site has a file: what it is made of is in the repository.
    fn is_made(href: &str) -> bool {
        let Some((part, file)) = href.split_once('/') else { return href == "index.html" };
        let there = |folder: &str, file: &str| root().join(folder).join(file).is_file();
        match part {
            "book" => file == "index.html" || there("book/src", &file.replace(".html", ".md")),
            "library" => {
                file == "index.html"
                    || library::CRATES.iter().any(|name| file == format!("deepshade_{name}/index.html"))
            }
            "networks" => {
                file == "index.html"
                    || there("models", &file.replace("/card.html", "/card.md")) && !file.ends_with(".md")
            }
            "page" => file == "report.css" || there(web::STATIC, file),
            _ => false,
        }
    }

    #[test]
    fn every_link_of_the_first_page_is_made() {
        let networks = web::networks().expect("the networks");
        assert!(networks.len() > 10);
        let page = page(&networks);
        assert!(!page.contains('{'), "a place is left");
        let hrefs = links::relative(&page);
        assert!(hrefs.len() > 3 * networks.len());
        for href in hrefs {
            assert!(is_made(href), "{href} is not made");
        }
        for name in networks {
            assert!(page.contains(&format!("networks/{name}/card.html")), "{name}");
        }
    }

    #[test]
    fn what_is_not_made_is_found() {
        for href in ["networks/nothing/card.html", "networks/ao/card.md", "book/no.html", "page/no.css", "no"]
        {
            assert!(!is_made(href), "{href}");
        }
        assert!(!is_made("library/xtask/index.html"));
    }
}
