// States after a stretch of time, where the medium dims the lamps' light.

#import shared/glow_step
#import shared/light_dimmed
