// Light of the environment that a level blocks.

#import methods/surfel/splat
#import shared/surfel_blocked
#import shared/surfel_colour
