// What lights without an extent send to a point, as render/src/path/lights/arrival.rs has it.

#import uniforms/light_record

const POINT = 0.0;
const SPOT = 1.0;
const DIRECTIONAL = 2.0;
const LEAST_DISTANCE = 1e-6;
const WIDEST_SLIDE = 0.0174524;
const LINEAR_PICTURE = 2.0;
// Added to what a picture's bytes mean where it is read texel by texel.
const NEAREST_PICTURE = 2.0;

struct Arrival {
    // To the light.
    direction: vec3f,
    distance: f32,
    // On a surface that faces the light.
    irradiance: vec3f,
}

fn picture_texel(light: LightRecord, x: i32, y: i32) -> vec3f {
    let size = vec2i(light.picture.yz);
    var at = vec2i(x, y);
    if light.place.w == DIRECTIONAL {
        at = ((at % size) + size) % size;
    } else {
        at = clamp(at, vec2i(0), size - 1);
    }
    let word = pictures[u32(light.picture.x) + u32(at.y * size.x + at.x)];
    let stored = unpack4x8unorm(word).rgb;
    if light.picture.w == LINEAR_PICTURE || light.picture.w == LINEAR_PICTURE + NEAREST_PICTURE {
        return stored;
    }
    return select(pow((stored + 0.055) / 1.055, vec3f(2.4)), stored / 12.92, stored <= vec3f(0.04045));
}

fn picture_at(light: LightRecord, uv: vec2f) -> vec3f {
    let is_nearest = light.picture.w > NEAREST_PICTURE;
    let at = uv * light.picture.yz - select(0.5, 0.0, is_nearest);
    let first = floor(at);
    let part = select(at - first, vec2f(0.0), is_nearest);
    let x = i32(first.x);
    let y = i32(first.y);
    let top = mix(picture_texel(light, x, y), picture_texel(light, x + 1, y), part.x);
    let bottom = mix(picture_texel(light, x, y + 1), picture_texel(light, x + 1, y + 1), part.x);
    return mix(top, bottom, part.y);
}

// `point` is in world space.
fn arrival(light: LightRecord, point: vec3f) -> Arrival {
    let projects = light.picture.w > 0.0;
    if light.place.w == DIRECTIONAL {
        var irradiance = light.power.rgb;
        if projects {
            irradiance *= picture_at(light, vec2f(dot(light.right.xyz, point), -dot(light.up.xyz, point)) / light.cone.w);
        }
        return Arrival(-light.axis.xyz, -1.0, irradiance);
    }
    let to_light = light.place.xyz - point;
    let distance = max(length(to_light), LEAST_DISTANCE);
    let direction = to_light / distance;
    var fade = 1.0;
    if light.axis.w > 0.0 {
        let part = distance / light.axis.w;
        fade = clamp(1.0 - part * part * part * part, 0.0, 1.0);
    }
    var irradiance = light.power.rgb * fade / (distance * distance);
    if light.place.w == SPOT {
        let cosine = -dot(direction, light.axis.xyz);
        let inside = clamp((cosine - light.cone.y) / (light.cone.x - light.cone.y), 0.0, 1.0);
        irradiance *= inside * inside;
        if projects && inside > 0.0 {
            let outer = max(light.cone.y, WIDEST_SLIDE);
            let rim = sqrt(max(1.0 - outer * outer, 0.0)) / outer;
            let forward = max(cosine, WIDEST_SLIDE);
            let at = vec2f(-dot(light.right.xyz, direction), dot(light.up.xyz, direction)) / (forward * max(rim, 1e-37));
            irradiance *= picture_at(light, 0.5 + 0.5 * at);
        }
    }
    return Arrival(direction, distance, irradiance);
}
