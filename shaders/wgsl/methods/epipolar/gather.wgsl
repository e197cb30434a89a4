// Fog in front of pixels: each asks the lines beside it for the lit light rays between its view ray's ends,
// node by node (Baran et al. 2010, Figure 6), and multiplies them with the integrand, which is a quadratic
// function within a node.

#import shared/epipolar_lines
#import shared/epipolar_part
#import shared/epipolar_rays
#import shared/epipolar_view
#import shared/lamp_axis
#import shared/light_dimmed
#import shared/lights
#import shared/phase
#import uniforms/epipolar
#import uniforms/frame_view
#import uniforms/light_record

@group(0) @binding(0) var<uniform> epipolar: Epipolar;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(3) var<storage, read> pictures: array<u32>;
@group(0) @binding(4) var<storage, read> valid_plane: array<f32>;
@group(0) @binding(5) var<storage, read> position_planes: array<f32>;
@group(0) @binding(6) var<storage, read> lines: array<u32>;
@group(0) @binding(7) var<storage, read> ends: array<f32>;
@group(0) @binding(8) var<storage, read> sums: array<vec2u>;
// [3, height, width]
@group(0) @binding(9) var<storage, read_write> image: array<f32>;

const PI = 3.14159265;
const LEAVES = 64u;
const SQUARES = 19u;
const LEAST_LEVEL = 2u;
const LARGEST_LEVEL = 6u;
// How much the middle of a node may be off the mean of its ends, twice, as a share of the largest value,
const MOST_BENT = 0.25;
// or of what is summed up before.
const NEGLIGIBLE = 1e-3;

// What lit light rays of a node add up to.
struct Lit {
    count: f32,
    // Of their places, in light rays from the beginning of 64, and of the squares of places.
    places: f32,
    squares: f32,
}

struct Query {
    ray: SeenRay,
    axis: Axis,
    bounds: vec2f,
    beta: f32,
    // The two lines that the pixel is between, and how far on to the second.
    first_rays: vec2u,
    on: f32,
}

// What a view ray would receive by one light ray if that is lit.
fn integrand(number: f32, query: Query) -> vec3f {
    let gamma = gamma_at(number, query.bounds);
    let in_plane = query.ray.in_plane;
    var distance = gamma / in_plane.y;
    var metres = 1.0 / in_plane.y;
    if query.axis.reach > 0.0 {
        distance = query.axis.reach * sin(gamma) / max(in_plane.y * cos(gamma) + in_plane.x * sin(gamma), 1e-20);
    }
    distance = clamp(distance, query.ray.enters, query.ray.leaves);
    let point = view.eye.xyz + query.ray.direction * distance;
    let arrived = arrival(lights[of_lamp.number], point);
    if query.axis.reach > 0.0 {
        metres = arrived.distance * arrived.distance / (query.axis.reach * in_plane.y);
    }
    let turned = phase(dot(arrived.direction, query.ray.direction));
    let left = exp(-medium.extinction.rgb * (distance - query.ray.enters)) * passed_share(point, arrived);
    return arrived.irradiance * left * (turned * metres * gamma_growth(number, query.bounds));
}

fn lit_of_node(first_ray: u32, node: u32, level: u32, beta: f32) -> Lit {
    let size = 1u << level;
    let begin = (level - LEAST_LEVEL) * epipolar.lines * epipolar.light_rays + first_ray + node;
    var ended = 0u;
    for (var step = size; step > 0u; step /= 2u) {
        if ended + step <= size && bitcast<f32>(sums[begin + ended + step - 1u].x) < beta {
            ended += step;
        }
    }
    if ended == size {
        return Lit(0.0, 0.0, 0.0);
    }
    let word = sums[begin + ended].y;
    return Lit(f32(size - ended), 0.5 * f32(word >> SQUARES), 0.25 * f32(word & ((1u << SQUARES) - 1u)));
}

// Of both lines.
fn lit_between(node: u32, level: u32, query: Query) -> Lit {
    let a = lit_of_node(query.first_rays.x, node, level, query.beta);
    let b = lit_of_node(query.first_rays.y, node, level, query.beta);
    return Lit(mix(a.count, b.count, query.on), mix(a.places, b.places, query.on), mix(a.squares, b.squares, query.on));
}

// The integrand at the beginning of a node, in its middle and at its end.
struct Curve {
    begin: vec3f,
    middle: vec3f,
    end: vec3f,
}

fn curve_of(node: u32, level: u32, query: Query) -> Curve {
    let size = f32(1u << level);
    let begin = f32(node);
    return Curve(integrand(begin, query), integrand(begin + 0.5 * size, query), integrand(begin + size, query));
}

// Whether a quadratic function is right for a node, or does not matter beside what there is already.
fn is_smooth(curve: Curve, level: u32, sum: vec3f) -> bool {
    let largest = max(max(curve.begin, curve.middle), curve.end);
    let bends = abs(curve.begin - 2.0 * curve.middle + curve.end);
    return all(bends <= max(MOST_BENT * largest, NEGLIGIBLE / f32(1u << level) * sum));
}

fn sum_of_node(node: u32, level: u32, curve: Curve, query: Query) -> vec3f {
    let lit = lit_between(node, level, query);
    let half = 0.5 * f32(1u << level);
    // Moments about the middle.
    let place = f32(node % LEAVES) + half;
    let first = lit.places - place * lit.count;
    let second = lit.squares - 2.0 * place * lit.places + place * place * lit.count;
    let slope = (curve.end - curve.begin) * (0.5 / half);
    let bend = (curve.begin - 2.0 * curve.middle + curve.end) * (0.5 / (half * half));
    return max(curve.middle * lit.count + slope * first + bend * second, vec3f(0.0));
}

// One light ray, or the part of it from `begins` to `ends_at`.
fn sum_of_ray(number: u32, begins: f32, ends_at: f32, query: Query) -> vec3f {
    let first = select(0.0, 1.0, ends[query.first_rays.x + number] >= query.beta);
    let second = select(0.0, 1.0, ends[query.first_rays.y + number] >= query.beta);
    let share = mix(first, second, query.on) * (ends_at - begins);
    if share <= 0.0 {
        return vec3f(0.0);
    }
    return share * integrand(0.5 * (begins + ends_at), query);
}

// Nodes are no wider than half of a spot's cone to a side, which they would miss between their three values;
// what a lamp projects is asked for light ray by light ray.
fn largest_level(bounds: vec2f) -> u32 {
    let light = lights[of_lamp.number];
    if light.picture.w > 0.0 {
        return 0u;
    }
    if light.place.w != SPOT {
        return LARGEST_LEVEL;
    }
    let widest = gamma_growth(f32(epipolar.light_rays), bounds);
    let rays = 0.5 * acos(clamp(light.cone.y, -1.0, 1.0)) / max(widest, 1e-20);
    return min(LARGEST_LEVEL, u32(log2(max(rays, 1.0))));
}

// Of all light rays from one number to another.
fn sum_between(numbers: vec2f, query: Query) -> vec3f {
    let last = min(u32(numbers.y), epipolar.light_rays - 1u);
    var next = min(u32(numbers.x), last);
    var sum = vec3f(0.0);
    if f32(next) < numbers.x {
        sum += sum_of_ray(next, numbers.x, min(f32(next) + 1.0, numbers.y), query);
        next++;
    }
    let most = largest_level(query.bounds);
    var allowed = most;
    while next < last {
        let level = min(min(countTrailingZeros(next), firstLeadingBit(last - next)), allowed);
        if level < LEAST_LEVEL {
            sum += sum_of_ray(next, f32(next), f32(next) + 1.0, query);
            next++;
            allowed = select(allowed, most, next % (1u << LEAST_LEVEL) == 0u);
            continue;
        }
        let curve = curve_of(next, level, query);
        if !is_smooth(curve, level, sum) {
            allowed = level - 1u;
            continue;
        }
        sum += sum_of_node(next, level, curve, query);
        next += 1u << level;
        allowed = min(allowed + 1u, most);
    }
    if next == last {
        sum += sum_of_ray(last, f32(last), numbers.y, query);
    }
    return sum;
}

@compute @workgroup_size(TILE, TILE)
fn gather(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= epipolar.width || id.y >= epipolar.height {
        return;
    }
    let axis = lamp_axis();
    let line = line_through(vec2f(id.xy) + 0.5, axis);
    let before = min(floor(line), bitcast<f32>(lines[border()]) - 1.0);
    // Of each pixel one part has the lines.
    let in_part = epipolar.lines - 1u;
    if u32(before) / in_part != part.number {
        return;
    }
    let ray = seen_ray(id.xy);
    let bounds = gamma_bounds();
    let numbers = crossed(ray, bounds);
    var sum = vec3f(0.0);
    if ray.leaves > ray.enters && !crosses_few(numbers) {
        let first = (u32(before) - first_line()) * epipolar.light_rays;
        let lines_beside = vec2u(first, first + epipolar.light_rays);
        let query = Query(ray, axis, bounds, beta_of(ray.in_plane), lines_beside, clamp(line - before, 0.0, 1.0));
        sum = medium.scattering.rgb * sum_between(numbers, query);
    }
    let pixels = epipolar.width * epipolar.height;
    let at = id.y * epipolar.width + id.x;
    for (var c = 0u; c < 3u; c++) {
        // The first lamp finds what the frame before left.
        image[at + c * pixels] = select(image[at + c * pixels], 0.0, of_lamp.number == 0u) + sum[c];
    }
}
