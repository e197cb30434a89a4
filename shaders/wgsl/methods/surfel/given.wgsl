// Light that objects on a level give through themselves.

#import methods/surfel/splat
#import shared/surfel_scattering
#constant CHANNELS = 12
