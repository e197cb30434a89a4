// The nodes above the lowest ones of the tree over facets.

#import shared/tree_parents
#constant HEIGHT = 10
