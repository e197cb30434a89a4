use super::super::Fit;
use super::super::tests::read;
use super::*;
use crate::noise::Noise;
use image::{ImageBuffer, Rgb};

const DECAY: f64 = 0.03;
/// What ISO 200 really does over what it says.
const REALLY: f64 = 1.08;

/// Writes a photograph of 40x24 pixels whose left half is of this radiance; the right half is lit by
/// something else.
fn photograph(path: &Path, radiance: f64, iso: f64, noise: &mut Noise) {
    let gain = iso / 100.0 * if iso > 100.0 { REALLY } else { 1.0 };
    let image = ImageBuffer::from_fn(40, 24, |x, y| {
        let shade = if x < 20 { radiance * (1.0 + 0.5 * f64::from(y % 8) / 8.0) / 1.22 } else { 0.011 };
        let colour = [1.0, 0.8, 0.5].map(|part| part * shade * gain + 2e-4 * noise.normal());
        Rgb(colour.map(|value| (65535.0 * value).clamp(0.0, 65535.0) as u16))
    });
    image.save(path).expect("written");
}

/// A folder of a decay that ISO 100 shows at first and ISO 200 at last.
fn folder(calibration: bool) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut noise, mut decay) = (Noise::new(2), "file,time_s,iso\n".to_owned());
    for index in 0..16u32 {
        let (time, iso) = (f64::from(index) * 5.0, if index < 8 { 100.0 } else { 200.0 });
        let name = format!("{index}.png");
        photograph(&folder.path().join(&name), 0.4 * (-DECAY * time).exp(), iso, &mut noise);
        decay += &format!("{name},{time},{iso}\n");
    }
    std::fs::write(folder.path().join("decay.csv"), decay).expect("written");
    let mask = ImageBuffer::from_fn(40, 24, |x, _| Rgb([if x < 20 { 255u8 } else { 0 }; 3]));
    mask.save(folder.path().join("mask.png")).expect("written");
    if calibration {
        for iso in [100.0, 200.0] {
            photograph(&folder.path().join(format!("steady-{iso}.png")), 0.2, iso, &mut noise);
        }
        let list = "file,iso\nsteady-100.png,100\nsteady-200.png,200\n";
        std::fs::write(folder.path().join("calibration.csv"), list).expect("written");
    }
    folder
}

fn decay(folder: &Path) -> f64 {
    let measurement = read(folder).expect("a measurement");
    Fit::new("test", &measurement, 1).expect("a fit").material.states[0].decay
}

#[test]
fn what_settings_really_do_is_measured() {
    let folder = folder(true);
    let calibrated = decay(folder.path());
    assert!((calibrated / DECAY - 1.0).abs() < 0.005, "{calibrated}");
    photograph(&folder.path().join("steady-200.png"), 0.4, 100.0, &mut Noise::new(3));
    let blind = decay(folder.path());
    assert!((blind / DECAY - 1.0).abs() > 0.02, "as the dials say: {blind}");
}

/// What pixels scatter is no noise that somebody stated: more than that is always left of what cameras and
/// lamps do.
#[test]
fn pixels_do_not_state_the_noise() {
    let measurement = read(folder(true).path()).expect("a measurement");
    assert!(!measurement.noise_is_known);
    assert_eq!(Fit::new("test", &measurement, 1).expect("a fit").warnings, []);
}

/// A PNG file of 8 bits that was saved as one of 16 is no more linear than it was.
#[test]
fn widened_bits_are_found_out() {
    let image = |value: &dyn Fn(u32) -> u16| {
        is_widened(&ImageBuffer::from_fn(16, 2, |x, _| Rgb([value(x), 0, 0])).into())
    };
    assert!(image(&|x| 257 * x as u16) && image(&|x| 256 * x as u16 + 256));
    assert!(!image(&|x| 16 * x as u16 + 16), "12 bits");
    assert!(!image(&|x| 257 * x as u16 + u16::from(x == 7)));
    assert!(!image(&|_| 0), "black");
    assert!(!image(&|x| if x < 8 { 257 * 40 } else { 0 }), "of one value nobody can tell");
}

/// All photographs of a setting count, whatever their exposure times: noise is averaged, and a shutter that
/// is off by 2 % one way and 2 % the other is right on average.
#[test]
fn photographs_of_a_setting_are_taken_together() {
    let folder = folder(false);
    let mut noise = Noise::new(7);
    let mut list = "file,exposure_s,iso\n".to_owned();
    for (name, seconds, really, iso) in
        [("a", 1.0, 1.0, 100.0), ("b", 0.5, 0.51, 200.0), ("c", 0.25, 0.245, 200.0)]
    {
        let name = format!("steady-{name}.png");
        photograph(&folder.path().join(&name), 0.2 * really, iso, &mut noise);
        list += &format!("{name},{seconds},{iso}\n");
    }
    std::fs::write(folder.path().join("calibration.csv"), list).expect("written");
    let photographs = Photographs::new(folder.path(), |_| Err("an EXR file".into())).expect("a calibration");
    let settings: Vec<[f64; 2]> = photographs.settings.iter().map(|(setting, _)| *setting).collect();
    assert_eq!(settings, [[100.0, 1.0], [200.0, 1.0]]);
    assert_eq!(photographs.settings[0].1, 1.0);
    let factor = photographs.settings[1].1;
    assert!((factor / REALLY - 1.0).abs() < 2e-3, "{factor}");
}

#[test]
fn what_cannot_be_used_is_said_by_name() {
    let good = folder(true);
    let said = |name: &str, change: &dyn Fn(&Path)| {
        let folder = folder(true);
        change(&folder.path().join(name));
        let mut error: &dyn Error = &read(folder.path()).expect_err("refused");
        let mut said = error.to_string();
        while let Some(source) = error.source() {
            said = format!("{said}: {source}");
            error = source;
        }
        said
    };
    assert!(read(good.path()).is_ok());
    let whole = |size: [u32; 2]| {
        move |path: &Path| {
            ImageBuffer::from_pixel(size[0], size[1], Rgb([u16::MAX; 3])).save(path).expect("written");
        }
    };
    assert!(said("3.png", &whole([40, 24])).contains("3.png: a pixel is full"));
    assert!(said("3.png", &whole([4, 4])).contains("4x4 pixels"));
    assert!(said("3.png", &|path| std::fs::write(path, "no image").expect("written")).contains("3.png"));
    let black = |path: &Path| ImageBuffer::from_pixel(40, 24, Rgb([0u16; 3])).save(path).expect("written");
    assert!(
        said("mask.png", &black).contains("mask.png leaves 0 pixels, in which there is none of the squares")
    );
    let column = ImageBuffer::from_fn(40, 24, |x, _| Rgb([if x == 3 { 255u8 } else { 0 }; 3]));
    let narrow = |path: &Path| column.save(path).expect("written");
    assert!(said("mask.png", &narrow).contains("steady-100.png: mask.png leaves 24 pixels"));
    let remove = |path: &Path| std::fs::remove_file(path).expect("removed");
    let mixed = said("calibration.csv", &remove);
    assert!(mixed.contains("8.png: is of ISO 200 at f/1, others are of ISO 100 at f/1"), "{mixed}");
    assert!(mixed.contains("calibration.csv, a table (file, exposure_s, iso, f_number)"), "{mixed}");
    let coarse = |path: &Path| ImageBuffer::from_pixel(40, 24, Rgb([9u8; 3])).save(path).expect("written");
    assert!(said("3.png", &coarse).contains("3.png: has 8 bits a colour"));
    assert!(said("steady-100.png", &black).contains("shows nothing to compare"));
    let written = |text: &'static str| move |path: &Path| std::fs::write(path, text).expect("written");
    let beside = "file,time_s,iso,red\n0.png,0,100,0.4\n";
    assert!(said("decay.csv", &written(beside)).contains("has a column red, which means nothing"));
    let beside = "file,time_s,gain\n0.png,0,1\n";
    assert!(said("decay.csv", &written(beside)).contains("has a column gain, which means nothing"));
    let beside = "time_s,gain,iso,red,green,blue\n0,1,100,0.4,0.4,0.4\n";
    assert!(said("decay.csv", &written(beside)).contains("has a column iso, which means nothing"));
    let misspelt = "file,exposure,iso\nsteady-100.png,1,100\nsteady-200.png,1,200\n";
    assert!(
        said("calibration.csv", &written(misspelt)).contains("has a column exposure, which means nothing")
    );
    let unsteady = "file,exposure_s,iso\nsteady-100.png,1,100\nsteady-200.png,1,200\nsteady-200.png,2,200\n";
    assert!(
        said("calibration.csv", &written(unsteady))
            .contains("steady-200.png: exposes -50 % beside another of calibration.csv at ISO 200 and f/1")
    );
    let other = |path: &Path| std::fs::write(path, "file,iso\nsteady-100.png,100\n").expect("written");
    assert!(said("calibration.csv", &other).contains("ISO 200 at f/1 is not in calibration.csv"));
}
