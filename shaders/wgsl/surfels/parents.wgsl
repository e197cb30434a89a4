// The nodes above the lowest ones of the tree over surfels.

#import shared/tree_parents
#constant HEIGHT = 8
