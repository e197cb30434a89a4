//! The package in `js/`: TypeScript compiles against it, networks make the images of their frames in headless
//! Chromium, and its node runs in three.js beside three.js's own.

use crate::browser::{self, Browser, WEBGPU};
use crate::command::{self, command, root, target};
use crate::program::Program;
use crate::web::serve::Server;
use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::time::Duration;
use thirtyfour::By;

/// Networks whose frames are checked; the last one is timed beside onnxruntime-web, too.
const NETWORKS: [&str; 4] = ["gi-paper", "gi", "ao", "ao-small"];
/// Share of an image's values that may be off by more than 1e-3.
const STRAY: f64 = 0.01;
/// Rows and columns of the frame that is timed, which suit a software adapter.
const SIZE: [u32; 2] = [192, 256];
/// How far occlusion reaches where it is held against truth, metres; samples of a pixel of truth.
const RADIUS: f64 = 0.5;
const TRUTH_SAMPLES: u32 = 1024;
/// By how much similarity may differ from the program's of the same picture, which a PNG file rounds.
const SIMILAR: f64 = 0.005;
/// How like the program's picture of the frame the node's is at least: both see the same, and half a pixel
/// aside they would not.
const ALIKE: f64 = 0.97;
/// How long a page may take: the software adapter compiles every pass.
const PATIENCE: Duration = Duration::from_mins(10);

/// Tests the package in a copy below the target folder.
///
/// # Errors
/// If npm or the browser is missing, or a test fails.
pub fn test(program: &Program) -> Result<Vec<(String, f64)>> {
    browser::ensure()?;
    let stage = target().join("hosts-js");
    copy(&root().join("js"), &stage)?;
    let npm = |words: &[&str]| command::run(command("npm", words).current_dir(&stage));
    npm(&["ci", "--no-audit", "--no-fund", "--silent"]).context("Node.js with npm is needed")?;
    npm(&["exec", "--", "tsc", "--project", "."])?;
    for network in NETWORKS {
        let (model, shaders) = (root().join("models").join(network), stage.join("shaders").join(network));
        let [model, shaders] = [model, shaders].map(|path| path.display().to_string());
        program.run(&["export", "--model", &model, "--wgsl", &shaders])?;
    }
    let [_, .., last] = NETWORKS;
    let onnx = root().join("models").join(last).join("model.onnx");
    fs::copy(&onnx, stage.join("model.onnx")).with_context(|| onnx.display().to_string())?;
    let server = Server::start(&stage)?;
    let address = server.address.trim_end_matches('/');
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let mut found = runtime.block_on(checked(address)).context("the package's own page")?;
    found.extend(runtime.block_on(in_three(address, &stage, program)).context("three.js")?);
    Ok(found)
}

/// The frames of networks, and times.
async fn checked(address: &str) -> Result<Vec<(String, f64)>> {
    let browser = Browser::open(WEBGPU).await?;
    let [height, width] = SIZE;
    let folders = NETWORKS.map(|network| format!("../shaders/{network}")).join(",");
    let wanted = format!("networks={folders}&onnx=../model.onnx&height={height}&width={width}");
    browser.goto(&format!("{address}/test/index.html?{wanted}")).await?;
    let figures: Value = serde_json::from_str(&browser.until_datum("figures", PATIENCE).await?)?;
    browser.quit().await?;
    let figure = |name: &str| figures[name].as_f64().with_context(|| format!("no figure {name}: {figures}"));
    let (mut found, mut worst) = (Vec::new(), 0.0f64);
    for network in NETWORKS {
        let stray = figure(&format!("stray_{network}"))?;
        ensure!(stray < STRAY, "{network}: {:.1} % of the values stray", 100.0 * stray);
        worst = worst.max(figure(&format!("max_abs_{network}"))?);
        found.push((format!("stray_{network}"), stray));
    }
    found.push(("max_abs_browser".to_owned(), worst));
    for name in ["ms_browser_learned", "ms_browser_onnxruntime"] {
        found.push((name.to_owned(), figure(name)?));
    }
    Ok(found)
}

/// The example with three.js: what its node and three.js's own take, and how like truth they are. Both have
/// to darken the frame; ours at another size, and with no other node, too.
async fn in_three(address: &str, stage: &Path, program: &Program) -> Result<Vec<(String, f64)>> {
    let browser = Browser::open(WEBGPU).await?;
    let [height, width] = SIZE;
    let network = format!("../../shaders/{}", NETWORKS[NETWORKS.len() - 1]);
    let page = format!("{address}/examples/three/index.html?network={network}&height={height}&width={width}");
    browser.goto(&page).await?;
    browser.until_datum("frames", PATIENCE).await?;
    let picture = browser.picture(By::Tag("canvas")).await?;
    fs::write(stage.join("three.png"), picture)?;
    let mut found = beside_truth(&browser, stage, program).await.context("beside truth")?;
    let alone = browser.evaluated("import('/test/three.js').then((test) => test.alone())").await?;
    let darker = alone.as_f64().with_context(|| format!("the node alone: {alone}"))?;
    ensure!(darker > 0.01, "the node alone darkens the frame by {darker}");
    let measured = browser.evaluated("import('/test/three.js').then((test) => test.measured())").await?;
    browser.quit().await?;
    let figure =
        |name: &str| measured[name].as_f64().with_context(|| format!("no figure {name}: {measured}"));
    for name in ["mean_learned", "mean_gtao", "mean_learned_resized"] {
        let mean = figure(name)?;
        ensure!((0.5..0.99).contains(&mean), "{name} is {mean}: nothing is occluded, or all");
    }
    let names = ["mean_learned", "mean_gtao", "ms_browser_three_learned", "ms_browser_three_gtao"];
    for name in names {
        found.push((name.to_owned(), figure(name)?));
    }
    Ok(found)
}

/// How like truth of the example's frame, which the program renders, both nodes are.
async fn beside_truth(browser: &Browser, stage: &Path, program: &Program) -> Result<Vec<(String, f64)>> {
    let exported = browser.evaluated("import('/test/three.js').then((test) => test.exported())").await?;
    let [scene, report, json] = ["frame.gltf", "report", "report.json"].map(|name| stage.join(name));
    fs::write(&scene, exported.as_str().context("no glTF file")?)
        .with_context(|| scene.display().to_string())?;
    let model = root().join("models").join(NETWORKS[NETWORKS.len() - 1]);
    let [scene, model, out, written] =
        [&scene, &model, &report, &json].map(|path| path.display().to_string());
    let [height, width] = SIZE.map(|edge| edge.to_string());
    let (radius, samples) = (RADIUS.to_string(), TRUTH_SAMPLES.to_string());
    let frame =
        ["--scene", &scene, "--effect", "ao", "--radius", &radius, "--height", &height, "--width", &width];
    let made =
        ["--methods", "learned", "--model", &model, "--spp", &samples, "--out", &out, "--json", &written];
    program.run(&[&["compare"], &frame[..], &made[..]].concat())?;
    let of_program: Value = serde_json::from_str(&fs::read_to_string(&json)?)?;
    let folder = of_program["details"]["frames"][0]["folder"].as_str().context("no frame")?;
    let picture = |name: &str| format!("'/report/{folder}/{name}.image.png'");
    let [truth, learned] = ["truth", "learned"].map(picture);
    let asked =
        format!("import('/test/three.js').then((test) => test.besideTruth({RADIUS}, {truth}, {learned}))");
    let measured = browser.evaluated(&asked).await?;
    println!("three.js beside truth: {measured}");
    let of_program = of_program["figures"]["ssim_learned"].as_f64().context("no figure ssim_learned")?;
    let figure =
        |name: &str| measured[name].as_f64().with_context(|| format!("no figure {name}: {measured}"));
    let same = figure("ssim_picture")?;
    ensure!((same - of_program).abs() < SIMILAR, "similarity is {same} there and {of_program} here");
    let alike = figure("ssim_own")?;
    ensure!(alike > ALIKE, "the node's picture is no longer the program's of the frame: {alike}");
    let names = ["ssim_learned", "ssim_gtao", "ssim_gtao_best"];
    let figures =
        names.into_iter().map(|name| Ok((name.replace("ssim_", "ssim_browser_three_"), figure(name)?)));
    figures.collect()
}

/// Copies the files of a folder, and those of its folders, but what npm has put there.
fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to).with_context(|| to.display().to_string())?;
    for entry in fs::read_dir(from).with_context(|| from.display().to_string())? {
        let entry = entry?;
        let (path, into) = (entry.path(), to.join(entry.file_name()));
        match path.is_dir() {
            true if entry.file_name() == "node_modules" || entry.file_name() == "shaders" => {}
            true => copy(&path, &into)?,
            false => fs::copy(&path, &into).map(|_| ()).with_context(|| path.display().to_string())?,
        }
    }
    Ok(())
}
