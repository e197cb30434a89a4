// Light that surfels scatter into the intervals of rays, with samples in full floats.

#import shared/intervals_splat
#import shared/intervals_decode_wide
#constant HEIGHT = 8
