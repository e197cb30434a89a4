// A network's coarsest layer.

#import net/feature_map
#import shared/net_pooled
#import shared/net_single
