// States as an integral over the past, where the medium dims the lamps' light.

#import methods/phosphor/glassner
#import shared/light_dimmed
