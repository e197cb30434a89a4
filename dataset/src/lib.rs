//! Training pairs on disk: g-buffers of sampled views with the truth of an effect.
//!
//! A [`Recipe`] says what to make. [`generate()`] makes it: one EXR file a view and a manifest that tells
//! where each comes from. [`verify()`] checks it, [`contact_sheet()`] shows it, [`Dataset`] reads it,
//! [`augment()`] turns and mirrors what was read. A [`TestSet`] is for evaluation: truth with far more
//! samples, on a share of the image's tiles. A [`Stream`] is pairs without end that are rendered while
//! somebody trains on them, and never lie on a disk.

pub mod augment;
pub mod capture;
pub mod contact_sheet;
pub mod error;
pub mod font;
pub mod generate;
pub mod holder;
pub mod identity;
mod journal;
pub mod lock;
pub mod manifest;
pub mod origin;
pub mod plan;
pub mod progress;
mod random;
pub mod read;
pub mod recipe;
pub mod scene;
pub mod sensor;
pub mod shard;
#[cfg(test)]
mod shipped;
pub mod stopwatch;
pub mod stream;
pub mod target;
pub mod testset;
pub mod truth;
pub mod vary;
pub mod verify;
pub mod views;

pub use augment::{Symmetry, augment};
pub use capture::{Capture, CaptureError};
pub use contact_sheet::{contact_sheet, test_sheet};
pub use deepshade_render::methods::estimate::{EstimateError, EstimateInputs, Estimator, with_estimates};
pub use error::DatasetError;
pub use generate::{Summary, generate, generate_by, generate_shard};
pub use manifest::{Manifest, PairRecord};
pub use origin::{Origin, Out, data_version};
pub use plan::TrainingSplit;
pub use read::{Dataset, Pair};
pub use recipe::{Radius, Recipe};
pub use scene::{SceneOrCapture, SceneRecord};
pub use sensor::Sensor;
pub use shard::Shard;
pub use shard::merge::merge;
pub use stream::Stream;
pub use target::TargetMethod;
pub use testset::{TestFrame, TestSet};
pub use vary::{Props, StagedScene, Variation, Vary};
pub use verify::{Fault, Report, verify};
