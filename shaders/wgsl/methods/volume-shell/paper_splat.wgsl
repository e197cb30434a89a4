// Light that surfels scatter into the intervals of rays, with samples kept as in the paper.

#import shared/intervals_splat
#import shared/intervals_decode_paper
#constant HEIGHT = 8
