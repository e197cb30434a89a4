// The nodes above the lowest ones of the tree over surfels.

#import surfels/parents
#constant HEIGHT = 8
