// Light that surfels scatter into the intervals of rays, with samples in full floats.

#import methods/volume_shell/splat
#import shared/intervals_decode_wide
#constant HEIGHT = 8
