// What a surfel sends to a point, irradiance over pi: its radiance times its form factor.
#import shared/surfel_form_factor
#import shared/surfel_receiver
#import shared/surfel_sent

fn added(sum: vec3f, which: u32, way: vec3f, squared: f32, receiver: Receiver) -> vec3f {
    let light = surfel_sent(which, way);
    // Where some of a leaf's surfels are lit, the others may be dark.
    if all(light == vec3f(0.0)) {
        return sum;
    }
    return sum + light * form_factor(surfels[which], way, squared, receiver.normal);
}
