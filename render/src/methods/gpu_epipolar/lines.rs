//! Lines through the epipole in plain Rust: `shared/epipolar_lines.wgsl` and `methods/epipolar/lines.wgsl`.

use crate::methods::epipolar::Geometry;
use crate::screen::View;
use glam::{Vec2, Vec3};

/// The lines of an image.
pub struct Lines {
    size: Vec2,
    /// The epipole in homogeneous coordinates.
    epipole: Vec3,
    /// How many leave before each place of the border, clockwise from where the line through the middle comes
    /// in.
    numbers: Vec<f32>,
    /// How far that is from the top left corner.
    first_place: f32,
}

impl Lines {
    /// Those of a view of a lamp.
    pub fn new(geometry: &Geometry, view: &View) -> Self {
        let size = Vec2::new(view.width as f32, view.height as f32);
        let at = view.camera.direction_to_camera(geometry.axis);
        let across = view.focal_length() * Vec2::new(at.x, -at.y);
        let epipole = (-0.5 * size * at.z + across).extend(-at.z);
        let mut lines = Self { size, epipole, numbers: Vec::new(), first_place: 0.0 };
        lines.first_place = lines.place_along(0.5 * size, -lines.direction(0.5 * size)).floor();
        let places = 2 * (view.width + view.height);
        let steps: Vec<f32> = (0..places).map(|place| lines.step_across(place as f32)).collect();
        let all: f32 = steps.iter().sum();
        let scale = all.ceil().max(1.0) / all;
        let mut before = 0.0;
        lines.numbers = vec![0.0];
        lines.numbers.extend(steps.iter().map(|step| {
            before += step * scale;
            before
        }));
        lines
    }

    /// How many there are; the last one's number.
    pub fn count(&self) -> f32 {
        self.numbers[self.numbers.len() - 1].round()
    }

    fn border_point(&self, place: f32) -> Vec2 {
        let Vec2 { x: width, y: height } = self.size;
        let around = 2.0 * (width + height);
        let from_corner = place + self.first_place;
        let place = if from_corner >= around { from_corner - around } else { from_corner };
        if place < width {
            Vec2::new(place, 0.0)
        } else if place < width + height {
            Vec2::new(width, place - width)
        } else if place < 2.0 * width + height {
            Vec2::new(2.0 * width + height - place, height)
        } else {
            Vec2::new(0.0, (2.0 * (width + height) - place).max(0.0))
        }
    }

    fn direction(&self, point: Vec2) -> Vec2 {
        let away = point * self.epipole.z - self.epipole.truncate();
        (away * if self.epipole.z >= 0.0 { 1.0 } else { -1.0 }).normalize_or(Vec2::X)
    }

    fn step_across(&self, place: f32) -> f32 {
        let [begins, ends] = [place, place + 1.0].map(|place| self.border_point(place));
        let along = ends - begins;
        self.direction(0.5 * (begins + ends)).dot(Vec2::new(along.y, -along.x)).max(0.0)
    }

    /// Where a ray in the image meets its border, from the top left corner.
    fn place_along(&self, point: Vec2, along: Vec2) -> f32 {
        let ends = Vec2::select(along.cmpgt(Vec2::ZERO), self.size, Vec2::ZERO);
        let steps = ((ends - point) / along).abs();
        let leaves = point + along * steps.min_element();
        let Vec2 { x: width, y: height } = self.size;
        match (steps.x < steps.y, along) {
            (true, along) if along.x > 0.0 => width + leaves.y,
            (true, _) => 2.0 * (width + height) - leaves.y,
            (false, along) if along.y > 0.0 => 2.0 * width + height - leaves.x,
            (false, _) => leaves.x,
        }
    }

    /// The fractional line through a point of the image.
    pub fn through(&self, point: Vec2) -> f32 {
        let from_first = self.place_along(point, self.direction(point)) - self.first_place;
        let around = 2.0 * self.size.element_sum();
        let place = if from_first < 0.0 { from_first + around } else { from_first };
        let before = (place.max(0.0) as usize).min(self.numbers.len() - 2);
        let on = (place - before as f32).clamp(0.0, 1.0);
        self.numbers[before] + (self.numbers[before + 1] - self.numbers[before]) * on
    }

    /// Where a line leaves the image, pixels.
    pub fn end(&self, line: f32) -> Vec2 {
        let line = line.min(self.count() - 0.05);
        let low = self.numbers[..self.numbers.len() - 1].partition_point(|number| *number <= line).max(1) - 1;
        let step = self.numbers[low + 1] - self.numbers[low];
        self.border_point(low as f32 + ((line - self.numbers[low]) / step.max(1e-20)).clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::proving::view;
    use crate::methods::shafts::LampPosition;
    use crate::scene::Camera;

    const SIZE: [usize; 2] = [48, 64];

    /// Lamps before, behind and beside the camera, almost across the view and in the image.
    fn axes() -> [Vec3; 6] {
        [
            [0.1, 0.05, -1.0],
            [0.2, -0.1, 1.0],
            [1.0, 0.3, -0.5],
            [1.0, 0.4, 1e-7],
            [-0.3, 1.0, 0.0],
            [0.5, 0.4, -1.0],
        ]
        .map(|axis| Vec3::from(axis).normalize())
    }

    fn distance_to_line(point: Vec2, from: Vec2, along: Vec2) -> f32 {
        along.perp_dot(point - from).abs()
    }

    #[test]
    fn every_pixel_is_between_two_lines_that_are_a_pixel_apart() {
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z);
        let view = View { camera, ..view(SIZE[0], SIZE[1], 1.0) };
        for axis in axes() {
            let geometry = Geometry::new(Vec3::ZERO, LampPosition::Distant(axis)).expect("a sun");
            let lines = Lines::new(&geometry, &view);
            // As many as lines through an epipole in the image leave a border at most, and some.
            assert!((40.0..2.0 * (48.0 + 64.0)).contains(&lines.count()), "{axis}: {}", lines.count());
            for i in 0..SIZE[0] * SIZE[1] {
                let point = Vec2::new((i % SIZE[1]) as f32 + 0.5, (i / SIZE[1]) as f32 + 0.5);
                let line = lines.through(point);
                assert!((0.0..=lines.count()).contains(&line), "{axis} at {point}: {line}");
                for number in [line.floor(), line.floor() + 1.0] {
                    let end = lines.end(number.min(lines.count()));
                    let off = distance_to_line(point, end, lines.direction(end));
                    assert!(off < 1.02, "{axis} at {point}: {off}");
                }
                let end = lines.end(line);
                let off = distance_to_line(point, end, lines.direction(end));
                assert!(off < 0.02, "{axis} at {point}: {off} from its own");
            }
        }
    }
}
