//! What the passes of phosphorescence read.

use super::{Field, Layout, vec4f};

uniforms! {
    /// A triangle whose surface keeps light: `shared/glow_tile.wgsl`.
    GlowTile {
        /// Its first corner, of the vertices that are drawn.
        corner_0: u32,
        /// Its second corner.
        corner_1: u32,
        /// Its third corner.
        corner_2: u32,
        /// Its first texel.
        first: u32,
        /// Steps between texels along an edge.
        divisions: u32,
        /// Which paint it has.
        paint: u32,
        /// The mesh that it is part of, as object ids count them.
        object: u32,
        /// Fills up.
        padding: u32,
    }

    /// A state of a paint: `glow/src/paint.rs`.
    PaintState {
        /// Excitation rate by irradiance of 1 of each colour, re-radiation rate, per second.
        rates: vec4f,
        /// Radiance where all is excited; the share that is at first.
        emission: vec4f,
    }

    /// A level of the tree over tiles.
    GlowLevel {
        /// Its nodes.
        nodes: u32,
        /// The nodes, or tiles, of the level below.
        children: u32,
        /// Its first node.
        first: u32,
        /// The first node of the level below.
        first_child: u32,
    }

    /// What `methods/phosphor/glassner` reads.
    GlowSamples {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Moments that are drawn of each state.
        samples: u32,
        /// Chooses them.
        seed: u32,
    }

    /// A stretch of the past in `methods/phosphor/glassner`.
    GlowStretch {
        /// From how many seconds ago on.
        since: f32,
        /// Up to how many.
        until: f32,
        /// Whether what it gives is added to the image (1).
        adds: u32,
        /// The first of the samples that are drawn.
        first: u32,
        /// How many are drawn.
        count: u32,
    }

    /// The cells of a medium that keeps light.
    GlowCells {
        /// The lowest corner of their box, world space, metres.
        low: vec4f,
        /// The highest.
        high: vec4f,
        /// How many there are along x, y and z.
        cells: vec4f,
    }
}
