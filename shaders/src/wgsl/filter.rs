//! The passes of networks that predict kernels on GPUs: the pyramid of the light, and the image that is gathered from it.
//! Every one reads a [`NetLayer`] of its level's frame.

use super::TILE;
use super::convolution::{Reading, Writing};
use super::uniforms::NetLayer;
use std::fmt::Write;

/// What the passes of a network have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Filter {
    /// Levels of the pyramid.
    pub levels: u32,
    /// Width and height of the kernel on every level.
    pub kernel: u32,
    /// Whether the last weight is that of black.
    pub black: bool,
    /// Channels of the light, and of the image.
    pub channels: u32,
    /// Which of the network's input channels the light begins with.
    pub first: u32,
}

impl Filter {
    /// Numbers of all levels, the finest of which has a frame of that size: a multiple of what levels divide it by.
    pub const fn pyramid_numbers(&self, [height, width]: [usize; 2]) -> usize {
        let (mut numbers, mut level) = (0, 0);
        while level < self.levels {
            numbers += self.channels as usize * (height >> level) * (width >> level);
            level += 1;
        }
        numbers
    }

    /// The pass that writes the finest level from the network's input.
    pub fn light(&self, reading: &Reading) -> String {
        let constants = [("CHANNELS", self.channels), ("FIRST", self.first)];
        [prelude(&constants), reading.input(), include_str!("../../wgsl/filter/light.wgsl").to_owned()]
            .join("\n")
    }

    /// The pass that writes a coarser level.
    pub fn halve(&self, level: u32) -> String {
        let constants = [("CHANNELS", self.channels), ("LEVEL", level)];
        [&prelude(&constants), include_str!("../../wgsl/filter/halve.wgsl")].join("\n")
    }

    /// The pass that makes the image, in planes or in a texture.
    pub fn gather(&self, writing: Writing) -> String {
        let constants = [
            ("CHANNELS", self.channels),
            ("LEVELS", self.levels),
            ("KERNEL", self.kernel),
            ("BLACK", u32::from(self.black)),
        ];
        let (target, write) = match writing {
            Writing::Texture(format) => {
                (target(format), include_str!("../../wgsl/filter/write_texture.wgsl"))
            }
            _ => (String::new(), include_str!("../../wgsl/filter/write_planes.wgsl")),
        };
        [&prelude(&constants), &target, include_str!("../../wgsl/filter/gather.wgsl"), write].join("\n")
    }
}

/// The type of a texture that an image goes into.
pub(super) fn target(format: &str) -> String {
    format!("alias Target = texture_storage_2d<{format}, write>;\n")
}

fn prelude(constants: &[(&str, u32)]) -> String {
    let mut prelude = String::new();
    for (name, value) in [("TILE", TILE)].iter().chain(constants) {
        writeln!(prelude, "const {name} = {value}u;").expect("writing to a string");
    }
    prelude + &NetLayer::LAYOUT.declaration()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wgsl::convolution::{Scale, TextureChannel};
    use crate::wgsl::tests::{agrees, parse};

    #[test]
    fn every_pass_is_valid_and_reads_the_layer_as_rust_wrote_it() {
        let channel = |component| TextureChannel { component, scale: Scale::Light, exponent: 0 };
        let textures = Reading::Textures(vec![vec![channel(Some(1))], vec![channel(None)]]);
        for (levels, kernel, channels) in [(1, 5, 1), (5, 1, 3), (8, 3, 1)] {
            let filter = Filter { levels, kernel, black: channels == 3, channels, first: 1 };
            let sources = [
                filter.light(&Reading::Planes),
                filter.light(&textures),
                filter.halve(1),
                filter.gather(Writing::Planes),
                filter.gather(Writing::Texture("rgba16float")),
            ];
            for source in sources {
                let module = parse(&source).map_err(|e| format!("{filter:?}: {e}")).expect("valid");
                assert_eq!(agrees(&NetLayer::LAYOUT, &module), Ok(()), "{filter:?}");
            }
        }
    }
}
