// A network's last layer.

#import net/image
#import shared/net_joined
#import shared/net_window
