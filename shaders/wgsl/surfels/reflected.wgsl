// Direct light that surfels reflect.

#import shared/light_clear
#import shared/surfel_reflected
#import surfels/light
