// The transmittance interval map, with samples in full floats.

#import methods/volume_shell/intervals
#import shared/intervals_encode_wide
