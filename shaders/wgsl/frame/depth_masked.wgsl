// A shadow map of surfaces with holes: where alpha is below the material's limit nothing stops the light.

#import shared/view
#import uniforms/frame_view
#import uniforms/material_record

@group(0) @binding(0) var<uniform> view: FrameView;
@group(1) @binding(0) var<uniform> material: MaterialRecord;
@group(1) @binding(1) var base_texture: texture_2d<f32>;
@group(1) @binding(5) var base_sampler: sampler;

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec4f,
    @location(1) alpha: f32,
}

@vertex
fn corner(@location(0) position: vec3f, @location(5) uv: vec4f, @location(6) colour: vec4f) -> Corner {
    return Corner(clip_position(position - view.eye.xyz, view), uv, colour.a);
}

@fragment
fn holes(in: Corner) {
    let both = select(in.uv.xy, in.uv.zw, material.base_rest.z == 1.0);
    let uv = material.base_linear.xy * both.x + material.base_linear.zw * both.y + material.base_rest.xy;
    if material.base.a * in.alpha * textureSampleLevel(base_texture, base_sampler, uv, 0.0).a < material.factors.z {
        discard;
    }
}
