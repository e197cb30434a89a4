//! The report as a whole: what is on the disk, and that the page asks for nothing else.

use super::images::{self, ExposedTruth};
use super::record::{ImageRecord, TRUTH};
use super::*;
use crate::figures::Figures;
use deepshade_render::exr_file::Metadata;
use deepshade_render::method::Clock;
use deepshade_render::path::Estimate;
use deepshade_shaders::Attribute;
use deepshade_shaders::random::random;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

const EFFECT: Effect = Effect::Ao;

fn wave(phase: f32) -> Planes {
    Planes::from_fn(1, 24, 32, |_, y, x| 0.5 + 0.4 * (0.3 * x as f32 + 0.2 * y as f32 + phase).sin())
}

/// Truth of two halves.
fn truth(halves: [Planes; 2]) -> Truth {
    let [a, b] = &halves;
    let mut image = a.clone();
    image.data_mut().iter_mut().zip(b.data()).for_each(|(a, b)| *a = 0.5 * (*a + b));
    let variance = Some(Planes::filled(1, a.height(), a.width(), 0.01));
    Truth { estimate: Estimate { mean: image, variance, samples: 64 }, halves }
}

/// A g-buffer that shows nothing, of the size of the images.
fn nothing() -> GBuffer {
    GBuffer::new(vec![Attribute::Valid], Planes::filled(1, 24, 32, 0.0))
}

/// A frame whose images are written into a folder.
fn frame(out: &Path, effect: Effect, name: &str, methods: &[&str]) -> FrameRecord {
    let truth = truth([wave(0.0), wave(0.1)]);
    let mean = &truth.estimate.mean;
    let record = TruthRecord::new(EFFECT, &truth, &nothing(), 1234.5);
    let folder =
        format!("frame-{}-{effect}", name.chars().filter(char::is_ascii_alphanumeric).collect::<String>());
    let place = out.join(&folder);
    std::fs::create_dir_all(&place).expect("made");
    images::write_truth(&place, effect, &truth, record.exposure, &Metadata::default()).expect("written");
    let exposed = ExposedTruth { effect, image: mean, exposure: record.exposure };
    let images = methods.iter().enumerate().map(|(i, name)| {
        let image = wave(0.3 * (i + 1) as f32);
        images::write_image(&place, name, &image, &exposed, &Metadata::default()).expect("written");
        ImageRecord {
            key: format!("key of {name}"),
            file: (*name).to_owned(),
            label: (*name).to_owned(),
            method: (*name).to_owned(),
            milliseconds: 2.5 * (i + 1) as f64,
            clock: Clock::Gpu,
            device: "a card".to_owned(),
            scores: exposed.scores(&image),
        }
    });
    let frame = FrameRecord {
        key: "key".to_owned(),
        effect,
        name: name.to_owned(),
        scene: name.to_owned(),
        view: "view 0".to_owned(),
        folder,
        height: 24,
        width: 32,
        radius: None,
        facts: vec![("radius".to_owned(), "0.5 m".to_owned())],
        images: images.collect(),
        truth: record,
    };
    frame.write(out).expect("written");
    frame
}

fn report(frames: Vec<FrameRecord>) -> Report {
    let machine = vec![("adapter".to_owned(), "none <of> any".to_owned())];
    Report { frames, quality: "high".to_owned(), machine }
}

/// A report of frames of an effect, each of which has a name and methods, in a folder of its own.
fn written(out: &Path, frames: &[(&str, &[&str])]) -> Report {
    let folder = Folder::open(out).expect("a folder");
    let frames = frames.iter().map(|(name, methods)| frame(out, EFFECT, name, methods));
    let report = report(frames.collect());
    report.write(&folder).expect("a report");
    report
}

/// Values of an attribute in the page's source.
fn values<'a>(page: &'a str, attribute: &str) -> Vec<&'a str> {
    page.split(attribute).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

fn page_of(out: &Path) -> String {
    std::fs::read_to_string(out.join(PAGE)).expect("the page")
}

#[test]
fn noise_is_between_the_halves() {
    let record = TruthRecord::new(EFFECT, &truth([wave(0.0), wave(0.1)]), &nothing(), 0.0);
    assert_eq!(record.noise, Scores::new(&wave(0.0), &wave(0.1)));
    assert!(record.floor.ssim < record.noise.ssim);
}

#[test]
fn methods_that_are_behind_doing_nothing_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut frames = ["hall", "cave"].map(|name| frame(folder.path(), EFFECT, name, &["near", "far"]));
    // Over both frames `near` is 0.1 below, `far` 0.1 above.
    for (frame, (floor, ssims)) in frames.iter_mut().zip([(0.5, [0.6, 0.5]), (0.7, [0.5, 0.8])]) {
        frame.truth.floor.ssim = floor;
        frame.images.iter_mut().zip(ssims).for_each(|(image, ssim)| image.scores.ssim = ssim);
    }
    let all: Vec<&FrameRecord> = frames.iter().collect();
    assert_eq!(summary::behind_nothing(&all), ["near"]);
    assert!(summary::behind_nothing(&all[..1]).is_empty(), "in the first neither is");
    let printed = report(frames.to_vec()).to_string();
    assert!(printed.contains("behind the white image by SSIM: near\n"), "{printed}");
}

#[test]
fn a_perfect_image_scores_better_than_half_against_half() {
    let noisy = |seed: u32| {
        let image = wave(0.0);
        Planes::from_fn(1, image.height(), image.width(), |_, y, x| {
            image.at(0, y, x) + 0.1 * (random(x as u32, y as u32, seed, 0) - 0.5)
        })
    };
    let truth = truth([noisy(1), noisy(2)]);
    let record = TruthRecord::new(EFFECT, &truth, &nothing(), 0.0);
    let exposed = ExposedTruth { effect: EFFECT, image: &truth.estimate.mean, exposure: record.exposure };
    let perfect = exposed.scores(&wave(0.0));
    assert!(perfect.ssim > record.noise.ssim && perfect.psnr > record.noise.psnr, "{perfect:?}");
}

#[test]
fn everything_that_the_page_shows_and_leads_to_is_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = folder.path().join("deep/report");
    written(&place, &[("one", &["learned", "hbao"]), ("two", &["learned", "hbao"])]);
    let page = page_of(&place);
    let sources = [values(&page, "src=\""), values(&page, "href=\"")].concat();
    assert!(sources.iter().filter(|source| source.ends_with(".exr")).count() == 6, "{sources:?}");
    for source in sources.into_iter().filter(|source| *source != folder::DESCRIPTION) {
        assert!(place.join(source).is_file(), "{source}");
    }
    for image in ["learned", "hbao", "truth"] {
        assert!(images::are_there(&place.join("frame-two-ao"), image), "{image}");
    }
    let own = page.replace("http://www.w3.org/2000/svg", "");
    assert!(!own.contains("http"), "nothing from elsewhere");
    for text in [
        "white image",
        "half against half",
        "1234",
        "2.50",
        "ms on a card, GPU timestamps",
        "0.5 m",
        "mean over 2",
        "Scene by scene",
    ] {
        assert!(page.contains(text), "{text}");
    }
    assert_eq!(page.matches("<svg").count(), 3, "error against time by three measures");
}

#[test]
fn truth_comes_back_from_its_file_to_the_last_digit() {
    let folder = tempfile::tempdir().expect("a folder");
    let frame = frame(folder.path(), EFFECT, "one", &[]);
    let expected = truth([wave(0.0), wave(0.1)]).estimate.mean;
    let found = images::read_truth(&folder.path().join(&frame.folder), EFFECT).expect("an image");
    assert_eq!(found, expected);
}

#[test]
fn a_second_report_leaves_nothing_of_the_first_and_all_that_is_not_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    written(folder.path(), &[("one", &["learned", "hbao"]), ("two", &["learned", "hbao"])]);
    std::fs::create_dir(folder.path().join("frame-of-mine")).expect("made");
    let others = ["notes.txt", "frame-one-ao/notes.txt", "frame-x.exr", "frame-of-mine/hbao.exr"];
    for name in others {
        std::fs::write(folder.path().join(name), "kept").expect("written");
    }
    written(folder.path(), &[("one", &["hbao"])]);
    let there = |name: &str| folder.path().join(name).exists();
    assert!(!there("frame-two-ao") && !there("frame-one-ao/learned.exr"));
    assert!(!there("frame-one-ao/learned.flip.png") && !there("compare.lock"));
    for name in others.into_iter().chain(["index.html", "frame-one-ao/hbao.exr"]) {
        assert!(there(name), "{name}");
    }
}

#[test]
fn a_folder_is_one_programs_and_has_no_page_while_images_may_change() {
    let folder = tempfile::tempdir().expect("a folder");
    written(folder.path(), &[("one", &["hbao"])]);
    let taken = Folder::open(folder.path()).expect("a report's folder");
    assert!(!folder.path().join(PAGE).exists());
    let error = Folder::open(folder.path()).expect_err("it is taken").to_string();
    assert!(error.contains("process ") && error.contains("is writing a comparison there"), "{error}");
    drop(taken);
    Folder::open(folder.path()).expect("free again");
}

#[test]
fn a_folder_that_holds_something_else_is_refused_and_left_as_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = |name: &str| folder.path().join(name);
    for (name, text) in [
        ("holiday.png", "a picture"),
        ("index.html", "<html>my own page</html>"),
        ("compare.toml", "scenes = [\"room:1\"]"),
    ] {
        std::fs::write(place(name), text).expect("written");
        let error = Folder::open(folder.path()).expect_err("another's folder").to_string();
        assert!(error.contains(name) && error.contains("no report"), "{error}");
        assert_eq!(std::fs::read_to_string(place(name)).expect("read"), text);
        assert_eq!(std::fs::read_dir(folder.path()).expect("entries").count(), 1);
        std::fs::remove_file(place(name)).expect("removed");
    }
    std::fs::create_dir(place("frame-01")).expect("made");
    let error = Folder::open(folder.path()).expect_err("one's own frames").to_string();
    assert!(error.contains("frame-01"), "{error}");
    std::fs::remove_dir(place("frame-01")).expect("removed");
    // What a report leaves that was killed while it was written.
    written(folder.path(), &[("one", &["hbao"])]);
    std::fs::remove_file(place("index.html")).expect("removed");
    std::fs::remove_file(place("compare.md")).expect("removed");
    written(folder.path(), &[("one", &["hbao"])]);
    written(folder.path(), &[("one", &["hbao"])]);
}

#[test]
fn only_images_that_are_wanted_and_whole_are_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let frame = frame(folder.path(), EFFECT, "one", &["learned", "hbao"]);
    let wanted: Vec<record::ImageRequest> = frame
        .images
        .iter()
        .map(|image| record::ImageRequest {
            key: image.key.clone(),
            file: image.file.clone(),
            label: "new".to_owned(),
        })
        .collect();
    let kept = |key: &str, wanted: &[record::ImageRequest]| {
        FrameRecord::kept(folder.path(), &frame.folder, key, wanted)
    };
    let whole = kept("key", &wanted).expect("truth is there");
    assert_eq!(whole.images.len(), 2);
    assert_eq!(whole.images[0].scores, frame.images[0].scores, "to the last digit");
    assert_eq!((whole.images[0].label.as_str(), &whole.truth), ("new", &frame.truth));
    assert_eq!(kept("another", &wanted), None);
    let other = [record::ImageRequest { key: "another".to_owned(), ..wanted[0].clone() }];
    assert_eq!(kept("key", &other).expect("truth is there").images, []);
    let place = folder.path().join(&frame.folder);
    std::fs::remove_file(place.join("hbao.flip.png")).expect("removed");
    assert_eq!(kept("key", &wanted).expect("truth is there").files().collect::<Vec<_>>(), ["learned", TRUTH]);
    std::fs::remove_file(place.join("truth.exr")).expect("removed");
    assert_eq!(kept("key", &wanted), None);
}

#[test]
fn names_cannot_break_the_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let hostile = "</script><img src=x>";
    let mut frames = vec![frame(folder.path(), EFFECT, hostile, &["hbao"])];
    hostile.clone_into(&mut frames[0].images[0].label);
    let page = page::render(&report(frames)).expect("a page");
    assert!(!page.contains(hostile) && !page.contains("<of>"));
    assert_eq!(page.matches("</script>").count(), 2);
    assert!(page.contains("\\u003c/script>"));
}

#[test]
fn ids_are_unique_and_the_script_finds_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = [(Effect::Ao, "a"), (Effect::Ao, "b"), (Effect::Aa, "a")];
    let frames = frames.map(|(effect, name)| frame(folder.path(), effect, name, &["hbao"]));
    let page = page::render(&report(frames.to_vec())).expect("a page");
    let ids = values(&page, " id=\"");
    let distinct: BTreeSet<&&str> = ids.iter().collect();
    assert_eq!(ids.len(), distinct.len(), "{ids:?}");
    for wanted in values(&page, "element(\"") {
        assert!(ids.contains(&wanted), "{wanted}");
    }
}

#[test]
fn means_are_over_those_frames_that_have_an_image() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames: [FrameRecord; 2] = [("a", &["hbao"][..]), ("b", &["gtao", "hbao"])]
        .map(|(name, methods)| frame(folder.path(), EFFECT, name, methods));
    let lines = summary::lines(EFFECT, &frames.iter().collect::<Vec<_>>());
    let names: Vec<&str> = lines.iter().map(|line| line.name.as_str()).collect();
    assert_eq!(names, ["hbao", "gtao (1 of 2 frames)", "truth, half against half", "white image"]);
    let scores = |frame: usize, image: usize| frames[frame].images[image].scores;
    assert!((lines[0].scores.ssim - 0.5 * (scores(0, 0).ssim + scores(1, 1).ssim)).abs() < 1e-12);
    assert_eq!((lines[0].milliseconds, lines[1].milliseconds), (Some(3.75), Some(2.5)));
    assert_eq!(lines[1].scores, scores(1, 0));
    assert!((lines[2].scores.flip - frames[0].truth.noise.flip).abs() < 1e-12);
}

#[test]
fn a_report_needs_frames() {
    let folder = tempfile::tempdir().expect("a folder");
    let taken = Folder::open(folder.path()).expect("a folder");
    let none = report(Vec::new()).write(&taken).expect_err("no frame");
    assert!(none.to_string().contains("without frames"));
}

/// A report's figures as JSON.
fn figures(report: &Report) -> Value {
    let mut figures = Figures::new("compare");
    report.set_figures(&mut figures);
    figures.to_json()
}

#[test]
fn figures_bear_the_names_that_scripts_ask_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let one = vec![frame(folder.path(), EFFECT, "a", &["bounced-z"])];
    let json = figures(&report(one));
    for name in ["ssim_", "psnr_", "flip_", "relmse_", "ms_"].map(|metric| format!("{metric}bounced_z")) {
        assert!(json["figures"][&name].is_number(), "{name}: {json}");
    }
    for name in ["ssim_ceiling", "ssim_white", "ms_truth"] {
        assert!(json["figures"][name].is_number(), "{name}");
    }
    assert_eq!(json["details"]["frames"][0]["facts"]["radius"], "0.5 m");
    let two = [Effect::Ao, Effect::Aa].map(|effect| frame(folder.path(), effect, "a", &["hbao"]));
    let json = figures(&report(two.to_vec()));
    for name in
        ["ssim_ao_hbao", "ms_aa_hbao", "flip_ao_white", "flip_aa_light", "ssim_aa_ceiling", "ms_ao_truth"]
    {
        assert!(json["figures"][name].is_number(), "{name}: {json}");
    }
}

#[test]
fn the_table_has_a_line_for_everything() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = report(vec![frame(folder.path(), EFFECT, "a", &["learned", "hbao"])]).to_string();
    let starts: Vec<&str> =
        text.trim().lines().map(|line| line.split([' ', ',', ':']).next().unwrap_or_default()).collect();
    assert_eq!(starts, ["ao", "learned", "hbao", "truth", "white", "ms", "truth"]);
}

#[test]
fn the_device_is_named_once_and_what_ran_elsewhere_has_no_time_beside_the_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut one = frame(folder.path(), EFFECT, "a", &["learned", "hbao", "march"]);
    one.images[2].device = "a processor".to_owned();
    let report = report(vec![one]);
    let (printed, page) = (report.to_string(), page::render(&report).expect("a page"));
    for text in [&printed, &markdown::text(&report)] {
        assert_eq!(text.matches("a card").count(), 1, "{text}");
        let march =
            text.lines().find(|line| line.trim_start_matches("| ").starts_with("march ")).expect("a line");
        assert!(!march.contains("7.50"), "{march}");
        assert!(text.contains("march: 7.50 ms on a processor, which is not to be compared"), "{text}");
    }
    assert_eq!(page.matches("against milliseconds on a card").count(), 3, "each plot names it");
    assert_eq!(page.matches("<circle").count(), 3 * 4, "and has those that ran there, and their legend");
}

#[test]
fn methods_within_truths_noise_are_named_in_tables_and_on_the_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut one = frame(folder.path(), EFFECT, "a", &["learned", "hbao"]);
    let mut said = |ceiling: f64| {
        one.truth.noise.ssim = ceiling;
        one.images.iter_mut().zip([0.95, 0.94]).for_each(|(image, ssim)| image.scores.ssim = ssim);
        let report = report(vec![one.clone()]);
        [report.to_string(), markdown::text(&report), page::render(&report).expect("a page")]
    };
    for text in said(0.92) {
        assert!(text.contains(" 0.020 of SSIM: learned and hbao;") && text.contains("--error"), "{text}");
    }
    for text in said(0.97) {
        assert!(!text.contains("of SSIM: learned and hbao"), "{text}");
    }
}

#[test]
fn markdown_has_the_figures_of_the_json_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = ["a|b", "c"].map(|name| frame(folder.path(), EFFECT, name, &["learned", "hbao"]));
    let report = report(frames.to_vec());
    let (text, json) = (markdown::text(&report), figures(&report));
    assert!(text.contains("a\\|b"), "a bar ends no cell");
    let (means, by_scene) = text.split_once("By scene:").expect("two tables");
    assert_eq!(by_scene.lines().filter(|line| line.starts_with('|')).count(), 2 + 2 * 4, "{text}");
    for (name, figure) in
        [("learned", "learned"), ("hbao", "hbao"), ("truth, half", "ceiling"), ("white", "white")]
    {
        let line = means.lines().find(|line| line.starts_with(&format!("| {name}"))).expect(name);
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        for (column, metric, within) in
            [(2, "ssim", 5e-4), (3, "psnr", 5e-2), (4, "flip", 5e-4), (5, "relmse", 5e-5)]
        {
            let stated: f64 = cells[column].parse().expect("a number");
            let exact = json["figures"][format!("{metric}_{figure}")].as_f64().expect("a figure");
            assert!((stated - exact).abs() <= within * 1.001, "{metric} of {name}: {stated}, {exact}");
        }
    }
}
