// What a surfel does to ambient occlusion: its form factor.

#import shared/surfel_form_factor
#import shared/surfel_receiver

fn nothing() -> f32 {
    return 0.0;
}

fn added(sum: f32, which: u32, way: vec3f, squared: f32, receiver: Receiver) -> f32 {
    return sum + form_factor(surfels[which], way, squared, receiver.normal);
}

fn write_sum(sum: f32, at: u32, pixels: u32) {
    sums[at] = sum;
}
