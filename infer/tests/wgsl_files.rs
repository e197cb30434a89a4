//! A network's WGSL files run in a host that knows nothing of deepshade but what `HOST.md` says.

use deepshade_infer::forward::{File, Precision, wgsl_files};
use deepshade_infer::parity::noise;
use deepshade_infer::{ChannelOrder, Comparison, Model, NetSpec, Reach, Weights, reference};
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Effect, Planes};
use serde_json::Value;
use std::collections::HashMap;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{Buffer, BufferUsages};

const STORAGE: BufferUsages = BufferUsages::STORAGE.union(BufferUsages::COPY_SRC);

/// An engine that reads `network.json`.
struct Host<'a> {
    gpu: &'a Gpu,
    files: HashMap<&'a str, &'a [u8]>,
    network: Value,
    size: [u32; 2],
}

impl<'a> Host<'a> {
    fn new(gpu: &'a Gpu, files: &'a [File], [width, height]: [u32; 2]) -> Self {
        let files: HashMap<&str, &[u8]> =
            files.iter().map(|(name, bytes)| (name.as_str(), &bytes[..])).collect();
        let network = serde_json::from_slice(files["network.json"]).expect("JSON");
        Self { gpu, files, network, size: [width, height] }
    }

    fn buffer(&self, contents: &[u8], usage: BufferUsages) -> Buffer {
        self.gpu.device.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage })
    }

    fn frame(&self, level: u64) -> [u32; 2] {
        let alignment = number(&self.network["alignment"]);
        self.size.map(|size| size.next_multiple_of(alignment) >> level)
    }

    fn uniform(&self, pass: &Value) -> Vec<u8> {
        let [width, height] = self.frame(pass["level"].as_u64().expect("a level"));
        let last = pass["bindings"]["3"] == "output";
        let channels = number(&self.network[if last { "output_channels" } else { "input_channels" }]);
        let mut bytes = Vec::new();
        for field in self.network["uniform"].as_array().expect("fields") {
            let value = match field["name"].as_str().expect("a name") {
                "width" => width,
                "height" => height,
                "image_width" | "keep_right" => self.size[0],
                "image_height" | "keep_bottom" => self.size[1],
                "channels" => channels,
                "stride" => number(&pass["stride"]),
                "leak" => (self.network["leak"].as_f64().expect("a leak") as f32).to_bits(),
                "length_scale" => 1f32.to_bits(),
                _ => 0,
            };
            bytes.resize(number(&field["offset"]) as usize, 0);
            bytes.extend(value.to_le_bytes());
        }
        bytes.resize(bytes.len().next_multiple_of(16), 0);
        bytes
    }

    fn run(&self, input: &Planes) -> Planes {
        let Self { gpu, network, .. } = self;
        let texel = if network["half"] == true { 8 } else { 16 };
        let mut buffers: HashMap<String, Buffer> = HashMap::new();
        for map in network["maps"].as_array().expect("maps") {
            let [width, height] = self.frame(map["level"].as_u64().expect("a level"));
            let bytes = vec![0xff; (number(&map["blocks"]) * width * height) as usize * texel];
            buffers.insert(map["name"].as_str().expect("a name").to_owned(), self.buffer(&bytes, STORAGE));
        }
        let channels = number(&network["output_channels"]) as usize;
        let pixels = (self.size[0] * self.size[1]) as usize;
        buffers.insert("input".to_owned(), self.buffer(bytemuck::cast_slice(input.data()), STORAGE));
        buffers.insert("output".to_owned(), self.buffer(&vec![0; 4 * channels * pixels], STORAGE));
        for pass in network["passes"].as_array().expect("passes") {
            self.dispatch(pass, &buffers);
        }
        let data = deepshade_shaders::gpu::read(&gpu.device, &gpu.queue, &buffers["output"]).expect("reads");
        Planes::from_data(channels, self.size[1] as usize, self.size[0] as usize, data)
    }

    fn dispatch(&self, pass: &Value, buffers: &HashMap<String, Buffer>) {
        let device = &self.gpu.device;
        let file = |key: &str| self.files[pass[key].as_str().expect("a name")];
        let source = std::str::from_utf8(file("file")).expect("text").to_owned();
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: Some("main"),
            compilation_options: Default::default(),
            cache: None,
        });
        let own = [
            self.buffer(&self.uniform(pass), BufferUsages::UNIFORM),
            self.buffer(file("reads"), STORAGE),
            self.buffer(file("weights"), STORAGE),
        ];
        let mut entries: Vec<(u32, &Buffer)> = (0..).zip(&own).collect();
        for (binding, name) in pass["bindings"].as_object().expect("bindings") {
            let binding = binding.parse().expect("a number");
            if binding > 2 {
                entries.push((binding, &buffers[name.as_str().expect("a name")]));
            }
        }
        let entries: Vec<_> = entries
            .iter()
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding: *binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let layout = pipeline.get_bind_group_layout(0);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &entries,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut compute = encoder.begin_compute_pass(&Default::default());
        compute.set_pipeline(&pipeline);
        compute.set_bind_group(0, &group, &[]);
        let [width, height] = self.frame(pass["level"].as_u64().expect("a level"));
        let tile = [0, 1].map(|axis| number(&pass["tile"][axis]));
        compute.dispatch_workgroups(
            width.div_ceil(tile[0]),
            height.div_ceil(tile[1]),
            number(&pass["workgroups_z"]),
        );
        drop(compute);
        self.gpu.queue.submit([encoder.finish()]);
    }
}

fn number(value: &Value) -> u32 {
    value.as_u64().and_then(|value| u32::try_from(value).ok()).expect("a number")
}

#[test]
fn a_host_that_knows_the_files_alone_makes_the_networks_image() {
    let gpu = Gpu::new().expect("an adapter");
    let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
    let published =
        |effect| NetSpec::published(effect, ChannelOrder::Interleaved, reach).expect("it has one");
    let contiguous = NetSpec { channel_order: ChannelOrder::Contiguous, levels: 3, ..published(Effect::Do) };
    for spec in [published(Effect::Ao), published(Effect::Aa), contiguous] {
        let model = Model { weights: Weights::random(&spec, 5), spec };
        let files = wgsl_files(&model, Precision::F32).expect("files");
        let input = noise(model.spec.input_channels(), 37, 53, 3);
        let expected = reference::forward(&model.spec, &model.weights, &input);
        let made = Host::new(&gpu, &files, [53, 37]).run(&input);
        let comparison = Comparison::new(&expected, &made);
        assert!(comparison.agrees(), "{:?}: {comparison:?}", model.spec.effect);

        let mut wrong = model.clone();
        wrong.weights.0[0].weight.reverse();
        let files = wgsl_files(&wrong, Precision::F32).expect("files");
        assert!(!Comparison::new(&expected, &Host::new(&gpu, &files, [53, 37]).run(&input)).agrees());
    }
}
