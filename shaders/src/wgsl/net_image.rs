//! The pass that makes an effect's image of what a network's run made.

use super::TILE;
use super::import::Product;

/// What the pass knows of the effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinishedImage {
    /// Channels that a run makes.
    pub channels: u32,
    /// The least and the greatest number of the image.
    pub range: [f32; 2],
    /// What is put where no surface is seen; none where the image is left as it is.
    pub background: Option<f32>,
}

impl FinishedImage {
    /// The whole source. It reads a [`NetFrame`](super::uniforms::NetFrame) in binding 0, what the run made
    /// in 1 and the g-buffer's `valid` in 3, and writes the image in 2.
    pub fn source(&self) -> String {
        let product = Product::of(&["net/finished"]);
        // No shader knows infinity. All digits: the fewest that name the largest `f32` are beyond it.
        let [least, most] = self.range.map(|end| f64::from(end.min(f32::MAX)));
        let (has_background, background) = (self.background.is_some(), self.background.unwrap_or(0.0));
        format!(
            "const TILE = {TILE}u;\nconst CHANNELS = {}u;\nconst LEAST = {least:?};\nconst MOST = {most:?};\n\
             const HAS_BACKGROUND = {has_background};\nconst BACKGROUND = {background:?};\n",
            self.channels
        ) + &product.text
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::wgsl::tests::{agrees, parse};
    use crate::wgsl::uniforms::NetFrame;

    pub(crate) fn sources() -> Vec<String> {
        let image = |channels, range, background| FinishedImage { channels, range, background }.source();
        vec![image(1, [0.0, 1.0], Some(1.0)), image(3, [0.0, f32::INFINITY], None)]
    }

    #[test]
    fn every_pass_is_valid_and_reads_the_frame_as_rust_wrote_it() {
        for source in sources() {
            let module = parse(&source).map_err(|e| format!("{e}\n{source}")).expect("valid");
            assert_eq!(agrees(&NetFrame::LAYOUT, &module), Ok(()), "{source}");
        }
    }
}
