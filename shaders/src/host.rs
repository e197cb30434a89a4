//! Compute passes as files for engines that know nothing of this program: what each binds, what its uniform
//! buffer holds, and over how many pixels it runs, in terms of numbers that every frame has.
//!
//! The crates of methods and of networks describe their passes so, and `deepshade export` writes them.

use crate::Attribute;
use crate::wgsl::uniforms::Layout;
use serde::Serialize;
use std::collections::BTreeMap;

/// Rows and columns of what a pass runs over or a buffer holds: those of the image, each rounded up to a
/// multiple of `align`, then shifted right by `shift`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Extent {
    /// What rows and columns are a multiple of, before they are shifted.
    pub align: usize,
    /// Halvings.
    pub shift: u32,
}

impl Extent {
    /// The image itself.
    pub const IMAGE: Self = Self { align: 1, shift: 0 };

    /// Squares of `1 << shift` pixels an edge that cover the image.
    pub const fn squares(shift: u32) -> Self {
        Self { align: 1 << shift, shift }
    }

    /// `[rows, columns]` for an image of `[height, width]`.
    pub fn size(self, image: [usize; 2]) -> [usize; 2] {
        image.map(|size| size.next_multiple_of(self.align) >> self.shift)
    }
}

/// A number of a frame that only its host knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FrameNumber {
    /// How far the effect reaches, in the unit of positions.
    Radius,
    /// Distance in pixels, at depth 1, of two points one unit apart.
    FocalLength,
    /// Chooses random numbers.
    Seed,
    /// What light is multiplied by before a network reads it.
    Exposure,
    /// Which of the network's runs.
    Run,
}

/// What a field of a uniform buffer holds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum HostValue {
    /// The same in every frame.
    Constant(f64),
    /// Rows of an extent.
    Rows(Extent),
    /// Columns of an extent.
    Columns(Extent),
    /// A number of the frame, times a constant.
    Times(FrameNumber, f64),
    /// A constant over a number of the frame.
    Over(f64, FrameNumber),
}

/// A field of a uniform buffer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HostField {
    /// Its name in the shader.
    pub name: &'static str,
    /// Its type in WGSL: `u32`, `i32` or `f32`.
    pub kind: &'static str,
    /// Bytes from the beginning of the buffer.
    pub offset: usize,
    /// What it holds.
    pub value: HostValue,
}

/// A compute pass.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HostPass {
    /// Its name.
    pub name: String,
    /// The file of its shader.
    pub file: String,
    /// The shader's entry point.
    pub entry: String,
    /// WGSL.
    #[serde(skip)]
    pub source: String,
    /// The fields of the uniform buffer of binding 0.
    pub uniform: Vec<HostField>,
    /// Bytes of the uniform buffer.
    pub uniform_bytes: usize,
    /// The storage buffers by their bindings in group 0.
    pub bindings: BTreeMap<u32, HostBinding>,
    /// What it runs over.
    pub over: Extent,
    /// Columns and rows of `over` that a workgroup works on.
    pub tile: [u32; 2],
    /// Workgroups in z.
    pub workgroups_z: usize,
    /// Whether it is repeated for every run of the network.
    pub each_run: bool,
}

/// A storage buffer that a pass binds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct HostBinding {
    /// Its name.
    pub buffer: String,
    /// Whether the shader declares it as one that it may write, `read_write`.
    pub written: bool,
}

/// A storage buffer.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum HostBuffer {
    /// An attribute of the g-buffer, which the host fills: planes of the image, 32-bit floats.
    Attribute(usize),
    /// What passes make: parts one after the other.
    Made(Vec<HostPart>),
    /// What a file holds.
    File(String),
}

/// Passes in the order in which they run, and the buffers that they bind.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct HostPasses {
    /// The passes.
    pub passes: Vec<HostPass>,
    /// The buffers by their names.
    pub buffers: BTreeMap<String, HostBuffer>,
}

/// A part of a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct HostPart {
    /// Elements of a plane.
    pub over: Extent,
    /// Planes.
    pub planes: usize,
    /// Bytes of an element.
    pub bytes: usize,
}

impl HostPasses {
    /// Adds a buffer. One that passes make is not taken for one that the host fills.
    pub fn add(&mut self, name: &str, buffer: HostBuffer) {
        let is_made = matches!(self.buffers.get(name), Some(HostBuffer::Made(_)));
        if !(is_made && matches!(buffer, HostBuffer::Attribute(_))) {
            self.buffers.insert(name.to_owned(), buffer);
        }
    }

    /// Adds the buffers of attributes that the host fills.
    pub fn add_attributes(&mut self, attributes: &[Attribute]) {
        for attribute in attributes {
            self.add(attribute.name(), HostBuffer::Attribute(attribute.width()));
        }
    }

    /// Adds what runs after these.
    pub fn extend(&mut self, later: Self) {
        self.passes.extend(later.passes);
        later.buffers.into_iter().for_each(|(name, buffer)| self.add(&name, buffer));
    }
}

impl HostPart {
    /// Planes of 32-bit floats.
    pub const fn floats(over: Extent, planes: usize) -> Self {
        Self { over, planes, bytes: 4 }
    }
}

impl HostBinding {
    /// A buffer that is read.
    pub fn read(buffer: impl Into<String>) -> Self {
        Self { buffer: buffer.into(), written: false }
    }

    /// A buffer that is written.
    pub fn written(buffer: impl Into<String>) -> Self {
        Self { buffer: buffer.into(), written: true }
    }
}

impl HostPass {
    /// A pass over an extent in tiles of `tile` x `tile`, whose file and entry point follow from its name and
    /// source.
    ///
    /// # Panics
    /// If the source has no compute shader.
    pub fn new(name: impl Into<String>, source: String, over: Extent, tile: u32) -> Self {
        let name = name.into();
        Self {
            file: format!("{name}.wgsl"),
            name,
            entry: entry_point(&source).expect("a compute shader").to_owned(),
            source,
            uniform: Vec::new(),
            uniform_bytes: 0,
            bindings: BTreeMap::new(),
            over,
            tile: [tile; 2],
            workgroups_z: 1,
            each_run: false,
        }
    }

    /// With a uniform buffer of a layout, whose fields hold what `value` says of their names.
    pub fn told(mut self, layout: &Layout, value: impl Fn(&str) -> HostValue) -> Self {
        let fields = layout.fields.iter();
        self.uniform = fields
            .map(|field| {
                let (name, kind, offset) = (field.name, field.kind, field.offset);
                HostField { name, kind, offset, value: value(name) }
            })
            .collect();
        self.uniform_bytes = layout.size.next_multiple_of(16);
        self
    }

    /// With a storage buffer in a binding.
    pub fn bind(mut self, binding: u32, buffer: HostBinding) -> Self {
        self.bindings.insert(binding, buffer);
        self
    }
}

/// The name of the only compute shader in a source.
fn entry_point(source: &str) -> Option<&str> {
    let (_, after) = source.split_once("@compute")?;
    let (_, name) = after.split_once("fn ")?;
    name.split_once('(').map(|(name, _)| name.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extents_cover_the_image() {
        assert_eq!(Extent::IMAGE.size([37, 53]), [37, 53]);
        assert_eq!(Extent::squares(4).size([37, 64]), [3, 4]);
        assert_eq!(Extent { align: 32, shift: 3 }.size([37, 53]), [8, 8]);
    }

    #[test]
    fn every_shader_has_the_entry_point_that_its_text_says() {
        for shader in crate::wgsl::all() {
            let source = shader.specialised(&[]);
            let module = naga::front::wgsl::parse_str(&source).expect("valid");
            let is_compute = |entry: &&naga::EntryPoint| entry.stage == naga::ShaderStage::Compute;
            if let [only] = &module.entry_points.iter().filter(is_compute).collect::<Vec<_>>()[..] {
                assert_eq!(entry_point(&source), Some(only.name.as_str()), "{shader:?}");
            }
        }
    }
}
