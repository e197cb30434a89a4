//! Densities from files: Mitsuba's volumes (`.vol`), and descriptions (`.toml`) of an array or of weather,
//! with the box that they fill:
//!
//! ```toml
//! [array]                    # or [volume] with the `file` of a .vol, or [weather], as `Weather` has it, with `cells`
//! file = "smoke.npy"         # along the longest edge
//!
//! [box]                      # without it, the volume's own or the scene's
//! min = [-1.0, 0.0, -1.0]
//! max = [1.0, 2.0, 1.0]
//! ```
//!
//! Files that it names are in its folder or below.
//!
//! OpenVDB is not read: the one crate that reads it is no longer kept. Its own Python module makes an array
//! of a grid.

use super::array::{Array, Cells};
use super::{DensityGrid, MediumError, Weather};
use crate::scene::{Bounds, file};
use deepshade_shaders::names::with_meant;
use glam::Vec3;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Cells of weather along the longest edge of its box, where none are stated.
const CELLS: usize = 64;

/// Densities of a file, which may change with time.
#[derive(Clone, Debug, PartialEq)]
pub struct DensityFile {
    path: PathBuf,
    source: DensitySource,
    bounds: Option<Bounds>,
}

#[derive(Clone, Debug, PartialEq)]
enum DensitySource {
    Grid(DensityGrid),
    Cells(Cells),
    Weather { weather: Weather, cells: usize },
}

/// What a description says.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    array: Option<Array>,
    volume: Option<Volume>,
    weather: Option<DescribedWeather>,
    #[serde(rename = "box")]
    bounds: Option<Corners>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Volume {
    file: PathBuf,
}

#[derive(Deserialize)]
struct DescribedWeather {
    #[serde(default = "cells")]
    cells: usize,
    #[serde(flatten)]
    weather: Weather,
}

fn cells() -> usize {
    CELLS
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Corners {
    min: Vec3,
    max: Vec3,
}

impl DensityFile {
    /// Reads a volume or a description, and what it names.
    ///
    /// # Errors
    /// If a file is missing, damaged, of another kind, or says what cannot be, or a description names one
    /// that is not in its folder.
    pub fn read(path: &Path) -> Result<Self, MediumError> {
        let ends = |ending: &str| path.extension().is_some_and(|end| end.eq_ignore_ascii_case(ending));
        if ends("vol") {
            let source = DensitySource::Grid(DensityGrid::read_vol(path, None)?);
            return Ok(Self { path: path.to_owned(), source, bounds: None });
        }
        let invalid = |what: String| MediumError::File { path: path.to_owned(), what };
        if !ends("toml") {
            return Err(invalid("is neither a volume (.vol) nor a description (.toml)".to_owned()));
        }
        let text = file::text(path).map_err(|source| MediumError::Io { path: path.to_owned(), source })?;
        let Description { array, volume, weather, bounds } =
            toml::from_str(&text).map_err(|error| invalid(with_meant(&error.to_string())))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let beside = |name: &Path| file::beside(folder, Path::new(""), name).map_err(invalid);
        let source = match (array, volume, weather) {
            (Some(array), None, None) => DensitySource::Cells(array.read(&beside(&array.file)?)?),
            (None, Some(Volume { file }), None) => {
                DensitySource::Grid(DensityGrid::read_vol(&beside(&file)?, None)?)
            }
            (None, None, Some(DescribedWeather { cells, weather })) => {
                DensitySource::Weather { weather, cells }
            }
            _ => return Err(invalid("needs one of [array], [volume] and [weather]".to_owned())),
        };
        Ok(Self {
            path: path.to_owned(),
            source,
            bounds: bounds.map(|Corners { min, max }| Bounds { min, max }),
        })
    }

    /// The grid at a time, seconds; in a scene's box where the file states none.
    ///
    /// # Errors
    /// As [`DensityGrid::new`] and [`Weather::grid`].
    pub fn grid(&self, scene: Bounds, time: f32) -> Result<DensityGrid, MediumError> {
        let bounds = self.bounds.unwrap_or(scene);
        match &self.source {
            DensitySource::Grid(grid) => {
                self.bounds.map_or_else(|| Ok(grid.clone()), |bounds| grid.moved(bounds))
            }
            DensitySource::Cells(Cells { size, values }) => {
                let of_file = |error: MediumError| match error {
                    MediumError::Density { .. } => {
                        MediumError::File { path: self.path.clone(), what: error.to_string() }
                    }
                    other => other,
                };
                DensityGrid::new(bounds, *size, values.clone()).map_err(of_file)
            }
            DensitySource::Weather { weather, cells } => weather.grid(bounds, *cells, time),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::medium::{WeatherKind, write_vol};

    const UNIT: Bounds = Bounds { min: Vec3::ZERO, max: Vec3::ONE };
    const OTHER: Bounds = Bounds { min: Vec3::new(-1.0, 0.0, 0.0), max: Vec3::new(1.0, 2.0, 3.0) };

    /// What is read of a description, in a folder with raw numbers of eight cells.
    fn read(text: &str) -> Result<DensityFile, String> {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("eight.raw"), [0, 51, 102, 153, 204, 255, 0, 51]).expect("written");
        let path = folder.path().join("medium.toml");
        std::fs::write(&path, text).expect("written");
        DensityFile::read(&path).map_err(|error| error.to_string())
    }

    const EIGHT: &str = "[array]\nfile = \"eight.raw\"\ncells = [2, 2, 2]\nnumbers = \"u8\"\nscale = 10.0\n";
    const CLOUDS: &str =
        "[weather]\nkind = \"clouds\"\nseed = 7\nbillow = 0.5\ncover = 0.6\nwind = [1.0, 0.0, 0.0]\n";

    #[test]
    fn arrays_fill_their_box_or_the_scenes() {
        let grid = read(EIGHT).expect("a file").grid(UNIT, 3.0).expect("a grid");
        assert_eq!((grid.bounds(), grid.size(), grid.largest()), (UNIT, [2; 3], 10.0));
        assert_eq!(grid.at(Vec3::new(0.75, 0.25, 0.25)), 2.0);
        let boxed = format!("{EIGHT}[box]\nmin = [-1.0, 0.0, 0.0]\nmax = [1.0, 2.0, 3.0]\n");
        assert_eq!(read(&boxed).expect("a file").grid(UNIT, 0.0).expect("a grid").bounds(), OTHER);
    }

    #[test]
    fn weather_changes_with_time() {
        let clouds = read(CLOUDS).expect("a file");
        let at = |time| clouds.grid(OTHER, time).expect("clouds");
        let weather = Weather {
            kind: WeatherKind::Clouds,
            seed: 7,
            billow: 0.5,
            cover: 0.6,
            wind: Vec3::X,
            churn: 0.0,
        };
        assert_eq!(at(0.5), weather.grid(OTHER, CELLS, 0.5).expect("clouds"));
        assert_ne!(at(0.5), at(0.0));
        let coarse = CLOUDS.replace("seed", "cells = 9\nseed");
        assert_eq!(read(&coarse).expect("a file").grid(OTHER, 0.0).expect("clouds").size(), [6, 6, 9]);
    }

    #[test]
    fn volumes_state_their_box() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.vol");
        write_vol(&path, OTHER, [1, 1, 2], 1, &[0.5, 1.0]).expect("written");
        let grid = DensityFile::read(&path).expect("a file").grid(UNIT, 0.0).expect("a grid");
        assert_eq!((grid.bounds(), grid.values()), (OTHER, &[0.5, 1.0][..]));
        let moved = folder.path().join("moved.toml");
        let described = "[volume]\nfile = \"a.vol\"\n[box]\nmin = [0.0, 0.0, 0.0]\nmax = [1.0, 1.0, 1.0]\n";
        std::fs::write(&moved, described).expect("written");
        let grid = DensityFile::read(&moved).expect("a file").grid(OTHER, 0.0).expect("a grid");
        assert_eq!((grid.bounds(), grid.values()), (UNIT, &[0.5, 1.0][..]));
    }

    #[test]
    fn what_a_description_cannot_say_is_named() {
        let both = format!("{EIGHT}{CLOUDS}");
        for (text, expected) in [
            ("", "needs one of [array], [volume] and [weather]"),
            (&*both, "needs one of [array], [volume] and [weather]"),
            (&CLOUDS.replace("clouds", "snow"), "snow"),
            (&CLOUDS.replace("cover", "covers"), "cover"),
            (&EIGHT.replace("scale", "scales"), "scales"),
            (&EIGHT.replace("u8", "u9"), "u9"),
            (&EIGHT.replace("eight.raw", "none.raw"), "none.raw: "),
            (
                &EIGHT.replace("eight.raw", "../eight.raw"),
                "medium.toml: `../eight.raw` leads out of the folder",
            ),
            ("[volume]\nfile = \"/dev/zero\"\n", "medium.toml: `/dev/zero` leads out of the folder"),
            ("[box]\nmin = 1\nmax = 2\n", "medium.toml: "),
            ("[array", "medium.toml: "),
        ] {
            let said = read(text).expect_err(expected);
            assert!(said.contains(expected), "{said}: not {expected}");
        }
        let nan = read(&EIGHT.replace("10.0", "nan")).expect("a file").grid(UNIT, 0.0);
        let nan = nan.expect_err("no number").to_string();
        assert!(nan.contains("cell (0, 0, 0)") && nan.contains("medium.toml"), "{nan}");
        let flat = format!("{EIGHT}[box]\nmin = [0.0, 0.0, 0.0]\nmax = [1.0, 0.0, 1.0]\n");
        let flat = read(&flat).expect("a file").grid(UNIT, 0.0);
        assert!(matches!(flat, Err(MediumError::Box(_))));
        assert!(
            DensityFile::read(Path::new("smoke.vdb"))
                .expect_err("a vdb")
                .to_string()
                .contains("smoke.vdb: is")
        );
    }

    #[test]
    fn a_description_that_is_no_plain_file_is_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("medium.toml");
        std::fs::create_dir(&path).expect("a folder");
        let said = DensityFile::read(&path).expect_err("a folder").to_string();
        assert!(said.contains("medium.toml: is not a plain file"), "{said}");
    }
}
