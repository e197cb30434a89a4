// The nodes above the lowest ones of the tree over facets.

#import surfels/parents
#constant HEIGHT = 10
