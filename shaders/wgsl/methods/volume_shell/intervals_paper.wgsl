// The transmittance interval map, with samples kept as in the paper.

#import methods/volume_shell/intervals
#import shared/intervals_encode_paper
