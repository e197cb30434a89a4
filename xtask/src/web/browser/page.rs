//! What is asked of the web page in a browser.

use crate::browser::{Browser, PAUSE};
use anyhow::{Context, Result, bail, ensure};
use std::time::{Duration, Instant};
use thirtyfour::By;

impl Browser {
    /// How many pixels wide the file of an image is.
    ///
    /// # Errors
    /// If there is no such image.
    pub async fn width(&self, id: &str) -> Result<f64> {
        self.asked(&format!("return document.getElementById('{id}').naturalWidth")).await
    }

    /// Where the border is, percent of the width.
    ///
    /// # Errors
    /// If there is none.
    pub async fn border(&self) -> Result<f64> {
        self.asked("return parseFloat(document.getElementById('wiped').style.getPropertyValue('--border'))")
            .await
    }

    /// What an element shows, without what lies over the images and moves with the border: that, its thumb
    /// and names.
    ///
    /// # Errors
    /// If it is not there.
    pub async fn uncovered(&self, place: By) -> Result<Vec<u8>> {
        self.cover("hidden").await?;
        let seen = self.find(place).await?.screenshot_as_png().await?;
        self.cover("visible").await?;
        Ok(seen)
    }

    /// Shows what lies over the images, or hides it.
    async fn cover(&self, visibility: &str) -> Result<()> {
        let covers = "#wiped .border, #wiped .tag, #wipe";
        let script = format!(
            "for (const cover of document.querySelectorAll('{covers}')) cover.style.visibility = '{visibility}'"
        );
        self.driver.execute(script, Vec::new()).await?;
        Ok(())
    }

    /// Chooses something of a list, as hands do.
    ///
    /// # Errors
    /// If there is no such list.
    pub async fn choose(&self, id: &str, value: &str) -> Result<()> {
        let list =
            format!("const list = document.getElementById('{id}'); list.value = '{value}'; list.onchange()");
        self.driver.execute(list, Vec::new()).await?;
        Ok(())
    }

    /// A figure of the table, such as `hbao.ms`.
    ///
    /// # Errors
    /// If it is not there or is no number.
    pub async fn figure(&self, name: &str) -> Result<f64> {
        let script = format!("return document.querySelector('[data-figure=\"{name}\"]').textContent");
        let text: String = self.asked(&script).await.with_context(|| name.to_owned())?;
        text.parse().with_context(|| format!("{name} is `{text}`"))
    }

    /// The values that a method made, `[channels, height, width]`.
    ///
    /// # Errors
    /// If there is no such method.
    pub async fn values(&self, method: &str) -> Result<Vec<f64>> {
        let script = format!(
            "const done = arguments[0]; deepshade.values('{method}').then((values) => done(Array.from(values)), (error) => done(String(error)))"
        );
        let answer = self.driver.execute_async(script, Vec::new()).await?;
        match answer.json() {
            serde_json::Value::Array(_) => Ok(answer.convert()?),
            other => bail!("the page says: {other}"),
        }
    }

    /// What the browser's compiler says of the program's shaders that it refuses, a line an error, and how
    /// many shaders there are.
    ///
    /// # Errors
    /// If the browser has no device.
    pub async fn refused_shaders(&self) -> Result<(usize, Vec<String>)> {
        let script = "const done = arguments[0];
            (async () => {
                const device = await (await navigator.gpu.requestAdapter()).requestDevice();
                const all = deepshade.shaders(), refused = [];
                for (const [name, code] of all) {
                    device.pushErrorScope('validation');
                    const module = device.createShaderModule({ code });
                    for (const { type, lineNum, message } of (await module.getCompilationInfo()).messages)
                        if (type === 'error') refused.push(`${name}, line ${lineNum}: ${message}`);
                    await device.popErrorScope();
                }
                device.destroy();
                return [all.length, refused];
            })().then(done, (error) => done([0, [String(error)]]));";
        Ok(self.driver.execute_async(script, Vec::new()).await?.convert()?)
    }

    /// Waits until the page is in a state.
    ///
    /// # Errors
    /// If it fails, or time is over.
    pub async fn until(&self, state: &str, patience: Duration) -> Result<()> {
        let began = Instant::now();
        loop {
            let now: String = self.asked("return document.body.dataset.state || ''").await?;
            if now == state {
                return Ok(());
            }
            let said = self.text("message").await?;
            ensure!(now != "failed" && !said.starts_with("The page stopped"), "the page says: {said}");
            ensure!(began.elapsed() < patience, "the page is `{now}` and says: {said}");
            tokio::time::sleep(PAUSE).await;
        }
    }

    /// Waits for so many samples of truth.
    ///
    /// # Errors
    /// If time is over.
    pub async fn until_samples(&self, samples: usize, patience: Duration) -> Result<()> {
        let began = Instant::now();
        while self.asked::<f64>("return Number(document.body.dataset.samples || 0)").await? < samples as f64 {
            ensure!(began.elapsed() < patience, "truth: {}", self.text("truth").await?);
            tokio::time::sleep(PAUSE).await;
        }
        Ok(())
    }
}
