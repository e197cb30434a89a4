//! An engine that knows nothing of deepshade but what `HOST.md` says.

use deepshade_shaders::gpu::Gpu;
use serde_json::Value;
use std::collections::HashMap;
use wgpu::util::{BufferInitDescriptor, DeviceExt};
use wgpu::{Buffer, BufferBindingType, BufferUsages};

/// The contents of buffers by their names.
pub type Contents = HashMap<String, Vec<f32>>;

const STORAGE: BufferUsages = BufferUsages::STORAGE.union(BufferUsages::COPY_SRC);
/// An engine that reads `network.json`.
pub struct Host<'a> {
    gpu: &'a Gpu,
    files: HashMap<&'a str, &'a [u8]>,
    network: Value,
    /// Rows and columns.
    size: [u64; 2],
    /// The frame's numbers by the names that `HOST.md` has for them.
    frame: HashMap<&'a str, f64>,
}

impl<'a> Host<'a> {
    /// For frames of `[height, width]`, with their numbers by the names that `HOST.md` has for them.
    pub fn new(
        gpu: &'a Gpu,
        files: &'a [(String, Vec<u8>)],
        size: [usize; 2],
        frame: HashMap<&'a str, f64>,
    ) -> Self {
        let files: HashMap<&str, &[u8]> =
            files.iter().map(|(name, bytes)| (name.as_str(), &bytes[..])).collect();
        let network = serde_json::from_slice(files["network.json"]).expect("JSON");
        Self { gpu, files, network, size: size.map(|size| size as u64), frame }
    }

    fn buffer(&self, contents: &[u8], usage: BufferUsages) -> Buffer {
        self.gpu.device.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage })
    }

    /// Rows and columns of an extent.
    fn extent(&self, extent: &Value) -> [u64; 2] {
        self.size.map(|size| size.next_multiple_of(number(&extent["align"])) >> number(&extent["shift"]))
    }

    /// What a field of a uniform buffer holds.
    fn told(&self, value: &Value, run: u64) -> f64 {
        let of = |name: &Value| match name.as_str().expect("a name") {
            "run" => run as f64,
            name => self.frame[name],
        };
        let (kind, value) = value.as_object().and_then(|value| value.iter().next()).expect("a value");
        match kind.as_str() {
            "constant" => value.as_f64().expect("a number"),
            "rows" => self.extent(value)[0] as f64,
            "columns" => self.extent(value)[1] as f64,
            "times" => of(&value[0]) * value[1].as_f64().expect("a number"),
            "over" => value[0].as_f64().expect("a number") / of(&value[1]),
            other => unreachable!("{other}"),
        }
    }

    fn uniform(&self, pass: &Value, run: u64) -> Vec<u8> {
        let mut bytes = vec![0; number(&pass["uniform_bytes"]) as usize];
        for field in pass["uniform"].as_array().expect("fields") {
            let value = self.told(&field["value"], run);
            let four = match field["kind"].as_str().expect("a kind") {
                "f32" => (value as f32).to_le_bytes(),
                "i32" => (value as i32).to_le_bytes(),
                _ => (value as u32).to_le_bytes(),
            };
            bytes[number(&field["offset"]) as usize..][..4].copy_from_slice(&four);
        }
        bytes
    }

    fn buffers(&self, filled: &Contents) -> HashMap<String, Buffer> {
        let buffer = |(name, buffer): (&String, &Value)| {
            let (kind, value) = buffer.as_object().and_then(|buffer| buffer.iter().next()).expect("a buffer");
            let contents = match kind.as_str() {
                "attribute" => {
                    let planes = &filled[name];
                    assert_eq!(planes.len() as u64, number(value) * self.size[0] * self.size[1], "{name}");
                    bytemuck::cast_slice(planes).to_vec()
                }
                "made" => {
                    let parts = value.as_array().expect("parts").iter();
                    let bytes = |part: &Value| {
                        let [rows, columns] = self.extent(&part["over"]);
                        rows * columns * number(&part["planes"]) * number(&part["bytes"])
                    };
                    vec![0xff; parts.map(bytes).sum::<u64>() as usize]
                }
                _ => self.files[value.as_str().expect("a file")].to_vec(),
            };
            (name.clone(), self.buffer(&contents, STORAGE))
        };
        self.network["buffers"].as_object().expect("buffers").iter().map(buffer).collect()
    }

    /// What the buffer of that name holds in the end.
    pub fn run(&self, filled: &Contents, name: &str) -> Vec<f32> {
        let Self { gpu, network, .. } = self;
        let buffers = self.buffers(filled);
        let passes = network["passes"].as_array().expect("passes");
        for run in 0..number(&network["runs"]) {
            for pass in passes.iter().filter(|pass| run == 0 || pass["each_run"] == true) {
                self.dispatch(pass, &buffers, run);
            }
        }
        deepshade_shaders::gpu::read(&gpu.device, &gpu.queue, &buffers[name]).expect("reads")
    }

    fn dispatch(&self, pass: &Value, buffers: &HashMap<String, Buffer>, run: u64) {
        let device = &self.gpu.device;
        let source = self.files[pass["file"].as_str().expect("a name")];
        let source = std::str::from_utf8(source).expect("text").to_owned();
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let uniform = self.buffer(&self.uniform(pass, run), BufferUsages::UNIFORM);
        let storage = pass["bindings"].as_object().expect("bindings").iter().map(|(binding, bound)| {
            let buffer = &buffers[bound["buffer"].as_str().expect("a name")];
            let read_only = bound["written"] == false;
            (binding.parse().expect("a number"), buffer, BufferBindingType::Storage { read_only })
        });
        let bound: Vec<(u32, &Buffer, BufferBindingType)> =
            [(0, &uniform, BufferBindingType::Uniform)].into_iter().chain(storage).collect();
        let entry = |(binding, _, ty): &(u32, &Buffer, BufferBindingType)| wgpu::BindGroupLayoutEntry {
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
            entry_point: pass["entry"].as_str(),
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
        let [rows, columns] = self.extent(&pass["over"]);
        let groups = |size: u64, axis: usize| size.div_ceil(number(&pass["tile"][axis])) as u32;
        let z = number(&pass["workgroups_z"]) as u32;
        compute.dispatch_workgroups(groups(columns, 0), groups(rows, 1), z);
        drop(compute);
        self.gpu.queue.submit([encoder.finish()]);
    }
}

/// A whole number.
pub fn number(value: &Value) -> u64 {
    value.as_u64().expect("a number")
}
