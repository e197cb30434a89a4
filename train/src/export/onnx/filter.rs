//! The filter of [`deepshade_infer::filter`] in a graph: of every level of the light, continued by its edge and spread to the
//! size of level 0, a tap is a window.

use super::{Graph, int, text};
use deepshade_infer::{Filter, NetSpec, Tap};

impl Graph {
    /// The image of what the last convolution makes and of the padded input.
    pub(super) fn filter(&mut self, spec: &NetSpec, filter: Filter, made: &str, padded: &str) -> String {
        let weights = self.node("Softmax", "weights", &[made], vec![int("axis", 1)]);
        let weights = if filter.black { self.without_black(&weights, filter) } else { weights };
        let lights: Vec<i64> = spec.light_channels().into_iter().map(|channel| channel as i64).collect();
        self.ints("lights", &lights);
        let mut level = self.node("Gather", "light0", &[padded, "lights"], vec![int("axis", 1)]);
        let frame = self.node("Shape", "frame", &[&level], vec![int("start", 2)]);
        let mut taps = Vec::with_capacity(filter.tap_count());
        for index in 0..filter.levels {
            if index > 0 {
                level = self.halve(&format!("light{index}"), &level);
            }
            let wide = self.spread(&level, index, filter.kernel / 2);
            for tap in filter.taps().filter(|tap| tap.level == index) {
                taps.push(self.window(&wide, taps.len(), tap, filter.kernel / 2, &frame));
            }
        }
        self.weigh(&weights, &taps, lights.len())
    }

    /// The weights of the taps, without that of black, which is the last.
    fn without_black(&mut self, weights: &str, filter: Filter) -> String {
        self.ints("black.begin", &[0]);
        self.ints("black.end", &[filter.tap_count() as i64]);
        self.ints("black.axis", &[1]);
        self.node("Slice", "tap_weights", &[weights, "black.begin", "black.end", "black.axis"], vec![])
    }

    /// A level continued by `radius` pixels on all sides, in pixels of level 0.
    fn spread(&mut self, level: &str, index: usize, radius: usize) -> String {
        let (pads, scales) = (format!("{level}.pads"), format!("{level}.scales"));
        let (scale, radius) = ((1u32 << index) as f32, radius as i64);
        self.ints(&pads, &[0, 0, radius, radius, 0, 0, radius, radius]);
        self.floats(&scales, &[4], &[1.0, 1.0, scale, scale]);
        let wide = self.node("Pad", &format!("{level}.wide"), &[level, &pads], vec![text("mode", "edge")]);
        let linear = vec![text("mode", "linear"), text("coordinate_transformation_mode", "half_pixel")];
        self.node("Resize", &format!("{level}.spread"), &[&wide, "", &scales], linear)
    }

    /// A level as a tap reads it, of the size of level 0.
    fn window(&mut self, wide: &str, number: usize, tap: Tap, radius: usize, frame: &str) -> String {
        let name = format!("tap{number}");
        let corner = tap.offset.map(|offset| (offset as i64 + radius as i64) << tap.level);
        let (begin, end) = (format!("{name}.begin"), format!("{name}.end"));
        self.ints(&begin, &corner);
        self.node("Add", &end, &[&begin, frame], vec![]);
        self.node("Slice", &name, &[wide, &begin, &end, "axes"], vec![])
    }

    /// The sum of the taps, `[batch, channels, height, width]` each, by their weights.
    fn weigh(&mut self, weights: &str, taps: &[String], channels: usize) -> String {
        let taps: Vec<&str> = taps.iter().map(String::as_str).collect();
        let all = self.node("Concat", "taps", &taps, vec![int("axis", 1)]);
        self.ints("over_taps", &[1]);
        let mut images = Vec::with_capacity(channels);
        for channel in 0..channels {
            let name = format!("channel{channel}");
            let (of, light, weighted) =
                (format!("{name}.of"), format!("{name}.light"), format!("{name}.weighted"));
            let indices: Vec<i64> = (0..taps.len()).map(|tap| (tap * channels + channel) as i64).collect();
            self.ints(&of, &indices);
            self.node("Gather", &light, &[&all, &of], vec![int("axis", 1)]);
            self.node("Mul", &weighted, &[weights, &light], vec![]);
            images.push(self.node("ReduceSum", &name, &[&weighted, "over_taps"], vec![int("keepdims", 1)]));
        }
        let images: Vec<&str> = images.iter().map(String::as_str).collect();
        self.node("Concat", "filtered", &images, vec![int("axis", 1)])
    }
}
