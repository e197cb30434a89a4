// Kinds of light that are kept apart: light that met no medium, by how often surfaces have reflected it,
// UNSCATTERED of them, and, if SCATTERED is 1, light that was scattered. What is shown is of the last of the
// former and of scattered light, and by surfaces of the last of all: render/src/lpv/propagation.rs.

#import shared/lpv_grid
#constant SCATTERED = 1
#constant UNSCATTERED = 2

const KINDS = UNSCATTERED + SCATTERED;

// Where a lobe is in [kinds, 3, cells].
fn lobe_index(light: u32, colour: u32, cell: u32) -> u32 {
    return (3u * light + colour) * cell_count() + cell;
}

// Where, behind the lobes, is what a cell sends out again of what collides in it.
fn again_index(cell: u32) -> u32 {
    return lobe_index(KINDS, 0u, cell);
}
