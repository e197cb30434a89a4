// States after a stretch of time, where no medium dims the lamps' light.

#import shared/glow_step
#import shared/light_clear
