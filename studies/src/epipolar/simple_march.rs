//! The march that trees were first compared with (Baran et al. 2010, section 10): one step after the other,
//! at each a look into the shadow map and an exponential. The map lies in blocks of 8 x 8 texels in Z-order.

use super::subject::FogView;
use deepshade_render::methods::ray_march::shift;
use deepshade_render::methods::shafts::{
    Haze, IntegrationInputs, LampPosition, Parallel, Projection, ShadowMap,
};
use glam::Vec3;
use rayon::ThreadPool;
use std::time::Instant;

/// Edge of a block, texels.
const BLOCK: usize = 8;
/// Every so many rows are marched; the time is that many times theirs.
const EVERY_ROW: usize = 8;

/// Depths in blocks row by row, each in Z-order.
struct BlockMap {
    size: usize,
    depths: Vec<f32>,
}

impl BlockMap {
    /// A square map's texels in the other order.
    fn of(map: &ShadowMap, size: usize) -> Self {
        let mut depths = vec![0.0; size.next_multiple_of(BLOCK).pow(2)];
        let laid_out = Self { size, depths: Vec::new() };
        for (y, x) in (0..size).flat_map(|y| (0..size).map(move |x| (y, x))) {
            depths[laid_out.texel(x, y)] = map.depth(0, x as f32 + 0.5, y as f32 + 0.5);
        }
        Self { depths, ..laid_out }
    }

    fn texel(&self, x: usize, y: usize) -> usize {
        let block = y / BLOCK * self.size.div_ceil(BLOCK) + x / BLOCK;
        block * BLOCK * BLOCK + (spread(y % BLOCK) << 1 | spread(x % BLOCK))
    }

    /// The depth at a point of the map, in texels.
    fn depth(&self, u: f32, v: f32) -> f32 {
        let [x, y] = [u, v].map(|at| (at.max(0.0) as usize).min(self.size - 1));
        self.depths[self.texel(x, y)]
    }
}

/// Three bits with a gap behind each.
const fn spread(bits: usize) -> usize {
    bits & 1 | (bits & 2) << 1 | (bits & 4) << 2
}

/// A march towards a distant lamp through grey fog.
struct SimpleMarch<'a> {
    lit: IntegrationInputs<'a>,
    haze: Haze<'a>,
    towards: Vec3,
    parallel: &'a Parallel,
    map: BlockMap,
}

impl<'a> SimpleMarch<'a> {
    /// None where the lamp is near or the fog uneven.
    fn new(lit: &IntegrationInputs<'a>, shadow_size: usize) -> Option<Self> {
        let (LampPosition::Distant(towards), Projection::Parallel(parallel)) =
            (lit.lamp.position, &lit.map.projection)
        else {
            return None;
        };
        let map = BlockMap::of(lit.map, shadow_size);
        Some(Self { lit: *lit, haze: Haze::of(lit.medium)?, towards, parallel, map })
    }

    /// Radiance of a view ray, its steps shifted by a number of its own.
    fn radiance(&self, ray: usize, steps: u32) -> f32 {
        let rays = self.lit.rays;
        let ([near, far], direction) = (rays.spans[ray], rays.directions[ray]);
        let length = (far.min(near + self.haze.deep()) - near) / steps as f32;
        let jitter = shift(ray, self.lit.seed);
        let mut sum = 0.0;
        for step in 0..steps {
            let distance = near + (step as f32 + jitter) * length;
            let point = rays.eye + direction * distance;
            let [right, up, depth] = self.parallel.locate(point);
            let [u, v] = self.parallel.cascades[0].texels([right, up]);
            if depth < self.map.depth(u, v) {
                let way = distance - near + self.haze.way_in(point, self.towards, f32::INFINITY);
                sum += (-self.haze.extinction.x * way).exp();
            }
        }
        let phase = self.haze.phase.evaluate(self.towards.dot(direction));
        self.lit.lamp.power.x * self.haze.scattering.x * phase * sum * length
    }
}

/// Seconds that one thread of a pool takes for all view rays; none where the lamp is near or the fog uneven.
pub fn seconds(subject: &FogView, steps: u32, pool: &ThreadPool) -> Option<f64> {
    let [height, width] = subject.setup.size;
    let rows: Vec<usize> = (0..height).step_by(EVERY_ROW).collect();
    subject.lit(|lit| {
        let march = SimpleMarch::new(lit, subject.setup.shadow_size)?;
        let start = Instant::now();
        let rays = rows.iter().flat_map(|y| y * width..(y + 1) * width);
        let sum: f32 = pool.install(|| rays.map(|ray| march.radiance(ray, steps)).sum());
        std::hint::black_box(sum);
        Some(start.elapsed().as_secs_f64() * height as f64 / rows.len() as f64)
    })
}

#[cfg(test)]
mod tests {
    use super::super::subject::{Kind, Setup, View};
    use super::*;
    use deepshade_render::methods::ray_march::March;

    #[test]
    fn it_is_the_march_in_vectors_taken_step_by_step() {
        let setup = Setup { size: [24, 32], light_rays: 64, shadow_size: 252 };
        let subject = FogView::new(Kind::Indoor, View::Side, setup).expect("a scene");
        subject.lit(|lit| {
            let march = SimpleMarch::new(lit, setup.shadow_size).expect("a sun in grey fog");
            let vectors = March::new(lit, 0);
            let radiances = |ray| [march.radiance(ray, 512), vectors.shifted(ray, 512).x];
            let both: Vec<[f32; 2]> = (0..24 * 32).map(radiances).collect();
            let brightest = both.iter().fold(0.0, |most: f32, [_, vectors]| most.max(*vectors));
            let far = both.iter().filter(|[a, b]| (a - b).abs() > 0.02 * brightest).count();
            assert!(brightest > 0.0 && far * 50 < both.len(), "{far} of {} rays", both.len());
        });
    }

    #[test]
    fn neighbours_lie_in_z_order() {
        let map = BlockMap { size: 16, depths: Vec::new() };
        assert_eq!([(0, 0), (1, 0), (0, 1), (1, 1), (2, 0)].map(|(x, y)| map.texel(x, y)), [0, 1, 2, 3, 4]);
        assert_eq!([(7, 7), (8, 0), (0, 8)].map(|(x, y)| map.texel(x, y)), [63, 64, 128]);
    }
}
