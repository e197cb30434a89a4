// The sum of all levels of indirect light.

#import methods/surfel/add
#import shared/surfel_sum
#constant CHANNELS = 3
