// States of patches after a stretch of time, where no medium dims the lamps' light.

#import shared/light_clear
#import shared/surfels_keep
