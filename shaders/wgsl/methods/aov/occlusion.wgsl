// What facets occlude of a pixel's hemisphere, added up (McGuire 2010), one slice of the facets after the
// other. A slice is below one node of the tree over them: few enough that no driver's bound of loops cuts the
// walk short.

#import shared/facet
#import shared/facet_form_factor
#import shared/surface
#import shared/surface_valid
#import shared/surfel
#import shared/surfel_patch_record
#import shared/surfel_tree
#import shared/surfel_walk
#import uniforms/facet_slice
#constant HEIGHT = 10
#constant SLICE = 4

/// What `methods/aov/occlusion` reads.
struct FacetSum {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// How far the effect reaches, metres.
    reach: f32,
    /// What is where no surface is seen.
    background: f32,
}

@group(0) @binding(0) var<uniform> image_size: FacetSum;
@group(0) @binding(4) var<uniform> slice: FacetSlice;
@group(0) @binding(5) var<storage, read> facets: array<Facet>;
@group(0) @binding(6) var<storage, read> nodes: array<Node>;
// [height, width]
@group(0) @binding(7) var<storage, read_write> image: array<f32>;

const TAU = 6.2831853;
// What an endless sum hides.
const MOST_HIDDEN = 0.7;

// The facets up to the end of the slice, as if there were no others.
var<private> totals: Totals;

// What the walk asks nodes about.
struct Query {
    point: vec3f,
    normal: vec3f,
}

// Whether something below a node may be within reach and above the tangent plane.
fn reaches(node: Node, query: Query) -> bool {
    let gap = max(max(query.point - node.high.xyz, node.low.xyz - query.point), vec3f(0.0));
    let highest = select(node.low.xyz, node.high.xyz, query.normal > vec3f(0.0)) - query.point;
    return dot(gap, gap) < image_size.reach * image_size.reach && dot(highest, query.normal) > 0.0;
}

fn occluded(query: Query) -> f32 {
    var sum = 0.0;
    var walk = next_leaf(Walk(SLICE, slice.index), 0u, query);
    while goes_on(walk) {
        let first = first_surfel(0u, walk.index);
        for (var i = first; i < min(first + LEAF, totals.kept); i++) {
            let facet = facets[i];
            let corners = mat3x3f(
                point(facet.a) - query.point, point(facet.b) - query.point, point(facet.c) - query.point
            );
            let share = facet_form_factor(corners, part_is_open(facet.part), query.normal, image_size.reach);
            sum += part_coverage(facet.part) * share;
        }
        walk = next_leaf(after(walk), 0u, query);
    }
    return sum;
}

// What is open, from a sum in which what hides behind something counts as well.
fn openness(sum: f32) -> f32 {
    return 1.0 - MOST_HIDDEN * (1.0 - exp(-sum / MOST_HIDDEN));
}

@compute @workgroup_size(TILE, TILE)
fn occlude(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= image_size.width || id.y >= image_size.height {
        return;
    }
    let at = id.y * image_size.width + id.x;
    if !surface_valid(at) {
        image[at] = image_size.background;
        return;
    }
    let pixels = image_size.width * image_size.height;
    let normal = surface_normal(at, pixels);
    totals.kept = min(arrayLength(&facets), first_surfel(SLICE, slice.index + 1u));
    let before = select(image[at], 0.0, slice.index == 0u);
    let sum = before + occluded(Query(lifted(surface_position(at, pixels), normal, image_size.reach), normal));
    image[at] = select(sum, openness(sum), slice.last == 1u);
}
