//! The CIE 1931 standard observer as sums of lobes: Wyman, Sloan and Shirley 2013, "Simple Analytic
//! Approximations to the CIE XYZ Color Matching Functions", Journal of Computer Graphics Techniques 2(2), the
//! multi-lobe fit.

/// A Gaussian of two widths: how high it is, where, and how wide (standard deviation, nm) below and above.
struct Lobe(f64, f64, f64, f64);

const X: [Lobe; 3] =
    [Lobe(1.056, 599.8, 37.9, 31.0), Lobe(0.362, 442.0, 16.0, 26.7), Lobe(-0.065, 501.1, 20.4, 26.2)];
const Y: [Lobe; 2] = [Lobe(0.821, 568.8, 46.9, 40.5), Lobe(0.286, 530.9, 16.3, 31.1)];
const Z: [Lobe; 2] = [Lobe(1.217, 437.0, 11.8, 36.0), Lobe(0.681, 459.0, 26.0, 13.8)];

/// The colour matching functions x, y and z at a wavelength in nm.
pub fn matching(wavelength: f64) -> [f64; 3] {
    [sum(&X, wavelength), sum(&Y, wavelength), sum(&Z, wavelength)]
}

fn sum(lobes: &[Lobe], wavelength: f64) -> f64 {
    let value = |Lobe(height, centre, below, above): &Lobe| {
        let off = (wavelength - centre) / if wavelength < *centre { below } else { above };
        height * (-0.5 * off * off).exp()
    };
    lobes.iter().map(value).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of the standard (CIE 15:2004, Table T.4), which the fit is within 0.03 of here.
    #[test]
    fn the_fit_is_near_the_standard() {
        let standard = [
            (420.0, [0.134_38, 0.004_0, 0.645_6]),
            (450.0, [0.336_2, 0.038, 1.772_11]),
            (500.0, [0.004_9, 0.323, 0.272]),
            (555.0, [0.512_05, 1.0, 0.005_75]),
            (600.0, [1.062_2, 0.631, 0.000_8]),
            (650.0, [0.283_5, 0.107, 0.0]),
        ];
        for (wavelength, expected) in standard {
            for (value, expected) in matching(wavelength).into_iter().zip(expected) {
                assert!((value - expected).abs() < 0.03, "{wavelength} nm: {value}, not {expected}");
            }
        }
    }
}
