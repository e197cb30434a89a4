// Steady light before the first iteration, which adds it anew as do all others: what surfaces have sent into
// cells, and where what sets out from their middles is written, beside what is shown of the way there.

#import shared/lpv_fixed
#import shared/lpv_flight
#import shared/lpv_grid
#import shared/lpv_kinds
#import shared/lpv_lattice
#import shared/lpv_lobe
#import shared/lpv_medium
#import uniforms/light_grid
#import uniforms/medium_record

@group(0) @binding(0) var<uniform> grid: LightGrid;
// [cells, 3, 4, 2]: flux and energy of each colour, as lpv_send.wgsl has them
@group(0) @binding(1) var<storage, read> sums: array<u32>;
// [kinds, 3, cells]: lobes
@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
// [3, cells]
@group(0) @binding(3) var<storage, read_write> shown: array<vec4f>;
// [kinds, 3, cells]: flux and energy
@group(0) @binding(4) var<storage, read_write> source: array<vec4f>;
// [kinds]: by how much to multiply what an iteration shows
@group(0) @binding(5) var<storage, read_write> weights: array<vec4f>;
@group(0) @binding(6) var<uniform> medium: MediumRecord;
// [cells, 3]: as media.wgsl writes it
@group(0) @binding(7) var<storage, read> media: array<vec4f>;

// Light of a colour that has been sent into a cell: flux and energy.
fn sent_into(cell: u32, colour: u32) -> vec4f {
    let first = 12u * cell + 4u * colour;
    let all = vec4f(fixed_sum(first), fixed_sum(first + 1u), fixed_sum(first + 2u), fixed_sum(first + 3u));
    return grid.low.w * grid.low.w * all;
}

// Light of a kind and a colour that sets out in each iteration.
fn set_out(light: u32, colour: u32, cell: u32, sent: vec4f) {
    let index = lobe_index(light, colour, cell);
    source[index] = sent;
    state[index] = lobe(sent.xyz, sent.w);
}
