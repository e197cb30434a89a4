//! A network's WGSL files run in a host that knows nothing of deepshade but what `HOST.md` says.

use deepshade_infer::forward::{File, HALF_TOLERANCE, Precision, wgsl_files};
use deepshade_infer::parity::{TOLERANCE, noise};
use deepshade_infer::{
    ChannelOrder, Colour, Comparison, Correction, Filter, Head, Model, NetSpec, Reach, Weights, reference,
};
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Attribute, Effect, Planes};
use serde_json::Value;
use std::collections::HashMap;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{Buffer, BufferBindingType, BufferUsages};

const STORAGE: BufferUsages = BufferUsages::STORAGE.union(BufferUsages::COPY_SRC);

const READ_ONLY: BufferBindingType = BufferBindingType::Storage { read_only: true };

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

    /// Columns and rows of what the last block makes.
    fn kernels(&self) -> [u32; 2] {
        self.frame(self.network["head"]["level"].as_u64().expect("a level"))
    }

    fn uniform(&self, pass: &Value) -> Vec<u8> {
        let [width, height] = self.frame(pass["level"].as_u64().expect("a level"));
        let image = if pass["whole_frame"] == true { [width, height] } else { self.size };
        let mut bytes = Vec::new();
        for field in self.network["uniform"].as_array().expect("fields") {
            let value = match field["name"].as_str().expect("a name") {
                "width" => width,
                "height" => height,
                "image_width" | "keep_right" => image[0],
                "image_height" | "keep_bottom" => image[1],
                name @ ("channels" | "stride") => match pass[name].as_str() {
                    Some("kernels_columns") => self.kernels()[0],
                    Some("kernels_rows") => self.kernels()[1],
                    _ => number(&pass[name]),
                },
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
        let head = &network["head"];
        if !head.is_null() {
            let level = |level| self.frame(level).iter().product::<u32>() as usize;
            let levels: usize = (0..number(&head["levels"])).map(|index| level(index.into())).sum();
            let pyramid = channels * levels + number(&head["planes"]) as usize * level(0);
            let kernels = number(&head["kernels"]) * self.kernels().iter().product::<u32>();
            for (name, numbers) in [("pyramid", pyramid.max(1)), ("kernels", kernels as usize)] {
                buffers.insert(name.to_owned(), self.buffer(&vec![0xff; 4 * numbers], STORAGE));
            }
        }
        for pass in network["passes"].as_array().expect("passes") {
            self.dispatch(pass, &buffers);
        }
        let data = deepshade_shaders::gpu::read(&gpu.device, &gpu.queue, &buffers["output"]).expect("reads");
        Planes::from_data(channels, self.size[1] as usize, self.size[0] as usize, data)
    }

    /// Whether a pass writes a map.
    fn writes(&self, pass: &Value, name: &str) -> bool {
        let maps = self.network["maps"].as_array().expect("maps");
        maps.iter().any(|map| map["name"] == name && map["written_by"] == pass["layer"])
    }

    /// What a pass binds: number, buffer and kind.
    fn bound(
        &self,
        pass: &Value,
        buffers: &HashMap<String, Buffer>,
    ) -> Vec<(u32, Buffer, BufferBindingType)> {
        let file = |key: &str| self.files[pass[key].as_str().expect("a name")];
        let bound = pass["bindings"].as_object().expect("bindings").iter().map(|(binding, name)| {
            let (binding, name) = (binding.parse().expect("a number"), name.as_str().expect("a name"));
            let read_only = binding != 3 && !self.writes(pass, name);
            let (buffer, kind) = match name {
                "uniform" => {
                    (self.buffer(&self.uniform(pass), BufferUsages::UNIFORM), BufferBindingType::Uniform)
                }
                "reads" | "weights" => (self.buffer(file(name), STORAGE), READ_ONLY),
                _ => (buffers[name].clone(), BufferBindingType::Storage { read_only }),
            };
            (binding, buffer, kind)
        });
        bound.collect()
    }

    fn dispatch(&self, pass: &Value, buffers: &HashMap<String, Buffer>) {
        let device = &self.gpu.device;
        let source = self.files[pass["file"].as_str().expect("a name")];
        let source = std::str::from_utf8(source).expect("text").to_owned();
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let bound = self.bound(pass, buffers);
        let entry = |(binding, _, ty): &(u32, Buffer, BufferBindingType)| wgpu::BindGroupLayoutEntry {
            binding: *binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty: *ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let entries: Vec<_> = bound.iter().map(entry).collect();
        let layout = device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: Some(&device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            })),
            module: &module,
            entry_point: Some("main"),
            compilation_options: Default::default(),
            cache: None,
        });
        let resources: Vec<_> = bound
            .iter()
            .map(|(binding, buffer, _)| wgpu::BindGroupEntry {
                binding: *binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &resources,
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

fn published(effect: Effect) -> NetSpec {
    let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
    NetSpec::published(effect, ChannelOrder::Interleaved, reach).expect("it has one")
}

/// A network that corrects an estimate, with a number of input channels that fills no block.
fn correcting() -> NetSpec {
    let inputs = vec![Attribute::Normal, Attribute::Openness, Attribute::RawOpenness];
    let (of, over) = (Attribute::Openness, Attribute::RawOpenness);
    let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
    let correction = Correction { of, over, levels: 2, kernel: 3, gain: false };
    NetSpec::correcting(Effect::Ao, inputs, Vec::new(), correction, 8, reach)
}

/// Networks of which some fill no block of outputs.
fn specs() -> [NetSpec; 9] {
    let filter = |levels, kernel| Head::Filter(Filter { levels, kernel, black: false });
    [
        NetSpec { colour: Colour::Rgb, ..published(Effect::Dof) }.with_head(filter(5, 1)),
        published(Effect::MotionBlur).with_head(filter(2, 3)),
        correcting(),
        published(Effect::Multi).predicting_kernels().expect("it reads light"),
        published(Effect::Ao),
        published(Effect::Aa),
        published(Effect::Ibl),
        published(Effect::Ao).reshaped(|net| (net.u0, net.levels) = (12, 3)),
        published(Effect::Do).reshaped(|net| (net.order, net.levels) = (ChannelOrder::Contiguous, 3)),
    ]
}

#[test]
fn a_host_that_knows_the_files_alone_makes_the_networks_image() {
    let gpu = Gpu::new().expect("an adapter");
    let half = gpu.device.features().contains(wgpu::Features::SHADER_F16);
    for spec in specs() {
        let [width, height] = if spec.effect == Effect::Ibl { [20, 9] } else { [53, 37] };
        let model = Model { weights: Weights::random(&spec, 5), spec };
        let input = noise(model.spec.input_channels(), height as usize, width as usize, 3);
        let expected = reference::forward(&model.spec, &model.weights, &input);
        let mut wrong = model.clone();
        wrong.weights.0[0].weight.reverse();
        let kinds = [(Precision::F32, TOLERANCE), (Precision::F16, HALF_TOLERANCE)];
        for (precision, tolerance) in kinds.into_iter().filter(|(kind, _)| half || *kind == Precision::F32) {
            let compare = |model: &Model| {
                let files = wgsl_files(model, precision).expect("files");
                let made = Host::new(&gpu, &files, [width, height]).run(&input);
                Comparison::within(&expected, &made, tolerance)
            };
            let comparison = compare(&model);
            assert!(comparison.agrees(), "{:?}, {precision:?}: {comparison:?}", model.spec.effect);
            assert!(!compare(&wrong).agrees(), "{:?}, {precision:?}", model.spec.effect);
        }
    }
}

#[test]
fn every_map_has_room_for_what_its_kernel_writes() {
    for spec in specs() {
        let model = Model { weights: Weights::random(&spec, 5), spec };
        let files = wgsl_files(&model, Precision::F32).expect("files");
        let file = |name: &Value| {
            let (_, bytes) = files.iter().find(|(file, _)| *name == file[..]).expect("it is there");
            std::str::from_utf8(bytes).expect("text")
        };
        let network: Value = serde_json::from_str(file(&Value::from("network.json"))).expect("JSON");
        for map in network["maps"].as_array().expect("maps") {
            let mut passes = network["passes"].as_array().expect("passes").iter();
            let pass = passes.find(|pass| pass["layer"] == map["written_by"]).expect("a pass");
            let (_, outputs) = file(&pass["file"]).split_once("const OUTPUTS = ").expect("a constant");
            let (outputs, _) = outputs.split_once("u;").expect("a number");
            let outputs: u32 = outputs.parse().expect("a number");
            assert_eq!(4 * number(&map["blocks"]), outputs * number(&pass["workgroups_z"]), "{map}");
        }
    }
}
