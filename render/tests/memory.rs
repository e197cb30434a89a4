//! A program of its own, since it watches its memory: drawing frame after frame takes no more of it.
#![cfg(target_os = "linux")]

use deepshade_render::raster::Frame;
use deepshade_render::raster::frame::{FrameStage, RasterSettings};
use deepshade_render::scene::procedural::Family;
use deepshade_render::scene::{AnimatedScene, Camera};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, Gpu};
use glam::Vec3;

/// Resident memory of this program, megabytes.
fn memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux tells");
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("resident memory");
    line.trim().trim_end_matches("kB").trim().parse::<f64>().expect("a number") / 1024.0
}

/// Drivers that compile a shader anew for every draw, as lavapipe does where a uniform decides on a branch,
/// keep 2 MB of each: 4 GB in these frames.
#[test]
fn drawing_again_and_again_takes_no_more_memory() {
    let gpu = Gpu::new().expect("an adapter");
    let animated = AnimatedScene::from(Family::StillLife.scene(1));
    let bounds = animated.scene.bounds();
    let camera = Camera::look_at(bounds.centre() + bounds.size() * Vec3::new(0.3, 0.4, 0.5), bounds.centre());
    let attributes = vec![Attribute::Light, Attribute::Normal, Attribute::Valid];
    let settings = RasterSettings { height: 32, width: 48, attributes, shadow_size: Some(256) };
    let mut frame = Frame::new(&gpu, &animated, &settings).expect("a frame");
    let mut frames = |count: usize| {
        for _ in 0..count {
            frame.set(&gpu.queue, 0.0, 0.0, &camera);
            gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| {
                FrameStage::ALL.iter().for_each(|stage| frame.encode(*stage, encoder, None));
            })
            .expect("valid passes");
            gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("a device");
        }
    };
    frames(20);
    let before = memory();
    frames(100);
    let growth = memory() - before;
    assert!(growth < 50.0, "100 frames took {growth} MB");
}
