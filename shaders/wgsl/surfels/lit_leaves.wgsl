// The lowest nodes of the tree, of surfels that send light.

#import shared/surfel_reach_if_lit
#import shared/surfels_leaves
#constant HEIGHT = 8
