// Direct light that surfels reflect, dimmed by the medium between them and the lamps.

#import shared/light_dimmed
#import shared/surfel_reflected
#import surfels/light
