//! The report as a whole: what is on the disk, and that the page asks for nothing else.

use super::*;
use crate::figures::Figures;
use deepshade_render::path::Estimate;
use deepshade_shaders::random::random;
use std::collections::BTreeSet;

const EFFECT: Effect = Effect::Ao;

fn wave(phase: f32) -> Planes {
    Planes::from_fn(1, 24, 32, |_, y, x| 0.5 + 0.4 * (0.3 * x as f32 + 0.2 * y as f32 + phase).sin())
}

/// Truth of two halves.
fn truth(halves: [Planes; 2], milliseconds: f64) -> TruthReport {
    let [a, b] = &halves;
    let mut image = a.clone();
    image.data_mut().iter_mut().zip(b.data()).for_each(|(a, b)| *a = 0.5 * (*a + b));
    let variance = Some(Planes::filled(1, a.height(), a.width(), 0.01));
    let estimate = Estimate { mean: image, variance, samples: 64 };
    TruthReport::new(EFFECT, Truth { estimate, halves }, milliseconds)
}

fn frame(name: &str, methods: &[&str]) -> FrameReport {
    let truth = truth([wave(0.0), wave(0.1)], 1234.5);
    let methods = methods.iter().enumerate().map(|(i, name)| {
        let image = wave(0.3 * (i + 1) as f32);
        let scores = truth.scores(&image);
        let (name, clock, device) = ((*name).to_owned(), Clock::Gpu, "a card".to_owned());
        MethodReport { name, scores, image, milliseconds: 2.5, clock, device }
    });
    let methods = methods.collect();
    FrameReport {
        name: name.to_owned(),
        facts: vec![("radius".to_owned(), "0.5 m".to_owned())],
        truth,
        methods,
    }
}

fn comparison(frames: Vec<FrameReport>) -> Comparison {
    let machine = vec![("adapter".to_owned(), "none <of> any".to_owned())];
    Comparison { effect: EFFECT, quality: Quality::High, frames, machine }
}

/// Values of an attribute in the page's source.
fn values<'a>(page: &'a str, attribute: &str) -> Vec<&'a str> {
    page.split(attribute).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

#[test]
fn noise_is_between_the_halves() {
    let truth = truth([wave(0.0), wave(0.1)], 0.0);
    assert_eq!(truth.noise, Scores::new(&wave(0.0), &wave(0.1)));
    assert!(truth.floor.ssim < truth.noise.ssim);
}

#[test]
fn a_perfect_image_scores_better_than_half_against_half() {
    let noisy = |seed: u32| {
        let image = wave(0.0);
        Planes::from_fn(1, image.height(), image.width(), |_, y, x| {
            image.at(0, y, x) + 0.1 * (random(x as u32, y as u32, seed, 0) - 0.5)
        })
    };
    let truth = truth([noisy(1), noisy(2)], 0.0);
    let perfect = truth.scores(&wave(0.0));
    assert!(perfect.ssim > truth.noise.ssim && perfect.psnr > truth.noise.psnr, "{perfect:?}");
}

#[test]
fn everything_that_the_page_shows_is_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = vec![frame("one", &["learned", "hbao"]), frame("two", &["learned", "hbao"])];
    let path = comparison(frames).write(&folder.path().join("deep/report")).expect("a report");
    let page = std::fs::read_to_string(&path).expect("the page");
    let place = path.parent().expect("its folder");
    let sources = values(&page, "src=\"");
    assert!(sources.len() >= 8, "{sources:?}");
    for source in sources {
        assert!(place.join(source).is_file(), "{source}");
    }
    for image in ["learned", "hbao", "truth"] {
        for ending in ["image.png", "difference.png", "flip.png", "exr"] {
            assert!(place.join(format!("frame-01/{image}.{ending}")).is_file(), "{image}.{ending}");
        }
    }
    assert!(!page.contains("http"), "nothing from elsewhere");
    for text in ["white image", "half against half", "1234", "2.50", "GPU timestamps", "0.5 m", "Mean over 2"]
    {
        assert!(page.contains(text), "{text}");
    }
}

#[test]
fn a_second_report_leaves_nothing_of_the_first_and_all_that_is_not_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let written = |frames: Vec<FrameReport>| comparison(frames).write(folder.path()).expect("a report");
    written(vec![frame("one", &["learned", "hbao"]), frame("two", &["learned", "hbao"])]);
    for name in ["notes.txt", "frame-00/notes.txt", "frame-x.exr"] {
        std::fs::write(folder.path().join(name), "kept").expect("written");
    }
    written(vec![frame("one", &["hbao"])]);
    let there = |name: &str| folder.path().join(name).exists();
    assert!(!there("frame-01") && !there("frame-00/learned.exr") && !there("frame-00/learned.flip.png"));
    for name in ["index.html", "frame-00/hbao.exr", "notes.txt", "frame-00/notes.txt", "frame-x.exr"] {
        assert!(there(name), "{name}");
    }
    // The page is gone as soon as an image cannot be written.
    std::fs::remove_dir_all(folder.path().join("frame-00")).expect("removed");
    std::fs::write(folder.path().join("frame-00"), "in the way").expect("written");
    assert!(comparison(vec![frame("one", &["hbao"])]).write(folder.path()).is_err());
    assert!(!there("index.html"));
}

#[test]
fn a_folder_that_holds_something_else_is_refused_and_left_as_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = |name: &str| folder.path().join(name);
    let report = comparison(vec![frame("one", &["hbao"])]);
    for (name, text) in [("holiday.png", "a picture"), ("index.html", "<html>my own page</html>")] {
        std::fs::write(place(name), text).expect("written");
        let error = report.write(folder.path()).expect_err("another's folder").to_string();
        assert!(error.contains(name) && error.contains("no report"), "{error}");
        assert_eq!(std::fs::read_to_string(place(name)).expect("read"), text);
        assert_eq!(std::fs::read_dir(folder.path()).expect("entries").count(), 1);
        std::fs::remove_file(place(name)).expect("removed");
    }
    // What a report leaves that was killed while it was written.
    report.write(folder.path()).expect("a report");
    std::fs::remove_file(place("index.html")).expect("removed");
    report.write(folder.path()).expect("only frames are left");
    report.write(folder.path()).expect("an earlier report");
}

#[test]
fn names_cannot_break_the_page() {
    let hostile = "</script><img src=x>";
    let page = page::render(&comparison(vec![frame(hostile, &["hbao"])])).expect("a page");
    assert!(!page.contains(hostile) && !page.contains("<of>"));
    assert_eq!(page.matches("</script>").count(), 2);
    assert!(page.contains("\\u003c/script>"));
}

#[test]
fn ids_are_unique_and_the_script_finds_them() {
    let page = page::render(&comparison(vec![frame("a", &["hbao"]), frame("b", &["hbao"])])).expect("a page");
    let ids = values(&page, " id=\"");
    let distinct: BTreeSet<&&str> = ids.iter().collect();
    assert_eq!(ids.len(), distinct.len(), "{ids:?}");
    for wanted in values(&page, "element(\"") {
        assert!(ids.contains(&wanted), "{wanted}");
    }
}

#[test]
fn means_are_over_frames() {
    let comparison = comparison(vec![frame("a", &["hbao"]), frame("b", &["hbao"])]);
    let expected = comparison.frames[0].truth.noise;
    let mean = comparison.mean_scores(|frame| frame.truth.noise);
    assert!((mean.ssim - expected.ssim).abs() < 1e-12 && (mean.flip - expected.flip).abs() < 1e-12);
    assert!((comparison.mean(|frame| frame.truth.milliseconds) - 1234.5).abs() < 1e-9);
}

#[test]
fn a_report_needs_frames_with_the_same_methods() {
    let folder = tempfile::tempdir().expect("a folder");
    let none = comparison(Vec::new()).write(folder.path()).expect_err("no frame");
    assert!(none.to_string().contains("without frames"));
    let mixed = comparison(vec![frame("a", &["hbao"]), frame("b", &["learned"])]);
    let error = mixed.write(folder.path()).expect_err("mixed methods");
    assert!(format!("{error:#}").contains("different methods"));
    assert_eq!(std::fs::read_dir(folder.path()).expect("entries").count(), 0, "nothing half-written");
}

#[test]
fn figures_bear_the_names_that_scripts_ask_for() {
    let mut figures = Figures::new("compare");
    comparison(vec![frame("a", &["bounced-z"])]).set_figures(&mut figures);
    let json = figures.to_json();
    for name in ["ssim_", "psnr_", "flip_", "relmse_", "ms_"].map(|metric| format!("{metric}bounced_z")) {
        assert!(json["figures"][&name].is_number(), "{name}: {json}");
    }
    for name in ["ssim_ceiling", "ssim_white", "ms_truth"] {
        assert!(json["figures"][name].is_number(), "{name}");
    }
    assert_eq!(json["details"]["frames"][0]["facts"]["radius"], "0.5 m");
}

#[test]
fn the_table_has_a_line_for_everything() {
    let text = comparison(vec![frame("a", &["learned", "hbao"])]).to_string();
    let starts: Vec<&str> =
        text.lines().map(|line| line.split([' ', ',']).next().unwrap_or_default()).collect();
    assert_eq!(starts, ["ao", "learned", "hbao", "truth", "white"]);
}
