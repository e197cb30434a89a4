// States as an integral over the past, where no medium dims the lamps' light.

#import shared/glow_glassner
#import shared/light_clear
