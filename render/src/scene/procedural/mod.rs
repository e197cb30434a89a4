//! Seeded families of scenes: every seed of a family is another scene of its kind, the same on every run.
//!
//! Twelve families are for training and five, of other natures, for testing only; one of each is a table with
//! neutral things, of which synthetic captures are made. Scenes are in metres, compact, and rich in corners,
//! contacts and thin things, since those are what ambient occlusion is about. Counts and choices rest on
//! whole numbers; positions use the platform's sine and cosine, so they may differ in the last bit between
//! systems. Beside them there are patterns for textures and skies, since the project stands without anybody's
//! files.

mod blobs;
mod bridge;
mod capture_table;
mod cave;
mod city;
mod cloth;
mod colonnade;
mod drapery;
mod furniture;
mod grove;
mod machinery;
mod materials;
pub(super) mod noise;
mod patterns;
mod playground;
mod random;
mod rides;
mod room;
mod scene_builder;
mod shape;
mod shelves;
mod sky;
mod solids;
mod specimens;
mod stairs;
mod still_life;
mod surface;
mod sweep;
mod tabletop;
mod terrain;
mod vessels;
mod workbench;

pub use patterns::pattern;
pub use sky::sky;

use super::{Scene, SceneError};
use random::Random;
use scene_builder::SceneBuilder;

/// A kind of procedural scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Family {
    /// Rooms with furniture.
    Room,
    /// Columns, arches and groin vaults.
    Colonnade,
    /// Streets between houses with windows and balconies.
    City,
    /// Trees, bushes and grass.
    Grove,
    /// Eroded mountains with rocks.
    Terrain,
    /// Vessels, fruit and books on a table.
    StillLife,
    /// Gears, pipes, flanges and bolts.
    Machinery,
    /// Shelves full of clutter.
    Shelves,
    /// Soft organic forms.
    Blobs,
    /// Platforms, stairs and galleries.
    Stairs,
    /// Cloth draped over things.
    Drapery,
    /// Caves with dripstones and crystals.
    Cave,
    /// Slides, climbing frames and vehicles.
    Playground,
    /// Truss, trestle and suspension bridges.
    Bridge,
    /// Plain and turned things in greys on a table, in a light that is always the same: for captures.
    Tabletop,
    /// Things of other shapes in greys on the same table.
    Workbench,
    /// Things on their own, wide apart on a plain floor.
    Specimens,
}

/// What a family may be used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// Training and validation.
    Train,
    /// Testing only.
    Test,
}

/// Builds a family's scene.
type Build = fn(&mut SceneBuilder, &mut Random);

impl Family {
    /// All families, those for training first.
    pub const ALL: [Self; 17] = [
        Self::Room,
        Self::Colonnade,
        Self::City,
        Self::Grove,
        Self::Terrain,
        Self::StillLife,
        Self::Machinery,
        Self::Shelves,
        Self::Blobs,
        Self::Stairs,
        Self::Tabletop,
        Self::Specimens,
        Self::Drapery,
        Self::Cave,
        Self::Playground,
        Self::Bridge,
        Self::Workbench,
    ];

    /// The family's name in recipes and file names.
    pub fn name(self) -> &'static str {
        self.entry().0
    }

    /// What its scenes show, in a few words.
    pub const fn about(self) -> &'static str {
        match self {
            Self::Room => "rooms with furniture",
            Self::Colonnade => "columns, arches and groin vaults",
            Self::City => "streets between houses with windows and balconies",
            Self::Grove => "trees, bushes and grass",
            Self::Terrain => "eroded mountains with rocks",
            Self::StillLife => "vessels, fruit and books on a table",
            Self::Machinery => "gears, pipes, flanges and bolts",
            Self::Shelves => "shelves full of clutter",
            Self::Blobs => "soft organic forms",
            Self::Stairs => "platforms, stairs and galleries",
            Self::Drapery => "cloth draped over things",
            Self::Cave => "caves with dripstones and crystals",
            Self::Playground => "slides, climbing frames and vehicles",
            Self::Bridge => "truss, trestle and suspension bridges",
            Self::Tabletop => "plain things in greys on a table",
            Self::Specimens => "things on their own, wide apart",
            Self::Workbench => "things of other shapes in greys on the same table",
        }
    }

    /// What the family may be used for.
    pub fn split(self) -> Split {
        self.entry().1
    }

    /// The family of a name.
    ///
    /// # Errors
    /// If there is none; the error lists the names that there are.
    pub fn by_name(name: &str) -> Result<Self, SceneError> {
        Self::ALL.into_iter().find(|family| family.name() == name).ok_or_else(|| SceneError::UnknownFamily {
            name: name.to_owned(),
            known: Self::ALL.map(Self::name).join(", "),
        })
    }

    /// The family's scene of a seed, called by both, 20,000 to 300,000 triangles; on the tables for captures
    /// 8,000 and more.
    pub fn scene(self, seed: u64) -> Scene {
        let mut builder = SceneBuilder::new(format!("{}-{seed}", self.name()));
        let mut random = Random::new(self as u64, seed);
        (self.entry().2)(&mut builder, &mut random);
        builder.finish()
    }

    /// Name, use and builder.
    fn entry(self) -> (&'static str, Split, Build) {
        match self {
            Self::Room => ("room", Split::Train, room::build),
            Self::Colonnade => ("colonnade", Split::Train, colonnade::build),
            Self::City => ("city", Split::Train, city::build),
            Self::Grove => ("grove", Split::Train, grove::build),
            Self::Terrain => ("terrain", Split::Train, terrain::build),
            Self::StillLife => ("still-life", Split::Train, still_life::build),
            Self::Machinery => ("machinery", Split::Train, machinery::build),
            Self::Shelves => ("shelves", Split::Train, shelves::build),
            Self::Blobs => ("blobs", Split::Train, blobs::build),
            Self::Stairs => ("stairs", Split::Train, stairs::build),
            Self::Drapery => ("drapery", Split::Test, drapery::build),
            Self::Cave => ("cave", Split::Test, cave::build),
            Self::Playground => ("playground", Split::Test, playground::build),
            Self::Bridge => ("bridge", Split::Test, bridge::build),
            Self::Tabletop => ("tabletop", Split::Train, tabletop::build),
            Self::Specimens => ("specimens", Split::Train, specimens::build),
            Self::Workbench => ("workbench", Split::Test, workbench::build),
        }
    }
}

#[cfg(test)]
mod tests;
