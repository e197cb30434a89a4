//! `deepshade parity`: whether the forms of a network agree: burn, the plain reference, WGSL, the CPU engine,
//! and the exported file in onnxruntime, as it is and in half floats.
//!
//! Each is compared element by element with onnxruntime's CPU provider, and that one with the reference; WGSL
//! in every kind of kernels that the device runs. Random weights are compared on noise, in both orders of
//! channels. A model's own are compared on noise and on a frame, in half floats on the frame alone: noise is
//! none of the images that it was trained on, and drives its features beyond what half floats resolve.

use crate::arguments::Size;
use crate::location::Location;
use crate::room_frame::RoomFrame;
use crate::{figures::Figures, onnxruntime};
use anyhow::{Context, Result, bail};
use deepshade_infer::forward::{HALF_TOLERANCE, Network, Options, OutputKind, Precision, Variant};
use deepshade_infer::parity::{self, Activation, Comparison, Parity, TOLERANCE, Tolerance};
use deepshade_infer::{ChannelOrder, Model, NetSpec, Reach, Weights, cpu, forward, reference};
use deepshade_shaders::{Effect, Planes, gpu::Gpu};
use deepshade_train::export::{ONNX_FILE, onnx};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// What the lines say.
const EXPLANATION: &str = "largest differences from onnxruntime's image of a pixel and channel; reference: plain Rust, \
    wgsl and wgsl_gpu: kernels for software adapters and for graphics cards, wgsl_half: those in half \
    floats, onnxruntime_half: the file in half floats";

/// The kernels in half floats, as figures name them.
const HALF: &str = "wgsl_half";

/// onnxruntime with the file in half floats, as figures name it. Its CPU provider rounds the weights and a
/// few layers, and computes the others in 32 bits.
const ONNX_HALF: &str = "onnxruntime_half";

/// Checks that burn, the reference, WGSL, the CPU engine and onnxruntime agree.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  \
    deepshade parity --model models/ao --sizes 256x256,768x512,203x117 --json parity.json\n\n\
    Random weights are tried on noise, in both orders in which channels of two resolutions may follow each \
    other: contiguous (all of the coarser, then all of the finer) and interleaved (group by group). A \
    network is tried on noise and on a frame of a room, in half floats on the frame alone. Each form may differ by \
    1e-4 of the image's root mean square or of 1, whichever is greater, half floats by 2.5e-3 of its largest \
    magnitude or of 1, the ONNX file in half floats by 5e-2 of that.")]
pub struct Args {
    /// Folder, address or name of a network; without it, random weights only.
    #[arg(long, value_parser = crate::learned::place)]
    model: Option<Location>,
    /// Effects whose networks of the paper's Table 7.1 are checked with random weights, beside the model's
    /// own.
    #[arg(long, value_delimiter = ',')]
    networks: Vec<Effect>,
    /// Sizes of the images, columns x rows.
    #[arg(long, value_delimiter = ',', default_value = "256x256,768x512,203x117")]
    sizes: Vec<Size>,
    #[command(flatten)]
    onnxruntime: onnxruntime::Args,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Compares everything, says what came out of it, and fails if anything differs.
///
/// # Errors
/// If two forms do not agree, or one of them does not run.
pub fn run(args: &Args) -> Result<()> {
    let location = args.model.as_ref().map(Location::read).transpose()?;
    let model = location.as_deref().map(Model::load).transpose()?;
    let folder = tempfile::tempdir()?;
    let gpu = Gpu::new()?;
    let adapter = format!("adapter {} ({})", gpu.info.name, gpu.info.driver_info);
    let mut check = Check {
        gpu,
        onnxruntime: &args.onnxruntime,
        max_abs: BTreeMap::new(),
        lines: vec![adapter, EXPLANATION.to_owned()],
        faults: Vec::new(),
    };
    for spec in specs(args, model.as_ref())? {
        for order in [ChannelOrder::Contiguous, ChannelOrder::Interleaved] {
            let model = random(spec.clone().reshaped(|net| net.order = order));
            let file = folder.path().join(ONNX_FILE);
            std::fs::write(&file, onnx::encode(&model)).with_context(|| file.display().to_string())?;
            let order = format!("{order:?}").to_lowercase();
            let name = format!("random {}, {order}", spec.effect);
            check.sizes(
                &ExportedModel { name, model: &model, file },
                &args.sizes,
                &[Image::Noise { half: true }],
            )?;
        }
    }
    if let (Some(model), Some(folder)) = (&model, &location) {
        let name = folder.display().to_string();
        let subject = ExportedModel { name: name.clone(), model, file: folder.join(ONNX_FILE) };
        check.sizes(&subject, &args.sizes, &[Image::Noise { half: false }, Image::Frame])?;
        check.stored(&name, model, &Parity::load(folder, &model.spec)?);
    }

    let mut figures = Figures::new("parity");
    for (form, max_abs) in &check.max_abs {
        figures.set(&format!("max_abs_{form}"), f64::from(*max_abs));
    }
    figures.detail("adapter", json!(check.gpu.info.name));
    figures.detail("driver", json!(check.gpu.info.driver_info));
    figures.detail("faults", json!(check.faults));
    let written = figures.write(args.json.as_deref());
    // Whether anybody reads the lines or not, faults make the check fail.
    let said = check.lines.iter().try_for_each(|line| say!("{line}"));
    written?;
    match check.faults.as_slice() {
        [] => said.and_then(|()| say!("all forms agree")),
        faults => bail!("the forms do not agree:\n{}", faults.join("\n")),
    }
}

/// The networks that are checked with random weights: those asked for, and the model's, or the paper's for
/// ambient occlusion where there is none.
fn specs(args: &Args, model: Option<&Model>) -> Result<Vec<NetSpec>> {
    let reach = Reach { radius: 1.0, diagonal_share: 0.1, height: 512 };
    let published = |effect: &Effect| {
        NetSpec::published(*effect, ChannelOrder::Interleaved, reach)
            .with_context(|| format!("the paper has no network for `{effect}`"))
    };
    let mut specs = args.networks.iter().map(published).collect::<Result<Vec<_>>>()?;
    match model {
        Some(model) => specs.push(model.spec.clone()),
        None if specs.is_empty() => specs.push(published(&Effect::Ao)?),
        None => {}
    }
    Ok(specs)
}

fn random(spec: NetSpec) -> Model {
    Model { weights: Weights::random(&spec, 1), spec }
}

/// What has been compared so far.
struct Check<'a> {
    gpu: Gpu,
    onnxruntime: &'a onnxruntime::Args,
    /// By form.
    max_abs: BTreeMap<&'static str, f32>,
    /// What every comparison came to.
    lines: Vec<String>,
    faults: Vec<String>,
}

/// A network in WGSL.
struct Wgsl {
    form: &'static str,
    network: Network,
    /// How far the image may be off.
    tolerance: Tolerance,
}

/// A network with the file that it was exported to.
struct ExportedModel<'a> {
    /// What lines call it.
    name: String,
    model: &'a Model,
    /// The exported file.
    file: PathBuf,
}

impl ExportedModel<'_> {
    /// The file in half floats.
    fn in_half(&self) -> Result<Vec<u8>> {
        let half = || -> Result<Vec<u8>> { Ok(onnx::halved(&std::fs::read(&self.file)?)?) };
        half().with_context(|| self.file.display().to_string())
    }

    /// The file with what every layer makes.
    fn with_layers(&self) -> Result<Vec<u8>> {
        let layers =
            || -> Result<Vec<u8>> { Ok(onnx::with_layers(&std::fs::read(&self.file)?, &self.model.spec)?) };
        layers().with_context(|| self.file.display().to_string())
    }
}

/// What is put into a network.
#[derive(Clone, Copy)]
enum Image {
    /// What [`parity::noise_for`] makes; into half floats too where that is said.
    Noise { half: bool },
    /// What the network reads of a room.
    Frame,
}

impl Image {
    fn input(self, spec: &NetSpec, size: [usize; 2]) -> Result<Planes> {
        match self {
            Self::Noise { .. } => Ok(parity::noise_for(spec, size, 2)),
            Self::Frame => RoomFrame::new(spec, size)?.input(spec),
        }
    }

    /// What follows a network's name in a line.
    const fn words(self) -> &'static str {
        match self {
            Self::Noise { .. } => "",
            Self::Frame => " of a room",
        }
    }
}

impl Check<'_> {
    /// Compares all forms of a network on images of each size.
    fn sizes(&mut self, subject: &ExportedModel<'_>, sizes: &[Size], images: &[Image]) -> Result<()> {
        let mut session = self.onnxruntime.session(&subject.file, rayon::current_num_threads())?;
        let mut half_session = self.session_of(&subject.in_half()?)?;
        let kernels = kernels(&self.gpu, subject.model)?;
        for Size { width, height } in sizes {
            for image in images {
                let what = format!("{}, {width}x{height}{}", subject.name, image.words());
                note!("{what}");
                let input = image.input(&subject.model.spec, [*height, *width])?;
                let in_half = !matches!(image, Image::Noise { half: false });
                let kernels: Vec<&Wgsl> =
                    kernels.iter().filter(|kernel| in_half || kernel.form != HALF).collect();
                let oracle = session.image(&input)?;
                let mut comparisons = self.comparisons(subject.model, &kernels, &input, &oracle)?;
                if in_half {
                    let made = half_session.image(&input)?;
                    let half = Comparison::within(&oracle, &made, onnx::ONNX_HALF_TOLERANCE);
                    comparisons.push((ONNX_HALF, half));
                }
                self.take(&what, &comparisons);
                if !comparisons.iter().all(|(_, comparison)| comparison.agrees()) {
                    self.explain(&what, subject, &kernels, &input, in_half)?;
                }
            }
        }
        Ok(())
    }

    /// How far each form is from onnxruntime's image.
    fn comparisons(
        &self,
        model: &Model,
        kernels: &[&Wgsl],
        input: &Planes,
        oracle: &Planes,
    ) -> Result<Vec<(&'static str, Comparison)>> {
        let plain = reference::forward(&model.spec, &model.weights, input);
        let cpu = cpu::Network::new(&model.spec, &model.weights)?.run(input)?;
        let burn = deepshade_train::forward_burn(&model.spec, &model.weights, input);
        let mut comparisons = vec![
            ("reference", Comparison::new(oracle, &plain)),
            ("onnxruntime", Comparison::new(&plain, oracle)),
            ("cpu", Comparison::new(oracle, &cpu)),
            ("burn", Comparison::new(oracle, &burn)),
        ];
        for Wgsl { form, network, tolerance } in kernels {
            let (made, _) = network.run_timed(&self.gpu.queue, input, 0, 1)?;
            comparisons.push((form, Comparison::within(oracle, &made, *tolerance)));
        }
        Ok(comparisons)
    }

    /// Keeps what comparisons came to.
    fn take(&mut self, what: &str, comparisons: &[(&'static str, Comparison)]) {
        // How far onnxruntime is from the reference is what the reference's column says.
        let columns = comparisons.iter().filter(|(form, _)| *form != "onnxruntime");
        let line = columns.map(|(form, comparison)| format!("{form} {:.1e}", comparison.max_abs));
        self.lines.push(format!("{what}: {}", line.collect::<Vec<_>>().join(", ")));
        for (form, comparison) in comparisons {
            let max_abs = self.max_abs.entry(form).or_default();
            *max_abs = max_abs.max(comparison.max_abs);
        }
    }

    /// Names the first layer in which each form differs from the reference.
    fn explain(
        &mut self,
        what: &str,
        subject: &ExportedModel<'_>,
        kernels: &[&Wgsl],
        input: &Planes,
        in_half: bool,
    ) -> Result<()> {
        let known = self.faults.len();
        let (model, with_layers) = (subject.model, subject.with_layers()?);
        let plain = reference::layers(&model.spec, &model.weights, input);
        let mut forms = vec![
            ("cpu", cpu_layers(model, input)?, TOLERANCE),
            ("burn", deepshade_train::layers_burn(&model.spec, &model.weights, input), TOLERANCE),
            ("onnxruntime", self.onnxruntime_layers(model, &with_layers, input)?, TOLERANCE),
        ];
        if in_half {
            let layers = self.onnxruntime_layers(model, &onnx::halved(&with_layers)?, input)?;
            forms.push((ONNX_HALF, layers, onnx::ONNX_HALF_TOLERANCE));
        }
        for Wgsl { form, network, tolerance } in kernels {
            forms.push((form, forward::run_layers(network, &self.gpu.queue, input)?, *tolerance));
        }
        for (form, layers, tolerance) in forms {
            if let Some((layer, difference)) = parity::first_difference_within(&plain, &layers, tolerance) {
                let Comparison { max_abs, tolerance } = difference;
                self.faults.push(format!(
                    "{what}: {form} differs from the reference first in layer `{layer}`: {max_abs:e} > {tolerance:e}"
                ));
            }
        }
        if self.faults.len() == known {
            self.faults.push(format!("{what}: the images differ although every layer agrees"));
        }
        Ok(())
    }

    /// What every layer of a file makes that gives them all.
    fn onnxruntime_layers(&self, model: &Model, file: &[u8], input: &Planes) -> Result<Vec<Activation>> {
        let outputs = self.session_of(file)?.run(input)?;
        let layers = model.spec.layers().into_iter().map(|layer| layer.name);
        Ok(layers.zip(outputs).map(|(layer, (_, planes))| Activation { layer, planes }).collect())
    }

    /// Loads a file that is in memory.
    fn session_of(&self, bytes: &[u8]) -> Result<onnxruntime::Session> {
        let folder = tempfile::tempdir()?;
        let file = folder.path().join(ONNX_FILE);
        std::fs::write(&file, bytes).with_context(|| file.display().to_string())?;
        self.onnxruntime.session(&file, rayon::current_num_threads())
    }

    /// Compares the reference with the image that was stored when the model was exported.
    fn stored(&mut self, name: &str, model: &Model, stored: &Parity) {
        let comparison =
            Comparison::new(&stored.output, &reference::forward(&model.spec, &model.weights, &stored.input));
        self.lines.push(format!("{name}, stored image: reference {:.1e}", comparison.max_abs));
        if !comparison.agrees() {
            self.faults.push(format!("{name}: parity.safetensors does not hold what these weights make"));
        }
    }
}

/// A network in all kinds of kernels that run on a device: `wgsl`, those for software adapters, `wgsl_gpu`,
/// those for graphics cards, and `wgsl_half`, those with feature maps in half floats.
fn kernels(gpu: &Gpu, model: &Model) -> Result<Vec<Wgsl>> {
    let Model { spec, weights } = model;
    let for_cards = || Variant::gpu(&gpu.device.limits(), spec, OutputKind::Buffer);
    // The kernels for software adapters are for U-nets.
    let software = spec.u_net().map(|_| ("wgsl", Variant::Software, Precision::F32, TOLERANCE));
    let mut kinds: Vec<_> = software.into_iter().collect();
    kinds.push(("wgsl_gpu", for_cards(), Precision::F32, TOLERANCE));
    if gpu.device.features().contains(wgpu::Features::SHADER_F16) {
        kinds.push((HALF, for_cards(), Precision::F16, HALF_TOLERANCE));
    }
    let made = |(form, variant, precision, tolerance)| {
        let options = Options { variant: Some(variant), precision, ..Options::default() };
        Ok(Wgsl { form, network: Network::with(&gpu.device, spec, weights, &options)?, tolerance })
    };
    kinds.into_iter().map(made).collect()
}

/// What every layer makes on the CPU; nothing where the image is too large to be run as a whole.
fn cpu_layers(model: &Model, input: &Planes) -> Result<Vec<Activation>> {
    let network = cpu::Network::new(&model.spec, &model.weights)?;
    Ok(network.plan(input.height(), input.width())?.run_layers(input)?.unwrap_or_default())
}
