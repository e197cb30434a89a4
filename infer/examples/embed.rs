//! A network inside a renderer: the g-buffer stays in the renderer's textures, the image goes into one, all on the
//! renderer's own device, in the renderer's own encoder, without a way to main memory and back.
//!
//! `cargo run --release -p deepshade-infer --example embed -- models/ao`

use deepshade_infer::forward::{Input, InputKind, Options, Output, OutputKind, Precision, Tuning};
use deepshade_infer::{Model, Network};
use deepshade_shaders::gpu::{Gpu, PipelineCache};
use std::error::Error;
use std::path::Path;
use wgpu::{TextureFormat, TextureUsages, TextureViewDescriptor};

const WIDTH: u32 = 321;
const HEIGHT: u32 = 203;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "models/ao".to_owned());
    let model = Model::load(Path::new(&folder))?;

    // A renderer has a device and a queue of its own. Of its features deepshade uses SHADER_F16, which halves the memory
    // of feature maps, and PIPELINE_CACHE, which makes later starts faster; it runs without either.
    let Gpu { device, queue, .. } = Gpu::new()?;
    let half = device.features().contains(wgpu::Features::SHADER_F16);
    let precision = if half { Precision::F16 } else { Precision::F32 };

    // What was found out about this device before: compiled kernels, and which are the fastest (`Tuning::measure`).
    let cache_folder = std::env::temp_dir().join("deepshade-embed");
    let (cache, cache_note) = PipelineCache::open(&device, &cache_folder.join("pipelines"));
    let (tuning, tuning_note) = Tuning::load(&device, &cache_folder.join("tuning.json"));
    cache_note.iter().chain(&tuning_note).for_each(|note| eprintln!("{note}"));

    // Once a model: compile its kernels and upload its weights.
    let mut options = Options {
        input: InputKind::Textures,
        output: OutputKind::Texture(TextureFormat::Rgba16Float),
        precision,
        cache: Some(&cache),
        ..Options::default()
    };
    options.variant = tuning.variant(&model.spec, &options);
    let network = Network::with(&device, &model.spec, &model.weights, &options)?;
    cache.save()?;

    // Once a size: feature maps. A limit on them would cut the image into tiles (`Network::plan_within`).
    let plan = network.plan(HEIGHT as usize, WIDTH as usize)?;
    println!("feature maps take {} bytes, weights {}", plan.bytes().activations, plan.bytes().weights);

    // Once for these textures: one of the g-buffer for each of the network's inputs, in its order, and the image. Lengths
    // are scaled by how far the effect is to reach here, in metres.
    let texture = |label: &str, usage| {
        device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: WIDTH, height: HEIGHT, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: TextureFormat::Rgba16Float,
            usage,
            view_formats: &[],
        })
    };
    let view = |texture: &wgpu::Texture| texture.create_view(&TextureViewDescriptor::default());
    let inputs: Vec<_> = model.spec.inputs.iter().map(|a| format!("{a:?}")).collect();
    let gbuffer: Vec<_> =
        inputs.iter().map(|name| view(&texture(name, TextureUsages::TEXTURE_BINDING))).collect();
    let image = texture("image", TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC);
    let length_scale = model.spec.reach.position_scale(0.5);
    let input = Input::Textures { views: &gbuffer, length_scale, run: 0 };
    let recording = plan.bind(input, Output::Texture(&view(&image)))?;

    // Every frame: fill the g-buffer, record the network, use the image. Nothing is allocated here, and more networks
    // may be recorded into the same encoder.
    for _frame in 0..3 {
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        recording.encode(&mut encoder);
        queue.submit([encoder.finish()]);
    }
    device.poll(wgpu::PollType::wait_indefinitely())?;
    println!("{WIDTH} x {HEIGHT}, reading {}", inputs.join(" and "));
    Ok(())
}
