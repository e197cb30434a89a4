//! The 24 patches of the classic colour chart (McCamy, Marcus and Davidson 1976): what is published of them.

use crate::curves::Curves;
use deepshade_glow::spectrum::Axis;
use deepshade_glow::spectrum::lights::Light;
use palette::chromatic_adaptation::AdaptFromUnclamped;
use palette::convert::FromColorUnclamped;
use palette::white_point::{D50, D65};
use palette::{Lab, LinSrgb, Xyz};

/// Narrow bands in which light of a patch is summed: filters may be narrower than those of materials.
const NARROW: Axis = Axis { from: 400.0, width: 5.0, count: 60 };
/// Between two values of a reflectance, in nm, of which the first is at 400 nm.
const STEP: f64 = 10.0;

/// A patch.
struct ChartPatch {
    name: &'static str,
    /// CIE L*a*b* under D50, of the charts that have been sold since November 2014, as their maker states it
    /// (X-Rite 2016, New color specifications for ColorChecker SG and Classic charts).
    lab: [f64; 3],
    /// Reflectance at 400, 410, ... 700 nm in thousandths (Ohta 1997, The basis of color reproduction
    /// engineering; those of ISO 17321-1:2012 are the same), of older charts.
    reflectance: [u16; 31],
}

/// All of them, row by row from the upper left of the chart.
static PATCHES: [ChartPatch; 24] = [
    ChartPatch {
        name: "dark skin",
        lab: [37.54, 14.37, 14.92],
        reflectance: [
            65, 68, 64, 59, 55, 53, 52, 52, 54, 57, 61, 65, 70, 74, 76, 79, 87, 100, 115, 129, 138, 146, 154,
            163, 173, 188, 204, 222, 242, 261, 282,
        ],
    },
    ChartPatch {
        name: "light skin",
        lab: [64.66, 19.27, 17.5],
        reflectance: [
            182, 197, 201, 205, 212, 224, 240, 262, 282, 293, 301, 321, 322, 298, 292, 300, 295, 305, 358,
            435, 494, 530, 550, 564, 574, 590, 605, 624, 652, 682, 713,
        ],
    },
    ChartPatch {
        name: "blue sky",
        lab: [49.32, -3.82, -22.54],
        reflectance: [
            266, 320, 336, 337, 335, 331, 322, 310, 293, 276, 260, 243, 225, 208, 198, 191, 183, 172, 163,
            157, 150, 144, 137, 130, 123, 118, 112, 108, 105, 104, 103,
        ],
    },
    ChartPatch {
        name: "foliage",
        lab: [43.46, -12.74, 22.72],
        reflectance: [
            50, 49, 50, 52, 54, 58, 61, 64, 67, 70, 78, 106, 155, 181, 177, 157, 137, 126, 122, 115, 104, 98,
            98, 100, 97, 95, 95, 101, 125, 174, 247,
        ],
    },
    ChartPatch {
        name: "blue flower",
        lab: [54.94, 9.61, -24.79],
        reflectance: [
            328, 418, 446, 448, 444, 434, 421, 405, 381, 362, 342, 314, 271, 231, 211, 209, 201, 196, 206,
            223, 235, 245, 243, 247, 269, 318, 384, 446, 490, 511, 520,
        ],
    },
    ChartPatch {
        name: "bluish green",
        lab: [70.48, -32.26, -0.37],
        reflectance: [
            252, 303, 322, 336, 353, 375, 408, 460, 523, 566, 582, 580, 569, 549, 519, 480, 436, 392, 346,
            302, 260, 234, 221, 215, 210, 208, 211, 220, 233, 244, 252,
        ],
    },
    ChartPatch {
        name: "orange",
        lab: [62.73, 35.83, 56.5],
        reflectance: [
            54, 53, 52, 52, 52, 52, 52, 53, 55, 57, 61, 68, 86, 120, 170, 228, 297, 380, 452, 503, 532, 552,
            566, 578, 587, 599, 604, 608, 615, 622, 628,
        ],
    },
    ChartPatch {
        name: "purplish blue",
        lab: [39.43, 10.75, -45.17],
        reflectance: [
            231, 293, 324, 348, 373, 387, 374, 345, 301, 247, 202, 167, 137, 116, 106, 99, 90, 83, 83, 86,
            87, 85, 84, 88, 98, 111, 123, 126, 120, 115, 116,
        ],
    },
    ChartPatch {
        name: "moderate red",
        lab: [50.57, 48.64, 16.67],
        reflectance: [
            144, 144, 138, 132, 131, 129, 126, 125, 119, 109, 103, 100, 94, 89, 92, 102, 108, 112, 157, 274,
            415, 517, 567, 591, 601, 607, 607, 605, 605, 605, 606,
        ],
    },
    ChartPatch {
        name: "purple",
        lab: [30.1, 22.54, -20.87],
        reflectance: [
            177, 199, 206, 190, 168, 144, 120, 101, 86, 75, 67, 61, 58, 54, 52, 53, 55, 54, 52, 53, 59, 74,
            99, 126, 149, 172, 193, 217, 248, 282, 319,
        ],
    },
    ChartPatch {
        name: "yellow green",
        lab: [71.77, -24.13, 58.19],
        reflectance: [
            60, 61, 62, 64, 68, 75, 85, 104, 135, 185, 269, 384, 484, 534, 545, 533, 513, 487, 454, 416, 374,
            346, 331, 325, 320, 319, 324, 337, 354, 368, 379,
        ],
    },
    ChartPatch {
        name: "orange yellow",
        lab: [71.51, 18.24, 67.37],
        reflectance: [
            65, 64, 64, 64, 65, 67, 69, 77, 92, 107, 123, 146, 193, 273, 374, 456, 512, 554, 584, 609, 624,
            635, 645, 654, 662, 672, 676, 678, 685, 690, 696,
        ],
    },
    ChartPatch {
        name: "blue",
        lab: [28.37, 15.42, -49.8],
        reflectance: [
            136, 175, 208, 244, 290, 335, 338, 302, 239, 172, 120, 86, 66, 54, 48, 45, 43, 41, 40, 40, 39,
            40, 40, 41, 42, 42, 43, 44, 44, 45, 48,
        ],
    },
    ChartPatch {
        name: "green",
        lab: [54.38, -39.72, 32.27],
        reflectance: [
            58, 59, 59, 62, 65, 70, 78, 91, 113, 140, 180, 244, 324, 363, 355, 323, 281, 238, 196, 158, 124,
            101, 89, 84, 80, 77, 75, 75, 78, 82, 88,
        ],
    },
    ChartPatch {
        name: "red",
        lab: [42.43, 51.05, 28.62],
        reflectance: [
            51, 50, 49, 49, 49, 49, 48, 47, 45, 44, 44, 44, 44, 44, 45, 47, 50, 57, 72, 109, 192, 332, 486,
            598, 654, 686, 700, 707, 718, 724, 729,
        ],
    },
    ChartPatch {
        name: "yellow",
        lab: [81.8, 2.67, 80.41],
        reflectance: [
            53, 53, 52, 53, 53, 55, 59, 75, 121, 202, 303, 394, 475, 544, 597, 630, 660, 686, 708, 726, 737,
            746, 753, 761, 768, 777, 780, 781, 785, 787, 792,
        ],
    },
    ChartPatch {
        name: "magenta",
        lab: [50.63, 51.28, -14.12],
        reflectance: [
            283, 343, 359, 350, 327, 298, 267, 239, 209, 182, 163, 146, 124, 106, 102, 107, 106, 112, 141,
            198, 279, 394, 522, 628, 696, 742, 766, 780, 791, 798, 804,
        ],
    },
    ChartPatch {
        name: "cyan",
        lab: [49.57, -29.71, -28.32],
        reflectance: [
            195, 238, 258, 281, 315, 352, 391, 434, 458, 457, 433, 392, 339, 282, 228, 180, 141, 114, 97, 88,
            80, 75, 73, 73, 73, 74, 76, 77, 75, 74, 72,
        ],
    },
    ChartPatch {
        name: "white",
        lab: [95.19, -1.03, 2.93],
        reflectance: [
            409, 671, 840, 878, 883, 886, 887, 888, 888, 888, 887, 887, 887, 887, 887, 886, 887, 888, 887,
            886, 887, 889, 891, 891, 890, 889, 889, 888, 888, 888, 888,
        ],
    },
    ChartPatch {
        name: "neutral 8",
        lab: [81.29, -0.57, 0.44],
        reflectance: [
            372, 529, 580, 585, 587, 588, 586, 583, 581, 580, 580, 580, 581, 582, 583, 583, 584, 586, 588,
            588, 588, 586, 585, 583, 580, 578, 576, 574, 572, 570, 568,
        ],
    },
    ChartPatch {
        name: "neutral 6.5",
        lab: [66.89, -0.75, -0.06],
        reflectance: [
            289, 346, 357, 359, 361, 362, 361, 358, 357, 356, 356, 356, 357, 357, 358, 358, 359, 360, 361,
            361, 360, 359, 357, 355, 353, 351, 349, 346, 345, 343, 341,
        ],
    },
    ChartPatch {
        name: "neutral 5",
        lab: [50.76, -0.13, 0.14],
        reflectance: [
            183, 199, 202, 203, 205, 205, 204, 203, 202, 202, 202, 202, 202, 203, 203, 203, 203, 204, 205,
            205, 204, 204, 203, 201, 200, 198, 197, 196, 195, 194, 192,
        ],
    },
    ChartPatch {
        name: "neutral 3.5",
        lab: [35.63, -0.46, -0.48],
        reflectance: [
            91, 94, 94, 94, 95, 95, 94, 94, 93, 93, 92, 93, 93, 93, 93, 93, 93, 93, 93, 93, 92, 92, 91, 90,
            90, 89, 89, 88, 87, 87, 86,
        ],
    },
    ChartPatch {
        name: "black",
        lab: [20.64, 0.07, -0.46],
        reflectance: [
            35, 36, 36, 36, 35, 35, 35, 35, 34, 34, 34, 34, 34, 34, 34, 34, 33, 33, 33, 33, 33, 33, 33, 33,
            33, 33, 33, 33, 33, 32, 32,
        ],
    },
];

/// The names of all patches, row by row from the upper left of the chart.
pub fn names() -> impl Iterator<Item = &'static str> {
    PATCHES.iter().map(|patch| patch.name)
}

/// The linear sRGB colour of a patch in daylight (D65), white being 1, as its maker states it. None if there
/// is no patch of this name; capitals do not count.
pub fn stated(name: &str) -> Option<[f64; 3]> {
    named(name).map(|patch| of_lab(patch.lab))
}

/// The same under a light and through a filter, curves over wavelength, from the patch's reflectance. The
/// unit is the luminance of a white diffuser in that light without the filter. Without a light it is
/// daylight.
///
/// Patches of newer charts have slightly other reflectances, which nobody published.
pub fn seen_in(name: &str, light: Option<&Curves>, filter: Option<(&Curves, usize)>) -> Option<[f64; 3]> {
    let patch = named(name)?;
    let daylight = Light::Daylight.spectrum(NARROW);
    let lit = |nm: f64| match light {
        Some(light) => light.at(&light.values[0], nm),
        None => NARROW.band_of(nm).map_or(0.0, |band| daylight[band]),
    };
    let through = |nm: f64| filter.map_or(1.0, |(filters, index)| filters.at(&filters.values[index], nm));
    let white: f64 =
        NARROW.xyz()[1].iter().zip(NARROW.means(lit)).map(|(weight, power)| weight * power).sum();
    let seen = NARROW.linear_srgb(&NARROW.means(|nm| patch.reflects(nm) * lit(nm) * through(nm)));
    Some(seen.map(|part| part / white))
}

/// Linear sRGB of CIE L*a*b* under D50, by Bradford's adaptation to D65. Colours that screens lack have
/// negative parts.
pub fn of_lab([l, a, b]: [f64; 3]) -> [f64; 3] {
    let under_d50 = Xyz::<D50, f64>::from_color_unclamped(Lab::<D50, f64>::new(l, a, b));
    let colour = LinSrgb::from_color_unclamped(Xyz::<D65, f64>::adapt_from_unclamped(under_d50));
    [colour.red, colour.green, colour.blue]
}

/// The light that a patch sends back in each band of an axis, of a light on it.
#[cfg(test)]
pub(super) fn reflected(name: &str, axis: &Axis, light: &Curves) -> Option<Vec<f64>> {
    let patch = named(name)?;
    Some(axis.means(|nm| patch.reflects(nm) * light.at(&light.values[0], nm)))
}

fn named(name: &str) -> Option<&'static ChartPatch> {
    PATCHES.iter().find(|patch| patch.name.eq_ignore_ascii_case(name))
}

impl ChartPatch {
    /// The reflectance at a wavelength (nm), linear between its values.
    fn reflects(&self, nm: f64) -> f64 {
        let at = ((nm - Axis::EIGHT.from) / STEP).clamp(0.0, (self.reflectance.len() - 1) as f64);
        let before = (at.floor() as usize).min(self.reflectance.len() - 2);
        let value = |index: usize| f64::from(self.reflectance[index]) / 1000.0;
        let share = at - before as f64;
        (1.0 - share) * value(before) + share * value(before + 1)
    }
}
