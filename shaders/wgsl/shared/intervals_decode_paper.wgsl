// Of each interval its length times scattering coefficient and transmittance at its end (Nalbach, Ritschel
// and Seidel 2014, 4.2).
#import shared/colours
#import shared/intervals_decode
#import shared/transmittance
#constant SAMPLES = 16

fn read_intervals(words: array<u32, SAMPLES / 2u>, ray: vec4f, steps: u32) {
    var packed = words;
    let step = (ray.y - ray.x) / f32(steps);
    let unit = f32(packed[SAMPLES / 4u] & 255u) * medium.low.w / (255.0 * 255.0);
    var passed = 0u;
    var begins = ray.x;
    for (var i = 0u; i < SAMPLES; i++) {
        passed += (packed[i / 4u] >> (8u * (i % 4u))) & 255u;
        // The first step of a march is shorter than the others.
        let at = ray.x + max(f32(passed) - 1.0 + ray.w, 0.0) * step;
        if i > 0u {
            let density = f32((packed[(SAMPLES + i) / 4u] >> (8u * (i % 4u))) & 255u) * unit;
            points[i - 1u] = at;
            weights[i - 1u] = colours(medium.scattering.rgb) * density * (at - begins)
                * share_of_colours(passed_before(i, ray.z, ray.w));
        }
        begins = at;
    }
}
