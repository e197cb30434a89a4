// States after a stretch of time, where no medium dims the lamps' light.

#import methods/phosphor/step
#import shared/light_clear
