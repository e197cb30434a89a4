// What surfels do something to: the surface seen at a pixel, as far as the effect reaches.

#import shared/surface
#import shared/surface_valid

struct Receiver {
    position: vec3f,
    normal: vec3f,
    // Metres; 0 where nothing is seen.
    reach: f32,
}

fn receiver_at(at: u32, pixels: u32) -> Receiver {
    let reach = select(0.0, level.reach, surface_valid(at));
    return Receiver(surface_position(at, pixels), surface_normal(at, pixels), reach);
}
