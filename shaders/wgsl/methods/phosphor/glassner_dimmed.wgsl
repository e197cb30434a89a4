// States as an integral over the past, where the medium dims the lamps' light.

#import shared/glow_glassner
#import shared/light_dimmed
