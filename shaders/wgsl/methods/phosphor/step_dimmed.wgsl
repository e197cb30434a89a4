// States after a stretch of time, where the medium dims the lamps' light.

#import methods/phosphor/step
#import shared/light_dimmed
