//! Key frames set by a hand that needs no window.

use super::*;
use deepshade_glow::material::{Material, State};
use deepshade_glow::paint::LightInterval;
use deepshade_glow::spectrum::Bands;
use deepshade_glow::spectrum::lights::Light;
use glam::Vec3;

const GREEN: [f64; 3] = [0.2, 1.0, 0.4];

/// A grip of a twentieth of 20 s and of 2 W/m²/sr.
const GRIP: CurvePoint = CurvePoint { seconds: 1.0, brightness: 0.1 };

fn at(seconds: f64, brightness: f64) -> CurvePoint {
    CurvePoint { seconds, brightness }
}

/// From second -1 on a second of light, then the dark, 20 s in all: a frame is 0.1 s.
fn light(strength: f32) -> FrameLight {
    let lit = |seconds, light| LightInterval { seconds, irradiance: Vec3::splat(light) };
    FrameLight::new(-1.0, 20.0, &[lit(1.0, strength), lit(19.0, 0.0)])
}

fn material(decay: f64) -> Material {
    let state = State { decay, excitation: vec![0.3; 3], emission: GREEN.map(|part| part / decay).to_vec() };
    Material { name: "test".into(), bands: Bands::Rgb, doubt: None, states: vec![state] }
}

/// Under a lamp, with what a material of that decay gives back.
fn wish(decay: f64) -> Wish {
    let light = light(4.0);
    let before = light.glow(&material(decay)).expect("measured");
    Wish::new(light, before)
}

fn frames(wish: &Wish) -> Vec<usize> {
    wish.keys().iter().map(|key| key.frame).collect()
}

#[test]
fn frames_have_the_mean_of_their_light() {
    let lit = |seconds, light: f32| LightInterval { seconds, irradiance: Vec3::new(light, 0.0, 2.0 * light) };
    // Frames of half a second; light ends in the middle of the second.
    let light = FrameLight::new(3.0, 100.0, &[lit(0.75, 4.0), lit(0.5, 0.0), lit(1.0, f32::NAN)]);
    let red: Vec<f64> = light.in_bands(Bands::Rgb).iter().map(|light| light[0]).collect();
    assert!(red[0] == 4.0 && (red[1] - 2.0).abs() < 1e-12 && red[2..].iter().all(|light| *light == 0.0));
    assert!((light.in_bands(Bands::Rgb)[1][2] - 4.0).abs() < 1e-12);
    assert_eq!((light.seconds(2), light.frame(4.1), light.frame(-9.0), light.frame(1e9)), (4.0, 2, 0, 199));
    assert!(!light.is_dark() && FrameLight::new(0.0, 1.0, &[]).is_dark());
}

#[test]
fn a_click_adds_a_key_or_selects_the_one_that_is_there() {
    let mut wish = wish(0.2);
    assert!(wish.click(at(5.0, 0.5), GRIP) && wish.click(at(2.0, 1.0), GRIP));
    assert_eq!(frames(&wish), [30, 60], "in order");
    assert!(!wish.click(at(5.5, 0.55), GRIP), "one is near");
    assert_eq!(wish.selected().map(|key| key.frame), Some(60));
    assert!(!wish.click(at(5.0, 0.9), GRIP) && wish.keys().len() == 2, "a frame has one key");
    let hue = wish.keys()[0].hue;
    assert!((hue[1] / hue[0] - 5.0).abs() < 1e-3, "as the place was: {hue:?}");
    assert!((brightness(hue) - 1.0).abs() < 1e-6);
}

#[test]
fn the_nearest_key_within_reach_is_hit() {
    let mut wish = wish(0.2);
    wish.click(at(4.0, 0.5), GRIP);
    wish.click(at(5.2, 0.5), GRIP);
    let hit = |seconds, brightness| wish.nearest(at(seconds, brightness), GRIP).map(|key| key.frame);
    assert_eq!([hit(4.5, 0.5), hit(4.7, 0.5)], [Some(50), Some(62)]);
    assert_eq!([hit(4.0, 0.59), hit(4.0, 0.61), hit(2.9, 0.5)], [Some(50), None, None]);
    assert_eq!([hit(3.2, 0.55), hit(3.2, 0.57)], [Some(50), None], "both axes count");
}

#[test]
fn a_key_that_is_held_goes_where_it_is_dragged() {
    let mut wish = wish(0.2);
    wish.click(at(2.0, 1.0), GRIP);
    wish.click(at(5.0, 0.5), GRIP);
    wish.fit(&[]);
    assert!(!wish.drag(at(7.0, 0.7)), "none is held");
    wish.grab(at(9.0, 0.5), GRIP);
    assert!(!wish.drag(at(7.0, 0.7)), "none was there");
    wish.grab(at(5.1, 0.52), GRIP);
    assert!(wish.drag(at(1.0, 0.7)) && !wish.drag(at(1.01, 0.7)), "it has not left the frame");
    assert_eq!((frames(&wish), wish.selected().map(|key| key.frame)), (vec![20, 30], Some(20)), "in order");
    assert!(wish.drag(at(2.0, -3.0)), "the frame is taken, the brightness ends at 0");
    assert_eq!((frames(&wish), wish.keys()[0].brightness), (vec![20, 30], 0.0));
    let top = wish.top();
    wish.drag(at(99.0, 99.0));
    assert_eq!((frames(&wish), wish.keys()[1].brightness), (vec![30, 199], top), "as far as the area goes");
    wish.fit(&[]);
    assert_eq!(wish.top(), top, "the area waits");
    wish.release();
    wish.fit(&[]);
    assert!(wish.top() > top && !wish.drag(at(3.0, 0.1)));
}

#[test]
fn keys_are_removed_and_coloured() {
    let mut wish = wish(0.2);
    assert!(!wish.remove_selected() && !wish.set_hue(GREEN));
    wish.click(at(2.0, 1.0), GRIP);
    wish.click(at(5.0, 0.5), GRIP);
    assert!(wish.set_hue([3.0, 0.0, 0.0]) && !wish.set_hue([0.0; 3]), "black is no hue");
    assert!((wish.keys()[1].radiance()[0] - 0.5 / 0.2126).abs() < 1e-5, "red, as bright as before");
    assert!(!wish.remove_at(at(9.0, 0.5), GRIP) && wish.remove_at(at(2.2, 1.0), GRIP));
    assert_eq!(frames(&wish), [60]);
    assert!(!wish.remove_selected(), "the one that was touched last is gone");
    wish.click(at(5.0, 0.5), GRIP);
    assert!(wish.remove_selected() && wish.keys().is_empty() && wish.selected().is_none());
    wish.click(at(5.0, 0.5), GRIP);
    assert!(wish.clear() && wish.keys().is_empty() && !wish.clear());
}

#[test]
fn keys_keep_their_moments_under_another_light() {
    let mut wish = wish(0.2);
    for seconds in [2.0, 2.1, 9.0] {
        assert!(wish.add(at(seconds, 1.0), Some(GREEN)));
    }
    assert!(!wish.add(at(9.0, 2.0), None), "that frame has one");
    let longer = FrameLight::new(-1.0, 200.0, &[]);
    wish.relight(longer, vec![[0.0; 3]; FRAMES]);
    assert_eq!(
        (frames(&wish), wish.selected().map(|key| key.frame)),
        (vec![3, 4, 10], Some(10)),
        "all apart"
    );
    // So short that all are at its end, and as it was.
    wish.relight(FrameLight::new(-1.0, 2.0, &[]), vec![[0.0; 3]; FRAMES]);
    assert_eq!(frames(&wish), [197, 198, 199]);
    wish.relight(light(4.0), vec![[0.0; 3]; FRAMES]);
    assert_eq!(frames(&wish), [30, 31, 100]);
}

#[test]
fn lamps_of_a_spectrum_and_what_is_reflected_count() {
    // White lamps of mercury light: mostly blue.
    let lit = [LightInterval { seconds: 5.0, irradiance: Vec3::ONE }];
    let plain = FrameLight::new(0.0, 20.0, &lit);
    let mercury = plain.clone().under(Some(Light::Mercury));
    let of_lamp = Light::Mercury.of_luminance_one(Bands::Rgb);
    let lit = mercury.in_bands(Bands::Rgb);
    let off = lit[7].iter().zip(&of_lamp).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 1e-6 && of_lamp[2] > of_lamp[0], "{of_lamp:?}");
    assert_eq!(
        mercury.glow(&material(0.2)).expect("measured"),
        plain.glow(&material(0.2)).expect("measured")
    );
    let mut wish = Wish::new(plain.clone(), vec![[0.0; 3]; FRAMES]);
    // What shines at the beginning of a frame is reflected in it.
    let reflecting =
        plain.reflecting(20.0, &[LightInterval { seconds: 4.95, irradiance: Vec3::splat(0.25) }]);
    assert_eq!([49, 50].map(|frame| reflecting.reflected()[frame][1]), [0.25, 0.0]);
    for (seconds, brightness) in [(2.0, 0.5), (8.0, 0.2)] {
        wish.add(at(seconds, brightness), Some([1.0; 3]));
    }
    let glow = |wish: &Wish| wish.answer("wall", 2).expect("found").reached;
    let own = glow(&wish);
    wish.relight(reflecting, vec![[0.0; 3]; FRAMES]);
    let (all, reflected) = (glow(&wish), wish.light().reflected()[20]);
    assert!((brightness(own[20]) - 0.5).abs() < 0.05 && (brightness(all[20]) - 0.5).abs() < 0.05);
    assert!((brightness(reflected) - 0.25).abs() < 1e-6, "half of what is seen is no glow");
}

#[test]
fn a_wish_that_a_material_fulfils_finds_it() {
    let mut wish = wish(0.2);
    let glow = wish.before().to_vec();
    for frame in [12, 40, 90] {
        let seconds = wish.light().seconds(frame);
        wish.add(at(seconds, brightness(glow[frame])), Some(glow[frame]));
    }
    let answer = wish.answer("wall, designed", 1).expect("found");
    let state = &answer.design.material.states[0];
    assert!((state.decay - 0.2).abs() < 2e-3, "{state:?}");
    assert!(answer.off < 1e-3 && answer.in_words()[0].starts_with("met"), "{:?}", answer.in_words());
    assert_eq!(answer.in_words()[1], "half life 3.5 s");
    let off = |frame: usize| (brightness(answer.reached[frame]) / brightness(glow[frame]) - 1.0).abs();
    assert!([12, 40, 90, 150].into_iter().all(|frame| off(frame) < 0.02), "the whole curve is as before");
    // A glow that grows in the dark is none of one state's.
    wish.grab(at(wish.light().seconds(90), wish.keys()[2].brightness), GRIP);
    assert!(wish.drag(at(wish.light().seconds(90), 0.99 * wish.top())));
    let answer = wish.answer("wall, designed", 1).expect("found");
    assert!(answer.off > 0.1 && answer.in_words()[0].starts_with("not met"), "{:?}", answer.in_words());
}

#[test]
fn what_cannot_be_wished_is_said() {
    let said = |wish: &Wish| wish.answer("wall", 1).expect_err("refused");
    let mut wish = wish(0.2);
    assert_eq!(said(&wish), WishError::NoKeys);
    wish.click(at(-1.0, 1.0), GRIP);
    assert_eq!(said(&wish), WishError::Unlit, "light of the key's own frame comes too late");
    wish.remove_selected();
    wish.click(at(3.0, 0.0), GRIP);
    assert_eq!(said(&wish), WishError::Black);
    wish.remove_selected();
    wish.click(at(3.0, 1.0), GRIP);
    assert!(matches!(wish.answer("wall", 3), Err(WishError::Design(_))));
    wish.relight(light(0.0), vec![[0.0; 3]; FRAMES]);
    assert_eq!(said(&wish), WishError::Unlit);
}
