// A network's first layer.

#import net/feature_map_pooled
#import shared/net_input
#import shared/net_planes
