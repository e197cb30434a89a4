//! `deepshade-studies crosscheck`: truth against Mitsuba 3, a renderer of others, on scenes that are exported
//! for it.
//!
//! `cargo xtask crosscheck` sets up Python and calls this. Each case is one effect in one scene; both
//! renderers give a mean and its variance for each value of the image, and [`agreement`] says whether the two
//! can be means of the same. Motion blur, which Mitsuba lacks, is compared with the mean of many still frames
//! instead. Controls are cases with a fault put in on purpose, which must be found.
//!
//! Materials are Lambert's in most scenes, here and there, so that there is one definition of them; one scene
//! is glossy, with our microfacets written once more on Mitsuba's, and for image-based lighting our Phong
//! lobe, since Mitsuba 3 has neither as it is defined here. Masked and blended surfaces are made opaque,
//! vertex colours and the pictures of spots and directional lights left out: they are proven by tests of
//! their own.
//!
//! Each case has random numbers of its own, and its mean is tested to the noise alone. What is left with many
//! more samples is Mitsuba's: rays of its own integrators start `9e-5 (1 + |p|)` above a surface, which lets
//! light into creases. That makes `flat-blobs.path` 0.02 % brighter, and 0.12 % if the scene is a tenth as
//! large, where the 1 counts more. The integrators of the script start their rays nearer.

mod agreement;
mod cases;
mod export;
mod files;
mod lambert;
mod pictures;
mod scenes;
mod stills;

use agreement::Agreement;
use anyhow::{Context, Result, bail, ensure};
use cases::{Case, Expected, Reference};
use clap::builder::RangedU64ValueParser;
use deepshade::shared::figures::Figures;
use deepshade_render::bvh::TracedScene;
use deepshade_render::path::{Footprint, Sampling, Shot, render};
use scenes::CrosscheckScene;
use std::path::PathBuf;
use std::process::Command;

/// Independent renderings that an image's variance is estimated from, in either renderer.
const REPLICATES: u32 = 32;

/// Checks truth against Mitsuba 3; `cargo xtask crosscheck` sets it up and calls this.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade-studies crosscheck --python python3 --only room.gi")]
pub struct Args {
    /// A Python that has Mitsuba 3.
    #[arg(long)]
    python: PathBuf,
    /// The script that renders what is exported.
    #[arg(long, default_value = "studies/tests/crosscheck/mitsuba_render.py")]
    script: PathBuf,
    /// Folder of the exported scenes, images and difference pictures.
    #[arg(long, default_value = "target/crosscheck")]
    out: PathBuf,
    /// Folder of the real scenes, by default what DEEPSHADE_DATA names, else ../shared/data/open; cases on
    /// them are left out, and counted, where it is missing.
    #[arg(long)]
    data: Option<PathBuf>,
    /// Only cases whose name holds this.
    #[arg(long, default_value = "")]
    only: String,
    /// Samples of a pixel in either renderer; some cases take a multiple. With fewer than by default, some
    /// are too noisy to agree.
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(64..=65_536))]
    samples: u32,
    /// Rows of the images; there are half again as many columns.
    #[arg(long, default_value_t = 64, value_parser = RangedU64ValueParser::<usize>::new().range(16..=1024))]
    height: usize,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = deepshade::shared::arguments::written_file)]
    json: Option<PathBuf>,
}

/// A case that can be rendered, and where its files are.
struct Job {
    case: &'static Case,
    setting: CrosscheckScene,
    folder: PathBuf,
}

/// What came of a case.
struct CaseOutcome {
    case: &'static Case,
    agreement: Agreement,
}

impl CaseOutcome {
    /// Whether the two renderers agree where they should, and a fault is found where one was put in.
    fn as_expected(&self) -> bool {
        self.agreement.agrees() == (self.case.expected == Expected::Agreement)
    }
}

/// Exports, renders twice, compares, writes pictures and figures; an error where renderers disagree.
pub fn run(args: &Args) -> Result<()> {
    let chosen: Vec<&Case> = cases::ALL.iter().filter(|case| case.name().contains(&args.only)).collect();
    ensure!(!chosen.is_empty(), "no case's name holds `{}`", args.only);
    let data = args.data.clone().or_else(|| std::env::var_os("DEEPSHADE_DATA").map(PathBuf::from));
    let data = data.unwrap_or_else(|| "../shared/data/open".into());
    let mut jobs = Vec::new();
    let mut absent = Vec::new();
    for case in chosen {
        match scenes::build(case.scene, &data)? {
            Some(setting) => jobs.push(Job { case, setting, folder: args.out.join(case.name()) }),
            None => absent.push(case),
        }
    }
    for case in &absent {
        note!("{}: left out, no such data in {}", case.name(), data.display());
    }
    render_with_mitsuba(args, &jobs)?;
    let mut outcomes = Vec::new();
    for job in &jobs {
        outcomes.push(compare(args, job).with_context(|| job.case.name())?);
        note!("compared {}", job.case.name());
    }
    figures(&outcomes, &absent).write(args.json.as_deref())?;
    let printed = outcomes
        .iter()
        .try_for_each(|outcome| say!("{:<36} {}{}", outcome.case.name(), outcome.agreement, remark(outcome)));
    // Whether anybody reads it does not change what came out.
    let wrong: Vec<String> =
        outcomes.iter().filter(|outcome| !outcome.as_expected()).map(|outcome| outcome.case.name()).collect();
    ensure!(wrong.is_empty(), "not as expected: {}; pictures in {}", wrong.join(", "), args.out.display());
    printed
}

fn remark(outcome: &CaseOutcome) -> &'static str {
    match (outcome.case.expected, outcome.as_expected()) {
        (Expected::Agreement, true) => "",
        (Expected::Agreement, false) => "  DISAGREES",
        (Expected::Disagreement, true) => "  fault found",
        (Expected::Disagreement, false) => "  FAULT NOT FOUND",
    }
}

/// Exports the cases that Mitsuba has a part in and lets it render them.
fn render_with_mitsuba(args: &Args, jobs: &[Job]) -> Result<()> {
    let mut mitsuba = Command::new(&args.python);
    mitsuba.arg(&args.script);
    let mut count = 0;
    for job in jobs {
        if let Reference::Mitsuba { fault } = job.case.reference {
            let sampling = sampling(args, job.case);
            export::write(&job.folder, job.case.effect, &job.setting, fault, size(args), sampling)
                .with_context(|| format!("exporting {}", job.case.name()))?;
            mitsuba.arg(&job.folder);
            count += 1;
        }
    }
    if count == 0 {
        return Ok(());
    }
    let status = mitsuba.status().with_context(|| format!("cannot start {}", args.python.display()))?;
    if !status.success() {
        bail!("{} failed ({status})", args.script.display());
    }
    Ok(())
}

fn compare(args: &Args, job: &Job) -> Result<CaseOutcome> {
    let effect = job.case.effect;
    let scene = TracedScene::new(job.setting.scene.clone())?;
    let shot = Shot {
        footprint: Footprint::Box,
        ..Shot::new(&scene, &job.setting.camera, size(args), job.setting.radius)
    };
    let sampling = sampling(args, job.case);
    let ours = render(effect, &shot, sampling);
    let theirs = match job.case.reference {
        Reference::Mitsuba { .. } => files::read_estimate(&job.folder, effect.channels(), sampling.samples)?,
        Reference::Stills => {
            stills::render_stills(&job.setting, size(args), Sampling { seed: !sampling.seed, ..sampling })?
        }
    };
    pictures::write(&job.folder, &ours, &theirs)?;
    let agreement = Agreement::of(&ours, &theirs, REPLICATES);
    Ok(CaseOutcome { case: job.case, agreement })
}

/// The samples of a case, in either renderer.
fn sampling(args: &Args, case: &Case) -> Sampling {
    Sampling { samples: args.samples * case.samples, scramblings: REPLICATES, seed: case.seed() }
}

const fn size(args: &Args) -> [usize; 2] {
    [args.height, args.height * 3 / 2]
}

/// The figures of all cases but the controls, and how many controls were found out.
fn figures(outcomes: &[CaseOutcome], absent: &[&Case]) -> Figures {
    let of = |expected| outcomes.iter().filter(move |outcome| outcome.case.expected == expected);
    let cases: Vec<&CaseOutcome> = of(Expected::Agreement).collect();
    let worst = |value: fn(&Agreement) -> f64| {
        agreement::largest(cases.iter().map(|outcome| value(&outcome.agreement)))
    };
    let distinct =
        |names: Vec<&str>| names.into_iter().collect::<std::collections::BTreeSet<_>>().len() as f64;
    let mut figures = Figures::new("crosscheck");
    figures.set("scenes", distinct(cases.iter().map(|outcome| outcome.case.scene).collect()));
    figures.set("scenes_absent", distinct(absent.iter().map(|case| case.scene).collect()));
    figures.set("cases", cases.len() as f64);
    figures.set("cases_agreeing", cases.iter().filter(|outcome| outcome.as_expected()).count() as f64);
    figures.set("worst_outside_share", worst(|agreement| agreement.outside_share));
    figures.set("expected_outside_share", agreement::EXPECTED_OUTSIDE_SHARE);
    figures.set("largest_outside_share", worst(|agreement| agreement.outside_limit));
    figures.set("worst_relmse", worst(|agreement| agreement.relative_mse));
    figures.set("worst_excess_relmse", worst(Agreement::excess_relative_mse));
    figures.set("worst_mean_difference", worst(|agreement| agreement.mean_difference));
    figures.set("worst_mean_deviate", worst(|agreement| agreement.mean_deviate));
    figures.set("worst_mean_error", worst(|agreement| agreement.mean_error));
    figures.set("controls", of(Expected::Disagreement).count() as f64);
    let found = of(Expected::Disagreement).filter(|outcome| outcome.as_expected()).count();
    figures.set("controls_found", found as f64);
    for outcome in outcomes {
        figures.detail(&outcome.case.name(), outcome.agreement.to_json());
    }
    figures
}
