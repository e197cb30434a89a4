//! Curves over wavelength from files: sensors of cameras, filters, lamps.

use crate::table::{Table, TableError};
use deepshade_glow::spectrum::Axis;
use std::path::Path;

/// How wide, in nm, what goes up or down between two bands is.
const STEP: f64 = 1e-6;

/// Curves over wavelength, linear between their points.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// Where they are known, in nm, ascending.
    pub wavelengths: Vec<f64>,
    /// One list a curve, as long as `wavelengths`.
    pub values: Vec<Vec<f64>>,
}

impl Curves {
    /// The curves of a CSV file: the column `wavelength_nm` and one column a curve, at least one. Wavelengths
    /// ascend and cover 400 to 700 nm; no value is negative.
    ///
    /// # Errors
    /// If the file cannot be read or is not of that form, with its line.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let table = Table::read(path)?;
        let wavelengths = table.ascending("wavelength_nm")?;
        let (first, last) = (wavelengths[0], wavelengths[wavelengths.len() - 1]);
        if first > Axis::EIGHT.from || last < Axis::EIGHT.end() {
            return Err(table.says(format!("has {first} to {last} nm, curves must cover 400 to 700 nm")));
        }
        if let Some(name) = table.names().iter().find(|name| crate::table::holds_names(name)) {
            return Err(
                table.says(format!("has a curve called {name}, which is for names: call it otherwise"))
            );
        }
        let names = table.names().iter().filter(|name| *name != "wavelength_nm");
        let values = names.map(|name| table.not_negative(name)).collect::<Result<Vec<_>, _>>()?;
        if values.is_empty() {
            return Err(table.says("has no curve beside wavelength_nm".into()));
        }
        Ok(Self { wavelengths, values })
    }

    /// The three curves of a camera's sensor, red, green and blue.
    ///
    /// # Errors
    /// As [`Self::read`], and if there are not columns `red`, `green` and `blue` and no other.
    pub fn read_sensor(path: &Path) -> Result<Self, TableError> {
        let table = Table::read(path)?;
        let values = ["red", "green", "blue"].map(|name| table.not_negative(name));
        let curves = Self::read(path)?;
        if curves.values.len() != 3 {
            return Err(table.says("has other columns than wavelength_nm, red, green and blue".into()));
        }
        Ok(Self { values: values.into_iter().collect::<Result<_, _>>()?, ..curves })
    }

    /// A sensor for tests and for cameras whose curves nobody knows: three Gaussians about where those of
    /// consumer cameras are.
    pub fn nominal_sensor() -> Self {
        let wavelengths: Vec<f64> = (0..=60).map(|i| 400.0 + 5.0 * f64::from(i)).collect();
        let bell = |centre: f64, width: f64| {
            wavelengths.iter().map(|at| (-0.5 * ((at - centre) / width).powi(2)).exp()).collect()
        };
        let values = vec![bell(600.0, 35.0), bell(530.0, 40.0), bell(460.0, 30.0)];
        Self { wavelengths, values }
    }

    /// A linear variable filter: at each of `count` places a band of about 25 nm (half maximum), centres
    /// evenly from 400 to 700 nm (thesis, section 8.4.2).
    pub fn variable_filter(count: usize) -> Self {
        let wavelengths: Vec<f64> = (0..=120).map(|i| 400.0 + 2.5 * f64::from(i)).collect();
        let deviation = 25.0 / (8.0 * std::f64::consts::LN_2).sqrt();
        let place = |index: usize| {
            let centre = 400.0 + 300.0 * index as f64 / (count - 1).max(1) as f64;
            wavelengths.iter().map(|at| 0.8 * (-0.5 * ((at - centre) / deviation).powi(2)).exp()).collect()
        };
        Self { values: (0..count).map(place).collect(), wavelengths }
    }

    /// A curve that has a value all over each of the eight bands.
    pub fn of_bands(values: Vec<f64>) -> Self {
        let Axis { from, width, .. } = Axis::EIGHT;
        let mut curve = Self { wavelengths: Vec::new(), values: vec![Vec::new()] };
        for (band, value) in values.into_iter().enumerate() {
            let begin = from + width * band as f64;
            let end = if band + 1 == Axis::EIGHT.count { begin + width } else { begin + width - STEP };
            curve.wavelengths.extend([begin, end]);
            curve.values[0].extend([value; 2]);
        }
        curve
    }

    /// The mean of each curve over each band.
    pub fn bands(&self, axis: Axis) -> Vec<Vec<f64>> {
        self.values.iter().map(|values| axis.means(|wavelength| self.at(values, wavelength))).collect()
    }

    /// A curve's value at a wavelength, that of the nearer end outside.
    pub(crate) fn at(&self, values: &[f64], wavelength: f64) -> f64 {
        let above = self.wavelengths.partition_point(|at| *at < wavelength);
        if above == 0 || above == values.len() {
            return values[above.min(values.len() - 1)];
        }
        let (low, high) = (self.wavelengths[above - 1], self.wavelengths[above]);
        let share = (wavelength - low) / (high - low);
        (1.0 - share) * values[above - 1] + share * values[above]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_linear_between_their_points() {
        let curves = Curves { wavelengths: vec![400.0, 600.0, 700.0], values: vec![vec![0.0, 2.0, 1.0]] };
        let bands = &curves.bands(Axis::EIGHT)[0];
        let expected = Axis::EIGHT
            .means(|nm| if nm < 600.0 { (nm - 400.0) / 100.0 } else { 2.0 - (nm - 600.0) / 100.0 });
        assert!(bands.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{bands:?}");
    }

    #[test]
    fn sensors_are_read_by_the_names_of_their_columns() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("camera.csv");
        let read = |text: &str| {
            std::fs::write(&path, text).expect("written");
            Curves::read_sensor(&path)
        };
        let curves = read("blue,wavelength_nm,green,red\n1,400,2,3\n4,700,5,6\n").expect("curves");
        assert_eq!(curves.values, [[3.0, 6.0], [2.0, 5.0], [1.0, 4.0]]);
        let fault = |text| read(text).expect_err("a fault").to_string();
        assert!(fault("wavelength_nm,red,green,blue\n450,1,1,1\n700,1,1,1\n").contains("must cover"));
        assert!(fault("wavelength_nm,red,green\n400,1,1\n700,1,1\n").contains("blue"));
        assert!(fault("wavelength_nm,red,green,blue\n400,1,1,1\n700,1,-1,1\n").contains(":3: green"));
        let named = fault("wavelength_nm,red,green,blue,patch\n400,1,1,1,a\n700,1,1,1,b\n");
        assert!(named.contains("patch, which is for names"), "{named}");
    }
}
