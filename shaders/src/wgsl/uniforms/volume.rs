//! What passes through participating media read.

use super::{Field, Layout, vec4f};

uniforms! {
    /// A medium: `render/src/scene/medium.rs`.
    MediumRecord {
        /// Scattering coefficient of each colour at density 1, 1/m; the mean cosine of the scattering angle.
        scattering: vec4f,
        /// Extinction coefficient.
        extinction: vec4f,
        /// The box's least coordinates, world space, metres; the largest density.
        low: vec4f,
        /// Its largest.
        high: vec4f,
        /// Cells along x, y and z.
        cells: vec4f,
    }

    /// What `methods/volume_shell/intervals` reads.
    Intervals {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Points of a ray's way through the medium at which density is looked up.
        steps: u32,
        /// Chooses random offsets.
        seed: u32,
    }

    /// What `methods/fog_march/march` reads.
    FogMarch {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Steps along each view ray.
        steps: u32,
        /// Chooses by how much they are shifted.
        seed: u32,
    }

    /// Which lamp a pass is of.
    OfLamp {
        /// Its number.
        number: u32,
    }

    /// What the passes of `methods/epipolar` read.
    Epipolar {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Light rays in a slice, a multiple of 64.
        light_rays: u32,
        /// Lines for which there is room.
        lines: u32,
        /// View rays that cross fewer are marched,
        least: u32,
        /// in so many steps,
        steps: u32,
        /// which this shifts.
        seed: u32,
    }

    /// What the passes of `methods/froxel` read.
    Froxels {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Pixels along an edge of a column of froxels.
        tile: u32,
        /// Columns of froxels.
        columns: u32,
        /// Their rows.
        rows: u32,
        /// Froxels in a column.
        slices: u32,
        /// Points of a froxel at which light is looked for, one behind the other.
        samples: u32,
        /// Chooses where in froxels they are.
        frame: u32,
    }

    /// Two levels of a Gaussian pyramid.
    Pyramid {
        /// Columns of the finer one.
        fine_width: u32,
        /// Its rows.
        fine_height: u32,
        /// Columns of the coarser one.
        coarse_width: u32,
        /// Its rows.
        coarse_height: u32,
    }

    /// What `methods/volume_shell/splat` and `direct` read beside the level.
    VolumeShell {
        /// Points of a ray's way through the medium at which density was looked up.
        steps: u32,
        /// Surfels nearer than this, metres, do what they would at this distance.
        nearest: f32,
    }

    /// The leaves of one run of `methods/volume_shell/splat`.
    SplatPart {
        /// Which part of them.
        index: u32,
    }

    /// The cells of a light propagation volume.
    LightGrid {
        /// The lowest corner, world space, and the edge of a cell, metres.
        low: vec4f,
        /// Cells along x, y and z, and all of them.
        size: vec4f,
    }

    /// One iteration of propagation.
    Iteration {
        /// Its number, from 0.
        number: u32,
    }

    /// How far light is propagated.
    Propagation {
        /// Metres.
        reach: f32,
    }

    /// What `methods/lpv/march` reads.
    Marching {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Steps along each view ray.
        steps: u32,
        /// Chooses by how much they are shifted.
        seed: u32,
    }
}
