//! The layers of networks on software adapters, and the yardstick that they are held against.

use super::Shader;

shaders! {
    table NETS;
    /// A network's first layer.
    NET_FIRST: "net.first", "net/first";
    /// A network's further layers on the way down.
    NET_DOWN: "net.down", "net/down";
    /// A network's coarsest layer.
    NET_BOTTOM: "net.bottom", "net/bottom";
    /// A network's layers on the way up.
    NET_UP: "net.up", "net/up";
    /// A network's last layer.
    NET_IMAGE: "net.image", "net/last";
    /// The first layer of a network of one level.
    NET_ONLY: "net.only", "net/only";
    /// The last layer of a network of one level.
    NET_PLAIN: "net.plain", "net/plain";
    /// Sums over squares of 4 pixels, of a g-buffer.
    NET_SQUARES_FIRST: "net.squares_first", "net/squares_first";
    /// Sums over squares of four of the squares before.
    NET_SQUARES: "net.squares", "net/squares";
}
