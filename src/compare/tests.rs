//! What a comparison's file says, and what it is refused for.

use super::description::{Comparison, read};
use super::run::ComparisonRun;
use super::values::{Colour, MethodChoice};
use crate::location::Location;
use crate::views::Choice;
use anyhow::Result;
use deepshade_dataset::Radius;
use deepshade_dataset::recipe::Resolution;
use deepshade_render::methods::Quality;
use deepshade_shaders::Effect;
use glam::Vec3;
use std::path::Path;

/// What a file says, in a folder of its own, with what a command line states beside it.
fn comparison(text: &str, line: &ComparisonRun) -> Result<Comparison> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("comparison.toml");
    std::fs::write(&path, text)?;
    Comparison::new(Some(read(&path)?), |_| line.clone())
}

fn parsed(text: &str) -> Comparison {
    comparison(text, &ComparisonRun::default()).expect(text)
}

/// A file that uses everything.
const WHOLE: &str = r#"
effects = ["ao", "fog-direct", "motion-blur", "dof", "sss"]
methods = ["gtao", { name = "hbao", qualities = ["low", "ultra"] }, { name = "learned", model = "runs/a b" }, "epipolar"]
qualities = ["low", "high"]
resolution = { height = 32, width = 48 }
samples = 64
error = 0.02
seed = 7
time = 0.5
shutter = 0.1
aperture = 0.01
focus = 2.0
extinction = 0.2
scattering_albedo = [0.9, 0.8, 1]
anisotropy = -0.3
mean_free_path = 0.01
scenes = ["room:1"]

[[runs]]
name = "from two sides"
views = [{ camera = "left" }, { view = 3 }, { eye = [1, 1.5, 1], look_at = [3.25, 0.5, 3] }]
radius = { diagonal = 0.2 }

[[runs]]
scenes = ["stairs:7", "room:2"]
views = 2
put = ["still-life:1@2,0,2,0.2,30"]
radius = { metres = 0.5 }
samples = 8
"#;

#[test]
fn four_lines_are_enough_and_the_rest_has_defaults() {
    let whole = parsed("scenes = [\"room:7\"]\n");
    let run = &whole.runs[0];
    assert_eq!(whole.runs.len(), 1);
    assert_eq!((run.effects(), run.qualities()), (&[Effect::Ao][..], &[Quality::High][..]));
    assert_eq!((run.size(), run.samples, run.seed), ([512, 512], Some(512), Some(0)));
    assert_eq!(run.time, Some(0.0));
    assert_eq!((&run.methods, &run.views, run.radius), (&None, &None, None));
}

#[test]
fn runs_have_what_they_leave_out_from_the_run_that_they_stand_in() {
    let whole = parsed(WHOLE);
    let (first, second) = (&whole.runs[0], &whole.runs[1]);
    assert_eq!(whole.runs.len(), 2);
    assert_eq!(first.scenes()[0].to_string(), "room:1");
    assert_eq!(second.scenes().len(), 2);
    assert_eq!((first.samples, first.error), (Some(64), Some(0.02)));
    assert_eq!((second.samples, second.error), (Some(8), None), "samples and error are one statement");
    assert_eq!(first.radius, Some(Radius::Diagonal(0.2)));
    assert_eq!(second.views, Some(Choice::Sampled(2)));
    assert_eq!(first.scattering_albedo, Some(Colour(Vec3::new(0.9, 0.8, 1.0))));
    assert_eq!(second.extinction, Some(Colour(Vec3::splat(0.2))));
    assert_eq!((first.time, second.anisotropy), (Some(0.5), Some(-0.3)));
}

#[test]
fn an_unknown_key_is_followed_by_the_one_that_was_meant() {
    let refused = comparison("scenes = [\"room:7\"]\nefects = [\"ao\"]", &ComparisonRun::default());
    let error = format!("{:#}", refused.expect_err("an unknown key"));
    assert!(error.contains("`efects` (did you mean `effects`?)"), "{error}");
}

#[test]
fn numbers_of_a_method_are_read_as_tables_and_written_so_that_they_are_read_again() {
    let text = "scenes = [\"room:7\"]\n\
        methods = [\"gtao\", { name = \"gtao\", parameters = { slices.thickness = 0.5, blur = { radius = 2 } } }]";
    let run = &parsed(text).runs[0];
    let changes = [("blur.radius".to_owned(), 2.0.into()), ("slices.thickness".to_owned(), 0.5.into())];
    assert_eq!(run.methods()[1].parameters.0, changes.into());
    assert!(run.methods()[0].parameters.is_empty());
    let written = parsed(text).to_toml(Path::new(".")).expect("text");
    assert_eq!(parsed(&written).runs[0].methods(), run.methods(), "{written}");
    let refused =
        toml::from_str::<ComparisonRun>("methods = [{ name = \"gtao\", parameters = { blur = [1] } }]");
    let error = refused.expect_err("a list").to_string();
    assert!(error.contains("`blur` is [1], which is no number or name"), "{error}");
}

#[test]
fn what_is_written_is_what_is_read_and_it_is_written_alike_again() {
    for text in
        [WHOLE, "scenes = [\"room:7\"]", "scenes = [\"room:7\"]\nviews = [{ view = 1 }]\nerror = 0.05"]
    {
        let folder = tempfile::tempdir().expect("a folder");
        let (first, path) = (parsed(text), folder.path().join("compare.toml"));
        let written = first.to_toml(folder.path()).expect("text");
        std::fs::write(&path, &written).expect("written");
        let mut again =
            Comparison::new(Some(read(&path).expect("sound")), |_| ComparisonRun::default()).expect("sound");
        // A folder that is not there has no way to it, and stays as it is.
        again.runs.iter_mut().for_each(|run| {
            run.map_paths(&|path| Path::new("runs").join(path.file_name().unwrap_or_default()));
        });
        let mut first = first;
        first.runs.iter_mut().for_each(|run| {
            run.map_paths(&|path| Path::new("runs").join(path.file_name().unwrap_or_default()));
        });
        assert_eq!(again, first, "{written}");
        assert_eq!(again.to_toml(folder.path()).expect("text").lines().count(), written.lines().count());
    }
}

#[test]
fn files_that_are_named_are_relative_to_the_file_that_names_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = |name: &str| folder.path().join(name);
    for name in ["scenes", "report"] {
        std::fs::create_dir(place(name)).expect("made");
    }
    std::fs::write(place("scenes/hall.gltf"), "{}").expect("written");
    std::fs::write(place("scenes/a.toml"), "scenes = [\"hall.gltf\"]").expect("written");
    let file = read(&place("scenes/a.toml")).expect("sound");
    let found = Comparison::new(Some(file), |_| ComparisonRun::default()).expect("sound");
    assert_eq!(found.runs[0].scenes()[0].to_string(), place("scenes/hall.gltf").display().to_string());
    let written = found.to_toml(&place("report")).expect("text");
    assert!(written.contains("scenes = [\"../scenes/hall.gltf\"]"), "{written}");
}

#[test]
fn the_command_line_comes_before_the_file_in_every_run() {
    let line = ComparisonRun {
        resolution: Some(Resolution { height: 16, width: 24 }),
        error: Some(0.1),
        methods: Some(vec![MethodChoice::named("gtao")]),
        ..ComparisonRun::default()
    };
    let whole = comparison(WHOLE, &line).expect("sound");
    for run in &whole.runs {
        assert_eq!((run.size(), run.error, run.samples), ([16, 24], Some(0.1), Some(16_384)));
        assert_eq!(run.methods(), [MethodChoice::named("gtao")]);
    }
}

#[test]
fn qualities_and_networks_of_the_command_line_are_those_of_every_method() {
    let text = "scenes = [\"room:1\"]\n\
                methods = [{ name = \"hbao\", qualities = [\"ultra\"] }, { name = \"learned\", model = \"a\" }]";
    let line = ComparisonRun {
        qualities: Some(vec![Quality::Low]),
        model: Some(Location::Folder("b".into())),
        ..ComparisonRun::default()
    };
    let run = &comparison(text, &line).expect("sound").runs[0];
    assert_eq!(run.methods(), [MethodChoice::named("hbao"), MethodChoice::named("learned")]);
    assert_eq!(
        (run.qualities(), run.model.clone()),
        (&[Quality::Low][..], Some(Location::Folder("b".into())))
    );
    let kept = &comparison(text, &ComparisonRun::default()).expect("sound").runs[0];
    assert_eq!(kept.methods()[0].qualities, Some(vec![Quality::Ultra]));
}

#[test]
fn a_files_network_goes_where_the_command_line_leaves_no_method_that_is_one() {
    let text = "scenes = [\"room:1\"]\nmethods = [\"learned\", \"hbao\"]\nmodel = \"a\"";
    let hbao = ComparisonRun { methods: Some(vec![MethodChoice::named("hbao")]), ..ComparisonRun::default() };
    assert_eq!(comparison(text, &hbao).expect("sound").runs[0].model, None);
    assert!(comparison(text, &ComparisonRun::default()).expect("sound").runs[0].model.is_some());
    for (text, line) in [
        (text, ComparisonRun { model: Some(Location::Folder("b".into())), ..hbao }),
        ("scenes = [\"room:1\"]\nmethods = [\"hbao\"]\nmodel = \"a\"", ComparisonRun::default()),
    ] {
        let error = format!("{:#}", comparison(text, &line).expect_err("no network"));
        assert!(error.contains("`model` means nothing"), "{error}");
    }
}

#[test]
fn of_methods_that_are_stated_elsewhere_a_run_has_those_of_its_effects() {
    let names = |text: &str, line: &ComparisonRun| -> Result<Vec<String>> {
        let run = comparison(text, line)?.runs.remove(0);
        Ok(run.methods().iter().map(|method| method.name.clone()).collect())
    };
    let text =
        "scenes = [\"room:1\"]\neffects = [\"ao\", \"gi\"]\nmethods = [\"gtao\", \"ssgi\", \"surfel\"]";
    let only = |effect: Effect| ComparisonRun { effects: Some(vec![effect]), ..ComparisonRun::default() };
    assert_eq!(names(text, &only(Effect::Ao)).expect("sound"), ["gtao", "surfel"]);
    assert_eq!(names(text, &only(Effect::Aa)).expect("sound"), [""; 0], "all that there are");
    let run = format!("{text}\n[[runs]]\neffects = [\"gi\"]");
    assert_eq!(names(&run, &ComparisonRun::default()).expect("sound"), ["ssgi", "surfel"]);
    let wrong = text.replace("gtao", "ssao");
    assert!(names(&wrong, &only(Effect::Gi)).expect_err("none").to_string().contains("comparison"));
}

#[test]
fn what_is_wrong_is_named_with_its_line_or_its_key() {
    for (text, named) in [
        ("scenes = [\"room:1\"]\ncolour = 1", &["line 2", "colour", "effects"][..]),
        ("scenes = [\"room:1\"]\n[[runs]]\nscene = 1", &["line 3", "scene", "scenes"]),
        ("scenes = [\"room:1\"]\nviews = [{ eye = [0, 0, 0], nose = 1 }]", &["line 2", "nose", "look_at"]),
        ("scenes = [\"room:1\"]\nviews = [{ eye = [0, 0, 0] }]", &["`views`", "`look_at`"]),
        ("scenes = [\"room:1\"]\nviews = 0", &["line 2", "0 is not within 1 to 1000"]),
        ("scenes = [\"room:1\"]\nviews = \"all\"", &["line 2", "a list of views"]),
        (
            "scenes = [\"room:1\"]\nmethods = [{ name = \"hbao\", speed = 1 }]",
            &["line 2", "speed", "qualities"],
        ),
        ("scenes = [\"room:1\"]\nmethods = [\"ssao\"]", &["no method `ssao`", "hbao"]),
        ("scenes = [\"room:1\"]\nmethods = [\"gtao\", \"gtao\"]", &["`gtao` is asked for twice"]),
        (
            "scenes = [\"room:1\"]\neffects = [\"ao\", \"gi\"]\nmethods = [\"fxaa\"]",
            &["effect `ao`", "effect `gi`", "ssgi"],
        ),
        ("scenes = [\"room:1\"]\nmethods = [{ name = \"hbao\", model = \"a\" }]", &["hbao", "`model`"]),
        ("scenes = [\"room:1\"]\neffects = [\"oa\"]", &["line 2", "oa", "motion-blur"]),
        ("scenes = [\"room:1\"]\nqualities = [\"best\"]", &["line 2", "best", "ultra"]),
        ("scenes = [\"stares:1\"]", &["line 1", "stares"]),
        ("scenes = [\"room:1\", \"room:1\"]", &["`scenes`", "twice"]),
        ("effects = [\"ao\"]", &["`scenes` names none"]),
        (
            "scenes = [\"room:1\"]\nresolution = { height = 8, width = 64 }",
            &["`resolution.height`", "8 is not within 16"],
        ),
        ("scenes = [\"room:1\"]\nsamples = 0", &["`samples`", "0 is not within 1"]),
        ("scenes = [\"room:1\"]\nradius = { metres = -1 }", &["`radius`", "-1 is not above 0"]),
        ("scenes = [\"room:1\"]\nextinction = [1, 2, -1]\n", &["line 2", "negative"]),
        ("scenes = [\"room:1\"]\nextinction = 1", &["--extinction means nothing to the effect ao"]),
        ("scenes = [\"room:1\"]\neffects = [\"aa\", \"dof\"]\nradius = { metres = 1 }", &["effects aa, dof"]),
        ("scenes = [\"room:1\"]\n[[runs]]\n[[runs]]\nsamples = 0", &["run 2", "`samples`"]),
        ("scenes = [\"room:1\"", &["line 1"]),
    ] {
        let error = format!("{:#}", comparison(text, &ComparisonRun::default()).expect_err(text));
        for name in named {
            assert!(error.contains(name), "{text}: no {name} in {error}");
        }
    }
}
