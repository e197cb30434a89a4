//! The image's pixels by epipolar lines, each in the nearest, in the order in which they lie on it.

use super::super::shafts::ViewRays;
use super::geometry::{Geometry, beta};
use super::slices::Slices;
use rayon::prelude::*;

/// View rays sorted by lines, and along each from the light away.
#[derive(Debug)]
pub struct Lines {
    rays: Vec<u32>,
    /// Where each line's begin, and the end of all.
    starts: Vec<usize>,
}

impl Lines {
    /// Sorts all view rays.
    pub fn new(view: &ViewRays, geometry: &Geometry) -> Self {
        let slices = Slices::new(geometry.epipole(view), view.height(), view.width());
        let key = |ray: usize| {
            let (before, on) = slices.of(view.at(ray).as_dvec2());
            let direction = geometry.direction(view.directions[ray]);
            let slice = if on < 0.5 { before } else { slices.after(before) };
            (slice, beta(direction.along, direction.aside), ray as u32)
        };
        let mut keys: Vec<(usize, f32, u32)> = (0..view.count()).into_par_iter().map(key).collect();
        keys.par_sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let starts = (0..=slices.count()).map(|slice| keys.partition_point(|key| key.0 < slice)).collect();
        Self { rays: keys.into_iter().map(|key| key.2).collect(), starts }
    }

    /// The view rays of every line.
    pub fn all(&self) -> impl IndexedParallelIterator<Item = &[u32]> {
        self.starts.par_windows(2).map(|ends| &self.rays[ends[0]..ends[1]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::TracedScene;
    use crate::gbuffer;
    use crate::method::Frame;
    use crate::methods::shafts::LampPosition;
    use crate::path::proving::floor;
    use crate::scene::{Camera, Material, Scene};
    use deepshade_shaders::Attribute;
    use glam::Vec3;

    #[test]
    fn every_pixel_is_in_one_line_and_angles_grow_along_it() {
        let scene =
            Scene { meshes: vec![floor()].into(), materials: vec![Material::default()], ..Scene::default() };
        let scene = TracedScene::new(scene).expect("triangles");
        let camera = Camera::look_at(Vec3::Y, Vec3::new(2.0, 1.3, 1.0));
        let gbuffer = gbuffer::render(&scene, &camera, 33, 47, &[Attribute::Depth, Attribute::Valid]);
        let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius: 1.0, seed: 0 };
        let view = ViewRays::of(&frame);
        let geometry = Geometry::new(view.eye, LampPosition::Distant(Vec3::new(2.0, 1.0, 1.0).normalize()))
            .expect("a sun");
        let lines = Lines::new(&view, &geometry);
        let all: Vec<Vec<u32>> = lines.all().map(<[u32]>::to_vec).collect();
        let mut pixels: Vec<u32> = all.concat();
        pixels.sort_unstable();
        assert!(pixels.iter().copied().eq(0..33 * 47));
        let along = |ray: &u32| geometry.direction(view.directions[*ray as usize]).along;
        assert!(all.iter().all(|line| line.is_sorted_by(|a, b| along(a) >= along(b) - 1e-6)));
        assert!(all.iter().filter(|line| line.len() > 5).count() > 40, "lines are long");
    }
}
