use super::*;
use crate::curves::Curves;
use crate::difference::ciede2000;
use crate::noise::Noise;

/// What a camera sees of linear sRGB: its channels are broad, and its blue is faint.
const CAMERA: [[f64; 3]; 3] = [[0.40, 0.22, 0.05], [0.12, 0.52, 0.11], [0.03, 0.09, 0.31]];

pub(super) fn camera(colour: [f64; 3]) -> [f64; 3] {
    CAMERA.map(|row| row.iter().zip(colour).map(|(a, b)| a * b).sum())
}

/// The classic chart as that camera sees it.
pub(super) fn classic() -> Vec<Patch> {
    let patch = |name: &str| {
        let known = chart::stated(name).expect("a patch");
        Patch { name: name.to_owned(), seen: camera(known), known }
    };
    chart::names().map(patch).collect()
}

fn found(patches: &[Patch]) -> Checker {
    Checker::new(patches).expect("a matrix")
}

/// How far a matrix is from undoing a camera.
pub(super) fn off(checker: &Checker) -> f64 {
    let unit = |channel: usize| [0, 1, 2].map(|other| f64::from(u8::from(other == channel)));
    let made = (0..3).map(|channel| (unit(channel), checker.colour(camera(unit(channel)))));
    made.flat_map(|(a, b)| [0, 1, 2].map(|c: usize| (a[c] - b[c]).abs())).fold(0.0, f64::max)
}

#[test]
fn a_known_matrix_is_found_again() {
    let checker = found(&classic());
    assert!(off(&checker) < 1e-12 && checker.rms < 1e-13, "{checker:?}");
    assert_eq!(checker.patches, 24);
    let few: Vec<Patch> = classic().into_iter().step_by(4).collect();
    assert!(off(&found(&few)) < 1e-12);
    let mut transposed = checker.clone();
    transposed.matrix = [0, 1, 2].map(|row| [0, 1, 2].map(|column: usize| checker.matrix[column][row]));
    assert!(off(&transposed) > 0.1, "the control");
}

/// Of noise on known values the errors of a matrix have the variance of the closed form,
/// `sigma^2 (A^T A)^-1`, and what is left is the noise, whatever was used up.
#[test]
fn noise_moves_a_matrix_as_theory_says() {
    const SIGMA: f64 = 0.01;
    const RUNS: u64 = 400;
    let patches = classic();
    let right = found(&patches);
    let square = patches.iter().fold(DMat3::ZERO, |sum, patch| {
        let seen = DVec3::from(patch.seen);
        sum + DMat3::from_cols(seen * seen.x, seen * seen.y, seen * seen.z)
    });
    let variance = square.inverse();
    let (mut ratio, mut rms, mut most) = (0.0, 0.0, 0.0f64);
    for seed in 0..RUNS {
        let mut noise = Noise::new(seed);
        let mut noisy = patches.clone();
        let values = noisy.iter_mut().flat_map(|patch| &mut patch.known);
        values.for_each(|value| *value += SIGMA * noise.normal());
        let checker = found(&noisy);
        for (row, column) in (0..9).map(|index| (index / 3, index % 3)) {
            let error = checker.matrix[row][column] - right.matrix[row][column];
            let expected = SIGMA * variance.col(column)[column].sqrt();
            ratio += (error / expected).powi(2) / (9 * RUNS) as f64;
            most = most.max((error / expected).abs());
        }
        rms += checker.rms.powi(2) / RUNS as f64;
    }
    // Four standard errors: channels of a row share noise, so at least 3 of 9 values are independent.
    assert!((ratio - 1.0).abs() < 4.0 * (2.0 / (3 * RUNS) as f64).sqrt(), "{ratio}");
    assert!((rms.sqrt() / SIGMA - 1.0).abs() < 0.02 && most < 5.5, "{} {most}", rms.sqrt());
}

/// Patches that were taken for others are found out by what is left.
#[test]
fn a_wrong_assignment_leaves_much() {
    let mistaken = |mix: &dyn Fn(usize) -> usize| {
        let patches = classic();
        let other =
            |(index, patch): (usize, &Patch)| Patch { seen: patches[mix(index)].seen, ..patch.clone() };
        found(&patches.iter().enumerate().map(other).collect::<Vec<_>>())
    };
    assert!(mistaken(&|index| index).rms < 1e-13);
    assert!(mistaken(&|index| 23 - index).rms > 0.2, "upside down: {}", mistaken(&|index| 23 - index).rms);
    assert!(mistaken(&|index| (index + 1) % 24).rms > 0.2, "one off");
    let swapped = mistaken(&|index| match index {
        13 => 14,
        14 => 13,
        other => other,
    });
    let pairs = (0..24).flat_map(|a| (0..a).map(move |b| (a, b)));
    let swap = |(a, b)| {
        mistaken(&|index| {
            if index == a {
                b
            } else if index == b {
                a
            } else {
                index
            }
        })
        .rms
    };
    let found = pairs.filter(|pair| swap(*pair) > 0.03).count();
    assert!(found > 250, "of 276 swaps of two patches {found} are warned of");
    assert!(swapped.rms > 0.04 && swapped.worst.1 > 0.1, "{swapped:?}");
    assert!(["green", "red"].contains(&swapped.worst.0.as_str()), "{swapped:?}");
}

#[test]
fn what_tells_no_colours_is_refused() {
    let said = |patches: &[Patch]| Checker::new(patches).expect_err("refused").to_string();
    let all = classic();
    assert!(said(&all[..5]).contains("checker.csv: 5 patches, at least 6 are needed"));
    let grey = said(&all[18..]);
    assert!(grey.contains("do not tell the camera's colours apart"), "{grey}");
    let mut noise = Noise::new(3);
    let mut noisy = all[18..].to_vec();
    noisy
        .iter_mut()
        .for_each(|patch| patch.seen = patch.seen.map(|value| value * (1.0 + 3e-3 * noise.normal())));
    assert!(said(&noisy).contains("greys alone"));
    let changed = |change: fn(&mut Patch)| {
        let mut changed = all.clone();
        changed.iter_mut().for_each(change);
        said(&changed)
    };
    assert!(changed(|patch| patch.seen[2] = 0.0).contains("its blue is"));
    assert!(changed(|patch| patch.seen[1] = 2.0 * patch.seen[0]).contains("is the same mixture"));
    assert!(changed(|patch| patch.seen[0] = f64::NAN).contains("patch dark skin was seen as [NaN"));
    assert!(changed(|patch| patch.known[0] = f64::INFINITY).contains("numbers must be finite"));
    assert!(changed(|patch| patch.seen[0] -= 0.2).contains("not negative"));
}

/// The maker's 8 bit sRGB values, of the older charts, beside its CIE L*a*b* of the newer ones: another
/// table, white point and adaptation. Charts differ by 1 to 4, and screens lack the cyan.
#[test]
fn what_is_known_of_the_chart_agrees_with_what_else_is_published() {
    let srgb: [[u8; 3]; 24] = [
        [115, 82, 68],
        [194, 150, 130],
        [98, 122, 157],
        [87, 108, 67],
        [133, 128, 177],
        [103, 189, 170],
        [214, 126, 44],
        [80, 91, 166],
        [193, 90, 99],
        [94, 60, 108],
        [157, 188, 64],
        [224, 163, 46],
        [56, 61, 150],
        [70, 148, 73],
        [175, 54, 60],
        [231, 199, 31],
        [187, 86, 149],
        [8, 133, 161],
        [243, 243, 242],
        [200, 200, 200],
        [160, 160, 160],
        [122, 122, 121],
        [85, 85, 85],
        [52, 52, 52],
    ];
    let linear = |value: u8| {
        let value = f64::from(value) / 255.0;
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    };
    let (mut shown, mut spectral) = (Vec::new(), Vec::new());
    for (name, srgb) in chart::names().zip(srgb) {
        let stated = chart::stated(name).expect("a patch");
        shown.push(ciede2000(stated.map(|part| part.max(0.0)), srgb.map(linear)));
        spectral.push(ciede2000(stated, chart::seen_in(name, None, None).expect("a patch")));
    }
    for (what, differences) in [("sRGB", shown), ("spectra", spectral)] {
        let mean = differences.iter().sum::<f64>() / 24.0;
        let most = differences.iter().copied().fold(0.0, f64::max);
        assert!(mean < 1.8 && most < 4.0, "{what}: {mean} {most} {differences:?}");
    }
    let next = chart::names().skip(1).chain(["black"]).map(|name| chart::stated(name).expect("a patch"));
    let far =
        chart::names().zip(next).map(|(name, next)| ciede2000(chart::stated(name).expect("a patch"), next));
    assert!(far.sum::<f64>() / 24.0 > 20.0, "the control: each beside the next one");
    assert_eq!(chart::stated("Dark Skin"), chart::stated("dark skin"));
    assert_eq!((chart::stated("mauve"), chart::seen_in("mauve", None, None)), (None, None));
    assert!(chart::of_lab([100.0, 0.0, 0.0]).iter().all(|part| (part - 1.0).abs() < 1e-3));
}

/// A flat filter takes its share of all, a red one leaves red, and a halogen lamp is red.
#[test]
fn filters_and_light_change_what_is_known() {
    let wavelengths = vec![400.0, 590.0, 600.0, 700.0];
    let filters = Curves { wavelengths, values: vec![vec![0.3; 4], vec![0.0, 0.0, 0.9, 0.9]] };
    let seen = |filter: Option<usize>| {
        chart::seen_in("white", None, filter.map(|index| (&filters, index))).expect("a patch")
    };
    assert!(seen(None).iter().zip(seen(Some(0))).all(|(all, part)| (0.3 * all - part).abs() < 1e-12));
    let [red, green, blue] = seen(Some(1));
    assert!(red > 0.5 && green < 0.1 && blue < 0.01, "{red} {green} {blue}");
    let halogen = Curves { wavelengths: vec![400.0, 700.0], values: vec![vec![0.3, 1.7]] };
    let [red, green, blue] = chart::seen_in("white", Some(&halogen), None).expect("a patch");
    assert!(red > 1.2 * green && green > 1.5 * blue, "{red} {green} {blue}");
    let doubled = Curves { values: vec![vec![0.6, 3.4]], ..halogen };
    assert!((chart::seen_in("white", Some(&doubled), None).expect("a patch")[0] - red).abs() < 1e-12);
}

/// What a camera leaves of the chart whose channels are no mixtures of the eye's: less than is warned of, and
/// all its channels are told.
#[test]
fn a_camera_that_is_no_eye_is_not_doubted() {
    let flat = Curves { wavelengths: vec![400.0, 700.0], values: vec![vec![1.0; 2]] };
    let narrow = deepshade_glow::spectrum::Axis { from: 400.0, width: 5.0, count: 60 };
    let sensor = Curves::nominal_sensor();
    let bands = sensor.bands(narrow);
    let patch = |name: &str| {
        let light = chart::reflected(name, &narrow, &flat).expect("a patch");
        let channel = |c: usize| bands[c].iter().zip(&light).map(|(a, b)| a * b).sum::<f64>() / 60.0;
        let known = chart::seen_in(name, Some(&flat), None).expect("a patch");
        Patch { name: name.into(), seen: [0, 1, 2].map(channel), known }
    };
    let checker = found(&chart::names().map(patch).collect::<Vec<_>>());
    assert!((0.005..0.007).contains(&checker.rms), "{checker:?}");
    let own = checker.own;
    assert!(own.iter().all(|own| *own > 5.0 * OWN), "{own:?}");
}
