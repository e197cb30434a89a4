// Ambient occlusion as light: that of a white sky which surfels hide.
#import shared/bounced_none

fn arriving(met: u32) -> vec3f {
    return select(vec3f(0.0), vec3f(1.0), met == NONE);
}
