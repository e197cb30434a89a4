// What filters of light go by: a lens and movements.

// What pixels are counted by, and the most of these of a circle.
const EIGHT_PIXELS = 8.0;
const MOST_EIGHTS = 8.0;

// The signed radius of a circle of confusion.
fn signed_circle(blurriness: f32, depth: f32) -> f32 {
    return clamp(blurriness / (depth * EIGHT_PIXELS), -MOST_EIGHTS, MOST_EIGHTS);
}

// A movement in the image as a vector at twice its angle, of which opposite directions are the same.
fn movement(direction: f32, length: f32) -> vec2f {
    return length / EIGHT_PIXELS * vec2f(cos(2.0 * direction), sin(2.0 * direction));
}
