// The g-buffer's attributes from the raster pass' words: planes [width, height, width] in a buffer each, 0
// where nothing is seen. `write_all`, which is generated, writes those that this pass is for.

#template
#import shared/seen

const PI = 3.14159265;
const OBJECT_IDS = 2048u;

// Direction in [0, pi) and length.
fn polar(movement: vec2f) -> vec2f {
    if all(movement == vec2f(0.0)) {
        return vec2f(0.0);
    }
    var direction = atan2(movement.y, movement.x);
    direction = select(direction, direction + PI, direction < 0.0);
    return vec2f(select(direction, 0.0, direction >= PI), length(movement));
}

fn focal_distance(seen: Seen) -> f32 {
    return select(0.0, seen.depth - view.focus, view.focus > 0.0);
}

@compute @workgroup_size(TILE, TILE)
fn write_attributes(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    write_all(seen_at(id.xy), id.y * view.width + id.x, view.width * view.height);
}
