//! A network on images of one size: its feature maps, used again from image to image.

use super::conv;
use super::operand::{Image, Operand};
use super::{Network, PackedLayer, conv_shape, correction, filter};
use crate::forward::{ForwardError, Tile, Tiling};
use crate::{Activation, BlockSource, Head};
use deepshade_shaders::Planes;
use std::borrow::Cow;
use web_time::Instant;

/// Most bytes of feature maps, unless the caller wants otherwise.
pub const MOST_BYTES: u64 = 1 << 30;

/// A network on images of one size.
#[derive(Clone, Debug)]
pub struct CpuPlan {
    network: Network,
    size: [usize; 2],
    tiling: Tiling,
    last_level: usize,
    /// What each layer makes of a tile, `[outputs, height, width]` of its level.
    maps: Vec<Vec<f32>>,
}

impl CpuPlan {
    pub(super) fn new(network: Network, size: [usize; 2], most: u64) -> Result<Self, ForwardError> {
        let [height, width] = size;
        let length = |packed: &PackedLayer, frame| conv_shape(&packed.layer, frame).made();
        let bytes =
            |frame| network.packed_layers.iter().map(|packed| 4 * length(packed, frame) as u64).sum::<u64>();
        let memory = ForwardError::Memory { width, height, limit: most };
        if height == 0 || width == 0 {
            return Err(memory);
        }
        let tiling = Tiling::new(&network.spec, size, |frame| bytes(frame) <= most).ok_or(memory)?;
        let maps =
            network.packed_layers.iter().map(|packed| vec![0.0; length(packed, tiling.frame)]).collect();
        let last_level = network.spec.last_level();
        Ok(Self { network, size, tiling, last_level, maps })
    }

    /// As [`Network::run`], in this plan's room.
    ///
    /// # Errors
    /// If the input is not the spec's.
    ///
    /// # Panics
    /// If the input is of another size than the plan.
    pub fn run(&mut self, input: &Planes) -> Result<Planes, ForwardError> {
        self.check(input)?;
        let mut made = self.last_map();
        for tile in 0..self.tiling.tiles.len() {
            let input = self.window(input, tile);
            (0..self.maps.len()).for_each(|layer| self.run_layer(layer, &input));
            self.keep(tile, &mut made);
        }
        Ok(self.image(input, made))
    }

    /// Room for what the last block makes of the whole image, on its level.
    fn last_map(&self) -> Planes {
        let [height, width] = self.size.map(|size| size.div_ceil(1 << self.last_level));
        Planes::filled(self.network.spec.last_channels(), height, width, 0.0)
    }

    /// The network's image, given what its last block makes.
    fn image(&self, input: &Planes, made: Planes) -> Planes {
        let spec = &self.network.spec;
        match spec.head {
            Head::Image if self.last_level == 0 => made,
            Head::Image => filter::unfolded(&made, self.last_level, self.size),
            Head::Filter(filter) => {
                filter::filtered(spec, filter, input, &filter::unfolded(&made, self.last_level, self.size))
            }
            Head::Correction(correction) => correction::corrected(spec, correction, input, &made),
        }
    }

    /// What every layer makes, as [`reference::layers`](crate::reference::layers) gives it; none if in tiles.
    ///
    /// # Errors
    /// If the input is not the spec's.
    ///
    /// # Panics
    /// If the input is of another size than the plan.
    pub fn run_layers(&mut self, input: &Planes) -> Result<Option<Vec<Activation>>, ForwardError> {
        let image = self.run(input)?;
        if self.tiling.tiles.len() > 1 {
            return Ok(None);
        }
        let made = |(packed, map): (&PackedLayer, &Vec<f32>)| {
            let [height, width] = self.tiling.frame.map(|size| size >> packed.layer.level);
            let planes = Planes::from_data(packed.layer.outputs, height, width, map.clone());
            Activation { layer: packed.layer.name.clone(), planes }
        };
        let mut made: Vec<Activation> = self.network.packed_layers.iter().zip(&self.maps).map(made).collect();
        made.iter_mut().next_back().into_iter().for_each(|last| last.planes = image.clone());
        Ok(Some(made))
    }

    /// How long each layer takes, by name, milliseconds; of all tiles together, the last one with the filter.
    ///
    /// # Errors
    /// If the input is not the spec's.
    ///
    /// # Panics
    /// If the input is of another size than the plan.
    pub fn layer_times(&mut self, input: &Planes) -> Result<Vec<(String, f64)>, ForwardError> {
        self.check(input)?;
        let names = self.network.packed_layers.iter().map(|packed| packed.layer.name.clone());
        let mut times: Vec<(String, f64)> = names.map(|name| (name, 0.0)).collect();
        let mut made = self.last_map();
        for tile in 0..self.tiling.tiles.len() {
            let input = self.window(input, tile);
            for (layer, (_, time)) in times.iter_mut().enumerate() {
                let start = Instant::now();
                self.run_layer(layer, &input);
                *time += start.elapsed().as_secs_f64() * 1e3;
            }
            self.keep(tile, &mut made);
        }
        let start = Instant::now();
        self.image(input, made);
        if let Some((_, time)) = times.last_mut() {
            *time += start.elapsed().as_secs_f64() * 1e3;
        }
        Ok(times)
    }

    /// Number of tiles in which images are run; 1 if as a whole.
    pub fn tiles(&self) -> usize {
        self.tiling.tiles.len()
    }

    fn check(&self, input: &Planes) -> Result<(), ForwardError> {
        let (expected, found) = (self.network.spec.input_channels(), input.channels());
        assert_eq!([input.height(), input.width()], self.size, "size of the input");
        if expected == found { Ok(()) } else { Err(ForwardError::Input { expected, found }) }
    }

    /// What a tile sees of the input: all of its frame that lies in the image.
    fn window<'a>(&self, input: &'a Planes, tile: usize) -> Cow<'a, Planes> {
        if self.tiling.tiles.len() == 1 {
            return Cow::Borrowed(input);
        }
        let Tile { origin: [top, left], .. } = self.tiling.tiles[tile];
        let [height, width] = self.tiling.frame;
        let (rows, columns) = (height.min(self.size[0] - top), width.min(self.size[1] - left));
        Cow::Owned(input.window(top, left, rows, columns))
    }

    fn run_layer(&mut self, index: usize, input: &Planes) {
        let Network { spec, packed_layers } = &self.network;
        let packed = &packed_layers[index];
        let frame = self.tiling.frame;
        let (made, rest) = self.maps.split_at_mut(index);
        let map = |of: usize| {
            let [height, width] = frame.map(|size| size >> packed_layers[of].layer.level);
            Image { data: &made[of], channels: packed_layers[of].layer.outputs, height, width }
        };
        let (channels, height, width) = (input.channels(), input.height(), input.width());
        let input = Image { data: input.data(), channels, height, width };
        let operand = match packed.layer.source {
            BlockSource::Input => Operand::Plain(input),
            BlockSource::Folded => Operand::Folded(input),
            BlockSource::Plain(from) => Operand::Plain(map(from)),
            BlockSource::Pooled(from) => Operand::Pooled(map(from)),
            BlockSource::Joined { coarse, skip, .. } => {
                Operand::Joined { coarse: map(coarse), fine: map(skip), order: Cow::Borrowed(&packed.order) }
            }
        };
        let leak = if packed.layer.activation { spec.leak } else { 1.0 };
        let shape = conv_shape(&packed.layer, frame);
        conv::forward(shape, &operand, &packed.weights, &packed.bias, leak, &mut rest[0]);
    }

    /// Copies what a tile makes out of the last layer's map.
    fn keep(&self, tile: usize, whole: &mut Planes) {
        let Tile { origin, keep } = &self.tiling.tiles[tile];
        let side = 1 << self.last_level;
        let [top, left] = origin.map(|at| at / side);
        let [rows, columns] = keep.clone().map(|kept| kept.start / side..kept.end.div_ceil(side));
        let [height, width] = self.tiling.frame.map(|size| size / side);
        let whole_width = whole.width();
        let map = &self.maps[self.maps.len() - 1];
        for (channel, plane) in map.chunks_exact(height * width).enumerate() {
            for row in rows.clone() {
                let made = &plane[(row - top) * width + columns.start - left..][..columns.len()];
                whole.plane_mut(channel)[row * whole_width..][columns.clone()].copy_from_slice(made);
            }
        }
    }
}
