// A network's layers on the way up.

#import net/feature_map
#import shared/net_joined
