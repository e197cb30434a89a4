//! `cargo xtask models`: every shipped network from nothing, within a budget that is stated here.
//!
//! Each step takes up what an interrupted run left, so the command is simply given again.

use crate::{
    command::{self, cargo, root},
    program::{Program, WITH_STUDIES},
    vulkan,
};
use anyhow::{Context, Result};
use std::{
    fmt::Write,
    path::{Path, PathBuf},
    process::Command,
    time::Instant,
};

/// What a network may cost. Pairs and samples are its recipe's.
struct Budget {
    /// Names recipes and model folder.
    name: &'static str,
    /// Steps of training.
    steps: u32,
    /// Images a step.
    batch: u32,
    /// Height and width of the crops, pixels.
    crop: u32,
    /// The optimiser's highest rate.
    rate: &'static str,
    /// What it is trained on.
    data: Data,
}

/// What a network is trained on.
#[derive(Clone, Copy)]
enum Data {
    /// Pairs that are made before, by the recipe of this name.
    Pairs(&'static str),
    /// Views that are rendered while it trains.
    Streamed(Streamed),
}

/// How a network is trained on views without end, and tested.
#[derive(Clone, Copy)]
struct Streamed {
    /// The task that it shares with others of its effect.
    task: &'static Task,
    /// `--network`, `--channels` and `--estimate`.
    network: [&'static str; 3],
}

/// Views without end of an effect, and what networks on them are tested on.
struct Task {
    /// The recipe of the views, and the model's folder in which the test sets are.
    stream: &'static str,
    /// The test sets' folders, and their recipes.
    tests: &'static [(&'static str, &'static str)],
    /// What `eval` measures beside doing nothing, and at which qualities.
    methods: &'static str,
    qualities: &'static str,
}

const AO: Task = Task {
    stream: "ao",
    tests: &[
        ("testset-small", "ao-small-radius-test"),
        ("testset-medium", "ao-medium-radius-test"),
        ("testset-large", "ao-large-radius-test"),
    ],
    methods: "learned,gtao,hbao",
    qualities: "low,medium,high,ultra",
};
const AA: Task = of_filter("aa", &[("testset", "aa-test")], "learned,fxaa");

const GI: Task = Task {
    stream: "gi",
    tests: &[("testset", "gi-test")],
    methods: "learned,surfel,ssgi",
    qualities: "low,medium",
};

const PHOSPHOR_GI: Task = Task {
    stream: "phosphor-gi",
    tests: &[("testset", "phosphor-gi-test")],
    methods: "learned,surfel",
    qualities: "medium,high",
};

const DO: Task = Task {
    stream: "do",
    tests: &[("testset", "do-test")],
    methods: "learned,ssdo",
    qualities: "low,medium,high",
};

const DOF: Task = of_filter("dof", &[("testset", "dof-test")], "learned,ring-gather");

const MOTION_BLUR: Task =
    of_filter("motion-blur", &[("testset", "motion-blur-test")], "learned,reconstruction");

const MULTI: Task = of_filter("multi", &[("testset", "multi-test")], "learned,occluded-gather");

const SSS: Task = of_filter("sss", &[("testset", "sss-test")], "learned,separable");

/// That of a filter of light, whose method is measured at all qualities.
const fn of_filter(
    stream: &'static str,
    tests: &'static [(&'static str, &'static str)],
    methods: &'static str,
) -> Task {
    Task { stream, tests, methods, qualities: "low,medium,high,ultra" }
}

/// The shipped networks, cheap ones first.
///
/// One core trains some 60 crops of 128 x 128 pixels a second of networks with 16 first kernels, 40 of
/// `ibl-paper`. It makes a pair with 64 samples in five seconds. So data take half an hour, training about as
/// long, and the runs of half and a quarter of the steps three quarters of that.
///
/// Images of indirect light, most of which are dark, want a lower rate. At 0.004 the weights grew without
/// bound, to where structural similarity has no gradient.
const BUDGETS: [Budget; 14] = [
    Budget { name: "aa", steps: 1_200, data: on(&AA, ["corrected", "12", "fxaa:high"]), ..FILTER },
    Budget { name: "dof", steps: 2_500, data: on(&DOF, ["corrected", "16", "ring-gather:high"]), ..FILTER },
    Budget {
        name: "motion-blur",
        steps: 2_000,
        data: on(&MOTION_BLUR, ["corrected", "16", "reconstruction:high"]),
        ..FILTER
    },
    Budget { name: "sss", steps: 2_000, data: on(&SSS, ["corrected", "16", "separable:ultra"]), ..FILTER },
    Budget { name: "gi", steps: 9_000, data: on(&GI, ["corrected", "16", "surfel:medium"]), ..CORRECTED },
    Budget {
        name: "gi-paper",
        steps: 16_000,
        batch: 4,
        crop: 128,
        rate: "0.003",
        data: Data::Pairs("gi-paper"),
    },
    Budget {
        name: "phosphor-gi",
        steps: 2_000,
        data: on(&PHOSPHOR_GI, ["corrected", "24", "surfel:medium"]),
        ..CORRECTED
    },
    Budget { name: "do", steps: 5_000, data: on(&DO, ["corrected", "16", "ssdo:medium"]), ..CORRECTED },
    Budget {
        name: "do-paper",
        steps: 20_000,
        batch: 4,
        crop: 128,
        rate: "0.004",
        data: Data::Pairs("do-paper"),
    },
    Budget {
        name: "multi",
        steps: 1_500,
        data: on(&MULTI, ["corrected", "16", "occluded-gather:high"]),
        ..FILTER
    },
    Budget { name: "ao", steps: 11_000, data: on(&AO, ["corrected", "24", "gtao:high"]), ..CORRECTED },
    Budget { name: "ao-small", steps: 8_500, data: on(&AO, ["corrected", "12", "gtao:low"]), ..CORRECTED },
    Budget { name: "ao-paper", data: on(&AO, ["paper", "24", "gtao:high"]), ..CORRECTED },
    Budget { name: "ibl-paper", steps: 64_000, batch: 4, crop: 128, rate: "0.005", data: Data::Pairs("ibl") },
];

/// What networks on views without end have in common. Two cores train some nine crops a second of `ao`,
/// fourteen of `ao-small`, eight of `gi` and of `do`, while they render the views: half an hour to an hour
/// and a half.
const CORRECTED: Budget =
    Budget { name: "", steps: 8_000, batch: 4, crop: 256, rate: "0.002", data: Data::Pairs("") };

/// The same of networks that correct a filter of light, which is nearer to truth: steps that are too long
/// lead away from it.
const FILTER: Budget = Budget { rate: "0.001", ..CORRECTED };

const fn on(task: &'static Task, network: [&'static str; 3]) -> Data {
    Data::Streamed(Streamed { task, network })
}

/// How often a view is used on average. With the default, 8, rendering was half of the time.
const USES: &str = "32";

/// What is made.
#[derive(clap::Args)]
pub struct Args {
    /// Only the network of that name.
    #[arg(long, value_parser = BUDGETS.map(|budget| budget.name))]
    only: Option<String>,
    /// Folder of data, runs and test sets, by default below the target folder.
    #[arg(long)]
    work: Option<PathBuf>,
    /// What trains: the processor, or a GPU by Vulkan.
    #[arg(long, default_value = "cpu", value_parser = ["cpu", "gpu"])]
    device: String,
}

/// Makes the networks and says how long each step took.
///
/// # Errors
/// If there is no Vulkan adapter, the program does not build, or a step fails.
pub fn run(args: &Args) -> Result<()> {
    let chosen = BUDGETS.iter().filter(|budget| args.only.as_deref().is_none_or(|only| only == budget.name));
    let work = args.work.as_ref().map_or_else(|| command::target().join("models"), |work| root().join(work));
    let features: &[&str] = if args.device == "gpu" { &["--features", "vulkan"] } else { &[] };
    vulkan::ensure()?;
    command::run(&mut cargo(&[&WITH_STUDIES[..], features].concat()))?;
    let mut report = String::new();
    for budget in chosen {
        for (step, mut command) in steps(budget, &work) {
            let began = Instant::now();
            command::run(&mut command).with_context(|| format!("{}: {step}", budget.name))?;
            writeln!(
                report,
                "{:<12} {step:<10} {:>8.1} min",
                budget.name,
                began.elapsed().as_secs_f64() / 60.0
            )?;
        }
    }
    println!("{report}");
    Ok(())
}

/// The steps from a recipe to a model with its figures.
fn steps(budget: &Budget, work: &Path) -> Vec<(&'static str, Command)> {
    match budget.data {
        Data::Pairs(recipe) => paired_steps(budget, recipe, work),
        Data::Streamed(streamed) => streamed_steps(budget, streamed, work),
    }
}

/// The steps of a network on pairs that are made before, by a recipe of this name.
fn paired_steps(budget: &Budget, recipe: &str, work: &Path) -> Vec<(&'static str, Command)> {
    let Budget { name, steps, batch, crop, rate, .. } = budget;
    let recipe = |suffix: &str| format!("dataset/recipes/{recipe}{suffix}.toml");
    let folder = |of: &str| work.join(of).join(name).display().to_string();
    let (data, run, testset) = (folder("data"), folder("runs"), folder("testsets"));
    let (model, metrics) = (format!("models/{name}"), format!("{testset}.json"));
    let deepshade = |words: &[&str]| Program::built().command(words);
    let studies = |words: &[&str]| Program::studies().command(words);
    let [batch, crop] = [batch, crop].map(u32::to_string);
    // No early stop: the rate falls until the last step.
    let budget = ["--batch", &batch, "--crop", &crop, "--rate", rate, "--patience", "0"];
    let training = |out: &str, steps: u32| {
        let words = ["train", "--dataset", &data, "--out", out, "--steps", &steps.to_string()];
        deepshade(&[&words[..], &budget[..]].concat())
    };
    let [half, quarter] = ["half", "quarter"].map(|part| format!("{run}-{part}"));
    let forecast = ["--plot", &format!("{run}.svg"), "--json", &format!("{run}.json")];
    vec![
        ("data", deepshade(&["dataset", "generate", &recipe(""), "--out", &data])),
        ("training", training(&run, *steps)),
        ("export", deepshade(&["export", "--run", &run, "--out", &model])),
        ("test set", deepshade(&["dataset", "testset", &recipe("-test"), "--out", &testset])),
        (
            "evaluation",
            deepshade(
                &[
                    &["eval", "--model", &model, "--testset", &testset, "--json", &metrics][..],
                    &["--results", "models/results.json"],
                ]
                .concat(),
            ),
        ),
        ("card", deepshade(&["export", "--model", &model, "--metrics", &metrics])),
        ("parity", deepshade(&["parity", "--model", &model])),
        // What runs of fewer steps end with says what more would bring.
        ("half", training(&half, steps / 2)),
        ("quarter", training(&quarter, steps / 4)),
        ("forecast", studies(&[&["forecast", &run, &half, &quarter][..], &forecast].concat())),
    ]
}

/// The steps of a network on views without end.
fn streamed_steps(budget: &Budget, streamed: Streamed, work: &Path) -> Vec<(&'static str, Command)> {
    let Budget { name, steps, batch, crop, rate, .. } = budget;
    let Streamed { task, network } = streamed;
    let recipe = |name: &str| format!("dataset/recipes/{name}.toml");
    let run = work.join("runs").join(name).display().to_string();
    let (model, metrics) = (format!("models/{name}"), format!("{run}.json"));
    let deepshade = |words: &[&str]| Program::built().command(words);
    let [steps, batch, crop] = [steps, batch, crop].map(u32::to_string);
    let words = ["--steps", &steps, "--batch", &batch, "--crop", &crop, "--rate", rate, "--patience", "0"];
    let options = ["--network", "--channels", "--estimate"];
    let which: Vec<&str> =
        options.into_iter().zip(network).flat_map(|(option, value)| [option, value]).collect();
    let train = ["train", "--recipe", &recipe(task.stream), "--uses", USES, "--out", &run];
    let mut all = vec![
        ("training", deepshade(&[&train[..], &which, &words].concat())),
        ("export", deepshade(&["export", "--run", &run, "--out", &model])),
    ];
    // Those of all networks on these views: `eval` finds them there.
    for (folder, test) in task.tests {
        let testset = format!("models/{}/{folder}", task.stream);
        all.push(("test set", deepshade(&["dataset", "testset", &recipe(test), "--out", &testset])));
    }
    let rivals = ["--methods", task.methods, "--quality", task.qualities];
    let evaluation = [&["eval", "--model", &model][..], &rivals, &["--json", &metrics]].concat();
    all.extend([
        ("evaluation", deepshade(&[&evaluation[..], &["--results", "models/results.json"]].concat())),
        ("card", deepshade(&["export", "--model", &model, "--metrics", &metrics])),
        ("parity", deepshade(&["parity", "--model", &model])),
    ]);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_network_has_its_recipes_and_crops_that_fit() {
        for Budget { name, crop, data, .. } in &BUDGETS {
            let shared = |Streamed { task, .. }| -> Vec<String> {
                let tests = task.tests.iter().map(|(_, test)| *test);
                [task.stream].into_iter().chain(tests).map(str::to_owned).collect()
            };
            let recipes = match data {
                Data::Pairs(recipe) => vec![(*recipe).to_owned(), format!("{recipe}-test")],
                Data::Streamed(streamed) => shared(*streamed),
            };
            for recipe in recipes {
                let file = root().join(format!("dataset/recipes/{recipe}.toml"));
                let text = std::fs::read_to_string(&file).expect("a recipe of that name");
                let height = text.split("height = ").nth(1).and_then(|rest| rest.split(',').next());
                let height: u32 = height.and_then(|number| number.trim().parse().ok()).expect("a height");
                assert!(*crop <= height && crop.is_multiple_of(8), "{name}: {recipe}");
                assert!(
                    !text.contains("radius = { metres"),
                    "{name}: {recipe} leaves the default radius open"
                );
            }
        }
    }

    #[test]
    fn a_quarter_of_the_steps_is_validated_often_enough_for_a_forecast() {
        // `deepshade train` validates every 500 steps by default, and `deepshade-studies forecast` wants four
        // validations of a run.
        // Views without end have no runs of half and a quarter.
        let paired = BUDGETS.iter().filter(|budget| matches!(budget.data, Data::Pairs(_)));
        for Budget { name, steps, .. } in paired {
            assert!(steps / 4 / 500 >= 4, "{name}");
        }
    }
}
