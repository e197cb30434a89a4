// States of patches after a stretch of time, where the medium dims the lamps' light.

#import shared/light_dimmed
#import shared/surfels_keep
