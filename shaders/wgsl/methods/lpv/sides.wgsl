// Light that surfaces send, kept apart by the side to which they send it, before the first iteration, which
// adds it anew as do all others; and what is shown of the way to the middles of cells: render/src/lpv/sides.rs.

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
// [sides, 3, cells]: lobes
@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
// [3, cells]
@group(0) @binding(3) var<storage, read_write> shown: array<vec4f>;
// [sides, 3, cells]: flux and energy
@group(0) @binding(4) var<storage, read_write> source: array<vec4f>;
// [sides]: by how much to multiply what an iteration shows
@group(0) @binding(5) var<storage, read_write> weights: array<vec4f>;
@group(0) @binding(6) var<uniform> medium: MediumRecord;
// [cells, 3]: as media.wgsl writes it
@group(0) @binding(7) var<storage, read> media: array<vec4f>;
// [cells, 4]: as links.wgsl writes it
@group(0) @binding(8) var<storage, read> links: array<vec4u>;

const WALLS = 4u;
const MATTE = 2.0 / 3.0;
const ALONG = 0.1;

// A wall that faces a direction and sends so much energy.
struct Wall {
    normal: vec3f,
    energy: f32,
}

// The wall of a number that sends light of a flux and an energy: one that faces the flux, or across an axis.
fn wall_of(flux: vec3f, energy: f32, number: u32) -> Wall {
    let along = abs(flux);
    let sum = along.x + along.y + along.z;
    if sum <= 0.0 {
        return Wall(vec3f(0.0, 1.0, 0.0), 0.0);
    }
    let aslant = clamp((sum / (MATTE * max(energy, 1e-37)) - 1.02) / 0.2, 0.0, 1.0);
    if number == 0u {
        return Wall(normalize(flux / sum), aslant * energy);
    }
    var normal = vec3f(0.0);
    normal[number - 1u] = sign(flux[number - 1u]);
    return Wall(normal, (1.0 - aslant) * energy * along[number - 1u] / sum);
}

// What a wall sends to a neighbour, up to a factor.
fn share(offset: vec3i, normal: vec3f) -> f32 {
    let cosine = dot(normalize(vec3f(offset)), normal);
    return select(SHARES[kind_of(offset)] * max(cosine, ALONG), 0.0, cosine < -0.01);
}

fn shares(normal: vec3f) -> f32 {
    var sum = 0.0;
    for (var number = 0u; number < 27u; number++) {
        if number != LINKS {
            sum += share(neighbour(number), normal);
        }
    }
    return sum;
}

// The axis that a direction is nearest to.
fn axis_of(direction: vec3f) -> u32 {
    let along = abs(direction);
    if along.x >= along.y && along.x >= along.z {
        return 0u;
    }
    return select(2u, 1u, along.y >= along.z);
}

// What passes from a cell to one that is an offset apart, which may be none.
fn passes(begin_at: vec3i, offset: vec3i) -> f32 {
    if all(offset == vec3i(0)) {
        return 1.0;
    }
    let number = u32(offset.x + 1 + 3 * (offset.y + 1) + 9 * (offset.z + 1));
    let link = select(number - LINKS - 1u, LINKS - 1u - number, number < LINKS);
    let cell = cell_index(select(begin_at, begin_at + offset, number < LINKS));
    return f32((links[cell][link / 4u] >> (8u * (link % 4u))) & 255u) / 255.0;
}

// Light of a colour that surfels have sent into a cell: flux and energy.
fn sent_into(cell: u32, colour: u32) -> vec4f {
    let first = 12u * cell + 4u * colour;
    let all = vec4f(fixed_sum(first), fixed_sum(first + 1u), fixed_sum(first + 2u), fixed_sum(first + 3u));
    return grid.low.w * grid.low.w * all;
}

@compute @workgroup_size(64)
fn begin(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cell_count() {
        return;
    }
    if id.x < KINDS {
        weights[id.x] = vec4f(1.0);
    }
    let at = cell_at(id.x);
    for (var c = 0u; c < 3u; c++) {
        var begun = array<vec4f, KINDS>();
        var halfway = vec4f(0.0);
        for (var around = 0u; around < 27u; around++) {
            // Light of the cells beside it goes aside into it, and its own to its middle.
            let aside = neighbour(around);
            let there = at - aside;
            if !is_cell(there) {
                continue;
            }
            let cell = cell_index(there);
            let sent = sent_into(cell, c);
            if sent.w <= 0.0 {
                continue;
            }
            let own = media[3u * cell];
            let extinction = reduced_extinction() * own.w * grid.low.w;
            let passed = passes(there, aside);
            for (var number = 0u; number < WALLS; number++) {
                let wall = wall_of(sent.xyz, sent.w, number);
                let axis = axis_of(wall.normal);
                if wall.energy <= 0.0 || aside[axis] != 0 {
                    continue;
                }
                let forward = select(1, -1, wall.normal[axis] < 0.0);
                let side = 2u * axis + select(0u, 1u, forward < 0);
                let energy = wall.energy / shares(wall.normal);
                for (var link = 0u; link < 27u; link++) {
                    let offset = neighbour(link);
                    let leaves = offset[axis] == forward;
                    var lateral = offset;
                    lateral[axis] = 0;
                    let goes_aside = leaves && all(lateral == aside);
                    let is_own = around == LINKS;
                    if link == LINKS || !(is_own || goes_aside) {
                        continue;
                    }
                    let kind = kind_of(offset);
                    let light = vec4f(normalize(vec3f(offset)), 1.0) * (energy * share(offset, wall.normal));
                    if !leaves {
                        begun[side] += light;
                        continue;
                    }
                    let enters = entering(own.rgb, extinction, kind);
                    if is_own {
                        halfway += light * half_track(enters, extinction, kind)[c];
                        begun[side] += light * (0.5 * enters[c]);
                    }
                    if goes_aside {
                        begun[side] += light * (0.5 * enters[c] * passed);
                    }
                }
            }
        }
        for (var side = 0u; side < KINDS; side++) {
            source[lobe_index(side, c, id.x)] = begun[side];
            state[lobe_index(side, c, id.x)] = lobe(begun[side].xyz, begun[side].w);
        }
        shown[lobe_index(0u, c, id.x)] = halfway;
    }
}
