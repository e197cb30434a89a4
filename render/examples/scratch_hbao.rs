//! scratch
use deepshade_render::{bvh::TracedScene, gbuffer, method::*, methods::hbao::*, scene::*, path::ao::Ao};
use deepshade_shaders::{Attribute, GBuffer, Planes, gpu::Gpu};
use glam::Vec3;
fn main() {
    let (x, y, z) = (8.0 * Vec3::X, 3.0 * Vec3::Y, 8.0 * Vec3::Z);
    let quad = |along: Vec3, beside: Vec3| Mesh { positions: vec![Vec3::ZERO, along, along + beside, beside], triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
    let materials = vec![Material::matte("grey", Vec3::splat(0.5))];
    let scene = TracedScene::new(Scene { meshes: vec![quad(z, x), quad(x, y), quad(y, z)], materials, ..Scene::default() }).unwrap();
    let camera = Camera::look_at(Vec3::new(7.0, 2.0, 8.0), Vec3::new(2.0, 0.8, 2.0));
    let (h, w, radius) = (512, 768, 1.0);
    let gb = gbuffer::render(&scene, &camera, h, w, &[Attribute::Normal, Attribute::Position, Attribute::Valid]);
    let data: Vec<f32> = gb.planes().data().iter().map(|v| half::f16::from_f32(*v).to_f32()).collect();
    let gb16 = GBuffer::new(gb.attributes().to_vec(), Planes::from_data(7, h, w, data));
    let truth = Ao { radius, samples: 64, seed: 1 }.render(&scene, &camera, h, w);
    let gpu = Gpu::new().unwrap();
    println!("{:?}", gpu.info);
    for (steps, bias) in [(24, 0.1), (24, 0.3), (24, 0.5), (1, 0.1)] {
        let m = Hbao::new(&gpu, Parameters { steps, bias, ..Parameters::default() }).unwrap();
        for (name, g) in [("f32", &gb), ("f16", &gb16)] {
            let s = m.shade(&Frame { scene: &scene, camera: &camera, gbuffer: g, radius, seed: 3 }, Repeats { warm_up: 1, timed: 5 }).unwrap();
            let e: f32 = s.image.data().iter().zip(truth.data()).map(|(a, b)| (a - b).abs()).sum::<f32>() / truth.pixels() as f32;
            let mean: f32 = s.image.data().iter().sum::<f32>() / truth.pixels() as f32;
            println!("steps {steps} bias {bias} {name}: {:.1} ms {:?}, mean {mean:.4}, abs error {e:.4}", s.milliseconds, s.clock);
        }
    }
    println!("truth mean {}", truth.data().iter().sum::<f32>() / truth.pixels() as f32);
}
