// A network's further layers on the way down.

#import net/feature_map_pooled
#import shared/net_pooled
