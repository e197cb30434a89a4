// Where what belongs to a froxel is in buffers.
fn froxel_index(cell: vec3u) -> u32 {
    return (cell.z * froxels.rows + cell.y) * froxels.columns + cell.x;
}
