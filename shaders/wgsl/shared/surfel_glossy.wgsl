// What of a surfel's light a glossy surface reflects to the eye: radiance. Its lobe is as much wider as what the surfel stands for
// looks large, whose light comes from all of it.

struct Receiver {
    position: vec3f,
    // Metres; 0 where nothing is reflected.
    reach: f32,
    lobe: Lobe,
}

fn receiver_at(at: u32, pixels: u32) -> Receiver {
    let position = surface_position(at, pixels);
    let lobe = lobe_at(at, position, surface_normal(at, pixels));
    return Receiver(position, select(0.0, level.reach, surface_valid(at) && shines(lobe)), lobe);
}

// The variance of an even disk's slopes is a fourth of its radius squared; facets turn half as far as what they mirror; and alpha
// squared is twice a variance.
const WIDER = 0.125;

fn added(sum: vec3f, surfel: Surfel, way: vec3f, squared: f32, receiver: Receiver) -> vec3f {
    let area = surfel.place.w * surfel.place.w;
    let distance_squared = max(squared, 1e-20);
    let distance = sqrt(distance_squared);
    var lobe = receiver.lobe;
    lobe.alpha = min(sqrt(lobe.alpha * lobe.alpha + WIDER * area * level.stands_for / distance_squared), 1.0);
    let light = way / distance;
    let reflected = lobe_density(lobe, light) * lobe_weight(lobe, light);
    return sum + surfel_sent(surfel, way) * reflected * (PI * area * surfel_facing(surfel, way) / (distance * (squared + area)));
}
