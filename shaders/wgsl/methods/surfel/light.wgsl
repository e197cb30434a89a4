// Indirect light of a level.

#import methods/surfel/splat
#import shared/surfel_colour
#import shared/surfel_light
