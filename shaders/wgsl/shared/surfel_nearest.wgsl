// The nearest surfel along a ray. The ray walks the tree from the nearest box on, and leaves out what begins
// behind what it has met. Passes bind `bounces`, `totals`, `surfels` and `nodes`.

#import shared/bounced_none
#import shared/inverse_direction
#import shared/surfel
#import shared/surfel_record
#import shared/surfel_tree
#import uniforms/bounces
#constant HEIGHT = 8

// Sine of the least angle between the way to a surfel and either surface: the point's own surface does not
// hide it. Surfels' normals are rounded by nearly as much.
const LEAST_SINE = 4.2e-3;
// Rounding may not lose what is met at a box's corner.
const SLACK = 1.00001;
// Farther than any box.
const NEVER = 3.0e38;
// Nodes that wait: three of each height, and the one that is entered.
const WAITING = 3u * HEIGHT + 1u;

struct Ray {
    origin: vec3f,
    // Of the surface that it starts from; zero between surfaces.
    normal: vec3f,
    direction: vec3f,
}

// What a ray has met so far, and how far along.
struct Hit {
    distance: f32,
    surfel: u32,
}

// A node that a ray has yet to enter, and where it does.
struct Waiting {
    height: u32,
    index: u32,
    enters: f32,
}

var<private> waiting: array<Waiting, WAITING>;

// Where a ray enters the box of a node, NEVER if it does not before `until`. Disks reach beyond the box by
// their radius. `inverse` is one over its direction's components.
fn entered(height: u32, index: u32, origin: vec3f, inverse: vec3f, until: f32) -> f32 {
    if first_surfel(height, index) >= totals.kept {
        return NEVER;
    }
    let node = nodes[node_index(height, index)];
    let widened = node.low.w * bounces.cover;
    let a = (node.low.xyz - widened - origin) * inverse;
    let b = (node.high.xyz + widened - origin) * inverse;
    let first = min(a, b);
    let last = max(a, b);
    let enters = max(max(first.x, first.y), max(first.z, 0.0));
    let leaves = min(min(last.x, last.y), min(last.z, until));
    return select(NEVER, enters, enters <= leaves * SLACK);
}

// Where a ray meets a surfel, or what it has met before if that is nearer. The first of two as near wins.
fn nearer(which: u32, ray: Ray, before: Hit) -> Hit {
    let surfel = surfels[which];
    let way = surfel.place - ray.origin;
    let normal = surfel_normal(surfel);
    let height = dot(way, normal);
    let least = LEAST_SINE * length(way);
    let slope = dot(ray.direction, normal);
    let radius = surfel_radius(surfel) * bounces.cover;
    let distance = height / select(slope, 1.0, abs(slope) < 1e-6);
    let off = distance * ray.direction - way;
    let is_ahead = dot(way, ray.normal) > least || all(ray.normal == vec3f(0.0));
    let is_met = is_ahead && abs(height) > least && abs(slope) >= 1e-6
        && distance > 0.0 && dot(off, off) < radius * radius;
    let is_first = distance == before.distance && which < before.surfel && before.surfel != NONE;
    let is_nearer = distance < before.distance || is_first;
    if is_met && is_nearer {
        return Hit(distance, which);
    }
    return before;
}

// Puts the nodes below one among those that wait, the nearest last; how many wait then.
fn enter(height: u32, index: u32, origin: vec3f, inverse: vec3f, until: f32, count: u32) -> u32 {
    var top = count;
    for (var child = 0u; child < 4u; child++) {
        let enters = entered(height - 1u, 4u * index + child, origin, inverse, until);
        if enters == NEVER {
            continue;
        }
        var place = top;
        while place > count && waiting[place - 1u].enters < enters {
            waiting[place] = waiting[place - 1u];
            place -= 1u;
        }
        waiting[place] = Waiting(height - 1u, 4u * index + child, enters);
        top += 1u;
    }
    return top;
}

// What a ray meets first, if anything within the effect's reach.
fn nearest(ray: Ray) -> Hit {
    let inverse = inverse_of(ray.direction);
    var hit = Hit(bounces.reach, NONE);
    waiting[0] = Waiting(HEIGHT, 0u, 0.0);
    var count = 1u;
    while count > 0u {
        // A loop of its own, so that all invocations of a workgroup look at leaves together.
        var leaf = NONE;
        while count > 0u && leaf == NONE {
            count -= 1u;
            let node = waiting[count];
            if node.enters > hit.distance {
                continue;
            }
            if node.height == 0u {
                leaf = node.index;
            } else {
                count = enter(node.height, node.index, ray.origin, inverse, hit.distance, count);
            }
        }
        if leaf == NONE {
            break;
        }
        let begin = first_surfel(0u, leaf);
        let end = min(begin + LEAF, totals.kept);
        for (var which = begin; which < end; which++) {
            hit = nearer(which, ray, hit);
        }
    }
    return hit;
}

// Twice the index of the surfel that is met, and 1 more where its back is, or NONE.
fn met_word(hit: Hit, direction: vec3f) -> u32 {
    if hit.surfel == NONE {
        return NONE;
    }
    return 2u * hit.surfel + select(0u, 1u, dot(direction, surfel_normal(surfels[hit.surfel])) >= 0.0);
}
