// The form factor from a point with a normal to a disk (Wallace, Elmquist and Haines 1989); `way` leads to
// the disk's middle, and `squared` is its length squared.
#import shared/surfel_facing
#import shared/surfel_record

fn form_factor(surfel: Surfel, way: vec3f, squared: f32, normal: vec3f) -> f32 {
    let radius = surfel_radius(surfel);
    let area = radius * radius;
    return area * max(dot(way, normal), 0.0) * surfel_facing(surfel, way) / (max(squared, 1e-20) * (squared + area));
}
