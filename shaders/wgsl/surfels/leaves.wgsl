// The lowest nodes of the tree, of surfels that reach as far as they are large.

#import shared/surfel_reach_by_radius
#import shared/surfels_leaves
#constant HEIGHT = 8
