// What of a surfel's light the lobe of a glossy surface would reflect to the eye if it reflected as much at
// every angle as at the eye's: radiance over that colour. It is as much wider as what the surfel stands for
// looks large, whose light comes from all of it.

#import shared/gloss
#import shared/lobe
#import shared/surface
#import shared/surfel
#import shared/surfel_facing
#import shared/surfel_record
#import shared/surfel_sent

struct Receiver {
    position: vec3f,
    // Metres; 0 where nothing is seen.
    reach: f32,
    lobe: Lobe,
}

fn receiver_at(at: u32, pixels: u32) -> Receiver {
    let position = surface_position(at, pixels);
    let lobe = lobe_at(at, position, surface_normal(at, pixels));
    return Receiver(position, select(0.0, level.reach, surface_valid(at) && is_seen(lobe)), lobe);
}

// The variance of an even disk's slopes is a fourth of its radius squared; facets turn half as far as what
// they mirror; and alpha squared is twice a variance.
const WIDER = 0.125;

// By how much more of light is reflected that a facet mirrors than of what the normal would; of what is black
// as much.
fn tint(lobe: Lobe, facet: vec3f) -> vec3f {
    let usual = fresnel(lobe, lobe.normal);
    return select(vec3f(1.0), fresnel(lobe, facet) / usual, usual > vec3f(0.0));
}

fn added(sum: vec3f, which: u32, way: vec3f, squared: f32, receiver: Receiver) -> vec3f {
    let sent = surfel_sent(which, way);
    let facing = surfel_facing(surfels[which], way);
    // Where some of a leaf's surfels are lit, the others may be dark.
    if all(sent == vec3f(0.0)) || facing <= 0.0 || dot(way, receiver.lobe.normal) <= 0.0 {
        return sum;
    }
    let radius = surfel_radius(surfels[which]);
    let area = radius * radius;
    let distance = sqrt(squared);
    var lobe = receiver.lobe;
    lobe.alpha = min(sqrt(lobe.alpha * lobe.alpha + WIDER * area * level.stands_for / squared), 1.0);
    let light = way / distance;
    let reflected = lobe_density(lobe, light) * lobe_visibility(lobe, light) * tint(lobe, facet_between(lobe, light));
    return sum + sent * reflected * (PI * area * facing / (distance * (squared + area)));
}
