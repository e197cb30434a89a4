// The sum of all levels of ambient occlusion.

#import methods/surfel/add
#import shared/surfel_openness
#constant CHANNELS = 1
