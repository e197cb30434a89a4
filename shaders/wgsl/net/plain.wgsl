// The last layer of a network of one level.

#import shared/net_last
#import shared/net_pooled
#import shared/net_single
#import shared/net_window
