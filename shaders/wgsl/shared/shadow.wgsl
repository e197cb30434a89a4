// Which share of a light's rays reaches a point, by the depths that the light's maps hold: the mean of four
// texels around it, each lit or not (Reeves, Salesin and Cook 1987). The point is lifted off its surface, so
// that surfaces do not shade themselves: by what a texel covers there, more where light grazes.

#import shared/view
#import uniforms/light_record

const CUBE = 6u;

fn map_of(light: LightRecord, point: vec3f) -> u32 {
    let first = u32(light.power.w);
    let count = u32(light.cone.z);
    if count == 1u {
        return first;
    }
    if count == CUBE {
        let away = point - light.place.xyz;
        let size = abs(away);
        if size.x >= size.y && size.x >= size.z {
            return first + select(1u, 0u, away.x > 0.0);
        }
        if size.y >= size.z {
            return first + select(3u, 2u, away.y > 0.0);
        }
        return first + select(5u, 4u, away.z > 0.0);
    }
    // The finest cascade that holds the point and what is filtered around it.
    let last = first + count - 1u;
    for (var map = first; map < last; map++) {
        let map_view = map_views[map];
        let at = to_view(point - map_view.eye.xyz, map_view);
        let across = abs(vec2f(at.x * map_view.scale_x, at.y * map_view.scale_y));
        if all(across < vec2f(1.0 - 4.0 / f32(map_view.width))) {
            return map;
        }
    }
    return last;
}

fn lit_share(light: LightRecord, point: vec3f, geometric: vec3f, to_light: vec3f) -> f32 {
    if light.power.w < 0.0 {
        return 1.0;
    }
    var map = map_of(light, point);
    var map_view = map_views[map];
    let depth = max(-to_view(point - map_view.eye.xyz, map_view).z, 0.0);
    let texel = 2.0 * select(1.0, depth, map_view.perspective == 1u) / (map_view.scale_x * f32(map_view.width));
    let sine = sqrt(max(1.0 - dot(geometric, to_light) * dot(geometric, to_light), 0.0));
    let lifted = point + geometric * texel * (0.5 + 1.5 * sine) + to_light * 0.5 * texel;
    // Lifting may lead from one face of a cube to another, which has what is there.
    if u32(light.cone.z) == CUBE {
        map = map_of(light, lifted);
        map_view = map_views[map];
    }
    let clip = clip_position(lifted - map_view.eye.xyz, map_view);
    if clip.w <= 0.0 {
        return 1.0;
    }
    let at = clip.xyz / clip.w;
    let uv = vec2f(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y);
    if any(uv < vec2f(0.0)) || any(uv > vec2f(1.0)) {
        return 1.0;
    }
    return textureSampleCompareLevel(maps, map_sampler, uv, i32(map), at.z);
}
