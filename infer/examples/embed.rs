//! Networks inside a renderer: the g-buffer stays in the renderer's textures, images go into others, all on
//! the renderer's own device, in the renderer's own encoder, without a way to main memory and back.
//!
//! `cargo run --release -p deepshade-infer --example embed -- models/ao models/ao`

use deepshade_infer::forward::{Input, InputKind, Options, Output, OutputKind, Precision, Tuning};
use deepshade_infer::{Model, Scaling};
use deepshade_shaders::gpu::{Gpu, PipelineCache};
use etcetera::BaseStrategy;
use half::f16;
use std::error::Error;
use std::path::Path;
use wgpu::{Extent3d, TextureFormat, TextureUsages, TextureView};

const SIZE: Extent3d = Extent3d { width: 321, height: 203, depth_or_array_layers: 1 };

fn main() -> Result<(), Box<dyn Error>> {
    let size = [SIZE.height as usize, SIZE.width as usize];
    let folders: Vec<String> = std::env::args().skip(1).collect();
    if folders.is_empty() {
        return Err("which networks? name their folders, such as models/ao".into());
    }

    // A renderer has a device and a queue of its own. Of its features SHADER_F16 halves the memory of feature
    // maps, and PIPELINE_CACHE makes later starts faster; deepshade runs without either.
    let gpu = Gpu::new()?;
    let Gpu { device, queue, .. } = &gpu;
    let half = device.features().contains(wgpu::Features::SHADER_F16);

    // What was found out about this device before: compiled kernels, and which are the fastest. The driver
    // trusts what the cache holds, so it is in a folder that is the user's own.
    let cache_folder = etcetera::choose_base_strategy()?.cache_dir().join("deepshade-embed");
    let (cache, cache_note) = PipelineCache::open(device, &cache_folder.join("pipelines"));
    let (mut tuning, tuning_note) = Tuning::load(device, &cache_folder.join("tuning.json"));
    cache_note.iter().chain(&tuning_note).for_each(|note| eprintln!("{note}"));

    let mut recordings = Vec::new();
    for folder in &folders {
        // Once a model: compile its kernels and upload its weights.
        let model = Model::load(Path::new(folder))?;
        let options = Options {
            input: InputKind::Textures,
            output: OutputKind::Texture(TextureFormat::Rgba16Float),
            precision: if half { Precision::F16 } else { Precision::F32 },
            cache: Some(&cache),
            ..Options::default()
        };
        // In 32-bit floats where no kernel in half floats works, and an error where none does at all: then
        // there is the CPU (`cpu::Network`).
        let (network, notes) = tuning.network(&gpu, &model, &options, size)?;
        notes.iter().for_each(|note| eprintln!("{note}"));

        // Once a size: feature maps. A limit on them would cut the image into tiles (`Network::plan_within`).
        let plan = network.plan(size[0], size[1])?;
        println!("{folder}: feature maps take {} bytes", plan.bytes().activations);

        // Once for these textures: one of the g-buffer for each of the network's inputs, in its order, and
        // the image. Lengths are scaled by how far the effect is to reach here, in metres; this network reads
        // no light.
        let inputs = model.spec.inputs.iter();
        let gbuffer: Vec<TextureView> = inputs.map(|input| filled(&gpu, &format!("{input:?}"))).collect();
        let image = texture(&gpu, "image", TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC);
        let scaling = Scaling { length: model.spec.reach.position_scale(0.5), light: 1.0 };
        let input = Input::Textures { views: &gbuffer, scaling, run: 0 };
        recordings.push(plan.bind(input, Output::Texture(&image.create_view(&Default::default())))?);
    }
    cache.save()?;
    tuning.save(&cache_folder.join("tuning.json"))?;

    // Every frame: render the g-buffer, record the networks, use the images. Nothing is allocated here, not
    // even where another frame's light is exposed otherwise (`Recording::set_scaling`).
    for _frame in 0..3 {
        let mut encoder = device.create_command_encoder(&Default::default());
        recordings.iter().for_each(|recording| recording.encode(&mut encoder));
        queue.submit([encoder.finish()]);
    }
    device.poll(wgpu::PollType::wait_indefinitely())?;
    println!("{} networks on {} x {} pixels", recordings.len(), SIZE.width, SIZE.height);
    Ok(())
}

fn texture(gpu: &Gpu, label: &str, usage: TextureUsages) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: SIZE,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TextureFormat::Rgba16Float,
        usage,
        view_formats: &[],
    })
}

/// Stands for a renderer's texture: a ramp.
fn filled(gpu: &Gpu, label: &str) -> TextureView {
    let texture = texture(gpu, label, TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST);
    let texel = |at: u32| [f16::from_f32((at % SIZE.width) as f32 / SIZE.width as f32); 4];
    let texels: Vec<[f16; 4]> = (0..SIZE.width * SIZE.height).map(texel).collect();
    let layout = wgpu::TexelCopyBufferLayout { bytes_per_row: Some(8 * SIZE.width), ..Default::default() };
    gpu.queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&texels), layout, SIZE);
    texture.create_view(&Default::default())
}
