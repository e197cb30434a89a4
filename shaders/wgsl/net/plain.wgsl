// The last layer of a network of one level.

#import net/image
#import shared/net_pooled
#import shared/net_single
#import shared/net_window
