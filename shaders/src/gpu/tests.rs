//! Passes that run, and mistakes that must come back as errors with a name.

use super::{Gpu, GpuError, Pass, empty, groups, read, storage, submit, time, uniform};
use crate::random;
use crate::wgsl::Shader;

const AFFINE: &str = "
    @group(0) @binding(0) var<storage, read> before: array<f32>;
    @group(0) @binding(1) var<storage, read_write> after: array<f32>;
    @group(0) @binding(2) var<uniform> offset: f32;
    @compute @workgroup_size(64)
    fn main(@builtin(global_invocation_id) id: vec3u) {
        if id.x < arrayLength(&before) {
            after[id.x] = 2.0 * before[id.x] + offset;
        }
    }";

fn gpu() -> Gpu {
    Gpu::new().expect("an adapter; lavapipe will do")
}

#[test]
fn a_pass_computes_every_element() {
    let Gpu { device, queue, .. } = gpu();
    let numbers: Vec<f32> = (0..1000).map(|i| i as f32).collect();
    let before = storage(&device, "before", &numbers).expect("room");
    let after = empty::<f32>(&device, "after", numbers.len()).expect("room");
    let offset = uniform(&device, "offset", &0.5f32).expect("room");
    let resources = [before.as_entire_binding(), after.as_entire_binding(), offset.as_entire_binding()];
    let pass = Pass::new(&device, "affine", AFFINE).expect("valid").bind(&device, &resources).expect("fits");
    submit(&device, &queue, "affine", |encoder| pass.dispatch(encoder, [16, 1, 1])).expect("runs");
    let doubled: Vec<f32> = read(&device, &queue, &after).expect("readable");
    assert_eq!(doubled, numbers.iter().map(|n| 2.0 * n + 0.5).collect::<Vec<_>>());

    let timing =
        time(&device, &queue, "affine", 2, 5, |encoder| pass.dispatch(encoder, [16, 1, 1])).expect("runs");
    assert!(timing.milliseconds > 0.0 && timing.milliseconds < 1e4, "{timing:?}");
}

#[test]
fn a_time_is_plausible_whatever_ran_before() {
    let Gpu { device, queue, .. } = gpu();
    let value = empty::<u32>(&device, "value", 64 * 256).expect("room");
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("deepshade.texture"),
        size: wgpu::Extent3d { width: 64, height: 64, depth_or_array_layers: 2 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING,
        view_formats: &[],
    });
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let fetch = "@group(0) @binding(0) var<storage, read_write> value: array<u32>;
         @group(0) @binding(1) var image: texture_2d_array<f32>;
         @compute @workgroup_size(1) fn main() { value[0] = u32(textureLoad(image, vec2u(0), 1, 0).x); }";
    let fetch = Pass::new(&device, "fetch", fetch).expect("valid");
    let resources = [value.as_entire_binding(), wgpu::BindingResource::TextureView(&view)];
    let fetch = fetch.bind(&device, &resources).expect("fits");
    submit(&device, &queue, "fetch", |encoder| fetch.dispatch(encoder, [1, 1, 1])).expect("runs");

    let spin = "@group(0) @binding(0) var<storage, read_write> value: array<u32>;
         @compute @workgroup_size(64)
         fn main(@builtin(global_invocation_id) id: vec3u) {
             var x = id.x;
             for (var i = 0u; i < 20000u; i++) { x = x * 747796405u + 2891336453u; }
             value[id.x] = x;
         }";
    let spin = Pass::new(&device, "spin", spin).expect("valid");
    let spin = spin.bind(&device, &[value.as_entire_binding()]).expect("fits");
    let start = std::time::Instant::now();
    let timing =
        time(&device, &queue, "spin", 1, 9, |encoder| spin.dispatch(encoder, [256, 1, 1])).expect("runs");
    let elapsed = start.elapsed().as_secs_f64() * 1e3;
    // Five of nine runs take the median or more. No device makes 3e8 turns in a microsecond; a clock that is
    // read before the work is done says so.
    assert!(timing.milliseconds > 1e-3, "{timing:?}");
    assert!(5.0 * timing.milliseconds < elapsed, "{timing:?}, though all runs together took {elapsed} ms");
}

#[test]
fn the_device_has_the_adapters_memory() {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let options = wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::HighPerformance,
        ..Default::default()
    };
    let adapter = pollster::block_on(instance.request_adapter(&options)).expect("an adapter");
    let memory = |limits: wgpu::Limits| {
        let binding = limits.max_storage_buffer_binding_size;
        (limits.max_buffer_size, binding, limits.max_compute_workgroup_storage_size)
    };
    assert_eq!(memory(gpu().device.limits()), memory(adapter.limits()));
}

#[test]
fn a_broken_shader_is_an_error_with_its_name() {
    let device = gpu().device;
    let error = Pass::new(&device, "broken", "fn main() { nonsense; }").expect_err("not WGSL");
    assert!(matches!(error, GpuError::Shader { .. }));
    let message = error.to_string();
    assert!(message.contains("deepshade.broken") && message.contains("nonsense"), "{message}");
}

#[test]
fn a_missing_resource_is_an_error_with_the_passs_name() {
    let device = gpu().device;
    let pass = Pass::new(&device, "affine", AFFINE).expect("valid");
    let before = storage(&device, "before", &[1.0f32]).expect("room");
    let error = pass.bind(&device, &[before.as_entire_binding()]).expect_err("two are missing");
    assert!(error.to_string().contains("deepshade.affine"), "{error}");
}

#[test]
fn absurd_sizes_are_errors_with_a_name() {
    let Gpu { device, queue, .. } = gpu();
    let error = empty::<f32>(&device, "huge", 1 << 40).expect_err("4 TB");
    assert!(matches!(error, GpuError::TooLarge { .. }));
    assert!(error.to_string().contains("deepshade.huge"), "{error}");

    let value = empty::<u32>(&device, "value", 1).expect("room");
    let source = "@group(0) @binding(0) var<storage, read_write> value: array<u32>;
                  @compute @workgroup_size(1) fn main() { value[0] = 1u; }";
    let pass = Pass::new(&device, "wide", source).expect("valid");
    let pass = pass.bind(&device, &[value.as_entire_binding()]).expect("fits");
    let error = submit(&device, &queue, "wide", |encoder| pass.dispatch(encoder, [1 << 20, 1, 1]))
        .expect_err("too many workgroups");
    assert!(error.to_string().contains("deepshade.wide"), "{error}");
}

#[test]
fn what_is_wrong_with_a_shader_is_said_with_its_place_in_a_file() {
    let Gpu { device, .. } = gpu();
    let (source, right) =
        (Shader::at("methods/blur/smooth").source(), "fn surface_valid(index: u32) -> bool {");
    assert!(source.contains(right));
    let wrong = source.replace(right, "fn surface_valid(index: u32) -> boot {");
    let error = Pass::new(&device, "wrong", &wrong).expect_err("no such type").to_string();
    assert!(error.contains("wgsl:") && error.contains("shaders/wgsl/shared/surface_valid.wgsl:"), "{error}");
    assert!(Pass::new(&device, "right", &source).is_ok());
}

#[test]
fn workgroups_cover_the_image() {
    assert_eq!(groups(43, 61, 8), [8, 6, 1]);
    assert_eq!(groups(8, 16, 8), [2, 1, 1]);
}

#[test]
fn random_numbers_are_the_same_on_both_sides() {
    let Gpu { device, queue, .. } = gpu();
    let source = format!(
        "{}
         @group(0) @binding(0) var<storage, read_write> numbers: array<f32>;
         @compute @workgroup_size(8, 8)
         fn main(@builtin(global_invocation_id) id: vec3u) {{
             numbers[id.y * 16u + id.x] = random(id.xy, 4000000000u, 3u);
         }}",
        include_str!("../../wgsl/shared/random.wgsl"),
    );
    let numbers = empty::<f32>(&device, "numbers", 16 * 16).expect("room");
    let pass = Pass::new(&device, "random", &source).expect("valid");
    let pass = pass.bind(&device, &[numbers.as_entire_binding()]).expect("fits");
    submit(&device, &queue, "random", |encoder| pass.dispatch(encoder, [2, 2, 1])).expect("runs");
    let found: Vec<f32> = read(&device, &queue, &numbers).expect("readable");
    let wanted: Vec<f32> =
        (0..16).flat_map(|y| (0..16).map(move |x| random::random(x, y, 4_000_000_000, 3))).collect();
    assert_eq!(found, wanted);
}
