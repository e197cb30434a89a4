//! Uniform structs that Rust fills and WGSL reads. The WGSL declaration is derived from the Rust struct; a test has
//! naga confirm that both put every field at the same offset.

/// How a uniform struct lies in memory.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// Name of the struct, in Rust and in WGSL.
    pub name: &'static str,
    /// Its size, bytes.
    pub size: usize,
    /// Its fields in order.
    pub fields: &'static [Field],
}

/// One field of a uniform struct.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Name of the field, in Rust and in WGSL.
    pub name: &'static str,
    /// Its type in WGSL.
    pub kind: &'static str,
    /// Bytes from the beginning of the struct.
    pub offset: usize,
}

impl Layout {
    /// The struct in WGSL.
    pub fn declaration(&self) -> String {
        let fields: Vec<String> =
            self.fields.iter().map(|f| format!("    {}: {},\n", f.name, f.kind)).collect();
        format!("struct {} {{\n{}}}\n", self.name, fields.concat())
    }
}

/// Declares uniform structs with their layouts. A field's type is `f32`, `u32` or `i32`, each the same in WGSL.
macro_rules! uniforms {
    ($($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $kind:ident,)* })*) => {
        $($(#[$doc])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
        pub struct $name {
            $($(#[$field_doc])* pub $field: $kind,)*
        }

        impl $name {
            /// How it lies in memory.
            pub const LAYOUT: Layout = Layout {
                name: stringify!($name),
                size: size_of::<Self>(),
                fields: &[$(Field {
                    name: stringify!($field),
                    kind: stringify!($kind),
                    offset: std::mem::offset_of!(Self, $field),
                }),*],
            };
        })*
    };
}

uniforms! {
    /// What `methods/hbao/occlusion` reads.
    Hbao {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Directions that are marched.
        directions: u32,
        /// Most samples of a direction.
        steps: u32,
        /// Chooses the random numbers.
        seed: u32,
        /// Radius within which a sample can occlude, metres.
        radius: f32,
        /// Distance in pixels, at depth 1, of two points one unit apart.
        focal_length: f32,
        /// Sine of the angle bias.
        bias_sine: f32,
        /// Cosine of the angle bias.
        bias_cosine: f32,
        /// Factor of the occlusion.
        strength: f32,
    }

    /// What `methods/hbao/blur` reads.
    HbaoBlur {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// 1 to blur along rows, else 0.
        step_x: i32,
        /// 1 to blur along columns, else 0.
        step_y: i32,
        /// Pixels on either side that are blurred together.
        radius: i32,
        /// The Gaussian's exponent of a distance of one pixel.
        falloff: f32,
        /// Factor, one over metres, of a distance from the tangent plane before it is squared into the exponent.
        sharpness: f32,
    }

    /// What the passes of `net` read about a part of a layer.
    NetLayer {
        /// Columns of the layer's frame: what it makes, before the image is cropped.
        width: u32,
        /// Rows of the layer's frame.
        height: u32,
        /// Columns of the network's input and image.
        image_width: u32,
        /// Rows of the network's input and image.
        image_height: u32,
        /// Channels of the network's input; in its last layer those of its image.
        channels: u32,
        /// Index of the first group of outputs that this part makes.
        first: u32,
        /// Weights a group of outputs has, with what fills it up.
        stride: u32,
        /// Factor of negative values in the leaky ReLU.
        leak: f32,
        /// Factor of lengths in the network's input, where it is read from textures.
        length_scale: f32,
        /// Column of the image where the layer's frame begins.
        origin_x: u32,
        /// Row of the image where the layer's frame begins.
        origin_y: u32,
        /// First column of the image that is kept.
        keep_left: u32,
        /// First row of the image that is kept.
        keep_top: u32,
        /// Column of the image after the last one that is kept.
        keep_right: u32,
        /// Row of the image after the last one that is kept.
        keep_bottom: u32,
        /// Which colour channel a mono network's run makes, where its input is read from textures.
        run: u32,
    }

    /// What the passes of `naive` read about a layer.
    NaiveLayer {
        /// Columns of what the pass makes.
        width: u32,
        /// Rows of what the pass makes.
        height: u32,
        /// Width and height of the convolution's kernel.
        kernel: u32,
        /// Inputs of a group.
        group_inputs: u32,
        /// Outputs of a group.
        group_outputs: u32,
        /// Channels of the coarser image in a concatenation.
        coarse: u32,
        /// Factor of negative values in the leaky ReLU.
        leak: f32,
    }
}
