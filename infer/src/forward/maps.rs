//! Which feature maps a network has between its layers, and when each is needed.

use crate::{BlockSource, Layer};

/// What a layer leaves for later ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapId {
    /// What the layer of that index makes.
    Made(usize),
    /// The means of its 2x2 pixels.
    Means(usize),
}

/// A feature map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Map {
    /// Which one.
    pub id: MapId,
    /// Level of its frame.
    pub level: usize,
    /// Its channels.
    pub channels: usize,
    /// Index of the layer that writes it.
    pub born: usize,
    /// Index of the last layer that reads it.
    pub dies: usize,
}

impl MapId {
    /// Index of the layer that writes it.
    pub const fn layer(self) -> usize {
        match self {
            Self::Made(layer) | Self::Means(layer) => layer,
        }
    }
}

/// What a layer reads.
pub fn read_by(layer: &Layer) -> Vec<MapId> {
    match layer.source {
        BlockSource::Input | BlockSource::Folded => Vec::new(),
        BlockSource::Plain(from) => vec![MapId::Made(from)],
        BlockSource::Pooled(from) => vec![MapId::Means(from)],
        BlockSource::Joined { coarse, skip, .. } => vec![MapId::Made(coarse), MapId::Made(skip)],
    }
}

/// Whether a layer below reads the means of what the layer of that index makes.
pub fn has_means(layers: &[Layer], index: usize) -> bool {
    layers.iter().any(|layer| layer.source == BlockSource::Pooled(index))
}

/// All maps of a network in the order in which they are written. The last layer makes the image instead of
/// one.
pub fn maps(layers: &[Layer]) -> Vec<Map> {
    let ids = (0..layers.len()).flat_map(|index| [MapId::Made(index), MapId::Means(index)]);
    let map = |id: MapId| {
        let readers = layers.iter().enumerate().filter(|(_, layer)| read_by(layer).contains(&id));
        let dies = readers.map(|(reader, _)| reader).max()?;
        let layer = &layers[id.layer()];
        let below = usize::from(matches!(id, MapId::Means(_)));
        Some(Map { id, level: layer.level + below, channels: layer.outputs, born: id.layer(), dies })
    };
    ids.filter_map(map).collect()
}
