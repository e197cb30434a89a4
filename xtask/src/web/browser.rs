//! The page's test in headless Chromium, which a WebDriver drives: it must compute, on the browser's software
//! adapter, the images that the program computes on this machine; its slider and its figures must work; and
//! without WebGPU it must say so and show what was recorded.

mod page;

use super::serve::Server;
use crate::browser::{self, Browser, WEBGPU};
use crate::command::{self, target};
use crate::figures;
use crate::program::Program;
use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};
use thirtyfour::{By, Key, WebElement};

/// Rows and columns of the images.
const SIZE: usize = 192;
/// Samples of a pixel of truth, of the first comparison.
const SAMPLES: usize = 64;
/// How long a comparison may take to appear: the browser's software adapter compiles every pass anew.
const PATIENCE: Duration = Duration::from_mins(15);
/// The software Vulkan that Chromium brings for WebGPU. The program runs on it too, so that what differs is
/// the browser.
const DRIVER: &str = "/usr/lib/chromium/vk_swiftshader_icd.json";
/// Share of the values of an image that may differ by more than [`CLOSE`]: drivers' compilers round
/// differently, and a pixel at an edge may then see another surface.
const STRAY: f64 = 1e-3;
/// Difference, as a share of the image's root mean square, up to which values are the same.
const CLOSE: f64 = 1e-3;

/// How an image differs from the program's.
struct Difference {
    max_abs: f64,
    stray: f64,
}

/// Tests the page in a folder.
///
/// # Errors
/// If the browser is missing and cannot be installed, or the page does not do what it should.
pub fn test(folder: &Path, json: Option<&Path>) -> Result<()> {
    browser::ensure()?;
    let values = target().join("web-values");
    let size = SIZE.to_string();
    let shown = values.display().to_string();
    let mut native =
        Program::studies().command(&["web", "--out", &shown, "--size", &size, "--samples", "0", "--values"]);
    if Path::new(DRIVER).is_file() {
        native.env("VK_DRIVER_FILES", DRIVER).env("VK_ICD_FILENAMES", DRIVER);
    }
    command::run(&mut native)?;
    let server = Server::start(folder)?;
    let address = server.address.trim_end_matches('/');
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let mut found = Vec::new();
    runtime.block_on(live(address, &values, &mut found)).context("with WebGPU")?;
    runtime.block_on(recorded(address)).context("without WebGPU")?;
    for (name, value) in &found {
        println!("{name} {value:.3e}");
    }
    figures::write(json, "web", &found, json!({}))
}

/// The live comparisons, one after the other.
async fn live(address: &str, values: &Path, found: &mut Vec<(String, f64)>) -> Result<()> {
    let text = fs::read_to_string(values.join("recorded.json")).context("recorded.json")?;
    let list: Value = serde_json::from_str(&text)?;
    let browser = Browser::open(WEBGPU).await?;
    let (mut worst, mut first) = (0.0f64, true);
    for one in list["recorded"].as_array().context("no list of comparisons")? {
        let effect = one["wish"]["effect"].as_str().context("an effect")?;
        let samples = if first { SAMPLES } else { 0 };
        let began = Instant::now();
        browser.goto(&format!("{address}/?effect={effect}&size={SIZE}&samples={samples}")).await?;
        browser.until("ready", PATIENCE).await.with_context(|| effect.to_owned())?;
        if first {
            found.push(("seconds_to_first_picture".to_owned(), began.elapsed().as_secs_f64()));
        }
        for method in one["wish"]["methods"].as_array().context("methods")? {
            let method = method.as_str().context("a method")?;
            let ours = floats(&values.join(format!("{effect}-{method}.f32")))?;
            let theirs = browser.values(method).await.with_context(|| format!("{effect} by {method}"))?;
            let Difference { max_abs, stray } = difference(&ours, &theirs)?;
            println!(
                "{effect} by {method}: at most {max_abs:.2e} off, {:.3} % of the values stray",
                100.0 * stray
            );
            ensure!(stray <= STRAY, "{effect} by {method}: {:.2} % of the values stray", 100.0 * stray);
            worst = worst.max(max_abs);
            found.push((format!("max_abs_{effect}_{method}"), max_abs));
            found.push((format!("stray_{effect}_{method}"), stray));
            found.push((format!("ms_{effect}_{method}"), browser.figure(&format!("{method}.ms")).await?));
        }
        // Without its truth, a method by itself is on both sides.
        if one["wish"]["methods"].as_array().is_some_and(|methods| methods.len() > 1) {
            slider(&browser, By::Id("canvas")).await.with_context(|| effect.to_owned())?;
        }
        if first {
            let (count, refused) = browser.refused_shaders().await?;
            ensure!(count > 0 && refused.is_empty(), "the browser refuses shaders:\n{}", refused.join("\n"));
            found.push(("shaders".to_owned(), count as f64));
            compare_scores(&browser, one, found).await?;
        }
        let said = browser.text("message").await?;
        ensure!(said.is_empty(), "{effect}: the page says: {said}");
        first = false;
    }
    found.push(("max_abs_native_browser".to_owned(), worst));
    browser.quit().await
}

/// Waits for truth, and reads what methods score against it.
async fn compare_scores(browser: &Browser, one: &Value, found: &mut Vec<(String, f64)>) -> Result<()> {
    browser.until_samples(SAMPLES, PATIENCE).await?;
    for method in one["wish"]["methods"].as_array().context("methods")? {
        let method = method.as_str().context("a method")?;
        let ssim = browser.figure(&format!("{method}.ssim")).await?;
        ensure!((0.2..1.0).contains(&ssim), "{method} has an SSIM of {ssim}");
        found.push((format!("ssim_{method}"), ssim));
        let error = browser.figure(&format!("{method}.relmse")).await?;
        ensure!(error > 0.0, "{method} has a relative error of {error}");
    }
    Ok(())
}

/// Moves the slider from one end to the other: the border must move, and what is seen of the picture itself
/// must change.
async fn slider(browser: &Browser, picture: By) -> Result<()> {
    let slider: WebElement = browser.find(By::Id("wipe")).await?;
    let mut seen = Vec::new();
    for key in [Key::Home, Key::End] {
        slider.send_keys(key).await?;
        tokio::time::sleep(Duration::from_millis(500)).await;
        let border = browser.border().await?;
        seen.push((border, browser.uncovered(picture.clone()).await?));
    }
    let [(low, left), (high, right)] = &seen[..] else { bail!("two ends") };
    ensure!(low + 50.0 < *high, "the border went from {low} % to {high} %");
    ensure!(left != right, "the picture is the same with either image");
    Ok(())
}

/// The page where the browser has no WebGPU.
async fn recorded(address: &str) -> Result<()> {
    let browser = Browser::open(&[]).await?;
    browser.goto(&format!("{address}/")).await?;
    browser.until("recorded with truth", PATIENCE).await?;
    let said = browser.text("message").await?;
    ensure!(said.contains("WebGPU") && said.contains("computed beforehand"), "the page says: {said}");
    for side in ["left-image", "right-image"] {
        ensure!(browser.width(side).await? > 100.0, "{side} is not there");
    }
    slider(&browser, By::Id("wiped")).await?;
    for (effect, method) in [("ao", "hbao"), ("path", "composed")] {
        browser.choose("effect", effect).await?;
        let ssim = browser.figure(&format!("{method}.ssim")).await?;
        ensure!((0.2..1.0).contains(&ssim), "{effect}: an SSIM of {ssim}");
        let [left, right] = ["left-name", "right-name"];
        let differ = browser.text(left).await? != browser.text(right).await?;
        ensure!(differ, "{effect}: both sides are the same");
    }
    browser.quit().await
}

fn floats(path: &Path) -> Result<Vec<f64>> {
    let bytes = fs::read(path).with_context(|| path.display().to_string())?;
    Ok(bytes.as_chunks().0.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes))).collect())
}

fn difference(ours: &[f64], theirs: &[f64]) -> Result<Difference> {
    ensure!(ours.len() == theirs.len() && !ours.is_empty(), "{} values, here {}", theirs.len(), ours.len());
    let size = (ours.iter().map(|value| value * value).sum::<f64>() / ours.len() as f64).sqrt();
    // What is not a number is no less than anything.
    let differences = || ours.iter().zip(theirs).map(|(a, b)| (a - b).abs());
    ensure!(differences().all(f64::is_finite), "a value is not a number");
    let stray = differences().filter(|off| *off > CLOSE * size).count();
    let max_abs = differences().fold(0.0, f64::max);
    Ok(Difference { max_abs, stray: stray as f64 / ours.len() as f64 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_strays_is_counted() {
        let ours = [1.0, -1.0, 1.0, 1.0];
        let off = difference(&ours, &[1.0, -1.0, 1.5, 1.0005]).expect("as many");
        assert_eq!((off.max_abs, off.stray), (0.5, 0.25));
        assert!(difference(&ours, &[1.0]).is_err());
        assert!(difference(&ours, &[1.0, -1.0, f64::NAN, 1.0]).is_err());
    }
}
