// Direct light that falls on surfels.

#import shared/light_clear
#import shared/surfel_received
#import surfels/light
