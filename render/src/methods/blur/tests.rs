use super::*;
use crate::methods::proving::{gbuffer_of, nearest, plane, view};
use glam::Vec3;

const HEIGHT: usize = 43;
const WIDTH: usize = 61;

#[test]
fn it_smooths_planes_and_keeps_steps() {
    let gbuffer = gbuffer_of(HEIGHT, WIDTH, |ray| {
        let low = plane(ray, Vec3::new(0.0, 0.0, -5.0), Vec3::Z);
        let high = plane(ray, Vec3::new(0.0, 0.0, -4.0), Vec3::Z).filter(|(at, _)| at.x > 0.0);
        nearest([low, high])
    });
    let surface = Surface::of(&gbuffer).expect("all attributes");
    let high = |x: usize| surface.position.at(2, 20, x) > -4.5;
    let edge = (0..WIDTH).find(|x| high(*x)).expect("a plateau");
    let parameters = BlurParameters { radius: 4, sharpness: 1024.0 };
    for effect in [Effect::Ao, Effect::Gi] {
        let settings = parameters.settings(&view(HEIGHT, WIDTH, 1.0), effect);
        // Dark and light columns in turn on the floor, all light on the plateau; each channel half of the one
        // before.
        let last = effect.channels() - 1;
        let share = 0.5f32.powi(last as i32);
        let stripes = Planes::from_fn(effect.channels(), HEIGHT, WIDTH, |c, _, x| {
            0.5f32.powi(c as i32) * if high(x) { 1.0 } else { (x % 2) as f32 }
        });
        let blurred = along(&surface, &settings[0], &stripes);
        let value = |x: usize| blurred.at(last, 20, x) / share;
        assert!((value(edge / 2) - 0.5).abs() < 0.05, "stripes become grey");
        assert!(value(edge) > 0.999, "nothing of the floor bleeds onto the plateau");
        assert!(value(edge - 1) < 0.9, "nothing of the plateau bleeds onto the floor");
        let along_columns = along(&surface, &settings[1], &stripes);
        assert_eq!(along_columns.at(last, 20, 3), share, "columns are uniform");
        assert_eq!(along_columns.at(last, 20, 4), 0.0, "columns are uniform");
    }
}

#[test]
fn where_nothing_is_seen_is_the_background() {
    let gbuffer =
        gbuffer_of(9, 9, |ray| plane(ray, Vec3::new(0.0, 0.0, -4.0), Vec3::Z).filter(|(at, _)| at.x > 0.0));
    let surface = Surface::of(&gbuffer).expect("all attributes");
    for effect in [Effect::Ao, Effect::Gi] {
        let settings = BlurParameters { radius: 4, sharpness: 1.0 }.settings(&view(9, 9, 1.0), effect);
        let [_, image] = smooth(&surface, &settings, &Planes::filled(effect.channels(), 9, 9, 0.25));
        assert_eq!(Some(image.at(effect.channels() - 1, 4, 0)), effect.background());
        assert_eq!(image.at(0, 4, 8), 0.25);
    }
}
