//! The passes of networks on GPUs whose image is not what their last block makes as it is: the pyramid of
//! what the head works on, and the image. Every one reads a
//! [`NetLayer`](super::uniforms::NetLayer) of its level's frame.

use super::TILE;
use super::convolution::{Reading, Writing, texture_channels};
use super::import::Product;
use std::fmt::Write;

/// How the image is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HeadKind {
    /// It is what the last block makes, which is on a coarser level.
    Unfold,
    /// It is the light weighted by a softmax.
    Filter {
        /// Whether the last weight is that of black.
        black: bool,
    },
    /// It is an estimate corrected.
    Correction {
        /// Which of the network's input channels the estimate begins with.
        estimate: u32,
        /// Whether the last weight is a gain, in place of a bias of each channel.
        gain: bool,
        /// The difference of the estimate from what the pyramid is of by which half of the correction counts;
        /// `None` where all of it does everywhere.
        half_gate: Option<f32>,
        /// The least and the greatest number of the image.
        range: [f32; 2],
    },
}

/// What the passes of a network have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Head {
    /// How the image is made.
    pub kind: HeadKind,
    /// Levels of the pyramid.
    pub levels: u32,
    /// Width and height of the kernel on every level.
    pub kernel: u32,
    /// Channels of the image, and of each level of the pyramid.
    pub channels: u32,
    /// Which of the network's input channels the pyramid is of, the first of them.
    pub first: u32,
    /// Width and height of the squares of pixels whose channels the last block makes together.
    pub square: u32,
}

impl Head {
    /// Channels that the last block makes for a pixel.
    pub const fn count(&self) -> u32 {
        let taps = self.levels * self.kernel * self.kernel;
        match self.kind {
            HeadKind::Unfold => self.channels,
            HeadKind::Filter { black } => taps + black as u32,
            HeadKind::Correction { gain, .. } => self.biases() + taps + gain as u32,
        }
    }

    /// Of these, biases.
    const fn biases(&self) -> u32 {
        if matches!(self.kind, HeadKind::Correction { gain: false, .. }) { self.channels } else { 0 }
    }

    /// Whether there is anything for the passes before the last one to make.
    pub const fn has_pyramid(&self) -> bool {
        !matches!(self.kind, HeadKind::Unfold)
    }

    /// Planes of the finest level's frame before the pyramid.
    pub const fn estimates(&self) -> u32 {
        if matches!(self.kind, HeadKind::Correction { .. }) { self.channels } else { 0 }
    }

    /// Numbers of the estimate and all levels, the finest of which has a frame of that size: a multiple of
    /// what levels divide it by.
    pub const fn pyramid_numbers(&self, [height, width]: [usize; 2]) -> usize {
        let (mut numbers, mut level) = (self.estimates() as usize * height * width, 0);
        while level < self.levels {
            numbers += self.channels as usize * (height >> level) * (width >> level);
            level += 1;
        }
        numbers
    }

    /// The pass that writes the estimate and the finest level from the network's input.
    pub fn light(&self, reading: &Reading) -> String {
        let estimate = match self.kind {
            HeadKind::Correction { estimate, .. } => estimate,
            _ => 0,
        };
        let levels = if self.levels > 0 { self.channels } else { 0 };
        // Where there is an estimate alone, it is read as the level is where there is a level alone.
        let first = if levels == 0 { estimate } else { self.first };
        let constants = [
            ("CHANNELS", self.channels),
            ("FIRST", first),
            ("ESTIMATE", estimate),
            ("PLANES", self.estimates() + levels),
        ];
        match reading {
            Reading::Textures(textures) => joined(&constants, &texture_channels(textures), &["head/light"]),
            _ => joined(&constants, "", &["shared/net_planes", "head/light"]),
        }
    }

    /// The pass that writes a coarser level.
    pub fn halve(&self, level: u32) -> String {
        let constants = [("CHANNELS", self.channels), ("LEVEL", level), ("ESTIMATES", self.estimates())];
        joined(&constants, "", &["head/halve"])
    }

    /// The pass that makes the image, in planes or in a texture.
    pub fn image(&self, writing: Writing) -> String {
        let black = matches!(self.kind, HeadKind::Filter { black: true });
        let gain = matches!(self.kind, HeadKind::Correction { gain: true, .. });
        let gated = matches!(self.kind, HeadKind::Correction { half_gate: Some(_), .. });
        let constants = [
            ("CHANNELS", self.channels),
            ("LEVELS", self.levels),
            ("KERNEL", self.kernel),
            ("BLACK", u32::from(black)),
            ("BIASES", self.biases()),
            ("GAIN", u32::from(gain)),
            ("GATED", u32::from(gated)),
            ("COUNT", self.count()),
            ("SQUARE", self.square),
        ];
        let (target, write) = match writing {
            Writing::Texture(format) => (target(format), "head/write_texture"),
            _ => (String::new(), "head/write_planes"),
        };
        let (range, kind) = match self.kind {
            HeadKind::Unfold => (String::new(), "head/unfold"),
            HeadKind::Filter { .. } => (String::new(), "head/filter"),
            HeadKind::Correction { range: [least, most], half_gate, .. } => {
                // No shader knows infinity. All digits: the fewest that name the largest `f32` are beyond it.
                let [least, most] = [least, most.min(f32::MAX)].map(f64::from);
                let half = half_gate.unwrap_or(1.0);
                let constants = format!(
                    "const LEAST = {least:?};\nconst MOST = {most:?};\nconst HALF_GATE = {half:?};\n"
                );
                (constants, "head/correction")
            }
        };
        joined(&constants, &(range + &target), &[kind, write])
    }
}

/// The type of a texture that an image goes into.
pub(super) fn target(format: &str) -> String {
    format!("alias Target = texture_storage_2d<{format}, write>;\n")
}

/// Files behind constants and declarations.
fn joined(constants: &[(&str, u32)], declared: &str, files: &[&'static str]) -> String {
    let product = Product::of(files);
    let mut source = String::new();
    for (name, value) in [("TILE", TILE)].iter().chain(constants) {
        writeln!(source, "const {name} = {value}u;").expect("writing to a string");
    }
    source + declared + &product.text
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::wgsl::convolution::{Scale, TextureChannel};
    use crate::wgsl::tests::{agrees, parse};
    use crate::wgsl::uniforms::NetLayer;

    fn heads() -> Vec<Head> {
        let kinds = [
            HeadKind::Filter { black: false },
            HeadKind::Filter { black: true },
            HeadKind::Correction { estimate: 0, gain: false, half_gate: None, range: [0.0, 1.0] },
            HeadKind::Correction {
                estimate: 0,
                gain: true,
                half_gate: Some(0.5),
                range: [0.0, f32::INFINITY],
            },
            HeadKind::Unfold,
        ];
        let mut heads = Vec::new();
        for (levels, kernel, channels, square) in [(1, 5, 1, 1), (5, 1, 3, 2), (0, 3, 1, 4)] {
            let fits = |kind: &HeadKind| levels > 0 || !matches!(kind, HeadKind::Filter { .. });
            let head = |kind| Head { kind, levels, kernel, channels, first: 1, square };
            heads.extend(kinds.into_iter().filter(fits).map(head));
        }
        heads
    }

    pub(crate) fn sources() -> Vec<String> {
        let channel = |component| TextureChannel { component, scale: Scale::Light, exponent: 0 };
        let textures = Reading::Textures(vec![vec![channel(Some(1))], vec![channel(None)]]);
        let passes = |head: Head| {
            [
                head.light(&Reading::Planes),
                head.light(&textures),
                head.halve(1),
                head.image(Writing::Planes),
                head.image(Writing::Texture("rgba16float")),
            ]
        };
        heads().into_iter().flat_map(passes).collect()
    }

    #[test]
    fn every_pass_is_valid_and_reads_the_layer_as_rust_wrote_it() {
        for source in sources() {
            let module = parse(&source).map_err(|e| format!("{e}\n{source}")).expect("valid");
            assert_eq!(agrees(&NetLayer::LAYOUT, &module), Ok(()), "{source}");
        }
    }
}
