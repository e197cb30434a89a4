// Of each interval the albedo times the transmittance to the eye that falls within it, in its middle: no
// density is looked up, and none is missed.
#import shared/colours
#import shared/intervals_decode
#import shared/transmittance
#constant SAMPLES = 16

fn read_intervals(words: array<u32, SAMPLES / 2u>, ray: vec4f, steps: u32) {
    var packed = words;
    let albedo = colours(medium.scattering.rgb) / max(colours(medium.extinction.rgb), vec3f(1e-30));
    var begins = ray.x;
    var before = vec3f(1.0);
    for (var i = 0u; i < SAMPLES; i++) {
        let share = f32((packed[i / 2u] >> (16u * (i % 2u))) & 65535u) / 65535.0;
        let ends = mix(ray.x, ray.y, share);
        let after = share_of_colours(passed_before(i, ray.z, ray.w));
        if i > 0u {
            points[i - 1u] = 0.5 * (begins + ends);
            weights[i - 1u] = albedo * max(before - after, vec3f(0.0));
        }
        begins = ends;
        before = after;
    }
}
