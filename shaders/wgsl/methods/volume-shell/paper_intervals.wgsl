// The transmittance interval map, with samples kept as in the paper.

#import shared/intervals
#import shared/intervals_encode_paper
