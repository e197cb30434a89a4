// Light that surfels scatter into the intervals of rays, with samples kept as in the paper.

#import methods/volume_shell/splat
#import shared/intervals_decode_paper
#constant HEIGHT = 8
