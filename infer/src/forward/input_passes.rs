//! A network's input made on the device of the buffers of a g-buffer there: what [`NetSpec::prepared`] and
//! [`NetSpec::input`] do in main memory.

use super::frame_recording::{FrameRecording, FrameScale};
use super::{ForwardError, io};
use crate::NetSpec;
use crate::input::RELIEF_LEVELS;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::net_input::{FIRST_ATTRIBUTE, InputChannel, InputPass, SQUARES, VALID, WRITTEN};
use deepshade_shaders::wgsl::{Shader, TILE};
use deepshade_shaders::{Attribute, MissingAttribute};
use wgpu::{Buffer, Device};

/// Most storage buffers of a pass: WebGPU guarantees as many.
pub(super) const MOST_BUFFERS: usize = 8;
/// Storage buffers that one attribute needs: two that it is made of, or positions and sums over squares,
/// `valid`, and the input.
const LEAST_BUFFERS: usize = 4;

/// Passes that write a network's input, as [`Input::Buffer`](super::Input::Buffer) wants it, on the device:
/// scaled, 0 where no surface is seen, and with what is [made](Attribute::made_of) of other attributes and
/// the radius. They are compiled once.
#[derive(Debug)]
pub struct InputPasses {
    device: Device,
    spec: NetSpec,
    /// The levels of sums over squares, of networks that read `relief`.
    squares: Vec<Pass>,
    parts: Vec<(InputPass, Pass)>,
}

/// A g-buffer on the device.
#[derive(Clone, Copy, Debug)]
pub struct InputSource<'a> {
    /// Rows and columns.
    pub size: [usize; 2],
    /// Storage buffers of the attributes, each planar `[attribute.width(), height, width]` f32: at least
    /// those of [`InputPasses::reads`].
    pub attributes: &'a [(Attribute, &'a Buffer)],
    /// Which of [`NetSpec::runs`], and so which colour channel a mono network reads.
    pub run: usize,
    /// The frame's scale; [`FrameRecording::set`] takes another frame's.
    pub frame: FrameScale,
}

impl InputPasses {
    /// Compiles them for a network.
    ///
    /// # Errors
    /// If the spec is not valid, the device allows fewer than four storage buffers in a shader, or it
    /// refuses.
    pub fn new(device: &Device, spec: &NetSpec) -> Result<Self, ForwardError> {
        let (name, allowed) =
            ("max_storage_buffers_per_shader_stage", device.limits().max_storage_buffers_per_shader_stage);
        if (allowed as usize) < LEAST_BUFFERS {
            return Err(ForwardError::Limit { name, needed: LEAST_BUFFERS as u32, allowed });
        }
        spec.validate().map_err(|_| ForwardError::Unfit)?;
        let compiled = |pass: InputPass| {
            let compiled = Pass::new(device, "net.input", &pass.source())?;
            Ok((pass, compiled))
        };
        let parts = passes(spec, MOST_BUFFERS.min(allowed as usize)).into_iter().map(compiled);
        let parts: Vec<_> = parts.collect::<Result<_, GpuError>>()?;
        let has_squares = parts.iter().any(|(part, _)| part.reads_squares());
        let squares = if has_squares { squares(device)? } else { Vec::new() };
        Ok(Self { device: device.clone(), spec: spec.clone(), squares, parts })
    }

    /// The attributes whose buffers it reads, `valid` among them. Estimates, such as `openness`, are to be
    /// there like any other, made by the methods that [`NetSpec::estimates`] names.
    pub fn reads(&self) -> Vec<Attribute> {
        let mut reads = vec![Attribute::Valid];
        for attribute in self.parts.iter().flat_map(|(part, _)| part.attributes()) {
            if !reads.contains(&attribute) {
                reads.push(attribute);
            }
        }
        reads
    }

    /// Prepares to write `input`, `[input channels, height, width]`, from a g-buffer on the network's device.
    ///
    /// # Errors
    /// If an attribute is missing, a buffer too small, there is no such run, or the device has no room.
    pub fn bind(&self, source: &InputSource<'_>, input: &Buffer) -> Result<FrameRecording, ForwardError> {
        let InputSource { size, run, frame, .. } = *source;
        io::check_buffer("input", input, self.spec.input_channels(), size)?;
        if run >= self.spec.runs() {
            return Err(io::refused("input", format!("run {run} of {}", self.spec.runs())));
        }
        let mut recording = FrameRecording::new(&self.device, "net.input", size, run, frame)?;
        let count = (0..self.squares.len()).map(|level| squares_of(size, level)).map(|[y, x]| y * x).sum();
        let squares = gpu::empty::<[f32; 2]>(&self.device, "net.squares", count)?;
        self.add_squares(&mut recording, source, &squares)?;
        for (part, pass) in &self.parts {
            let mut buffers = vec![(WRITTEN, input), (VALID, source.buffer(Attribute::Valid)?)];
            buffers.extend(part.reads_squares().then_some((SQUARES, &squares)));
            for (binding, attribute) in (FIRST_ATTRIBUTE..).zip(part.attributes()) {
                buffers.push((binding, source.buffer(attribute)?));
            }
            self.add(&mut recording, pass, &buffers, size)?;
        }
        Ok(recording)
    }

    /// Adds the levels of sums over squares.
    fn add_squares(
        &self,
        recording: &mut FrameRecording,
        source: &InputSource<'_>,
        squares: &Buffer,
    ) -> Result<(), ForwardError> {
        for (level, pass) in self.squares.iter().enumerate() {
            let mut buffers = vec![(SQUARES, squares)];
            if level == 0 {
                buffers.push((VALID, source.buffer(Attribute::Valid)?));
                buffers.push((FIRST_ATTRIBUTE, source.buffer(Attribute::Position)?));
            }
            self.add(recording, pass, &buffers, squares_of(source.size, level))?;
        }
        Ok(())
    }

    /// Adds a pass over `[rows, columns]`.
    fn add(
        &self,
        recording: &mut FrameRecording,
        pass: &Pass,
        buffers: &[(u32, &Buffer)],
        [rows, columns]: [usize; 2],
    ) -> Result<(), GpuError> {
        let told = (0, recording.uniform());
        let bindings = [told].into_iter().chain(buffers.iter().copied());
        let bound =
            pass.bind_at(&self.device, bindings.map(|(at, buffer)| (at, buffer.as_entire_binding())))?;
        recording.add(bound, gpu::groups(rows, columns, TILE));
        Ok(())
    }
}

impl InputSource<'_> {
    /// The buffer of an attribute, as large as it must be.
    fn buffer(&self, attribute: Attribute) -> Result<&Buffer, ForwardError> {
        let held = self.attributes.iter().find(|(held, _)| *held == attribute);
        let (_, buffer) = held.ok_or_else(|| MissingAttribute {
            wanted: attribute.name().to_owned(),
            held: self.attributes.iter().map(|(held, _)| held.name()).collect::<Vec<_>>().join(", "),
        })?;
        io::check_buffer(attribute.name(), buffer, attribute.width(), self.size)?;
        Ok(buffer)
    }
}

/// The passes that write a network's input, each of which binds at most so many storage buffers.
pub(super) fn passes(spec: &NetSpec, most_buffers: usize) -> Vec<InputPass> {
    let mut passes: Vec<InputPass> = Vec::new();
    let mut first = 0;
    for (attribute, scaled) in spec.inputs.iter().zip(io::texture_channels(spec)) {
        let channels: Vec<InputChannel> = match attribute {
            Attribute::Relief => (0..RELIEF_LEVELS.len() as u32).map(InputChannel::Relief).collect(),
            Attribute::PixelRadius => vec![InputChannel::PixelRadius],
            Attribute::Border => vec![InputChannel::Border],
            Attribute::SignedCircle => vec![InputChannel::SignedCircle],
            Attribute::Movement => (0..2).map(InputChannel::Movement).collect(),
            Attribute::FreePathPixels => {
                scaled.into_iter().map(|channel| InputChannel::FreePathPixels(channel.component)).collect()
            }
            _ if spec.is_everywhere(*attribute) => {
                scaled.into_iter().map(|channel| InputChannel::Everywhere(*attribute, channel)).collect()
            }
            _ => scaled.into_iter().map(|channel| InputChannel::Of(*attribute, channel)).collect(),
        };
        let count = channels.len() as u32;
        let longer = passes
            .last()
            .map(|pass| InputPass { channels: [&pass.channels[..], &channels].concat(), first: pass.first });
        match longer.filter(|longer| longer.buffers() <= most_buffers) {
            Some(longer) => {
                passes.pop();
                passes.push(longer);
            }
            None => passes.push(InputPass { first, channels }),
        }
        first += count;
    }
    passes
}

/// The passes that make the levels of sums over squares.
fn squares(device: &Device) -> Result<Vec<Pass>, GpuError> {
    squares_sources().iter().map(|source| Pass::new(device, "net.squares", source)).collect()
}

/// Their sources.
pub(super) fn squares_sources() -> Vec<String> {
    let level = |level: u32| match level {
        0 => Shader::at("net/squares_first").specialised(&[]),
        _ => Shader::at("net/squares").specialised(&[("LEVEL", level)]),
    };
    (0..RELIEF_LEVELS.len() as u32).map(level).collect()
}

/// Rows and columns of a level of squares.
fn squares_of(size: [usize; 2], level: usize) -> [usize; 2] {
    size.map(|size| size.div_ceil(1 << RELIEF_LEVELS[level]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ChannelOrder, Reach};
    use deepshade_shaders::Effect;

    #[test]
    fn every_channel_is_written_once_however_few_buffers_a_pass_may_bind() {
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
        let multi = NetSpec::published(Effect::Multi, ChannelOrder::Interleaved, reach).expect("it has one");
        let mut all = multi.clone();
        all.inputs = [&Attribute::ALL[..], &Attribute::MADE].concat();
        for spec in [multi, all] {
            for room in [LEAST_BUFFERS, 5, MOST_BUFFERS] {
                let passes = passes(&spec, room);
                let mut next = 0;
                for pass in &passes {
                    assert!(pass.first == next && pass.buffers() <= room, "{pass:?}");
                    next += pass.channels.len() as u32;
                }
                assert_eq!(next as usize, spec.input_channels());
            }
            assert!(passes(&spec, LEAST_BUFFERS).len() > passes(&spec, MOST_BUFFERS).len());
        }
    }
}
