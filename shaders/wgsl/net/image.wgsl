// A network's last layer.

#import shared/net_last
#import shared/net_joined
#import shared/net_window
