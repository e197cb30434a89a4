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
}
