//! Heads in a graph, [`deepshade_infer::Head`]: of every level of the light, continued by its edge and spread
//! to the size of level 0, a tap is a window.

use super::{Graph, int, ints, text};
use deepshade_infer::{Correction, Filter, HALF_GATE, NetSpec, Tap};

impl Graph {
    /// The image of what the last convolution makes and of the padded input.
    pub(super) fn filter(&mut self, spec: &NetSpec, filter: Filter, made: &str, padded: &str) -> String {
        let weights = self.node("Softmax", "weights", &[made], vec![int("axis", 1)]);
        // The weight of black is the last.
        let taps = [0, filter.tap_count() as i64];
        let weights = if filter.black { self.part("tap_weights", &weights, taps) } else { weights };
        let taps = self.taps(spec, filter, padded);
        self.weigh(&weights, &taps, spec.output_channels())
    }

    /// The image of what the last block makes of the padded input, an estimate corrected.
    pub(super) fn correct(
        &mut self,
        spec: &NetSpec,
        correction: Correction,
        made: &str,
        padded: &str,
    ) -> String {
        let channels = spec.output_channels() as i64;
        let of: Vec<i64> =
            spec.channels_of(correction.of).into_iter().map(|channel| channel as i64).collect();
        self.ints("estimate.of", &of);
        let estimate = self.node("Gather", "estimate", &[padded, "estimate.of"], vec![int("axis", 1)]);
        let filter = correction.filter();
        let (biases, taps) = (correction.bias_count(channels as usize) as i64, filter.tap_count() as i64);
        let added = match correction.gain {
            true => {
                let gain = self.part("gain", made, [taps, taps + 1]);
                self.node("Mul", "gained", &[&estimate, &gain], vec![])
            }
            false => self.part("bias", made, [0, biases]),
        };
        let mut image = self.node("Add", "added", &[&estimate, &added], vec![]);
        if filter.tap_count() > 0 {
            let weights = self.part("tap_weights", made, [biases, biases + taps]);
            let taps = self.taps(spec, filter, padded);
            let there = self.weigh(&weights, &taps, channels as usize);
            let sum = self.node("ReduceSum", "weight", &[&weights, "over_taps"], vec![int("keepdims", 1)]);
            let here = self.node("Mul", "here", &[&estimate, &sum], vec![]);
            let differences = self.node("Sub", "differences", &[&there, &here], vec![]);
            image = self.node("Add", "corrected", &[&image, &differences], vec![]);
        }
        if correction.gated {
            image = self.gate(&estimate, &image);
        }
        let [least, most] = spec.effect.range();
        self.floats("least", &[], &[least]);
        if most.is_finite() {
            self.floats("most", &[], &[most]);
            return self.node("Clip", "within", &[&image, "least", "most"], vec![]);
        }
        self.node("Clip", "within", &[&image, "least"], vec![])
    }

    /// An image of which so much is corrected as its estimate differs from the finest level of the pyramid.
    fn gate(&mut self, estimate: &str, image: &str) -> String {
        self.floats("half_gate", &[], &[HALF_GATE]);
        let differences = self.node("Sub", "changes", &["light0", estimate], vec![]);
        let sizes = self.node("Abs", "change_sizes", &[&differences], vec![]);
        let over_channels = vec![ints("axes", &[1]), int("keepdims", 1)];
        let difference = self.node("ReduceMax", "change", &[&sizes], over_channels);
        let sum = self.node("Add", "change_and_half", &[&difference, "half_gate"], vec![]);
        let share = self.node("Div", "gate", &[&difference, &sum], vec![]);
        let correction = self.node("Sub", "correction", &[image, estimate], vec![]);
        let counted = self.node("Mul", "gated", &[&share, &correction], vec![]);
        self.node("Add", "with_gate", &[estimate, &counted], vec![])
    }

    /// Some channels of an image.
    fn part(&mut self, name: &str, of: &str, [begin, end]: [i64; 2]) -> String {
        let constants = ["begin", "end", "axis"].map(|part| format!("{name}.{part}"));
        for (constant, value) in constants.iter().zip([begin, end, 1]) {
            self.ints(constant, &[value]);
        }
        let [begin, end, axis] = &constants;
        self.node("Slice", name, &[of, begin, end, axis], vec![])
    }

    /// What every tap reads of the pyramid of the padded input, in the order of their weights.
    fn taps(&mut self, spec: &NetSpec, filter: Filter, padded: &str) -> Vec<String> {
        let lights: Vec<i64> = spec.pyramid_channels().into_iter().map(|channel| channel as i64).collect();
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
        taps
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
