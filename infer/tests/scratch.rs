#![allow(unsafe_code, clippy::all, missing_docs)]
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::wgsl::uniforms::NetLayer;
fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/self/stat").unwrap();
    let f: Vec<&str> = s.rsplit(')').next().unwrap().split_whitespace().collect();
    (f[11].parse::<f64>().unwrap() + f[12].parse::<f64>().unwrap()) * 10.0
}
#[test]
fn scratch() {
    let gpu = Gpu::new().unwrap();
    let d = &gpu.device;
    for spec in std::env::var("RUNS").unwrap().split(',') {
        // kind:file:px:py
        let p: Vec<&str> = spec.split(':').collect();
        let (kind, file, trust) = (p[0], p[1], p[2] == "t");
        let (bx, by): (u32, u32) = (p[3].parse().unwrap(), p[4].parse().unwrap());
        let (w, h, first, count, sf, sc, stride, z) = match kind {
            "down0" => (768u32, 512u32, 0u32, 2u32, 0u32, 0u32, 18u32, 1u32),
            "down1" => (384, 256, 0, 1, 0, 0, 9, 2),
            "up1" => (384, 256, 0, 4, 0, 2, 54, 2),
            _ => (768, 512, 0, 4, 0, 2, 54, 1),
        };
        let layer = NetLayer { width: w, height: h, image_width: 768, image_height: 512, channels: 6, first: 0, stride, leak: 0.01 };
        let mut b = vec![gpu::uniform(d, "l", &layer).unwrap()];
        let mut reads = vec![];
        for i in 0..z { reads.extend([first + i % 1, count, sf, sc, 0, 0, 0, 0, 0, 0, 0, 0]); }
        b.push(gpu::storage(d, "r", &reads).unwrap());
        b.push(gpu::uniforms(d, "w", &vec![0.01f32; 16384]).unwrap());
        let tex = |l: usize, dv: u32| gpu::array_view(&gpu::texture_array(d, "t", l, (h / dv) as usize, (w / dv) as usize).unwrap());
        let buf = gpu::empty::<f32>(d, "i", 6 * 768 * 512).unwrap();
        let views = match kind {
            "down0" => vec![tex(2, 1), tex(2, 2)],
            "down1" => vec![tex(4, 1), tex(2, 1), tex(4, 2)],
            "up1" => vec![tex(4, 1), tex(8, 2), tex(4, 1)],
            _ => vec![tex(4, 2), tex(2, 1)],
        };
        use wgpu::BindingResource as R;
        let v = |i: usize| R::TextureView(&views[i]);
        let mut res: Vec<R> = b.iter().map(|b| b.as_entire_binding()).collect();
        match kind {
            "down0" => res.extend([v(0), buf.as_entire_binding(), v(1)]),
            "down1" | "up1" => res.extend([v(0), v(1), v(2)]),
            _ => res.extend([buf.as_entire_binding(), v(0), v(1)]),
        }
        let src = std::fs::read_to_string(file).unwrap();
        let desc = wgpu::ShaderModuleDescriptor { label: None, source: wgpu::ShaderSource::Wgsl(src.into()) };
        let module = if trust { unsafe { d.create_shader_module_trusted(desc, wgpu::ShaderRuntimeChecks::unchecked()) } } else { d.create_shader_module(desc) };
        let pipe = d.create_compute_pipeline(&wgpu::ComputePipelineDescriptor { label: None, layout: None, module: &module, entry_point: None, compilation_options: Default::default(), cache: None });
        let entries: Vec<_> = res.into_iter().enumerate().map(|(i, r)| wgpu::BindGroupEntry { binding: i as u32, resource: r }).collect();
        let group = d.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &pipe.get_bind_group_layout(0), entries: &entries });
        let mut go = |n: usize| {
            let mut e = d.create_command_encoder(&Default::default());
            for _ in 0..n {
                let mut p = e.begin_compute_pass(&Default::default());
                p.set_pipeline(&pipe);
                p.set_bind_group(0, &group, &[]);
                p.dispatch_workgroups((w.div_ceil(bx)).div_ceil(8), (h.div_ceil(by)).div_ceil(8), z);
            }
            gpu.queue.submit([e.finish()]);
            d.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        };
        let c0 = cpu();
        go(1);
        let c1 = cpu();
        let n = 8;
        go(n);
        println!("{spec}: first {:.0} then {:.1} (cpu ms / 2)", (c1 - c0) / 2.0, (cpu() - c1) / 2.0 / n as f64);
    }
}
