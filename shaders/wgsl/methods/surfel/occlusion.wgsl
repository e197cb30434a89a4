// Ambient occlusion of a level.

#import methods/surfel/splat
#import shared/surfel_occlusion
#constant CHANNELS = 1
