//! The layers of networks on software adapters, and the yardstick that they are held against.

use super::{Shader, uniforms};

table! {
    /// A network's first layer.
    NET_FIRST: "net.first", file "net/feature_map_pooled", constants [KERNEL = 3], uniforms [NetLayer],
        shared ["net_features", "net_layer", "net_window", "net_planes", "net_input", "net_single", "net_pool"];
    /// A network's further layers on the way down.
    NET_DOWN: "net.down", file "net/feature_map_pooled", constants [KERNEL = 3], uniforms [NetLayer],
        shared ["net_features", "net_layer", "net_pooled", "net_single", "net_pool"];
    /// A network's coarsest layer.
    NET_BOTTOM: "net.bottom", file "net/feature_map", constants [KERNEL = 3], uniforms [NetLayer],
        shared ["net_features", "net_layer", "net_pooled", "net_single"];
    /// A network's layers on the way up.
    NET_UP: "net.up", file "net/feature_map", constants [KERNEL = 3], uniforms [NetLayer],
        shared ["net_features", "net_layer", "net_joined"];
    /// A network's last layer.
    NET_IMAGE: "net.image", file "net/image", constants [KERNEL = 3], uniforms [NetLayer],
        shared ["net_image", "net_layer", "net_window", "net_joined"];
    /// The first layer of a network of one level.
    NET_ONLY: "net.only", file "net/feature_map", constants [KERNEL = 3], uniforms [NetLayer],
        shared ["net_features", "net_layer", "net_window", "net_planes", "net_input", "net_single"];
    /// The last layer of a network of one level.
    NET_PLAIN: "net.plain", file "net/image", constants [KERNEL = 3], uniforms [NetLayer],
        shared ["net_image", "net_layer", "net_window", "net_pooled", "net_single"];
    /// The yardstick's convolution.
    NAIVE_CONVOLUTION: "naive.convolution", file "naive/convolution", constants [], uniforms [NaiveLayer], shared [];
    /// The yardstick's leaky ReLU.
    NAIVE_ACTIVATION: "naive.activation", file "naive/activation", constants [], uniforms [NaiveLayer], shared [];
    /// The yardstick's means of 2x2 pixels.
    NAIVE_POOLING: "naive.pooling", file "naive/pooling", constants [], uniforms [NaiveLayer], shared [];
    /// The yardstick's bilinear doubling.
    NAIVE_DOUBLING: "naive.doubling", file "naive/doubling", constants [], uniforms [NaiveLayer], shared [];
    /// The yardstick's concatenation.
    NAIVE_CONCATENATION: "naive.concatenation", file "naive/concatenation", constants [], uniforms [NaiveLayer], shared [];
}
