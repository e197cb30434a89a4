// Keeps what the layer makes.

#import convolution/layer

@group(0) @binding(3) var<storage, read_write> made: array<Texel>;

fn activate(sums: ptr<function, Sums>) {
    *sums = Sums(
        activated((*sums)[0]), activated((*sums)[1]), activated((*sums)[2]), activated((*sums)[3]),
        activated((*sums)[4]), activated((*sums)[5]), activated((*sums)[6]), activated((*sums)[7]),
    );
}

fn store_vector(at: vec2<i32>, block: u32, value: vec4<f32>) {
    if (inside(at)) {
        made[(block * layer.height + u32(at.y)) * layer.width + u32(at.x)] = Texel(value);
    }
}
