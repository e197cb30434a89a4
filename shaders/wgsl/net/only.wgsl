// The first layer of a network of one level.

#import net/feature_map
#import shared/net_input
#import shared/net_planes
#import shared/net_single
