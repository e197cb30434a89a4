// Shell splatting (thesis 4.2.2) of one level, turned round: each pixel of a sub-buffer adds up what the
// surfels do to it that this sub-buffer gets, one of 4^l that stands for all, and in whose shell it is. A
// tree over the surfels leaves out those that do not reach it, so the work is that of splats, without
// blending, in an order that is always the same.

#import shared/bounded
#import shared/interleaved
#import shared/surfel
#import shared/surfel_record
#import shared/surfel_tree
#import shared/surfel_walk
#import uniforms/splat_level
#constant HEIGHT = 8

@group(0) @binding(0) var<uniform> level: SplatLevel;
@group(0) @binding(4) var<storage, read> totals: Totals;
@group(0) @binding(5) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(6) var<storage, read> nodes: array<Node>;
// [CHANNELS, height, width]
@group(0) @binding(7) var<storage, read_write> sums: array<f32>;

// What the walk asks nodes about: the surface of a pixel.
alias Query = Receiver;

// How far surfels of a node, or one alone, do something to a receiver on this level.
fn outer(distance: f32, receiver: Receiver) -> f32 {
    return select(min(receiver.reach, distance * level.farthest), receiver.reach, level.last == 1u);
}

// Whether a surfel below a node may do something to a receiver: not if all are as good as not there.
fn reaches(node: Node, receiver: Query) -> bool {
    let gap = max(max(receiver.position - node.high.xyz, node.low.xyz - receiver.position), vec3f(0.0));
    let reach = outer(node.low.w, receiver);
    return node.low.w > 0.0 && dot(gap, gap) <= reach * reach;
}

@compute @workgroup_size(TILE, TILE)
fn splat(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let sub_buffer = group.z;
    let pixel = interleaved_pixel(sub_buffer, group.xy * TILE + local.xy, level.level, level.seed);
    if any(pixel >= vec2u(level.width, level.height)) {
        return;
    }
    let pixels = level.width * level.height;
    let at = pixel.y * level.width + pixel.x;
    var sum = nothing();
    let receiver = receiver_at(at, pixels);
    if receiver.reach > 0.0 {
        let leaves = bounded(level.level, pixel);
        var walk = next_leaf(Walk(HEIGHT, 0u), leaves, receiver);
        while goes_on(walk) {
            let first = first_surfel(walk.height, walk.index) + sub_buffer;
            for (var i = 0u; i < LEAF; i++) {
                let which = first + (i << (2u * leaves));
                if which >= totals.kept {
                    break;
                }
                let surfel = surfels[which];
                let way = surfel.place - receiver.position;
                let squared = dot(way, way);
                let distance = surfel_radius(surfel);
                let inner = distance * level.nearest;
                let farthest = outer(distance, receiver);
                if squared >= inner * inner && squared < farthest * farthest {
                    sum = added(sum, which, way, squared, receiver);
                }
            }
            walk = next_leaf(after(walk), leaves, receiver);
        }
    }
    write_sum(sum * level.stands_for, at, pixels);
}
