//! The shaders of a network in other languages than WGSL, translated by naga: for engines that do not take
//! WGSL.

use anyhow::{Context, Result};
use deepshade_infer::forward::File;
use naga::back::{glsl, hlsl, spv};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ResourceBinding, ShaderStage};

/// A language of shaders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Language {
    /// For Direct3D: HLSL 2018, shader model 6.0, with half floats 6.2; uniforms in b0, what is read in t,
    /// what is written in u, space 0
    Hlsl,
    /// For OpenGL: version 4.50, bindings as in WGSL
    Glsl,
    /// For Vulkan 1.1: SPIR-V 1.3, set 0, bindings as in WGSL
    Spirv,
}

/// The WGSL files of a network in another language, beside which the others stay as they are: `NAME.hlsl`,
/// `NAME.glsl` or `NAME.spv` for `NAME.wgsl`.
///
/// # Errors
/// If a shader needs what the language does not have, such as half floats in GLSL.
pub fn translated(files: &[File], language: Language) -> Result<Vec<File>> {
    let shaders = files.iter().filter_map(|(name, text)| Some((name.strip_suffix(".wgsl")?, text)));
    let translate = |(name, text): (&str, &Vec<u8>)| -> Result<File> {
        let shader = Shader::new(std::str::from_utf8(text)?)?;
        let (ending, content) = match language {
            Language::Hlsl => ("hlsl", shader.hlsl()?.into_bytes()),
            Language::Glsl => ("glsl", shader.glsl()?.into_bytes()),
            Language::Spirv => ("spv", bytemuck::pod_collect_to_vec(&shader.spirv()?)),
        };
        Ok((format!("{name}.{ending}"), content))
    };
    shaders
        .map(|shader| translate(shader).with_context(|| format!("{}.wgsl in {language:?}", shader.0)))
        .collect()
}

/// A compute shader with one entry point.
struct Shader {
    module: Module,
    info: ModuleInfo,
}

/// Buffers are as large as `network.json` has it, so that nothing is read or written beyond them.
const UNCHECKED: BoundsCheckPolicies = BoundsCheckPolicies {
    index: BoundsCheckPolicy::Unchecked,
    buffer: BoundsCheckPolicy::Unchecked,
    image_load: BoundsCheckPolicy::Unchecked,
    binding_array: BoundsCheckPolicy::Unchecked,
};

impl Shader {
    fn new(wgsl: &str) -> Result<Self> {
        let module = naga::front::wgsl::parse_str(wgsl)?;
        let info = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module)?;
        Ok(Self { module, info })
    }

    fn entry(&self) -> String {
        self.module.entry_points[0].name.clone()
    }

    /// Whether it has numbers of 16 bits. Before shader model 6.2 a `half` is a 32-bit float.
    fn has_half_floats(&self) -> bool {
        let half = |scalar: naga::Scalar| scalar == naga::Scalar::F16;
        self.module.types.iter().any(|(_, kind)| match kind.inner {
            naga::TypeInner::Scalar(scalar) | naga::TypeInner::Vector { scalar, .. } => half(scalar),
            _ => false,
        })
    }

    fn hlsl(&self) -> Result<String> {
        // Registers are the numbers of bindings where nothing else is said.
        let options = hlsl::Options {
            shader_model: if self.has_half_floats() {
                hlsl::ShaderModel::V6_2
            } else {
                hlsl::ShaderModel::V6_0
            },
            zero_initialize_workgroup_memory: false,
            restrict_indexing: false,
            force_loop_bounding: false,
            ..hlsl::Options::default()
        };
        let pipeline = hlsl::PipelineOptions { entry_point: Some((ShaderStage::Compute, self.entry())) };
        let mut text = String::new();
        hlsl::Writer::new(&mut text, &options, &pipeline).write(&self.module, &self.info, None)?;
        Ok(text)
    }

    fn glsl(&self) -> Result<String> {
        let bindings = self.module.global_variables.iter().filter_map(|(_, variable)| variable.binding);
        let options = glsl::Options {
            version: glsl::Version::Desktop(450),
            writer_flags: glsl::WriterFlags::empty(),
            binding_map: bindings.map(numbered).collect::<Result<_>>()?,
            zero_initialize_workgroup_memory: false,
        };
        let pipeline = glsl::PipelineOptions {
            shader_stage: ShaderStage::Compute,
            entry_point: self.entry(),
            multiview: None,
        };
        let mut text = String::new();
        glsl::Writer::new(&mut text, &self.module, &self.info, &options, &pipeline, UNCHECKED)?.write()?;
        Ok(text)
    }

    fn spirv(&self) -> Result<Vec<u32>> {
        let options = spv::Options {
            lang_version: (1, 3),
            flags: spv::WriterFlags::empty(),
            bounds_check_policies: UNCHECKED,
            zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::None,
            force_loop_bounding: false,
            ..spv::Options::default()
        };
        let pipeline = spv::PipelineOptions { entry_point: self.entry(), shader_stage: ShaderStage::Compute };
        Ok(spv::write_vec(&self.module, &self.info, &options, Some(&pipeline))?)
    }
}

/// A binding with its number.
fn numbered(binding: ResourceBinding) -> Result<(ResourceBinding, u8)> {
    Ok((binding, u8::try_from(binding.binding)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::forward::{Precision, wgsl_files};
    use deepshade_infer::{AnalyticEstimate, ChannelOrder, Model, NetSpec, Reach, Weights};
    use deepshade_render::methods::estimate::Estimator;
    use deepshade_shaders::Effect;
    use deepshade_shaders::host::HostPasses;

    const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.1, height: 64 };

    /// Those of a network with the passes of a method whose image it reads.
    fn correcting(precision: Precision) -> Vec<File> {
        let estimate = AnalyticEstimate::new("gtao", "low");
        let spec = NetSpec::corrected(Effect::Ao, 8, vec![estimate], REACH).expect("it has one");
        let gtao = Estimator::named(Effect::Ao, "gtao", "low").expect("it is known");
        files(spec, precision, &gtao.host_passes().map_or_else(Vec::new, |passes| vec![passes]))
    }

    fn filtering() -> Vec<File> {
        let dof = NetSpec::published(Effect::Dof, ChannelOrder::Interleaved, REACH).expect("it has one");
        files(dof.predicting_kernels().expect("it reads light"), Precision::F32, &[])
    }

    fn files(spec: NetSpec, precision: Precision, estimates: &[HostPasses]) -> Vec<File> {
        let model = Model { weights: Weights::random(&spec, 1), spec };
        wgsl_files(&model, precision, estimates).expect("files").files
    }

    #[test]
    fn every_shader_is_there_in_every_language() {
        let files = [correcting(Precision::F32), filtering()].concat();
        assert!(files.iter().any(|(name, _)| name == "00_gtao.wgsl"), "the method's passes are among them");
        let count = files.iter().filter(|(name, _)| name.ends_with(".wgsl")).count();
        for (language, ending, marks) in [
            (Language::Hlsl, ".hlsl", "[numthreads("),
            (Language::Glsl, ".glsl", "#version 450"),
            (Language::Spirv, ".spv", "\u{3}\u{2}#\u{7}"),
        ] {
            let made = translated(&files, language).expect("translates");
            assert_eq!(made.len(), count);
            for (name, content) in &made {
                assert!(name.ends_with(ending), "{name}");
                let holds = content.windows(marks.len()).any(|part| part == marks.as_bytes());
                assert!(holds, "{name}");
            }
        }
    }

    #[test]
    fn what_a_language_does_not_have_is_said_with_the_shaders_name() {
        let refused = translated(&correcting(Precision::F16), Language::Glsl).expect_err("no half floats");
        assert!(format!("{refused:#}").contains(".wgsl in Glsl"), "{refused:#}");
    }
}
