//! Images of fewer pixels brought to full size, for what is too dear for every pixel (Kopf et al. 2007,
//! "Joint Bilateral Upsampling"): each pixel takes the mean of the four around it in the smaller image, of
//! those that show the same surface.

use super::{Device, GpuGBuffer, MethodStep, Surface};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, TILE, uniforms};
use deepshade_shaders::{Attribute, Effect, Planes};
use glam::{IVec2, Vec2};

/// What `frame/upsample.wgsl` calls so.
const TOLERANCE: f32 = 0.005;
const LEAST: f32 = 1e-4;

/// What the pass reads of a smaller image that shows the same as the full one.
pub fn settings(size: [usize; 2], small: [usize; 2], effect: Effect) -> uniforms::Upsampling {
    let [[height, width], [small_height, small_width]] = [size, small].map(|size| size.map(|n| n as u32));
    let (columns, rows) = (small_width as f32 / width as f32, small_height as f32 / height as f32);
    let background = effect.background().unwrap_or(0.0);
    uniforms::Upsampling { width, height, small_width, small_height, columns, rows, corner: 0.5, background }
}

/// What the pass reads of an image of every second pixel of every second row, the first ones among them.
pub fn settings_of_halved(size: [usize; 2], effect: Effect) -> uniforms::Upsampling {
    let settings = settings(size, size.map(|edge| edge.div_ceil(2)), effect);
    uniforms::Upsampling { columns: 0.5, rows: 0.5, corner: 0.0, ..settings }
}

/// The pass that brings an effect's image `small`, `[channels, height, width]` of its own g-buffer, into
/// `image`, which is of another.
///
/// # Errors
/// If the device refuses it.
pub fn step(
    device: &Device,
    (effect, settings): (Effect, &uniforms::Upsampling),
    (small_gbuffer, small): (&GpuGBuffer, &wgpu::Buffer),
    (gbuffer, image): (&GpuGBuffer, &wgpu::Buffer),
) -> Result<MethodStep, GpuError> {
    let pass = device.pass(Shader::at("frame/upsample"), &[("CHANNELS", effect.channels() as u32)])?;
    let size = [gbuffer.height(), gbuffer.width()];
    let settings = gpu::uniform(device, "upsampling", settings)?;
    let [full, few] = [gbuffer, small_gbuffer]
        .map(|of| [Attribute::Position, Attribute::Normal, Attribute::Valid].map(|a| of.buffer(a)));
    let reads = [&[&settings], &full[..], &few[..], &[small]].concat();
    MethodStep::bind(device, &pass, gpu::groups(size[0], size[1], TILE), &reads, &[image])
}

/// The same slowly and plainly: `[channels, height, width]`.
pub fn reference(
    (few, small): (&Surface, &Planes),
    surface: &Surface,
    settings: &uniforms::Upsampling,
) -> Planes {
    let mut image = Planes::filled(small.channels(), surface.height, surface.width, 0.0);
    for channel in 0..small.channels() {
        let plane = surface.image(settings.background, |at| {
            let values = neighbours(few, surface, at, settings)
                .map(|(tap, weight)| [weight * small.at(channel, tap.y as usize, tap.x as usize), weight]);
            let [sum, weights] = values.fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
            [if weights > 0.0 { sum / weights } else { settings.background }]
        });
        image.plane_mut(channel).copy_from_slice(plane.data());
    }
    image
}

/// The pixels of a smaller image around a pixel of the full one, with what they count.
fn neighbours(
    few: &Surface,
    surface: &Surface,
    at: IVec2,
    settings: &uniforms::Upsampling,
) -> impl Iterator<Item = (IVec2, f32)> {
    let small = IVec2::new(few.width as i32, few.height as i32);
    let scale = Vec2::new(settings.columns, settings.rows);
    let there = (at.as_vec2() + settings.corner) * scale - settings.corner;
    let (corner, part) = (there.floor(), there - there.floor());
    let (position, normal) = (surface.position_at(at), surface.normal_at(at));
    (0..4).filter_map(move |i| {
        let side = IVec2::new(i & 1, i >> 1);
        let tap = (corner.as_ivec2() + side).clamp(IVec2::ZERO, small - 1);
        let near = Vec2::select(side.cmpeq(IVec2::ONE), part, 1.0 - part);
        let off = (few.position_at(tap) - position).dot(normal) / (TOLERANCE * position.length());
        let alike = few.normal_at(tap).dot(normal).max(0.0).powi(8) / (1.0 + off * off);
        few.valid_at(tap).then(|| (tap, (near.x * near.y * alike).max(LEAST)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::proving::{self, Tolerance, agree, prove_comparator};
    use deepshade_shaders::GBuffer;
    use deepshade_shaders::gpu::Gpu;

    const FULL: [usize; 2] = [66, 96];
    const HALF: [usize; 2] = [33, 48];

    /// A value that changes along surfaces and jumps from one to the other.
    fn painted(surface: &Surface) -> Planes {
        surface.image(0.0, |at| {
            let position = surface.position_at(at);
            [0.2 * position.x + 0.1 * position.z, surface.normal_at(at).y, 0.5 * position.y]
        })
    }

    fn surfaces() -> [Surface; 2] {
        [FULL, HALF]
            .map(|[height, width]| Surface::of(&proving::still_life(height, width)).expect("positions"))
    }

    #[test]
    fn edges_stay_where_they_are() {
        let [full, half] = surfaces();
        let (wanted, settings) = (painted(&full), settings(FULL, HALF, Effect::Gi));
        let found = reference((&half, &painted(&half)), &full, &settings);
        // Without a look at the surfaces: the nearest pixel of the smaller image.
        let scale = |n: usize, full: usize, half: usize| (n * half / full).min(half - 1);
        let small = painted(&half);
        let nearest = Planes::from_fn(3, FULL[0], FULL[1], |c, y, x| {
            small.at(c, scale(y, FULL[0], HALF[0]), scale(x, FULL[1], HALF[1]))
        });
        let [off, nearest_off] = [&found, &nearest].map(|image| proving::mean_difference(image, &wanted));
        assert!(off < 0.004 && nearest_off > 5.0 * off, "{off} and {nearest_off}");
    }

    #[test]
    fn every_second_pixel_of_every_second_row_stays_where_it_is() {
        let size = [65, 95];
        let gbuffer = proving::still_life(size[0], size[1]);
        let full = Surface::of(&gbuffer).expect("positions");
        let every_second =
            |of: &Planes| Planes::from_fn(of.channels(), 33, 48, |c, y, x| of.at(c, 2 * y, 2 * x));
        let few = GBuffer::new(gbuffer.attributes().to_vec(), every_second(gbuffer.planes()));
        let few = Surface::of(&few).expect("positions");
        let wanted = painted(&full);
        let off = |settings: &uniforms::Upsampling| {
            let found = reference((&few, &every_second(&wanted)), &full, settings);
            proving::mean_difference(&found, &wanted)
        };
        let (off, shifted) =
            (off(&settings_of_halved(size, Effect::Gi)), off(&settings(size, [33, 48], Effect::Gi)));
        assert!(off < 0.004 && shifted > 1.5 * off, "{off} and, half a pixel beside, {shifted}");
    }

    #[test]
    fn gpu_and_reference_agree() {
        const TOLERANCE: Tolerance = Tolerance { usual: 1e-5, worst: 1e-3 };
        let gpu = Gpu::new().expect("an adapter");
        let Gpu { device, queue, .. } = &gpu;
        let attributes = [Attribute::Position, Attribute::Normal, Attribute::Valid];
        let [full, half] = surfaces();
        let small = painted(&half);
        let [on_gpu, half_on_gpu] = [FULL, HALF].map(|[height, width]| {
            let gbuffer = proving::still_life(height, width);
            GpuGBuffer::upload(device, &gbuffer, &attributes).expect("room")
        });
        let few = gpu::storage(device, "test", small.data()).expect("room");
        let image = gpu::empty::<f32>(device, "test", 3 * FULL[0] * FULL[1]).expect("room");
        let (compiled, settings) = (Device::new(device), settings(FULL, HALF, Effect::Gi));
        let step = step(&compiled, (Effect::Gi, &settings), (&half_on_gpu, &few), (&on_gpu, &image))
            .expect("a valid pass");
        gpu::submit(device, queue, "test", |encoder| step.step.encode(encoder, "test", None)).expect("valid");
        let found = Planes::from_data(3, FULL[0], FULL[1], gpu::read(device, queue, &image).expect("read"));
        let wanted = reference((&half, &small), &full, &settings);
        assert_eq!(agree(&found, &wanted, TOLERANCE), Ok(()));
        prove_comparator(&wanted, TOLERANCE);
    }
}
