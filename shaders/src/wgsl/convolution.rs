//! The kernels of a network's layers on GPUs: one template, `shaders/wgsl/convolution`, and what a layer's
//! shape and a device's taste make of it.
//!
//! A kernel is a prelude of constants, and files by what it is like: how it stages, how it reads, how many
//! outputs it makes at a time and where it writes them.

use super::head::target;
use super::import::Product;
use std::fmt::Write;

/// Width and height of the workgroups, invocations.
pub const WORKGROUP: u32 = 8;

/// A layer's kernel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Convolution {
    /// Width and height of the convolution's kernel: 1, 3, 5 or 7.
    pub kernel: u32,
    /// How an invocation works.
    pub shape: Shape,
    /// Whether feature maps are kept in half floats; sums and weights are not.
    pub half: bool,
    /// Whether maps share buffers: a buffer that is written is then declared as such wherever it is read too.
    pub arena: bool,
    /// Where it reads from.
    pub reading: Reading,
    /// Whether the network's input is read space to depth: of a square of four pixels the channels of each,
    /// so many blocks of four; none where it is read as it is.
    pub folded: Option<u32>,
    /// Where it writes to.
    pub writing: Writing,
}

/// What an invocation makes, and how it comes by what it needs for that.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shape {
    /// Outputs: 1 (images only), 4, 8 or 16.
    pub outputs: u32,
    /// Columns and rows of pixels, 2x1, 2x2 or 4x2; 2x1 where no means are kept.
    pub pixels: [u32; 2],
    /// Whether the workgroup brings its inputs and weights into its own memory first.
    pub staged: bool,
}

/// Where a layer reads from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reading {
    /// The network's input, a planar buffer.
    Planes,
    /// The network's input, textures in this order: of each the channels that are read.
    Textures(Vec<Vec<TextureChannel>>),
    /// A feature map.
    Map,
    /// A coarser map, doubled, beside one of the same frame.
    Joined,
}

/// A channel of the network's input that a texture holds, or a buffer of an attribute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextureChannel {
    /// Which of the components; `None` for that of the colour channel that the run makes.
    pub component: Option<usize>,
    /// What it is multiplied by.
    pub scale: Scale,
    /// And by this power of two.
    pub exponent: i32,
}

/// What a frame's channel is multiplied by before a network reads it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Nothing.
    One,
    /// The frame's factor of lengths.
    Length,
    /// The frame's factor of light.
    Light,
}

impl TextureChannel {
    /// What the channel is multiplied by in WGSL, followed by the sign of that; the frame's factors are
    /// fields of a uniform of that name.
    pub(super) fn factor(self, told: &str) -> String {
        let power =
            if self.exponent == 0 { String::new() } else { format!("{:?} * ", 2f32.powi(self.exponent)) };
        let scale = match self.scale {
            Scale::One => String::new(),
            Scale::Length => format!("{told}.length_scale * "),
            Scale::Light => format!("{told}.light_scale * "),
        };
        power + &scale
    }

    /// The channel's value in WGSL, given what loads the texel.
    fn value(self, load: &str) -> String {
        let component = match self.component {
            Some(component) => format!(".{}", ["x", "y", "z", "w"][component]),
            None => "[layer.run]".to_owned(),
        };
        format!("{}{load}{component}", self.factor("layer"))
    }
}

/// Where a layer writes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Writing {
    /// A feature map.
    Map,
    /// A feature map, and the means of its 2x2 pixels; not where two maps are joined.
    MapAndMeans,
    /// The network's image, a planar buffer.
    Planes,
    /// The network's image, a texture of that format in WGSL's words.
    Texture(&'static str),
}

impl Convolution {
    /// The whole source.
    pub fn source(&self) -> String {
        let staging = if self.shape.staged { "convolution/staged" } else { "convolution/direct" };
        let outputs = match self.shape.outputs {
            1 => "convolution/outputs_1",
            4 => "convolution/outputs_4",
            8 => "convolution/outputs_8",
            _ => "convolution/outputs_16",
        };
        let files = [vec![staging, outputs, "convolution/main"], self.reading_files(), self.writing.files()];
        let product = Product::of(&files.concat());
        self.prelude() + &self.inputs() + &product.text
    }

    /// Bytes of memory that a workgroup shares.
    pub const fn workgroup_bytes(&self) -> u32 {
        if !self.shape.staged {
            return 0;
        }
        let [x, y] = self.shape.pixels;
        let columns = (WORKGROUP * x + self.kernel - 1).next_multiple_of(x);
        let rows = WORKGROUP * y + self.kernel - 1;
        let weights = self.kernel * self.kernel * self.shape.outputs;
        (columns * rows + weights) * size_of::<[f32; 4]>() as u32
    }

    fn prelude(&self) -> String {
        let Shape { outputs, pixels: [x, y], .. } = self.shape;
        let mut prelude = if self.half { "enable f16;\n" } else { "" }.to_owned();
        let constants = [
            ("WORKGROUP", WORKGROUP),
            ("KERNEL", self.kernel),
            ("OUTPUTS", outputs),
            ("PIXELS_X", x),
            ("PIXELS_Y", y),
            ("PIXELS", x * y),
        ];
        for (name, value) in constants {
            writeln!(prelude, "const {name} = {value}u;").expect("writing to a string");
        }
        let scalar = if self.half { "f16" } else { "f32" };
        writeln!(prelude, "alias Texel = vec4<{scalar}>;").expect("writing to a string");
        if let Some(blocks) = self.folded {
            writeln!(prelude, "const BLOCKS = {blocks}u;").expect("writing to a string");
        }
        if let Writing::Texture(format) = self.writing {
            prelude.push_str(&target(format));
        }
        prelude
    }

    fn reading_files(&self) -> Vec<&'static str> {
        let texel = if self.folded.is_some() { "shared/net_folded" } else { "shared/net_input" };
        match self.reading {
            Reading::Planes => vec!["convolution/single", texel, "shared/net_planes"],
            Reading::Textures(_) => vec!["convolution/single", texel],
            Reading::Map => vec!["convolution/single", "convolution/read_map"],
            Reading::Joined => vec!["convolution/read_joined"],
        }
    }

    /// What is bound to be read, but for planes.
    fn inputs(&self) -> String {
        match &self.reading {
            Reading::Planes => String::new(),
            Reading::Textures(textures) => texture_channels(textures),
            Reading::Map => self.map_binding(4, "source"),
            Reading::Joined => self.map_binding(4, "coarse") + &self.map_binding(5, "skip"),
        }
    }

    fn map_binding(&self, binding: u32, name: &str) -> String {
        let access = if self.arena { "read_write" } else { "read" };
        format!("@group(0) @binding({binding}) var<storage, {access}> {name}: array<Texel>;\n")
    }
}

impl Writing {
    fn files(self) -> Vec<&'static str> {
        match self {
            Self::Map => vec!["convolution/write_map", "convolution/write_no_means"],
            Self::MapAndMeans => vec!["convolution/write_map", "convolution/write_means"],
            Self::Planes => vec!["convolution/write_planes", "convolution/write_no_means"],
            Self::Texture(_) => vec!["convolution/write_texture", "convolution/write_no_means"],
        }
    }
}

/// Binding of the first texture that is read.
pub const FIRST_TEXTURE: u32 = 6;

/// `input_channels`, as `shaders/wgsl/shared/net_planes.wgsl` has it for a buffer: four channels of a pixel.
pub(super) fn texture_channels(textures: &[Vec<TextureChannel>]) -> String {
    let mut source = "// The network's input as textures.\n\n".to_owned();
    let mut channels = Vec::new();
    for (binding, texture) in (FIRST_TEXTURE..).zip(textures) {
        writeln!(source, "@group(0) @binding({binding}) var input{binding}: texture_2d<f32>;")
            .expect("writing to a string");
        let load = format!("textureLoad(input{binding}, pixel, 0)");
        channels.extend(texture.iter().map(|channel| channel.value(&load)));
    }
    channels.resize(channels.len().next_multiple_of(4), "0.0".to_owned());
    source += "\nfn input_channels(block: u32, pixel: vec2<u32>) -> vec4<f32> {\n    switch block {\n";
    for (block, four) in channels.chunks(4).enumerate() {
        writeln!(source, "        case {block}u: {{\n            return vec4(\n                {},\n            );\n        }}",
            four.join(",\n                ")).expect("writing to a string");
    }
    source + "        default: {\n            return vec4(0.0);\n        }\n    }\n}\n"
}

#[cfg(test)]
pub(super) mod tests;
