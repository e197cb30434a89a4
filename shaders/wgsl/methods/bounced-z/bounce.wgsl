// Light of the environment that surfels reflect along pixels' rays: a surfel that is met reflects what comes
// from a random direction by its cosine, found in the same way. A path ends where it meets nothing, or after
// BOUNCES.

#import shared/bounced_directions
#import shared/cosine_direction
#import shared/environment
#import shared/environment_height
#import shared/packing
#import shared/surfel_nearest
#import shared/surfel_order
#import shared/surfel_patch_record
#import shared/view
#import uniforms/frame_view
#constant BOUNCES = 2

@group(0) @binding(0) var<uniform> bounces: Bounces;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read> totals: Totals;
@group(0) @binding(3) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(4) var<storage, read> nodes: array<Node>;
@group(0) @binding(5) var<storage, read> patches: array<Patch>;
@group(0) @binding(6) var<storage, read> starts: array<u32>;
// Each direction's texel its mean radiance.
@group(0) @binding(7) var<storage, read> environment: array<vec4f>;
// [directions, height, width]: twice the index of a surfel, and 1 more where its back is met, or NONE; then
// radiance, as `pack_radiance` has it.
@group(0) @binding(8) var<storage, read_write> arrived: array<u32>;

// A direction by the cosine to a normal, spread evenly over the pixels of a square as the first ones are.
// `at` is the ray, `bounce` how many surfels its path has met before.
fn reflected_direction(normal: vec3f, at: u32, bounce: u32) -> vec3f {
    let pixel = at % (bounces.width * bounces.height);
    let number = at / (bounces.width * bounces.height);
    let spread = vec2u(bounces.directions, hash(bounces.seed + bounce));
    let place = place_on_disk(vec2u(pixel % bounces.width, pixel / bounces.width), number, spread);
    return cosine_direction(normal, place);
}

// The radiance that arrives along a ray which has met a surfel.
fn light_of_path(first: u32, at: u32) -> vec3f {
    var share = vec3f(1.0);
    var word = first;
    for (var bounce = 0u; bounce < BOUNCES; bounce++) {
        let surfel = surfels[word >> 1u];
        let is_back = (word & 1u) == 1u;
        // Nothing comes out of a closed body.
        if is_back && !surfel_is_open(surfel) {
            break;
        }
        share *= patch_colour(patches[patch_of(chosen(word >> 1u))]);
        let normal = select(surfel_normal(surfel), -surfel_normal(surfel), is_back);
        let direction = reflected_direction(normal, at, bounce);
        word = met_word(nearest(Ray(surfel.place, normal, direction)), direction);
        if word == NONE {
            return share * environment_radiance(0u, environment_height(), from_view(direction, view));
        }
    }
    return vec3f(0.0);
}

@compute @workgroup_size(64)
fn bounce(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let at = id.x + id.y * groups.x * 64u;
    if at >= arrayLength(&arrived) {
        return;
    }
    var radiance = vec3f(0.0);
    if arrived[at] != NONE {
        radiance = light_of_path(arrived[at], at);
    }
    arrived[at] = pack_radiance(radiance);
}
