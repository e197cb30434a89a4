// States as an integral over the past, where no medium dims the lamps' light.

#import methods/phosphor/glassner
#import shared/light_clear
