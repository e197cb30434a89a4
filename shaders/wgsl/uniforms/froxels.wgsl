/// What the passes of `methods/froxel` read.
struct Froxels {
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
