//! What the passes that make a frame read.

use super::{Field, Layout, vec4f};

uniforms! {
    /// From where a raster pass looks: `shared/view.wgsl`.
    FrameView {
        /// Where the eye is, world space, metres.
        eye: vec4f,
        /// To the right in the image, unit vector in world space.
        right: vec4f,
        /// Up in the image.
        up: vec4f,
        /// Against the direction of sight.
        back: vec4f,
        /// Half images to the right per metre, at depth 1 where it is a perspective.
        scale_x: f32,
        /// Half images up.
        scale_y: f32,
        /// Nearest depth that is seen in perspective, metres.
        near: f32,
        /// Farthest depth that is seen in parallel projection, metres.
        far: f32,
        /// 1 in perspective, 0 in parallel projection.
        perspective: u32,
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Distance in pixels, at depth 1, of two points one unit apart.
        focal_length: f32,
        /// Depth of the plane in focus, metres; 0 without a lens.
        focus: f32,
        /// Radius of the circle of confusion of what is infinitely far away, pixels.
        blur: f32,
        /// Fills up.
        padding_0: f32,
        /// Fills up.
        padding_1: f32,
    }

    /// A material: `render/src/scene/material.rs`.
    MaterialRecord {
        /// Base colour and alpha.
        base: vec4f,
        /// Metalness, roughness, the alpha below which nothing is there, nothing.
        factors: vec4f,
        /// Emitted radiance; scale of the normal map, 0 without one.
        emission: vec4f,
        /// Specular colour; 1 where the material says one.
        specular: vec4f,
        /// How what is specular spreads (0 microfacets, 1 Phong, 2 not at all); mean free path, metres.
        gloss_path: vec4f,
        /// Columns of the transform of the base colour's coordinates.
        base_linear: vec4f,
        /// Its translation, the set of coordinates, nothing.
        base_rest: vec4f,
        /// As of the base colour, of metalness and roughness.
        gloss_linear: vec4f,
        /// As of the base colour, of metalness and roughness.
        gloss_rest: vec4f,
        /// As of the base colour, of the normal map.
        normal_linear: vec4f,
        /// As of the base colour, of the normal map.
        normal_rest: vec4f,
        /// As of the base colour, of emission.
        emission_linear: vec4f,
        /// As of the base colour, of emission.
        emission_rest: vec4f,
    }

    /// A light: `render/src/scene/light.rs`.
    LightRecord {
        /// Where it is; 0 point, 1 spot, 2 directional.
        place: vec4f,
        /// In which direction it shines; its range, metres, 0 without an end.
        axis: vec4f,
        /// Intensity or irradiance; its first map, -1 without one.
        power: vec4f,
        /// Cosines of the inner and outer cone, number of maps, metres after which a pattern repeats.
        cone: vec4f,
        /// First word of the picture that it projects, columns, rows; 1 where there is one in sRGB, 2 a linear one,
        /// and 2 more where only the nearest texel is read.
        picture: vec4f,
        /// The picture's right.
        right: vec4f,
        /// The picture's up.
        up: vec4f,
    }

    /// What `frame/pose` reads.
    Pose {
        /// How many vertices move.
        vertices: u32,
        /// Workgroups in x; there may be more in y.
        groups: u32,
        /// Matrices of a moment.
        matrices: u32,
        /// Morph weights of a moment.
        weights: u32,
        /// 1 in the first frame, which has none before it.
        first: u32,
    }

    /// Which light `frame/reflective` is of.
    Chosen {
        /// Its index.
        light: u32,
    }

    /// What `frame/reproject` reads.
    Reprojection {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// 1 in the first frame, which has none before it.
        first: u32,
        /// Share of this frame in what is made of it.
        share: f32,
        /// Difference in depth, as a share of it, above which a pixel showed another surface.
        depth_tolerance: f32,
        /// Standard deviations of the pixels around, beyond which what was is cut off.
        clip: f32,
    }

    /// What `frame/upsample` reads.
    Upsampling {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Columns of the smaller one.
        small_width: u32,
        /// Rows of the smaller one.
        small_height: u32,
        /// The image where no surface is seen.
        background: f32,
    }

    /// What `frame/wipe` reads.
    Wipe {
        /// Columns of the images.
        width: u32,
        /// Rows of the images.
        height: u32,
        /// Their channels: 1 or 3.
        channels: u32,
        /// Columns to the left of the border.
        border: f32,
        /// What light is multiplied by.
        scale: f32,
        /// How much brightness is compressed.
        compression: f32,
        /// How much of that is taken back.
        stretch: f32,
    }
}
